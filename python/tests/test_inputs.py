"""What comes wrong is told: the argument, what was expected, and what came."""

from __future__ import annotations

import os
import pickle
import resource
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

import jbt
import numpy as np
import pytest

SHAPES = r"an array of the shape \(n, 3\) or \(3, n\), or three arrays of one shape"


@pytest.mark.parametrize(
    ("points", "error", "message"),
    [
        (np.array([[0, 0, None]]), TypeError, f"points: expected {SHAPES}, .* got an array of object"),
        (np.array([["a", "b", "c"]]), TypeError, "points: .* got an array of <U1"),
        (np.zeros((4, 3), complex), TypeError, "got an array of complex128"),
        (np.zeros((4, 3), bool), TypeError, "got an array of bool"),
        (np.zeros((4, 2)), ValueError, rf"points: expected {SHAPES}, got an array of float64 .* \(4, 2\)"),
        (np.zeros((2, 3, 4)), ValueError, r"the shape \(2, 3, 4\)"),
        (np.zeros(5), ValueError, r"the shape \(5,\)"),
        (7, ValueError, r"the shape \(\)"),
        ([[0, 0, 0], [0, 0]], ValueError, "points: .* rows of different lengths"),
        ([[0, 0, 0], [np.nan, 1, 2]], ValueError, r"points: point 1 is \(NaN, 1, 2\): expected numbers"),
        ((np.zeros(3), np.zeros(4), np.zeros((2, 2))), ValueError, r"got \(3,\), \(4,\) and \(2, 2\)"),
    ],
)
def test_points(peanut: jbt.Model, points: object, error: type, message: str) -> None:
    with pytest.raises(error, match=message):
        peanut.compile()(points)


def test_nan_may_be_wanted(peanut: jbt.Model) -> None:
    answers = peanut.compile()([[0, 0, 0], [np.nan, 1, 2]], nan="propagate")
    assert np.isnan(answers.field).tolist() == [False, True]
    assert answers.color[1].tolist() == [1, 1, 1]
    far = np.zeros((20_000, 3), np.float32)
    far[17_777, 2] = np.nan
    with pytest.raises(ValueError, match="points: point 17777 is"):
        peanut.compile()(far)
    with pytest.raises(ValueError, match='nan: expected "raise" or "propagate"'):
        peanut.compile()(far, nan="ignore")  # type: ignore[arg-type]


def test_particles() -> None:
    with pytest.raises(ValueError, match=r"xyz: expected finite numbers, got nan at \[1, 2\]"):
        jbt.points([[0, 0, 0], [0, 0, np.nan]], radius=1)
    with pytest.raises(ValueError, match=r"radius: expected a number or the shape \(2,\)"):
        jbt.points([[0, 0, 0], [1, 0, 0]], radius=[1, 2, 3])
    with pytest.raises(ValueError, match=r"radius: expected numbers above 0, got -1.0 at \[1\]"):
        jbt.points([[0, 0, 0], [1, 0, 0]], radius=[1, -1])
    with pytest.raises(ValueError, match="xyz: expected at least one point"):
        jbt.points(np.empty((0, 3)), radius=1)
    with pytest.raises(ValueError, match=r"color: expected 3 numbers or the shape \(2, 3\)"):
        jbt.points([[0, 0, 0], [1, 0, 0]], radius=1, color=np.zeros((3, 3)))
    with pytest.raises(TypeError, match="xyz: .* got an array of object"):
        jbt.points(np.array([[0, 0, object()]]), radius=1)


def test_members() -> None:
    with pytest.raises(TypeError, match=r"point\(\): expected either radius or surface_radius, got none"):
        jbt.point((0, 0, 0))
    with pytest.raises(TypeError, match="got both"):
        jbt.point((0, 0, 0), radius=1, surface_radius=1)
    with pytest.raises(TypeError, match=r"at: expected 3 numbers, got \(0, 0\) \(tuple\)"):
        jbt.point((0, 0), radius=1)
    with pytest.raises(TypeError, match="radius: expected a number or a jbt.Number, got 'big'"):
        jbt.point(radius="big")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"rate: expected a number .* got None|required"):
        jbt.point(radius=1).twist("z", rate=None)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match='edge: expected one of exact, smooth, got "soft"'):
        jbt.blinn(3, edge="soft")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="rows: expected 3 rows of 4 numbers"):
        jbt.point(radius=1).affine([[1, 0], [0, 1]])


def test_a_wrong_model_says_all_that_is_wrong() -> None:
    with pytest.raises(jbt.SceneError) as raised:
        jbt.loads("jbt 1\nsum {\n  point { radius -1 }\n  point { radius 0 }\n}").check()
    found = raised.value.diagnostics
    assert [(one.line, one.severity) for one in found] == [(3, "error"), (4, "error")]
    assert "<text>:3:3: error: the radius is -1" in str(raised.value)
    assert "^^^" in str(raised.value)
    assert found[0].hint
    again = pickle.loads(pickle.dumps(raised.value))
    assert (str(again), again.diagnostics) == (str(raised.value), found)


