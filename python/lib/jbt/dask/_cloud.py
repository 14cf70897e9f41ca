"""Particles that no machine has all of: in arrays of Dask, or in files that workers read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _jbt
from . import _work
from ._bricks import Bricks
from ._run import Place, client_of, edge_of, workers

if TYPE_CHECKING:
    from distributed import Client, Future

# Particles of a chunk that is read from a file.
CHUNK = 1_000_000
# Bytes of a particle, its rows and its supports while a brick is made.
PARTICLE_BYTES = 600


@dataclass(frozen=True)
class Cloud:
    """Particles in chunks, in their order. `jbt.dask.points` and `jbt.dask.files` make one.

    Attributes:
        chunks: tasks that give the particles of a chunk as arrays.
        each: columns that have a number for every particle: "radius", "strength", "color".
        common: what all particles have in common.
    """

    chunks: tuple[Any, ...]
    each: tuple[str, ...] = ()
    common: dict[str, Any] = field(default_factory=dict)

    def futures(self, client: Client) -> list[Future]:
        """The chunks, on the workers."""
        made: list[Future] = client.compute(list(self.chunks))
        return made


def points(xyz: Any, *, radius: Any, color: Any = None, strength: Any = 1.0, falloff: str = "soft") -> Cloud:
    """Particles from arrays of Dask: the sum that `jbt.points` makes of all of them, in their order.

    Args:
        xyz: a `dask.array` of the shape (n, 3), in chunks of rows.
        radius, color, strength: one value for all, or an array of Dask with the same chunks of rows.
        falloff: the name of a falloff.
    """
    from dask import array, delayed

    if not isinstance(xyz, array.Array) or xyz.ndim != 2 or xyz.shape[1] != 3:
        shape = getattr(xyz, "shape", type(xyz).__name__)
        raise ValueError(f"xyz: expected a dask.array of the shape (n, 3), got {shape}")
    if xyz.dtype.kind not in "fiu":
        raise TypeError(f"xyz: expected numbers, got the dtype {xyz.dtype}")
    rows = xyz.rechunk({1: 3}).to_delayed().ravel()
    lists, each = {}, []
    for name, given in (("radius", radius), ("color", color), ("strength", strength)):
        if isinstance(given, array.Array):
            if given.chunks[0] != xyz.chunks[0]:
                raise ValueError(f"{name}: expected chunks as those of xyz, got {given.chunks[0]}")
            whole = given.rechunk({1: -1}) if given.ndim == 2 else given
            lists[name] = whole.to_delayed().ravel()
            each.append(name)
        else:
            value = None if given is None else np.asarray(given, np.float64)
            lists[name] = [value] * len(rows)
    if radius is not None and not isinstance(radius, array.Array) and not np.asarray(radius).ndim == 0:
        raise ValueError("radius: expected one number, or a dask.array")
    make = delayed(_work.given, pure=True)
    parts = zip(rows, lists["radius"], lists["color"], lists["strength"], strict=True)
    return Cloud(tuple(make(a, b, c, d, falloff) for a, b, c, d in parts), tuple(each))


def files(
    paths: str | PathLike[str] | Sequence[str | PathLike[str]],
    *,
    allow_files: str | PathLike[str],
    radius: float | None = None,
    color: Any = None,
    strength: float = 1.0,
    falloff: str = "soft",
    chunk: int = CHUNK,
    client: Client | None = None,
) -> Cloud:
    """Particles from files of NumPy (`.npy`) that workers read: arrays of the shape (n, 3) for places, or
    (n, 4) for places and radii. All files together are one cloud, in the order of the paths.

    Args:
        paths: files that the workers see.
        allow_files: the folder below which workers may open files.
        radius: where the fields reach zero, for files of places alone.
        color, strength, falloff: those of all particles, as for `jbt.points`.
        chunk: particles that are read at once.
    """
    from dask import delayed

    given = [fspath(path) for path in ([paths] if isinstance(paths, str | PathLike) else paths)]
    if not given:
        raise ValueError("paths: expected at least one file, got none")
    root = fspath(allow_files)
    found = client_of(client)
    shapes = found.gather([found.submit(_work.npy_shape, path, root, pure=False) for path in given])
    common = {
        "radius": radius,
        "strength": strength,
        "falloff": falloff,
        "color": None if color is None else np.asarray(color, np.float64).reshape(1, 3),
    }
    read = delayed(_work.read_npy, pure=True)
    chunks, widths = [], set()
    for path, shape in zip(given, shapes, strict=True):
        if len(shape) != 2 or shape[1] not in (3, 4):
            raise ValueError(f"{path}: expected the shape (n, 3) or (n, 4), got {shape}")
        widths.add(shape[1])
        chunks += [
            read(path, root, at, min(at + chunk, shape[0]), common) for at in range(0, shape[0], chunk)
        ]
    if len(widths) > 1:
        raise ValueError("paths: some files have radii and others have none")
    if widths == {3} and radius is None:
        raise ValueError("radius: expected a number, because the files have places alone")
    return Cloud(tuple(chunks), ("radius",) if widths == {4} else ())


class CloudBricks(Bricks):
    """The bricks of particles. The client sees counts, and the few particles that reach farthest."""

    def __init__(
        self,
        cloud: Cloud,
        cell: float | None,
        resolution: int | None,
        region: Any,
        bricks: int | None,
        client: Client,
        retries: int,
    ) -> None:
        super().__init__(client, retries)
        self.chunks = cloud.futures(client)
        self.each = cloud.each
        facts = client.gather([client.submit(_work.cloud_facts, chunk, cell) for chunk in self.chunks])
        some = [one["farthest"] for one in facts if one["count"]]
        if not some:
            raise ValueError("xyz: expected at least one point, got none: a model needs a primitive")
        farthest = _work.joined(some)
        model = _work.model_of(farthest, self.each)
        self.lay(model._native, resolution, cell, region)
        self.share(_jbt.RowSource(model.with_origin(self.origin)._native, None).shape())
        self.kinds = self._kinds(farthest)
        self._size(bricks)
        place = (self.lattice, self.origin, self.edge)
        self.cuts = [client.submit(_work.cut, chunk, *place, 8, pure=False) for chunk in self.chunks]
        found = client.gather([client.submit(_work.counts, part, pure=False) for part in self.cuts])
        self.where: dict[int, list[int]] = {}
        weights: dict[int, int] = {}
        for chunk, counts in enumerate(found):
            for number, count in counts.items():
                self.where.setdefault(number, []).append(chunk)
                weights[number] = weights.get(number, 0) + count
        self.work = [(self._place(number), weight) for number, weight in sorted(weights.items())]

    def _kinds(self, farthest: dict[str, Any]) -> dict[str, Any] | None:
        """Of each kind of code that the particles have one, so far away that it reaches no brick. None if all
        have the same code."""
        strength = np.broadcast_to(farthest["strength"], (len(farthest["xyz"]),))
        kinds = [np.flatnonzero(strength == 1.0)[:1], np.flatnonzero(strength != 1.0)[:1]]
        if not all(len(kind) for kind in kinds):
            return None
        first, spacing, cells = self.lattice
        chosen = _work.some(farthest, np.concatenate(kinds))
        far = (
            np.asarray(self.origin) + np.asarray(first) - 4 * (spacing * max(cells) + chosen["radius"].max())
        )
        return {**chosen, "xyz": np.broadcast_to(far, (2, 3)).copy()}

    def _size(self, bricks: int | None) -> None:
        threads, memory = workers(self.client)
        boxes: dict[Place, int] = {}
        if bricks is None:
            tasks = [
                self.client.submit(_work.count_boxes, chunk, self.lattice, self.origin, pure=False)
                for chunk in self.chunks
            ]
            self.edge = 32
            for counts in self.client.gather(tasks):
                for number, count in counts.items():
                    place = self._place(number)
                    boxes[place] = boxes.get(place, 0) + count
        self.edge = edge_of(bricks, boxes, threads, memory, lambda rows: PARTICLE_BYTES * rows)

    def _counts(self) -> list[int]:
        return [-(-cells // self.edge) for cells in self.lattice[2]]

    def _place(self, number: int) -> Place:
        nx, ny, _ = self._counts()
        return number % nx, number // nx % ny, number // (nx * ny)

    def submit(self, place: Place, reach: int, folder: str | None) -> Future:
        nx, ny, _ = self._counts()
        number = (place[2] * ny + place[1]) * nx + place[0]
        submit = self.client.submit
        where = (self.lattice, self.origin, self.edge)
        if reach == 8:
            parts = [submit(_work.pick, self.cuts[n], number, pure=False) for n in self.where[number]]
        else:
            parts = [
                submit(_work.pick_near, chunk, number, *where, reach, pure=False) for chunk in self.chunks
            ]
        return submit(
            _work.cloud_brick,
            self.shared,
            parts,
            self.each,
            self.kinds,
            self.origin,
            self.lattice,
            self.edge,
            place,
            reach,
            folder,
            pure=False,
            retries=self.retries,
        )
