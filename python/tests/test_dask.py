"""Workers of Dask make what one machine makes, to the bit; and say what goes wrong."""

from __future__ import annotations

import json
import os
import resource
import signal
import threading
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jbt
import numpy as np
import pytest

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")

import jbt.dask  # noqa: E402
from jbt import _jbt  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
RESOLUTION = 120


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """Two processes, of which one thread each works."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        settings = {"distributed.scheduler.allowed-failures": 6, "distributed.admin.log-length": 0}
        with dask.config.set(settings):
            made = distributed.LocalCluster(
                n_workers=2, threads_per_worker=1, dashboard_address=None, memory_limit="2GB", silence_logs=50
            )
            yield made
            made.close()


@pytest.fixture(scope="module")
def client(cluster: Any) -> Iterator[Any]:
    made = distributed.Client(cluster)
    yield made
    made.close()


@pytest.fixture(autouse=True)
def _quiet() -> Iterator[None]:
    """Sockets of killed workers are no fault of the tests."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        warnings.simplefilter("ignore", UserWarning)
        yield


def same(a: jbt.Mesh, b: jbt.Mesh) -> None:
    """All bytes are equal."""
    assert a.vertices.shape == b.vertices.shape
    for name in ("vertices", "normals", "faces"):
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes(), name
    assert a.attributes.keys() == b.attributes.keys()
    for name, values in a.attributes.items():
        assert values.tobytes() == b.attributes[name].tobytes(), name
    assert (a.origin, a.up, a.handed, a.closed) == (b.origin, b.up, b.handed, b.closed)