def test_an_empty_model() -> None:
    empty = jbt.point(radius=1) & jbt.point((5, 0, 0), radius=1)
    for ask in (empty.mesh, empty.sample, lambda: empty.bounds, lambda: empty.support):
        with pytest.raises(ValueError, match="the model is empty"):
            ask()
    nothing = empty.mesh(region=[(0, 0, 0), (1, 1, 1)], resolution=8)
    assert nothing.faces.shape == (0, 3)
    assert nothing.vertices.shape == (0, 3)


def test_a_model_without_end() -> None:
    endless = ~jbt.point(radius=1)
    for ask in (endless.mesh, endless.sample, endless.contours):
        with pytest.raises(ValueError, match="the model is unbounded"):
            ask()
    assert endless._repr_png_() is None


def test_a_surface_that_leaves_the_region(peanut: jbt.Model) -> None:
    half = [(-2, 0, -2), (2, 2, 2)]
    with pytest.warns(jbt.OpenMeshWarning, match="cuts the surface at its sides -y: the mesh is open"):
        mesh = peanut.mesh(resolution=32, region=half)
    assert not mesh.closed
    assert mesh.cut_sides == "-y"
    with pytest.raises(ValueError, match="open: it has no volume"):
        _ = mesh.volume
    # Warnings are errors in these tests: nobody gets an open mesh who does not want one.
    with pytest.raises(jbt.OpenMeshWarning):
        peanut.mesh(resolution=32, region=half)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"resolution": 0}, "resolution: expected 1 or more"),
        ({"cell": -1.0}, "cell: expected a finite number above 0"),
        ({"cell": float("nan")}, "cell: expected a finite number"),
        ({"region": [(0, 0, 0), (0, 1, 1)]}, "region: expected finite corners"),
        ({"region": [0, 1]}, "region: expected two corners of 3 numbers"),
        ({"engine": "gpu"}, 'engine: expected one of scalar, lanes, jit, got "gpu"'),
        ({"threads": 1000}, "threads: expected 1 to 256"),
    ],
)
def test_settings_of_meshes(peanut: jbt.Model, given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        peanut.mesh(**given)


def test_limits(peanut: jbt.Model) -> None:
    with pytest.raises(jbt.LimitError):
        peanut.mesh(cell=1e-12)
    with pytest.raises(jbt.LimitError, match="more than"):
        peanut.sample(resolution=5000)


def test_rays_and_pictures(peanut: jbt.Model) -> None:
    with pytest.raises(ValueError, match=r"directions: expected vectors of any length but 0, .* at \[1\]"):
        peanut.trace([[0, 0, 5]], [[0, 0, -1], [0, 0, 0]])
    with pytest.raises(ValueError, match=r"directions: expected the shape of origins"):
        peanut.trace(np.zeros((2, 3)), np.ones((3, 3)))
    with pytest.raises(ValueError, match="view: expected one of three-quarter"):
        peanut.render((8, 8), view="behind")
    with pytest.raises(ValueError, match="no attribute `heat`; it has color"):
        peanut.render((8, 8), mode="heat")
    with pytest.raises(ValueError, match="quality: expected one of draft"):
        peanut.render((8, 8), quality="fast")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="plane: .*is no plane"):
        peanut.contours("w=0")


def test_files_that_cannot_be_written(peanut: jbt.Model, tmp_path: Path) -> None:
    mesh = peanut.mesh(resolution=16)
    with pytest.raises(ValueError, match=r"ends in \.glb, \.ply"):
        mesh.save(tmp_path / "x.txt")
    with pytest.raises(FileNotFoundError):
        mesh.save(tmp_path / "none" / "x.glb")
    with pytest.raises(ValueError, match='up: "w"'):
        mesh.save(tmp_path / "x.glb", up="w")
    mesh.vertices[0, 0] = np.nan
    with pytest.raises(ValueError, match="position of vertex 0 is not finite"):
        mesh.save(tmp_path / "x.glb")
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="files are limited by the system there")
def test_a_full_disk_leaves_no_part_of_a_file(tmp_path: Path) -> None:
    """A limit of the size of files is as a full disk to who writes."""
    program = """
        import resource, signal, sys
        import jbt
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        mesh = jbt.point(radius=1).mesh(resolution=64)
        resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
        try:
            mesh.save(sys.argv[1])
        except OSError as error:
            print(type(error).__name__, error)
    """
    target = tmp_path / "x.glb"
    target.write_bytes(b"before")
    command = [sys.executable, "-c", textwrap.dedent(program), os.fspath(target)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "OSError" in done.stdout
    assert "too large" in done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["x.glb"]
    assert target.read_bytes() == b"before"
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] != 10_000
