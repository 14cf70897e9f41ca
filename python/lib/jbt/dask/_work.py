"""What workers do. Arguments are numbers, arrays and bytes that are checked when they are read."""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from .. import _jbt
from .._model import Model, loads
from .._points import points
from ._run import Kept, Place

# A lattice: its first corner, the edge of a cell, cells along the axes.
LatticeParts = tuple[list[float], float, list[int]]
Columns = dict[str, Any]

SHAPES = Kept(_jbt.Shape)
MODELS = Kept(lambda text: loads(text))


def lattice_of(parts: LatticeParts) -> _jbt.Lattice:
    origin, spacing, cells = parts
    return _jbt.Lattice(origin, spacing, cells)


def brick(
    shape: bytes,
    rows: bytes,
    lattice: LatticeParts,
    edge: int,
    place: Place,
    reach: int,
    folder: str | None,
) -> dict[str, Any] | None:
    """The part of a mesh in a brick: as bytes, or written to a file of a folder. None if rows of a larger
    reach are needed."""
    made = SHAPES(shape).block(rows, lattice_of(lattice), edge, list(place), reach, 1)
    if made is None:
        return None
    vertices, triangles, _, is_open, sides = _jbt.block_facts(made)
    facts = {
        "place": place,
        "vertices": vertices,
        "triangles": triangles,
        "open": is_open,
        "cut_sides": sides,
        "level": _jbt.cpu_level(),
        "bytes": len(made),
        "shipped": len(rows),
    }
    if folder is None or not (triangles or vertices):
        return {**facts, "block": made}
    name = "brick-{}-{}-{}.jbtblock".format(*place)
    write_whole(Path(folder) / name, made)
    return {**facts, "file": name, "sha256": hashlib.sha256(made).hexdigest()}