def particles(count: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    return rng.uniform(-1, 1, (count, 3)), rng.uniform(0.06, 0.1, count)


def test_hero(hero: jbt.Model, client: Any) -> None:
    whole = hero.mesh(resolution=RESOLUTION, thin=False)
    told: list[float] = []
    made = jbt.dask.mesh(hero, resolution=RESOLUTION, bricks=32, client=client, progress=told.append)
    same(made, whole)
    assert told[-1] == 1.0
    assert told == sorted(told)
    assert made.info["levels"] == [_jbt.cpu_level()]
    # Bricks as large as they are best.
    same(jbt.dask.mesh(hero, resolution=RESOLUTION), whole)


def test_models(client: Any) -> None:
    ball = jbt.point(radius=1, color=(1, 0.5, 0)).attribute("rough", 0.25).with_orientation("y", "left")
    far = ball.translate((1e6, 0, 3e5))
    walls = jbt.union(ball.within((-0.5, -1, -1), (0.4, 1, 1)), ball.translate((0.6, 0.2, 0)))
    for model in (far, walls):
        same(jbt.dask.mesh(model, resolution=70, bricks=32), model.mesh(resolution=70, thin=False))


def test_what_leaves_the_region_is_open(client: Any) -> None:
    ball = jbt.point(surface_radius=1)
    region = ((-0.8, -2, -2), (2, 2, 0.3))
    with pytest.warns(jbt.OpenMeshWarning, match=r"at its sides -x \+z"):
        whole = ball.mesh(cell=0.05, region=region, thin=False)
    with pytest.warns(jbt.OpenMeshWarning, match=r"at its sides -x \+z"):
        made = jbt.dask.mesh(ball, 0.05, region=region, bricks=32)
    same(made, whole)
    assert not made.closed
    nothing = jbt.dask.mesh(ball, 0.05, region=((2, 2, 2), (3, 3, 3)))
    assert len(nothing.faces) == 0
    assert nothing.closed
    with pytest.raises(ValueError, match="unbounded"):
        jbt.dask.mesh(jbt.expression(jbt.x), 0.1)
    with pytest.raises(ValueError, match="empty"):
        jbt.dask.mesh(ball & ball.translate((9, 0, 0)), 0.1)
    with pytest.raises(ValueError, match="power of two"):
        jbt.dask.mesh(ball, 0.1, bricks=48)
    with pytest.raises(TypeError, match=r"expected a jbt\.Model"):
        jbt.dask.mesh("ball", 0.1)  # type: ignore[call-overload]


@pytest.mark.parametrize("strengths", [False, True])
def test_particles_in_arrays(client: Any, strengths: bool) -> None:
    from dask import array

    xyz, radius = particles()
    color = np.random.default_rng(4).uniform(0, 1, (len(xyz), 3))
    # In the first chunks all strengths are 1: other code than in the last ones.
    strength = np.where(np.arange(len(xyz)) < 2500, 1.0, 0.8) if strengths else 1.0
    whole = jbt.points(xyz, radius=radius, color=color, strength=strength).mesh(cell=0.025, thin=False)

    def chunked(values: Any) -> Any:
        return array.from_array(values, chunks=(1000, 3)[: values.ndim]) if np.ndim(values) else values

    cloud = jbt.dask.points(
        *map(chunked, [xyz]), radius=chunked(radius), color=chunked(color), strength=chunked(strength)
    )
    same(jbt.dask.mesh(cloud, 0.025, bricks=32), whole)
    with pytest.raises(ValueError, match="chunks as those of xyz"):
        jbt.dask.points(chunked(xyz), radius=array.from_array(radius, chunks=500))
    with pytest.raises(ValueError, match=r"expected a dask\.array"):
        jbt.dask.points(xyz, radius=1)


def test_particles_in_files_become_parts(client: Any, tmp_path: Path) -> None:
    xyz, radius = particles()
    rows = np.column_stack([xyz, radius])
    (tmp_path / "in").mkdir()
    paths = [tmp_path / "in" / f"{index}.npy" for index in range(2)]
    for path, part in zip(paths, np.split(rows, 2), strict=True):
        np.save(path, part)
    whole = jbt.points(xyz, radius=radius).mesh(cell=0.03, thin=False)
    cloud = jbt.dask.files(paths, allow_files=tmp_path / "in", chunk=900)
    parts = jbt.dask.mesh(cloud, 0.03, bricks=32, folder=tmp_path / "out")
    assert len(parts) > 8
    assert parts.triangles == len(whole.faces)
    assert parts.closed
    same(parts.mesh(), whole)
    same(jbt.dask.read(tmp_path / "out").mesh(), whole)
    with pytest.raises(PermissionError, match="allow_files"):
        jbt.dask.files(paths, allow_files=tmp_path / "out")
    broken = tmp_path / "out" / parts.index["parts"][0]["file"]
    broken.write_bytes(broken.read_bytes()[:-1])
    with pytest.raises(ValueError, match="SHA-256"):
        jbt.dask.read(tmp_path / "out").mesh()
    with pytest.raises(FileNotFoundError):
        jbt.dask.read(tmp_path / "in")


@pytest.mark.parametrize("moment", [0.05, 0.4, 0.8])
def test_a_killed_worker_changes_nothing(hero: jbt.Model, client: Any, moment: float) -> None:
    client.wait_for_workers(2)
    whole = hero.mesh(resolution=RESOLUTION, thin=False)
    victims = list(client.run(os.getpid).values())
    killed: list[int] = []

    def kill(part: float) -> None:
        if part >= moment and not killed:
            killed.append(victims[0])
            os.kill(victims[0], signal.SIGKILL)

    same(jbt.dask.mesh(hero, resolution=RESOLUTION, bricks=32, progress=kill), whole)
    assert killed
    # Another one comes in its place.
    client.wait_for_workers(2)


def test_workers_come_and_go(hero: jbt.Model) -> None:
    """A cluster that grows with its work and shrinks after it: from no worker to some, and once more."""
    whole = hero.mesh(resolution=RESOLUTION, thin=False)
    with (
        distributed.LocalCluster(
            n_workers=0, threads_per_worker=1, dashboard_address=None, memory_limit="2GB", silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        cluster.adapt(minimum=0, maximum=2, interval="100 ms", wait_count=2)
        for _ in range(2):
            same(jbt.dask.mesh(hero, resolution=RESOLUTION, bricks=32, client=client), whole)
            deadline = time.monotonic() + 30
            while client.nthreads() and time.monotonic() < deadline:
                time.sleep(0.1)
            assert not client.nthreads(), "idle workers leave"


def test_a_full_disk_is_named(hero: jbt.Model, client: Any, tmp_path: Path) -> None:
    """A limit on the length of files stands for a disk that is full: a write fails in the middle."""
    client.wait_for_workers(2)

    def limit(length: int) -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (length, resource.RLIM_INFINITY))

    client.run(limit, 20_000)
    try:
        with pytest.raises(
            jbt.dask.BrickError, match=r"octopus: the brick \(\d, \d, \d\) has failed"
        ) as caught:
            jbt.dask.mesh(hero, resolution=64, folder=tmp_path, retries=1, name="octopus")
    finally:
        client.run(limit, resource.RLIM_INFINITY)
    assert isinstance(caught.value.__cause__, OSError)
    assert caught.value.scene == "octopus"
    assert caught.value.place is not None
    # Neither an index nor any part of a part.
    assert not (tmp_path / "index.json").exists()
    # A part that another worker was writing meanwhile fails as well.
    end = time.monotonic() + 20
    while list(tmp_path.glob(".jbt-*")) and time.monotonic() < end:
        time.sleep(0.05)
    assert not list(tmp_path.glob(".jbt-*"))
    for path in tmp_path.glob("*.jbtblock"):
        _jbt.block_facts(path.read_bytes())


def test_cancelling(hero: jbt.Model, client: Any) -> None:
    def stop(part: float) -> None:
        if part > 0.1:
            raise InterruptedError("enough")

    with pytest.raises(InterruptedError, match="enough"):
        jbt.dask.mesh(hero, resolution=RESOLUTION, bricks=32, progress=stop)
    timer = threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    begun = time.monotonic()

    def work() -> None:
        while time.monotonic() < begun + 60:
            jbt.dask.mesh(hero, resolution=RESOLUTION, bricks=32)

    with pytest.raises(KeyboardInterrupt):
        work()
    timer.cancel()


def test_samples(hero: jbt.Model, client: Any, tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr")
    # 65 points along the longest side: the last chunk is a single layer.
    whole = hero.sample(resolution=64)
    made = jbt.dask.sample(hero, resolution=64, bricks=32)
    assert made.numblocks == tuple(-(-count // 32) for count in whole.shape)
    assert made.compute().tobytes() == np.ascontiguousarray(whole.field).tobytes()
    made.to_zarr(str(tmp_path / "field.zarr"))
    assert (
        zarr.open_array(tmp_path / "field.zarr")[:].tobytes() == np.ascontiguousarray(whole.field).tobytes()
    )
    grid = jbt.dask.sample_grid(hero, resolution=40, bricks=32, gradient=True, attributes=True)
    expected = hero.sample(resolution=40, gradient=True, attributes=True)
    assert (grid.names, grid.groups, grid.origin) == (expected.names, expected.groups, expected.origin)
    for name in grid.names:
        assert (np.asarray(grid[name]) == expected[name]).all()


def test_sweeps(client: Any) -> None:
    size = jbt.param("size", 1.0)
    ball = jbt.point((0, 0, size), surface_radius=size)
    rows = jbt.dask.sweep(ball, {"size": [1, 2, 3]}, ["volume", "bounds"]).compute()
    assert [row["size"] for row in rows] == [1, 2, 3]
    assert [row["volume"] for row in rows] == [ball.with_parameters(size=s).volume for s in (1, 2, 3)]
    made = jbt.dask.sweep(ball, [{"size": 2.0}], lambda model: len(model.mesh(resolution=16).faces)).compute()
    assert made[0]["result"] == len(ball.with_parameters(size=2).mesh(resolution=16).faces)
    with pytest.raises(ValueError, match="the model has no length; it has size"):
        jbt.dask.sweep(ball, {"length": [1]})
    with pytest.raises(ValueError, match="expected properties"):
        jbt.dask.sweep(ball, {"size": [1]}, "mesh")


def test_frames(client: Any, tmp_path: Path) -> None:
    source, target = tmp_path / "in", tmp_path / "out"
    source.mkdir()
    for index in range(4):
        np.save(source / f"f{index}.npy", np.random.default_rng(index).uniform(-1, 1, (300, 3)))
    (source / "scene.jbt").write_text("jbt 1\npoint { radius 1 }\n")
    files = sorted(source.iterdir())
    options: dict[str, Any] = {"allow_files": source, "resolution": 32, "radius": 0.3, "format": "ply"}
    rows = jbt.dask.frames(files, target, **options)
    assert [row["made"] for row in rows] == [True] * 5
    assert [row["made"] for row in jbt.dask.frames(files, target, **options)] == [False] * 5
    # What is broken, and what was made of something else, is made again.
    (target / "f1.ply").write_bytes(b"ply")
    np.save(source / "f2.npy", np.zeros((1, 3)))
    (target / "f3.ply.json").write_text("{")
    again = jbt.dask.frames(files, target, **options)
    assert [row["made"] for row in again] == [False, True, True, True, False]
    assert again[1]["sha256"] == rows[1]["sha256"]
    assert json.loads((target / "f1.ply.json").read_text())["sha256"] == rows[1]["sha256"]
    with pytest.raises(jbt.dask.BrickError, match=r"f0\.npy: .*allow_files"):
        jbt.dask.frames(files[:1], target, **{**options, "allow_files": target})
    with pytest.raises(jbt.dask.BrickError, match=r"f0\.npy: radius: expected a number"):
        jbt.dask.frames(files[:1], target, **{**options, "radius": None})


def test_strangers_bytes_are_refused(client: Any) -> None:
    with pytest.raises(ValueError, match="no bytes of"):
        _jbt.Shape(b"cos\nsystem\n(S'true'\ntR.")
    source = _jbt.RowSource((jbt.point(radius=1) + jbt.segment((0, 0, 0), (1, 0, 0), radius=1))._native)
    shape, (rows, count) = source.shape(), source.rows([-1, -1, -1], [1, 1, 1])
    assert count >= 2
    lattice = _jbt.Lattice([-1, -1, -1], 0.1, [20, 20, 20])
    assert _jbt.Shape(shape).block(rows, lattice, 32, [0, 0, 0], 8, 1)
    with pytest.raises(ValueError, match="there is no brick"):
        _jbt.Shape(shape).block(rows, lattice, 32, [1, 0, 0], 8, 1)
    wide = _jbt.Lattice([-2, -1, -1], 0.1, [20, 20, 20])
    with pytest.raises(ValueError, match="another box"):
        _jbt.Shape(shape).block(rows, wide, 32, [0, 0, 0], 8, 1)
    with pytest.raises(ValueError, match="byte .* are said to follow"):
        _jbt.Shape(shape[:-1])
    with pytest.raises(ValueError, match="byte"):
        _jbt.Shape(shape).block(rows[:-3], lattice, 32, [0, 0, 0], 8, 1)


def test_bricks_fit_into_memory() -> None:
    from jbt.dask._run import BOX_BYTES, edge_of

    boxes = {(x, y, z): 1000 for x in range(16) for y in range(16) for z in range(16)}
    assert edge_of(None, boxes, 1, 1 << 40, lambda rows: rows) == 128
    assert edge_of(None, boxes, 5, 1 << 40, lambda rows: rows) == 128
    assert edge_of(None, boxes, 16, 1 << 40, lambda rows: rows) == 64
    assert edge_of(None, boxes, 1, 9 * BOX_BYTES, lambda rows: rows) == 64
    assert edge_of(None, boxes, 1, 9 * BOX_BYTES, lambda rows: 10**6 * rows) == 32
    assert edge_of(64, {}, 1, 1, lambda rows: rows) == 64
