"""A sequence of particle files: a mesh of each, and none twice."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _jbt
from .._model import Model, _region, load
from .._points import points
from .._progress import watcher
from .._types import Progress, Region
from . import _work
from ._run import BrickError, cancelling, client_of

if TYPE_CHECKING:
    from distributed import Client


def frames(
    files: Sequence[str | PathLike[str]],
    folder: str | PathLike[str],
    *,
    allow_files: str | PathLike[str],
    cell: float | None = None,
    resolution: int | None = None,
    region: Region | None = None,
    radius: float | None = None,
    color: Any = None,
    format: str = "glb",
    client: Client | None = None,
    retries: int = 2,
    progress: Progress = None,
) -> list[dict[str, Any]]:
    """Meshes each file of a sequence into a folder: `fluid-0007.npy` becomes `fluid-0007.glb`. A mesh that is
    there with the right hash is not made again, so work that was stopped goes on where it was.

    Args:
        files: arrays of NumPy (`.npy`) of the shape (n, 3) for places or (n, 4) for places and radii; or any
            files that `jbt.load` reads. Workers read them.
        folder: where workers write, each file whole or not at all. Beside each is a small file `.json` with
            the hash of what it was made of, and of what it is.
        allow_files: the folder below which workers may open files.
        cell, resolution, region: as for `Model.mesh`. For a sequence, a cell and a region keep meshes alike.
        radius, color: of particles in arrays, as for `jbt.points`.
        format: that of the meshes, `jbt.MESH_FORMATS`.

    Returns:
        For each file a dictionary: `file`, `mesh`, `made` (whether it was made now), `triangles`, `sha256`.
    """
    found = client_of(client)
    if format not in _jbt.mesh_formats():
        raise ValueError(f"format: expected one of {', '.join(_jbt.mesh_formats())}, got {format!r}")
    paths = [fspath(path) for path in files]
    stems = [Path(path).stem for path in paths]
    if len(set(stems)) != len(stems):
        raise ValueError("files: expected different names, because meshes are named like their files")
    settings = {
        "resolution": resolution,
        "cell": cell,
        "region": _region(region),
        "radius": radius,
        "color": None if color is None else np.asarray(color, np.float64).tolist(),
        "format": format,
        "version": _jbt.__version__,
    }
    root, target = fspath(allow_files), fspath(folder)
    futures = {
        found.submit(frame, path, root, target, settings, pure=False, retries=retries): path for path in paths
    }
    from distributed import as_completed

    made: dict[str, dict[str, Any]] = {}
    with watcher(progress, "frames") as told, cancelling(found, futures):
        for future in as_completed(list(futures)):
            path = futures[future]
            try:
                made[path] = future.result()
            except Exception as error:
                raise BrickError(f"{path}: {str(error) or type(error).__name__}", path) from error
            if told is not None:
                told(len(made) / len(paths))
    return [made[path] for path in paths]


def frame(path: str, root: str, folder: str, settings: dict[str, Any]) -> dict[str, Any]:
    """One mesh of a sequence, on a worker."""
    file = _work.inside(path, root)
    wanted = hashlib.sha256(json.dumps(settings, sort_keys=True).encode())
    with file.open("rb") as stream:
        while block := stream.read(1 << 20):
            wanted.update(block)
    target = Path(folder) / f"{file.stem}.{settings['format']}"
    note = target.with_name(target.name + ".json")
    told = _told(note, target, wanted.hexdigest())
    if told is not None:
        return {"file": path, "mesh": str(target), "made": False, **told}
    mesh = _model(file, settings)._native.mesh(
        settings["resolution"], settings["cell"], settings["region"], False, False, None, 1, None
    )
    from .._mesh import of_native

    target.parent.mkdir(parents=True, exist_ok=True)
    whole = of_native(mesh)
    whole.save(target, format=settings["format"])
    told = {"triangles": len(whole.faces), "sha256": hashlib.sha256(target.read_bytes()).hexdigest()}
    _work.write_whole(note, json.dumps({"made_of": wanted.hexdigest(), **told}).encode())
    return {"file": path, "mesh": str(target), "made": True, **told}


def _told(note: Path, target: Path, wanted: str) -> dict[str, Any] | None:
    """What is noted of a mesh, if it is there and is what is wanted."""
    try:
        known = json.loads(note.read_text())
        if known["made_of"] != wanted or hashlib.sha256(target.read_bytes()).hexdigest() != known["sha256"]:
            return None
        return {"triangles": int(known["triangles"]), "sha256": str(known["sha256"])}
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _model(file: Path, settings: dict[str, Any]) -> Model:
    if file.suffix != ".npy":
        return load(file)
    rows = np.load(file, allow_pickle=False)
    if rows.ndim != 2 or rows.shape[1] not in (3, 4):
        raise ValueError(f"{file}: expected the shape (n, 3) or (n, 4), got {rows.shape}")
    radius = rows[:, 3] if rows.shape[1] == 4 else settings["radius"]
    if radius is None:
        raise ValueError("radius: expected a number, because the files have places alone")
    return points(rows[:, :3], radius=radius, color=settings["color"])
