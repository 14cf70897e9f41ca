"""Answers at points: shapes, types, memory, threads."""

from __future__ import annotations

import pickle
import threading
import time
import tracemalloc
from typing import Any

import jbt
import numpy as np
import pytest


def test_every_way_to_give_points(peanut: jbt.Model, cloud: np.ndarray) -> None:
    ev = peanut.compile()
    single = cloud.astype(np.float32)
    expected = ev(single)
    planes = np.ascontiguousarray(single.T)
    ways = {
        "rows": single,
        "planes": planes,
        "three arrays": tuple(planes),
        "transposed": planes.T,
        "strided": np.repeat(single, 2, axis=0)[::2],
        "reversed and back": single[::-1][::-1],
        "double": single.astype(np.float64),
        "Fortran": np.asfortranarray(single),
        "list": single.tolist(),
    }
    for name, points in ways.items():
        answers = ev(points)
        assert (answers.planes == expected.planes).all(), name
        as_rows = name not in ("planes", "three arrays")
        assert answers.gradient.shape == ((1000, 3) if as_rows else (3, 1000)), name
    x, y, z = planes
    assert (ev(x, y, z).field == expected.field).all()
    assert (ev(x, y.astype(np.float64), z).field == expected.field).all()
    for dtype in (np.float16, np.int32, np.uint8):
        assert ev(np.array([[0, 1, 0]], dtype)).field.shape == (1,)


def test_answers_have_the_shape_of_three_arrays(peanut: jbt.Model) -> None:
    axes = np.linspace(-1, 1, 5), np.linspace(-1, 1, 4), np.linspace(-1, 1, 3)
    x, y, z = np.meshgrid(*axes, indexing="ij")
    answers = peanut.compile()(x, y, z)
    assert answers.field.shape == (5, 4, 3)
    assert answers.gradient.shape == answers.color.shape == (3, 5, 4, 3)
    assert answers.field[4, 0, 1] == peanut.compile()([[x[4, 0, 1], y[4, 0, 1], z[4, 0, 1]]]).field[0]


def test_the_gradient_is_that_of_the_field(peanut: jbt.Model, cloud: np.ndarray) -> None:
    ev = peanut.compile()
    step = 1e-3
    for axis in range(3):
        shift = np.zeros(3)
        shift[axis] = step
        difference = (ev(cloud + shift).field.astype(float) - ev(cloud - shift).field) / (2 * step)
        assert np.abs(difference - ev(cloud).gradient[:, axis]).max() < 0.02


def test_fewer_answers(peanut: jbt.Model, cloud: np.ndarray) -> None:
    ev = peanut.compile(gradient=False, attributes=False)
    assert ev.names == ("field",)
    answers = ev(cloud)
    with pytest.raises(AttributeError, match="gradient=True"):
        _ = answers.gradient
    with pytest.raises(KeyError, match="attributes=True"):
        _ = answers.color
    assert peanut.compile(attributes=False)(cloud).attributes == {}
    with pytest.raises(KeyError, match="there are field, gx"):
        peanut.compile()(cloud)["colour"]


def test_nothing_is_copied(peanut: jbt.Model) -> None:
    ev = peanut.compile()
    count = 1 << 20
    planes = np.random.default_rng(4).uniform(-1, 1, (3, count)).astype(np.float32)
    ev(planes[:, :1000].copy())
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    answers = ev(planes)
    after, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    output = answers.planes.nbytes
    assert after - before < output + 20_000
    assert peak - before < output + 20_000
    for view in (answers.field, answers.gradient, answers.color):
        assert np.shares_memory(view, answers.planes)


def test_out(peanut: jbt.Model, cloud: np.ndarray) -> None:
    ev = peanut.compile()
    mine = ev.empty(len(cloud))
    answers = ev(cloud, out=mine)
    assert answers.planes is mine.planes
    array = np.empty((len(ev.names), len(cloud)), np.float32)
    assert ev(cloud, out=array).planes is array
    assert (array == mine.planes).all()
    for wrong in (np.empty((7, 999), np.float32), array.astype(np.float64), np.asfortranarray(array), "x"):
        with pytest.raises(ValueError, match=r"out: expected a writable C-contiguous array .* \(7, 1000\)"):
            ev(cloud, out=wrong)  # type: ignore[arg-type]
    array.flags.writeable = False
    with pytest.raises(ValueError, match="out: expected a writable"):
        ev(cloud, out=array)
    # Answers may not go where the points are.
    both = np.zeros((7, 100), np.float32)
    with pytest.raises((ValueError, TypeError, RuntimeError, BufferError), match="borrow"):
        ev(both[:3], out=both)


def test_any_number_of_threads_gives_the_same_bits(hero: jbt.Model) -> None:
    points = np.random.default_rng(5).uniform(-1.5, 1.5, (100_000, 3)).astype(np.float32)
    ev = hero.compile()
    one = ev(points, threads=1).planes
    for threads in (None, 2, 3, 7):
        assert (ev(points, threads=threads).planes == one).all()
    with pytest.raises(ValueError, match="threads: expected 1 to 256, got 0"):
        ev(points, threads=0)