def write_whole(path: Path, content: bytes) -> None:
    """A file appears whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=".jbt-", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        Path(name).chmod(0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def inside(path: str, root: str) -> Path:
    """A path that a worker may open: below the root, wherever links lead."""
    found = Path(path).resolve()
    if not found.is_relative_to(Path(root).resolve()):
        raise PermissionError(f"{path}: workers open files below {root} alone (allow_files)")
    return found


# Clouds.


def read_npy(path: str, root: str, first: int, end: int, columns: Columns) -> Columns:
    """Some particles of a file of NumPy: places, or places and radii."""
    rows = np.load(inside(path, root), mmap_mode="r", allow_pickle=False)[first:end]
    found = np.asarray(rows, np.float64)
    made = {**columns, "xyz": found[:, :3]}
    if found.shape[1] == 4:
        made["radius"] = found[:, 3]
    return checked(made, path)


def npy_shape(path: str, root: str) -> tuple[int, ...]:
    """The shape of the array in a file of NumPy."""
    shape: tuple[int, ...] = np.load(inside(path, root), mmap_mode="r", allow_pickle=False).shape
    return shape


def given(xyz: Any, radius: Any, color: Any, strength: Any, falloff: str) -> Columns:
    """Particles from arrays."""
    return checked(
        {"xyz": xyz, "radius": radius, "color": color, "strength": strength, "falloff": falloff}, "xyz"
    )


def checked(columns: Columns, name: str) -> Columns:
    """Particles as arrays of f64, if they are good ones."""
    xyz = np.ascontiguousarray(columns["xyz"], np.float64)
    if xyz.ndim != 2 or xyz.shape[1] != 3:
        raise ValueError(f"{name}: expected the shape (n, 3), got {xyz.shape}")
    if not np.isfinite(xyz).all():
        index = int((~np.isfinite(xyz).all(axis=1)).argmax())
        raise ValueError(f"{name}: expected finite numbers, got {xyz[index].tolist()} at [{index}]")
    made: Columns = {"xyz": xyz, "falloff": columns["falloff"], "color": columns["color"]}
    for column in ("radius", "strength"):
        made[column] = np.atleast_1d(np.asarray(columns[column], np.float64))
        if len(made[column]) not in (1, len(xyz)):
            raise ValueError(f"{column}: expected one number, or {len(xyz)}, got {len(made[column])}")
    if (made["radius"] <= 0).any():
        raise ValueError(f"{name}: expected radii above 0, got {made['radius'].min()}")
    if made["color"] is not None:
        made["color"] = np.atleast_2d(np.asarray(made["color"], np.float64))
    return made


def some(columns: Columns, index: Any) -> Columns:
    """Some particles."""
    count = len(columns["xyz"])
    many = {
        name: values[index]
        for name, values in columns.items()
        if isinstance(values, np.ndarray) and len(values) == count and (count != 1 or name == "xyz")
    }
    return {**columns, **many}


def joined(parts: list[Columns]) -> Columns:
    """The particles of all parts."""
    made = dict(parts[0])
    made["xyz"] = np.concatenate([part["xyz"] for part in parts])
    for name in ("radius", "strength", "color"):
        if parts[0][name] is None:
            continue
        if all(len(part[name]) == 1 and (part[name] == parts[0][name]).all() for part in parts):
            continue
        wide = [np.broadcast_to(p[name], (len(p["xyz"]), *p[name].shape[1:])) for p in parts]
        made[name] = np.concatenate(wide)
    return made


def model_of(columns: Columns, each: tuple[str, ...] = ()) -> Model:
    """The model of particles. Columns in `each` have a number for every particle, whatever these are."""
    count = len(columns["xyz"])
    wide = dict(columns)
    for name in ("radius", "strength", "color"):
        values = wide[name]
        if name in each:
            wide[name] = np.broadcast_to(values, (count, *values.shape[1:]))
        elif values is not None and len(values) == 1:
            wide[name] = values[0]
    return points(wide.pop("xyz"), **wide)


def cloud_facts(columns: Columns, cell: float | None) -> dict[str, Any]:
    """What the client has to know of a chunk: how many there are, those that reach farthest, and which
    columns differ."""
    xyz, radius = columns["xyz"], columns["radius"]
    count = len(xyz)
    facts: dict[str, Any] = {"count": count}
    facts["each"] = tuple(
        name
        for name in ("radius", "strength", "color")
        if columns[name] is not None and len(columns[name]) > 1 and count > 1
    )
    facts["first"] = {n: columns[n][:1].tolist() for n in ("radius", "strength") if len(columns[n])}
    if not count:
        return facts
    low, high = xyz - radius[:, None], xyz + radius[:, None]
    ends = [low.argmin(axis=0), low.argmax(axis=0), high.argmin(axis=0), high.argmax(axis=0)]
    chosen = {int(index) for end in ends for index in end}
    strength = np.broadcast_to(columns["strength"], (count,))
    for kind in (strength == 1.0, strength != 1.0):
        if kind.any():
            chosen.add(int(kind.argmax()))
    facts["farthest"] = some(columns, sorted(chosen))
    facts["most_radius"] = float(radius.max())
    return facts


def places_of(
    columns: Columns, lattice: LatticeParts, origin: list[float], edge: int, reach: int
) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """For each brick that a particle reaches, the particle and the brick: sorted by bricks, particles
    ascending. A few more than those that reach it."""
    first, spacing, cells = lattice
    bricks = np.array([-(-count // edge) for count in cells])
    low = columns["xyz"] - (np.asarray(origin) + np.asarray(first))
    # Coordinates of f32, and supports a little enlarged.
    size = np.abs(np.asarray(first)).max() + spacing * max(cells)
    far = columns["radius"] * (1 + 1e-5) + 1e-5 * size + reach * spacing
    ends = [np.floor((low + sign * far[:, None]) / (spacing * edge)).astype(np.int64) for sign in (-1, 1)]
    begin, end = np.maximum(ends[0], 0), np.minimum(ends[1], bricks - 1)
    index, numbers = [], []
    spans = (end - begin).max(axis=0, initial=0)
    for dz in range(int(spans[2]) + 1):
        for dy in range(int(spans[1]) + 1):
            for dx in range(int(spans[0]) + 1):
                place = begin + (dx, dy, dz)
                mine = np.flatnonzero((place <= end).all(axis=1))
                x, y, z = place[mine].T
                index.append(mine)
                numbers.append((z * bricks[1] + y) * bricks[0] + x)
    particles, number = np.concatenate(index), np.concatenate(numbers)
    order = np.lexsort((particles, number))
    return particles[order], number[order]


def cut(
    columns: Columns, lattice: LatticeParts, origin: list[float], edge: int, reach: int
) -> dict[int, Columns]:
    """The particles of a chunk by brick."""
    particles, numbers = places_of(columns, lattice, origin, edge, reach)
    keys, starts = np.unique(numbers, return_index=True)
    ends = [*starts[1:], len(numbers)]
    return {
        int(key): some(columns, particles[start:end])
        for key, start, end in zip(keys, starts, ends, strict=True)
    }


def counts(parts: dict[int, Columns]) -> dict[int, int]:
    """How many particles of a chunk are in each brick."""
    return {number: len(part["xyz"]) for number, part in parts.items()}


def count_boxes(columns: Columns, lattice: LatticeParts, origin: list[float]) -> dict[int, int]:
    """How many particles of a chunk reach each box of 32 cells."""
    if not len(columns["xyz"]):
        return {}
    _, numbers = places_of(columns, lattice, origin, 32, 0)
    keys, found = np.unique(numbers, return_counts=True)
    return dict(zip(keys.tolist(), found.tolist(), strict=True))


def pick(parts: dict[int, Columns], number: int) -> Columns:
    return parts[number]


def pick_near(
    columns: Columns, number: int, lattice: LatticeParts, origin: list[float], edge: int, reach: int
) -> Columns:
    """The particles of a chunk that reach a brick from farther away."""
    particles, numbers = places_of(columns, lattice, origin, edge, reach)
    return some(columns, particles[numbers == number])


def cloud_rows(
    shape: bytes,
    parts: list[Columns],
    each: tuple[str, ...],
    kinds: Columns | None,
    origin: list[float],
    box: tuple[list[float], list[float]],
) -> bytes:
    """The rows of particles that reach a box, of a cloud with this shape."""
    columns = joined(parts)
    if kinds is not None:
        # Of each kind of code that the whole has one, far away: it reaches no brick.
        columns = joined([columns, kinds])
    source = _jbt.RowSource(model_of(columns, each).with_origin(origin)._native, None)
    if source.shape() != shape:
        raise RuntimeError(
            "the particles of a brick have another program than the whole: a defect of jbt.dask"
        )
    return source.rows(*box)[0]


def cloud_brick(
    shape: bytes,
    parts: list[Columns],
    each: tuple[str, ...],
    kinds: Columns | None,
    origin: list[float],
    lattice: LatticeParts,
    edge: int,
    place: Place,
    reach: int,
    folder: str | None,
) -> dict[str, Any] | None:
    """The part of a mesh of particles in a brick: see `brick`."""
    box = lattice_of(lattice).bounds(edge, list(place), reach)
    rows = cloud_rows(shape, parts, each, kinds, origin, box)
    return brick(shape, rows, lattice, edge, place, reach, folder)


# Samples, sweeps, frames.


def sample(
    shape: bytes,
    rows: bytes,
    query: tuple[bool, bool],
    lattice: LatticeParts,
    first: list[int],
    points_: list[int],
) -> list[np.ndarray[Any, Any]]:
    """The answers at points of a lattice: one array for each plane."""
    cells = lattice[2]
    # A lattice has a cell at least: of a single layer of points the one below is taken too.
    single = [count == 1 for count in points_]
    begin = [
        at - 1 if one and at + 1 > last else at for at, one, last in zip(first, single, cells, strict=True)
    ]
    count = [max(1, points - 1) for points in points_]
    _, planes = SHAPES(shape).sample(rows, query, lattice_of(lattice), begin, count, 1)
    cut_ = tuple(
        slice(at - start, at - start + points)
        for at, start, points in zip(first, begin, points_, strict=True)
    )
    return [np.ascontiguousarray(plane[cut_]) for plane in planes]


def measured(text: str, parameters: dict[str, float], what: Any) -> dict[str, Any]:
    """A model with other values of its parameters, and what is asked of it."""
    model = MODELS(text).with_parameters(parameters)
    if callable(what):
        return {**parameters, "result": what(model)}
    found = {}
    for word in what:
        value = getattr(model, word)
        found[word] = value.tolist() if isinstance(value, np.ndarray) else value
    return {**parameters, **found}
