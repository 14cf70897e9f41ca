"""Answers at the points of a lattice, as arrays of Dask."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from .. import _jbt
from .._grid import Grid
from .._model import Model, _region
from .._types import Region
from . import _work


def sample_grid(
    model: Model,
    cell: float | None = None,
    *,
    resolution: int | None = None,
    region: Region | None = None,
    bricks: int = 128,
    gradient: bool = False,
    attributes: bool = False,
) -> Grid:
    """The answers at all points of a lattice, as a `jbt.Grid` whose planes are arrays of Dask: nothing is
    computed yet. Their chunks are bricks; the numbers are those of `Model.sample`, to the bit.

    Args:
        cell, resolution, region, gradient, attributes: as for `Model.sample`.
        bricks: points along the edge of a chunk.
    """
    from dask import array

    if bricks < 2:
        raise ValueError(f"bricks: expected 2 or more points, got {bricks}")
    native = model._native
    made, origin = native.lattice(resolution, cell, _region(region))
    first, spacing, cells = made.parts()
    lattice = (list(first), spacing, list(cells))
    query = (gradient, attributes)
    source = _jbt.RowSource(native, query)
    shape = source.shape()
    points = [count + 1 for count in cells]
    chunks = tuple(tuple(min(bricks, count - at) for at in range(0, count, bricks)) for count in points)
    names, groups = _names(model, gradient, attributes)
    token = hashlib.sha256(shape + repr((lattice, bricks)).encode())
    graph: dict[Any, Any] = {}
    tasks: dict[tuple[int, int, int], tuple[bytes, list[int], list[int]]] = {}
    for at in np.ndindex(*(len(axis) for axis in chunks)):
        begin = [index * bricks for index in at]
        count = [chunks[axis][index] for axis, index in enumerate(at)]
        low = [max(0, b - 1) if c == 1 else b for b, c in zip(begin, count, strict=True)]
        high = [min(e, b + max(1, c - 1)) for b, c, e in zip(begin, count, cells, strict=True)]
        box = made.points(low, [h - b for h, b in zip(high, low, strict=True)])
        rows, _ = source.rows(*box)
        token.update(rows)
        tasks[at[0], at[1], at[2]] = (rows, begin, count)
    name = "jbt-sample-" + token.hexdigest()[:32]
    graph[f"{name}-shape"] = shape
    planes = []
    for at3, (rows, begin, count) in tasks.items():
        graph[(f"{name}-all", *at3)] = (_work.sample, f"{name}-shape", rows, query, lattice, begin, count)
    from operator import getitem

    for plane in range(len(names)):
        mine = dict(graph)
        key = f"{name}-{plane}"
        mine.update({(key, *at3): (getitem, (f"{name}-all", *at3), plane) for at3 in tasks})
        planes.append(array.Array(mine, key, chunks, dtype=np.float32))
    x, y, z = (o + f for o, f in zip(origin, first, strict=True))
    return Grid(planes, names, groups, (x, y, z), spacing)


def sample(model: Model, cell: float | None = None, **options: Any) -> Any:
    """The field at all points of a lattice as a `dask.array` with indices for x, y and z: see `sample_grid`.

    `jbt.dask.sample(model, 0.01).to_zarr("field.zarr")` writes it, a brick at a time.
    """
    return sample_grid(model, cell, **options).planes[0]


def _names(model: Model, gradient: bool, attributes: bool) -> tuple[list[str], list[tuple[str, int, int]]]:
    evaluator = model.compile(gradient=gradient, attributes=attributes)._native
    return evaluator.names(), evaluator.groups()