def test_points_far_away_keep_their_digits() -> None:
    far = jbt.point((1e6, 0, 0), radius=1)
    ev = far.compile()
    assert ev.origin == pytest.approx((1e6, 0, 0))
    assert ev([[1e6 + 0.5, 0, 0]]).field[0] == pytest.approx(0.5, abs=1e-6)
    mesh = far.mesh(resolution=32)
    assert mesh.origin == pytest.approx((1e6, 0, 0))
    assert np.allclose(mesh.world.mean(axis=0), [1e6, 0, 0], atol=0.01)


def test_update_compiles_nothing() -> None:
    ev = jbt.segment((0, 0, 0), (1, 0, 0), radius=jbt.param("r", 1.0)).compile()
    points = [[0.5, 0.5, 0]]
    assert ev(points).field[0] == 0.5
    before = jbt.COMPILER.programs
    ev.update(r=0.25)
    assert ev(points).field[0] == 0
    assert ev.parameters == {"r": 0.25}
    ev.update(r=1)
    assert ev(points).field[0] == 0.5
    assert jbt.COMPILER.programs == before
    with pytest.raises(jbt.SceneError, match="the radius is -1"):
        ev.update(r=-1)
    assert ev(points).field[0] == 0.5, "as it was"
    assert ev.counters.points == 4
    assert ev.counters.evaluations == 4


def test_evaluators_pickle() -> None:
    ev = jbt.point(radius=jbt.param("r", 1.0)).compile(attributes=False, engine="lanes")
    ev.update(r=2)
    again = pickle.loads(pickle.dumps(ev))
    assert again.engine == "lanes"
    assert again.parameters == {"r": 2.0}
    assert again([[1, 0, 0]]).field[0] == 0.5


def test_the_interpreter_is_free_meanwhile(hero: jbt.Model) -> None:
    ev = hero.compile()
    points = np.random.default_rng(6).uniform(-1.5, 1.5, (3, 400_000)).astype(np.float32)
    ticks, done = 0, threading.Event()

    def work() -> None:
        ev(points, threads=1)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        ticks += 1
        time.sleep(0.001)
    thread.join()
    assert ticks >= 3


def test_threads_share_an_evaluator_while_it_is_updated() -> None:
    ev = jbt.point(radius=jbt.param("r", 1.0)).compile(gradient=False, attributes=False)
    points = np.zeros((3, 5000), np.float32)
    points[0] = 0.5
    known = {}
    for r in (1.0, 2.0):
        ev.update(r=r)
        known[r] = float(ev(points).field[0])
    wrong = []

    def ask() -> None:
        for _ in range(200):
            fields = set(ev(points).field.tolist())
            if len(fields) != 1 or not fields <= set(known.values()):
                wrong.append(fields)

    threads = [threading.Thread(target=ask) for _ in range(3)]
    for thread in threads:
        thread.start()
    for turn in range(100):
        ev.update(r=1.0 + turn % 2)
    for thread in threads:
        thread.join()
    assert not wrong


def test_no_points(peanut: jbt.Model) -> None:
    ev = peanut.compile()
    nothings: list[Any] = [np.empty((0, 3)), np.empty((3, 0), np.float32), []]
    for nothing in nothings:
        assert len(ev(nothing)) == 0


def test_weights_mix_what_leaves_have() -> None:
    left = jbt.point((0, 0, 0), radius=2).color((1, 0, 0))
    right = jbt.point((1, 0, 0), radius=2).color((0, 1, 0.5))
    model = left + right
    points = np.random.default_rng(3).uniform(-2, 3, (500, 3)).astype(np.float32)
    weights = model.weights(points)
    assert weights.names == ("0.sum/0.color/0.point", "0.sum/1.color/0.point")
    assert weights.values.shape == (500, 2)
    assert weights.default.shape == (500,)
    np.testing.assert_allclose(weights.values.sum(axis=1) + weights.default, 1, atol=1e-6)
    colors = np.array([[1, 0, 0], [0, 1, 0.5]])
    mixed = weights.values @ colors + weights.default[:, None] * np.ones(3)
    np.testing.assert_allclose(mixed, model.compile()(points).color, atol=1e-6)
    assert (weights.default == 1).any()
    assert (weights.values.max(axis=1) < 1).any()
    named = jbt.loads("jbt 1 sum { left: point { radius 2 } point { at (1 0 0) radius 2 } }")
    only = named.weights(points, of=["left"])
    assert only.names == ("left",)
    np.testing.assert_array_equal(only["left"], weights.values[:, 0])
    with pytest.raises(jbt.SceneError, match="nothing in the model is called `leg`"):
        named.weights(points, of=["leg"])
    with pytest.raises(KeyError, match="there are left"):
        only["right"]


def test_contains_and_owner(peanut: jbt.Model) -> None:
    assert peanut.contains([[0, 0.4, 0], [0, 3, 0]]).tolist() == [True, False]
    owners = peanut.owner([[0, 0.5, 0], [0, -0.5, 0], [9, 9, 9]])
    assert owners.path == ["0.sum/0.color/0.point", "0.sum/1.color/0.point", None]
    assert owners.leaf[2] == -1
    assert owners.particle.tolist() == [0, 0, -1]
    drops = jbt.points([[0, 0, 0], [3, 0, 0]], radius=1)
    assert drops.owner([[3, 0.5, 0], [0, 0.5, 0]]).particle.tolist() == [1, 0]
    assert 0.5 < owners.share[0] < 1
    text = jbt.loads("jbt 1\nunion {\npoint { radius 1 }\n}")
    assert text.owner([[0, 0, 0]]).line.tolist() == [3]
