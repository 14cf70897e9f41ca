"""Meshes, grids, contours, rays and pictures; and what other libraries get."""

from __future__ import annotations

import copy
import gc
import pickle
import subprocess
from pathlib import Path

import jbt
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_a_ball_is_one() -> None:
    ball = jbt.point((1, 2, 3), surface_radius=1, color=(1, 0.5, 0))
    mesh = ball.mesh(cell=0.05)
    assert mesh.vertices.dtype == np.float32
    assert mesh.faces.dtype == np.uint32
    assert mesh.closed
    assert np.abs(np.linalg.norm(mesh.world - [1, 2, 3], axis=1) - 1).max() < 1e-5
    assert np.abs((mesh.normals * (mesh.vertices - [1, 2, 3])).sum(axis=1) - 1).max() < 1e-4
    assert mesh.volume == pytest.approx(4 / 3 * np.pi, rel=0.01)
    assert mesh.area == pytest.approx(4 * np.pi, rel=0.01)
    assert np.allclose(mesh.bounds, [[0, 1, 2], [2, 3, 4]], atol=0.01)
    assert (mesh.colors == np.array([1, 0.5, 0], np.float32)).all()
    assert mesh.srgb[0].tolist() == [255, 188, 0]
    assert mesh.spacing == 0.05
    assert mesh.info["engine"] == "jit"


def test_edges_are_sharp_and_split(tmp_path: Path) -> None:
    box = "within (-0.83 -0.83 -0.83) to (0.83 0.83 0.83) { point { radius 9 } }"
    cube = jbt.loads(f"jbt 1 color (1 0 0) {{ {box} }}")
    mesh, smooth = cube.mesh(cell=0.1), cube.mesh(cell=0.1, sharp=False)
    assert mesh.closed
    corners = np.linalg.norm(np.abs(mesh.vertices) - 0.83, axis=1) < 1e-3
    assert corners.sum() == 8
    assert not len(smooth.creases.corners)
    assert mesh.volume == pytest.approx(1.66**3, rel=1e-3)
    split = mesh.split()
    assert len(split.vertices) == len(mesh.vertices) + len(mesh.creases.vertices)
    normals = split.normals[split.faces]
    assert (np.abs(normals).max(axis=2) > 0.999).all(), "each corner has the normal of its face"
    assert (split.colors == np.array([1, 0, 0], np.float32)).all()
    mesh.save(tmp_path / "a.ply")
    assert b"element vertex %d" % len(split.vertices) in (tmp_path / "a.ply").read_bytes()
    mesh.save(tmp_path / "a.obj")
    lines = (tmp_path / "a.obj").read_text().splitlines()
    assert sum(line.startswith("v ") for line in lines) == len(mesh.vertices)


def test_arrays_own_their_memory(peanut: jbt.Model) -> None:
    mesh = peanut.mesh(resolution=32)
    vertices, expected = mesh.vertices, mesh.vertices.copy()
    assert vertices.flags.writeable
    del mesh
    gc.collect()
    jbt.point(radius=1).mesh(resolution=32)
    assert (vertices == expected).all()
    vertices[0] = 7


