"""Workers of Dask on this machine, compared with one process: bytes, seconds, memory.

    python benches/workers.py hero [RESOLUTION] [WORKERS]        the octopus, 512 cells; 1, 2, 4 workers
    python benches/workers.py strokes [RESOLUTION] [WORKERS]     200 curves, all heard everywhere; 448 cells
    python benches/workers.py particles [COUNT CELLS] [WORKERS]  a million particles of an array
    python benches/workers.py files [COUNT CELLS]                2 x 10^7 particles in files, into parts
    python benches/workers.py paper [RESOLUTION]                 the client's share, 4,096 cells of octopus

Starting the workers does not count. Each line says whether the bytes are those of one process.
"""

from __future__ import annotations

import hashlib
import resource
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import jbt
import jbt.dask
import numpy as np
from jbt.dask._mesh import REACH

ROOT = Path(__file__).resolve().parents[2]


def digest(mesh: jbt.Mesh) -> str:
    """A number for all bytes of a mesh."""
    found = hashlib.sha256()
    for array in (mesh.vertices, mesh.normals, mesh.faces, *mesh.attributes.values()):
        found.update(array.tobytes())
    return found.hexdigest()


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    begun = time.perf_counter()
    made = work()
    return time.perf_counter() - begun, made


def on_workers(count: int, work: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds on so many workers of one thread, which have compiled before."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(
            n_workers=count, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        Client(cluster) as client,
    ):
        client.run(lambda: __import__("jbt.dask"))
        return timed(work)


def table(name: str, whole: Callable[[], jbt.Mesh], parts: Callable[[], jbt.Mesh], only: int) -> None:
    seconds, mesh = timed(whole)
    wanted = digest(mesh)
    print(f"{name}: {mesh}\n  in one process {seconds:.1f} s", flush=True)
    first = 0.0
    for count in (only,) if only else (1, 2, 4):
        took, made = on_workers(count, parts)
        first = first or took
        same = "the same bytes" if digest(made) == wanted else "OTHER BYTES"
        print(
            f"  {count} workers {took:.1f} s, {took / seconds:.2f} of one process, efficiency "
            f"{first / took / min(count, 2):.2f}: {same}; {made.info['shipped_bytes'] / 1e6:.1f} MB of rows, "
            f"bricks of {made.info['bricks']} cells",
            flush=True,
        )


def hero(resolution: int = 512, only: int = 0) -> None:
    model = jbt.load(ROOT / "examples" / "hero.jbt")
    table(
        f"the hero at {resolution}",
        lambda: model.mesh(resolution=resolution, thin=False),
        lambda: jbt.dask.mesh(model, resolution=resolution),
        only,
    )


def strokes(resolution: int = 448, only: int = 0) -> None:
    rng = np.random.default_rng(3)
    curves = [
        jbt.bezier(rng.uniform(-1, 1, (4, 3)), radius=2.0, falloff=jbt.blinn(hardness=8)) for _ in range(200)
    ]
    model = jbt.ricci(*curves, exponent=3)
    table(
        f"200 strokes at {resolution}",
        lambda: model.mesh(resolution=resolution, thin=False),
        lambda: jbt.dask.mesh(model, resolution=resolution),
        only,
    )


def particles(count: int = 1_000_000, cells: int = 512, only: int = 0) -> None:
    from dask import array

    xyz = np.random.default_rng(1).uniform(-1, 1, (count, 3))
    # Four times the mean distance: a fluid, and not as many balls.
    radius = 0.04 * (1_000_000 / count) ** (1 / 3)

    def parts() -> jbt.Mesh:
        places = array.from_array(xyz, chunks=(max(1, count // 8), 3))
        return jbt.dask.mesh(jbt.dask.points(places, radius=radius), resolution=cells)

    table(
        f"{count:,} particles at {cells}",
        lambda: jbt.points(xyz, radius=radius).mesh(resolution=cells, thin=False),
        parts,
        only,
    )


def files(count: int = 20_000_000, cells: int = 512) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder, chunk = Path(name), 1_000_000
        (folder / "in").mkdir()
        rng = np.random.default_rng(2)
        for index, at in enumerate(range(0, count, chunk)):
            size = min(chunk, count - at)
            # A fluid comes in order: slabs along x.
            part = rng.uniform(-1, 1, (size, 3))
            part[:, 0] = -1 + 2 * (at + (part[:, 0] + 1) / 2 * size) / count
            np.save(folder / "in" / f"{index:04}.npy", part.astype(np.float32))
        del part
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

        def work() -> jbt.dask.Parts:
            paths = sorted((folder / "in").iterdir())
            radius = 0.04 * (1_000_000 / count) ** (1 / 3)
            cloud = jbt.dask.files(paths, allow_files=folder / "in", radius=radius)
            return jbt.dask.mesh(cloud, resolution=cells, folder=folder / "out")

        took, made = on_workers(2, work)
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        print(f"{count:,} particles in files at {cells}: {took:.1f} s, {made}")
        print(f"  the client had {most / 1024:.0f} MB at most, {before / 1024:.0f} MB before")


def paper(resolution: int = 4096) -> None:
    """What the client does before and between the bricks. None of them is made."""
    native = jbt.load(ROOT / "examples/hero.jbt")._native
    lattice, _ = native.lattice(resolution, None, None)
    source = jbt._jbt.RowSource(native, None)
    print(f"the octopus at {resolution}: {len(source.shape()) / 1e3:.0f} kB of shape")

    def rows(edge: int, places: list[Any]) -> int:
        """Bytes of the rows of all bricks."""
        return sum(len(source.rows(*lattice.bounds(edge, list(place), REACH))[0]) for place, _ in places)

    for edge in (256, 128):
        asked, places = timed(partial(native.busy, lattice, edge, None))
        took, size = timed(partial(rows, edge, places))
        count = len(places)
        print(
            f"  bricks of {edge}: {count:,}; ranges {asked:.1f} s; rows {took:.1f} s, "
            f"{1e3 * took / count:.1f} ms and {size / 1e3 / count:.0f} kB a brick, {size / 1e6:.0f} MB",
            flush=True,
        )


def main() -> None:
    warnings.simplefilter("ignore")
    words: dict[str, Callable[..., None]] = {
        "hero": hero,
        "strokes": strokes,
        "particles": particles,
        "files": files,
        "paper": paper,
    }
    word, *numbers = sys.argv[1:] or ["hero"]
    words[word](*(int(number) for number in numbers))


if __name__ == "__main__":
    main()
