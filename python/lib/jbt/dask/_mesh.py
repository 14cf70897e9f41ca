"""Meshes brick by brick."""

from __future__ import annotations

import json
import warnings
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from .. import _jbt, _mesh
from .._errors import OpenMeshWarning
from .._mesh import Mesh
from .._model import Model, _region
from .._progress import watcher
from .._types import Progress, Region
from . import _work
from ._bricks import Bricks
from ._cloud import Cloud, CloudBricks
from ._parts import INDEX, Parts, index_of
from ._run import Place, Window, client_of, edge_of, workers

if TYPE_CHECKING:
    from distributed import Client, Future

# Cells beyond a brick that are looked at, at first and where flips of faces lead farther.
REACH = 8


@overload
def mesh(
    model: Model | Cloud,
    cell: float | None = None,
    *,
    resolution: int | None = None,
    region: Region | None = None,
    bricks: int | None = None,
    folder: None = None,
    client: Client | None = None,
    retries: int = 2,
    progress: Progress = None,
    name: str = "scene",
) -> Mesh: ...
@overload
def mesh(
    model: Model | Cloud,
    cell: float | None = None,
    *,
    resolution: int | None = None,
    region: Region | None = None,
    bricks: int | None = None,
    folder: str | PathLike[str],
    client: Client | None = None,
    retries: int = 2,
    progress: Progress = None,
    name: str = "scene",
) -> Parts: ...
def mesh(
    model: Model | Cloud,
    cell: float | None = None,
    *,
    resolution: int | None = None,
    region: Region | None = None,
    bricks: int | None = None,
    folder: str | PathLike[str] | None = None,
    client: Client | None = None,
    retries: int = 2,
    progress: Progress = None,
    name: str = "scene",
) -> Mesh | Parts:
    """The surface as triangles, made by the workers of a cluster: the bytes of `model.mesh(thin=False)`.

    Args:
        model: a model; or particles that no machine has all of, as `points` and `files` make them.
        cell, resolution, region: as for `Model.mesh`.
        bricks: cells along the edge of a brick, a power of two from 32 on. As a rule so many that every
            thread has a few bricks, and that a brick fits into a worker's memory.
        folder: where workers write the parts, on a file system that they share. The result is then `Parts`,
            and the client gets no vertices.
        client: a `distributed.Client`; as a rule the present one.
        retries: how often a task that has failed is tried again. Workers that are lost do not count.
        progress: as for `Model.mesh`. An exception of it, and Ctrl-C, cancel all tasks.
        name: what errors call the scene.

    Raises:
        BrickError: a task has failed for good; it names the scene and the brick.
    """
    found = client_of(client)
    where = None if folder is None else fspath(folder)
    source: _ModelBricks | CloudBricks
    if isinstance(model, Cloud):
        source = CloudBricks(model, cell, resolution, _region(region), bricks, found, retries)
    elif isinstance(model, Model):
        source = _ModelBricks(model, cell, resolution, _region(region), bricks, found, retries)
    else:
        raise TypeError(
            f"model: expected a jbt.Model, or what jbt.dask.points or jbt.dask.files make, got {model!r}"
        )
    results: dict[Place, dict[str, Any]] = {}
    with watcher(progress, "mesh") as told:

        def submit(place: Place, again: int) -> Future:
            reach = REACH * 4**again
            return source.submit(place, reach, where)

        def take(place: Place, result: dict[str, Any] | None) -> int | None:
            if result is None:
                asked[place] = asked.get(place, 0) + 1
                return asked[place]
            results[place] = result
            return None

        asked: dict[Place, int] = {}
        Window(found, name, retries, told).run(source.work, submit, take)
    facts = {
        "origin": source.origin,
        "lattice_origin": source.lattice[0],
        "spacing": source.lattice[1],
        "cells": source.lattice[2],
        "bricks": source.edge,
        "shape_bytes": len(source.shape),
        "shipped_bytes": sum(result["shipped"] for result in results.values()),
        "levels": sorted({result["level"] for result in results.values()}),
    }
    if where is not None:
        index = index_of(results, facts)
        content = json.dumps(index, indent=1).encode()
        found.submit(_work.write_whole, Path(where) / INDEX, content, pure=False, retries=retries).result()
        return Parts(Path(where), index)
    return _joined([result["block"] for result in results.values()], facts, model)


def _joined(blocks: list[bytes], facts: dict[str, Any], model: Model | Cloud) -> Mesh:
    made = _jbt.join(blocks)
    made["spacing"] = facts["spacing"]
    if not blocks:
        made["origin"] = facts["origin"]
        if isinstance(model, Model):
            made["up"], made["handed"] = model.orientation
            for group in model.groups:
                made["attributes"][group.name] = np.empty((0, len(group.default)), np.float32)
    whole = _mesh.of_native(
        {**made, **{key: facts[key] for key in facts if key not in ("origin", "spacing")}}
    )
    if not whole.closed:
        warnings.warn(
            f"the region cuts the surface at its sides {whole.cut_sides}: the mesh is open there",
            OpenMeshWarning,
            stacklevel=3,
        )
    return whole


class _ModelBricks(Bricks):
    """The bricks of a model that the client has."""

    def __init__(
        self,
        model: Model,
        cell: float | None,
        resolution: int | None,
        region: Any,
        bricks: int | None,
        client: Client,
        retries: int,
    ) -> None:
        super().__init__(client, retries)
        native = model._native
        self.lay(native, resolution, cell, region)
        self.source = _jbt.RowSource(native, None)
        threads, memory = workers(client)
        boxes = {(x, y, z): 0 for (x, y, z), _ in native.busy(self.native, 32, None)}
        self.edge = edge_of(bricks, boxes, threads, memory, lambda rows: rows)
        side = self.edge // 32
        weights: dict[Place, int] = {}
        for x, y, z in boxes:
            place = (x // side, y // side, z // side)
            weights[place] = weights.get(place, 0) + 1
        # The heaviest first, so that none is left alone at the end; parts are ordered when they are joined.
        self.work = sorted(weights.items(), key=lambda one: -one[1])
        self.share(self.source.shape())

    def submit(self, place: Place, reach: int, folder: str | None) -> Future:
        rows, _ = self.source.rows(*self.native.bounds(self.edge, list(place), reach))
        return self.client.submit(
            _work.brick,
            self.shared,
            rows,
            self.lattice,
            self.edge,
            place,
            reach,
            folder,
            pure=False,
            retries=self.retries,
        )