def test_meshes_pickle_and_copy(peanut: jbt.Model) -> None:
    mesh = peanut.mesh(resolution=24)
    for again in (pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
        assert (again.vertices == mesh.vertices).all()
        assert (again.faces == mesh.faces).all()
        assert (again.colors == mesh.colors).all()
        assert again.info == mesh.info
        assert not np.shares_memory(again.vertices, mesh.vertices)


def test_any_number_of_threads_gives_the_same_mesh(hero: jbt.Model) -> None:
    one = hero.mesh(resolution=64, threads=1)
    two = hero.mesh(resolution=64, threads=2)
    other = hero.mesh(resolution=64, engine="lanes")
    for mesh in (two, other):
        assert (mesh.vertices == one.vertices).all()
        assert (mesh.faces == one.faces).all()
        assert (mesh.colors == one.colors).all()


def test_the_program_makes_the_same_file(hero: jbt.Model, tmp_path: Path) -> None:
    program = ROOT / "target" / "release" / "jbt"
    if not program.exists():
        pytest.skip("there is no program: cargo build --release")
    for name in ("x.glb", "x.ply"):
        theirs, mine = tmp_path / f"program-{name}", tmp_path / name
        scene = ROOT / "examples" / "hero.jbt"
        subprocess.run([program, "mesh", scene, "--resolution", "48", "-o", theirs, "-q"], check=True)
        hero.mesh(48).save(mine)
        assert mine.read_bytes() == theirs.read_bytes()


def test_every_format_is_written(peanut: jbt.Model, tmp_path: Path) -> None:
    mesh = peanut.mesh(resolution=24)
    assert set(jbt.MESH_FORMATS) >= {"glb", "ply", "obj", "stl"}
    for ending in jbt.MESH_FORMATS:
        path = tmp_path / f"x.{ending}"
        mesh.save(path)
        assert path.stat().st_size > 1000
        mesh.save(tmp_path / "plain", format=ending, up="y")
        if ending in ("glb", "ply", "obj", "stl"):
            # The others are judged by their own libraries (`outside/`).
            trimesh = pytest.importorskip("trimesh")
            assert len(trimesh.load_mesh(path).faces) == len(mesh.faces)


def test_trimesh(peanut: jbt.Model) -> None:
    pytest.importorskip("trimesh")
    mesh = peanut.attribute("rough", 0.5).mesh(resolution=32)
    made = mesh.to_trimesh()
    assert made.is_watertight
    assert made.volume == pytest.approx(mesh.volume, rel=1e-6)
    assert (made.visual.vertex_colors[:, :3] == mesh.srgb).all()
    assert made.vertex_attributes["rough"].shape == (len(mesh.vertices), 1)


def test_pyvista(peanut: jbt.Model) -> None:
    pytest.importorskip("pyvista")
    mesh = peanut.mesh(resolution=32)
    made = mesh.to_pyvista()
    assert made.n_cells == len(mesh.faces)
    assert made.volume == pytest.approx(mesh.volume, rel=1e-4)
    assert (made.point_data["rgb"] == mesh.srgb).all()
    assert np.allclose(made.point_data["color"], mesh.colors)
    grid = peanut.sample(resolution=16)
    image = grid.to_pyvista()
    assert image.n_points == grid.field.size
    index = image.find_closest_point((0, 0.4, 0))
    assert image.point_data["field"][index] == pytest.approx(grid.field.max(), rel=0.2)


def test_meshio(peanut: jbt.Model, tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    mesh = peanut.mesh(resolution=24)
    made = mesh.to_meshio()
    made.write(tmp_path / "x.vtu")
    read = meshio.read(tmp_path / "x.vtu")
    assert np.allclose(read.points, mesh.world)
    assert np.allclose(read.point_data["color"], mesh.colors)


def test_a_grid_has_the_answers_of_its_points(peanut: jbt.Model) -> None:
    grid = peanut.sample(resolution=20, gradient=True, attributes=True)
    assert grid.names[:4] == ["field", "gx", "gy", "gz"]
    x, y, z = np.meshgrid(*grid.axes, indexing="ij")
    answers = peanut.compile()(x.astype(np.float32), y.astype(np.float32), z.astype(np.float32))
    assert np.allclose(grid.field, answers.field, atol=1e-6)
    assert np.allclose(grid.gradient, np.moveaxis(answers.gradient, 0, -1), atol=1e-4)
    assert grid.color.shape == (*grid.shape, 3)
    assert grid.field.flags.f_contiguous
    with pytest.raises(KeyError, match="there are field"):
        grid["heat"]


def test_xarray(peanut: jbt.Model) -> None:
    pytest.importorskip("xarray")
    dataset = peanut.sample(resolution=16, attributes=True).to_xarray()
    assert set(dataset) == {"field", "color.r", "color.g", "color.b"}
    assert float(dataset["field"].sel(x=0, y=0.4, z=0, method="nearest")) > 0.8


def test_contours(tmp_path: Path) -> None:
    torus = jbt.ring(ring_radius=1, surface_radius=0.25)
    path = tmp_path / "x.svg"
    slice = torus.contours("z=0", resolution=128, svg=path)
    assert [loop.is_hole for loop in slice.loops] == [False, True]
    assert slice.loops[1].parent == 0
    assert slice.area == pytest.approx(np.pi * (1.25**2 - 0.75**2), rel=0.01)
    assert np.allclose(np.linalg.norm(slice.loops[0].positions, axis=1), 1.25, atol=0.01)
    assert (slice.loops[0].points[:, 2] == 0).all()
    assert path.read_text().startswith("<svg")
    across = torus.contours(("y", 0.0))
    assert len(across) == 2
    tilted = torus.contours([(0, 0, 0), (1, 0, 0), (0, 1, 1)], resolution=64)
    assert len(tilted) == 2
    assert torus.contours(region=[(0, -2), (2, 2)]).cut_sides == (True, False, False, False)


def test_rays(peanut: jbt.Model) -> None:
    ball = jbt.point(surface_radius=1, color=(0, 1, 0))
    grid = np.linspace(-1.5, 1.5, 31)
    origins = np.stack([*np.meshgrid(grid, grid), np.full((31, 31), 4.0)], axis=-1).reshape(-1, 3)
    hits = ball.trace(origins, (0, 0, -2))
    distance = np.linalg.norm(origins[:, :2], axis=1)
    inside = distance < 0.99
    assert hits.hit[inside].all()
    assert not hits.hit[distance > 1.01].any()
    height = np.sqrt(1 - (origins[inside, :2] ** 2).sum(axis=1))
    assert np.allclose(hits.position[inside, 2], height, atol=1e-3)
    assert np.allclose(hits.t[inside], (4 - height) / 2, atol=1e-3)
    assert np.allclose(hits.normal[inside], hits.position[inside], atol=1e-2)
    assert np.isnan(hits.t[~hits.hit]).all()
    assert (hits.color[inside] == [0, 1, 0]).all()
    both = ball.trace_all([[0, 0, 4], [5, 5, 5]], [[0, 0, -1], [0, 0, -1]])
    assert both.ray.tolist() == [0, 0]
    assert both.t.tolist() == pytest.approx([3, 5], abs=1e-3)
    assert both.entering.tolist() == [True, False]
    with pytest.raises(ValueError, match="give a span and a tolerance"):
        (~ball).trace([[0, 0, 4]], [0, 0, -1])


def test_pictures(peanut: jbt.Model, tmp_path: Path) -> None:
    pixels = peanut.render((64, 48), quality="draft")
    assert pixels.shape == (48, 64, 4)
    assert pixels.dtype == np.uint8
    assert (peanut.render((64, 48), quality="draft", threads=1) == pixels).all()
    shown = peanut._repr_png_()
    assert shown is not None
    assert shown.startswith(b"\x89PNG")
    depth = peanut.render((32, 32), mode="depth", view="front", background="transparent")
    assert (depth[0, 0, 3], depth[16, 16, 3]) == (0, 255)
    image = pytest.importorskip("PIL.Image")
    (tmp_path / "x.png").write_bytes(jbt.png(pixels))
    assert (np.asarray(image.open(tmp_path / "x.png").convert("RGBA")) == pixels).all()


def test_measures() -> None:
    ball = jbt.point((5, 0, 0), surface_radius=1)
    measures = ball.measure(resolution=64)
    assert measures.least <= 4 / 3 * np.pi <= measures.most
    assert measures.volume == pytest.approx(4 / 3 * np.pi, rel=1e-3)
    assert measures.area == pytest.approx(4 * np.pi, rel=1e-2)
    assert measures.center == pytest.approx((5, 0, 0), abs=1e-2)
    assert np.allclose(ball.bounds, [[4, -1, -1], [6, 1, 1]], atol=0.01)
    assert np.allclose(ball.tight_bounds(1e-5), [[4, -1, -1], [6, 1, 1]], atol=2e-5)
    assert ball.support[1, 0] > 6


def test_models_stand_as_they_say(tmp_path: Path) -> None:
    # POV-Ray's axes: y up, left-handed.
    pear = jbt.point((0, 0, 0.3), surface_radius=0.5) | jbt.point((0, 1, 0), surface_radius=0.3)
    assert pear.orientation == ("z", "right")
    left = pear.with_orientation("y", "left")
    assert "orientation up y handed left" in str(left)
    assert pickle.loads(pickle.dumps(left)).orientation == ("y", "left")
    mesh = left.mesh(resolution=24)
    assert (mesh.up, mesh.handed) == ("y", "left")
    assert (mesh.vertices == pear.mesh(resolution=24).vertices).all()
    right = mesh.right_handed()
    assert right.volume == pytest.approx(mesh.volume, rel=1e-6)
    assert np.allclose(right.vertices, mesh.vertices * [1, 1, -1])
    trimesh = pytest.importorskip("trimesh")
    made = mesh.to_trimesh()
    assert made.volume == pytest.approx(mesh.volume, rel=1e-6)
    mesh.save(tmp_path / "x.glb")
    read = trimesh.load_mesh(tmp_path / "x.glb")
    assert np.allclose(read.bounds, made.bounds, atol=1e-6), "glTF has y up"
    with pytest.raises(ValueError, match="stand in different ways"):
        pear | left
    with pytest.raises(ValueError, match="up: expected y or z"):
        pear.with_orientation("x")  # type: ignore[arg-type]
