"""Building, reading, writing and combining models."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import jbt
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def field(model: jbt.Model, *point: float) -> float:
    return float(model.compile(gradient=False, attributes=False)([list(point)]).field[0])


def test_the_published_peanut(peanut: jbt.Model) -> None:
    answers = peanut.compile()([[0.0, 0.1, 0.0]])
    assert answers.field[0] == pytest.approx(1.294976, abs=1e-6)
    assert answers.color[0] == pytest.approx([0.613892, 0, 0.386108], abs=1e-5)


def test_operators_are_those_of_the_text() -> None:
    a, b = jbt.point(radius=1), jbt.point((0.5, 0, 0), radius=1)
    words = {
        "sum": a + b,
        "union": a | b,
        "intersection": a & b,
        "difference": a - b,
        "symmetric_difference": a ^ b,
    }
    for word, model in words.items():
        assert model == getattr(jbt, word)(a, b)
        text = f"jbt 1 {word} {{ point {{ radius 1 }} point {{ at (0.5 0 0) radius 1 }} }}"
        assert model == jbt.loads(text)
    assert ~a == jbt.loads("jbt 1 complement { point { radius 1 } }")
    assert sum([a, b, b]) == a + b + b
    assert jbt.union([a, b]) == jbt.union(a, b)


def test_other_operands_are_refused() -> None:
    ball = jbt.point(radius=1)
    with pytest.raises(TypeError):
        ball + 1  # type: ignore[operator]
    with pytest.raises(TypeError, match=r"models: expected jbt.Model, got 3 \(int\)"):
        jbt.union(ball, [3])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="expected one model or more"):
        jbt.union()


def test_a_model_as_text_comes_back(hero: jbt.Model) -> None:
    for model in (hero, jbt.point(radius=jbt.param("size", 1.0)).with_iso(0.25)):
        assert jbt.loads(str(model)) == model
        assert pickle.loads(pickle.dumps(model)) == model
        assert copy.copy(model) is model
        assert copy.deepcopy([model])[0] is model


def test_parameters() -> None:
    size = jbt.param("size", 1.0)
    ball = jbt.point((0, 0, 1 - size), surface_radius=jbt.sqrt(size) * size**0.5)
    assert ball.parameters == {"size": 1.0}
    large = ball.with_parameters(size=4)
    assert large.parameters == {"size": 4.0}
    assert np.allclose(large.bounds, [[-4, -4, -7], [4, 4, 1]], atol=0.02)
    assert pickle.loads(pickle.dumps(large)).parameters == {"size": 4.0}
    with pytest.raises(jbt.SceneError, match="no parameter `bulge`"):
        ball.with_parameters(bulge=1)
    with pytest.raises(jbt.SceneError, match="is not finite"):
        ball.with_parameters(size=float("nan"))


def test_a_sweep_compiles_once() -> None:
    ball = jbt.segment((0, 0, 0), (1, 0, 0), surface_radius=jbt.param("r", 0.5))
    ball.mesh(resolution=16)
    before = jbt.COMPILER.programs
    volumes = [ball.with_parameters(r=r).mesh(resolution=24).volume for r in np.linspace(0.2, 0.6, 5)]
    assert jbt.COMPILER.programs == before
    assert volumes == sorted(volumes)


def test_loading(tmp_path: Path) -> None:
    assert jbt.load(ROOT / "examples" / "mood.jbt").parameters
    assert "jbt" in jbt.SCENE_FORMATS
    with pytest.raises(FileNotFoundError):
        jbt.load(tmp_path / "none.jbt")
    with pytest.raises(jbt.SceneError, match=r"scenes end in \.jbt"):
        jbt.load(tmp_path / "none.pdf")
    text = "_0 var-x\n_1 const 1\n_2 sub _1 _0\n"
    assert field(jbt.loads(text, "a.vm"), 0.25, 0, 0) != 0
    parsip = b"[BLOBTREE]"
    with pytest.raises(jbt.SceneError):
        jbt.loads(parsip, "a.blob")


def test_groups() -> None:
    ball = jbt.point(radius=1).attribute("rough", 0.9)
    assert [group.name for group in ball.groups] == ["color", "rough"]
    stone = ball.group("rough", [0.2], mixing="dominant")
    both = stone | jbt.point((3, 0, 0), radius=1)
    answers = both.compile()([[0, 0, 0], [3, 0, 0]])
    assert answers["rough"][:, 0].tolist() == pytest.approx([0.9, 0.2])
    with pytest.raises(ValueError, match="declared in two ways"):
        stone | ball
    with pytest.raises(ValueError, match="mixing: expected one of blend, dominant"):
        ball.group("rough", [0], mixing="mean")  # type: ignore[arg-type]


def test_models_of_different_iso_are_refused() -> None:
    with pytest.raises(ValueError, match=r"0\.5 and 0\.3 cannot be combined"):
        jbt.point(radius=1) + jbt.point(radius=1).with_iso(0.3)


def test_textures_and_uv() -> None:
    ball = jbt.point(surface_radius=1).textured("color", jbt.checker(0.5), (1, 0, 0), (0, 0, 1)).uv()
    answers = ball.compile()([[0.1, 0.1, 0.1], [0.6, 0.1, 0.1]])
    assert answers.color.tolist() == [[1, 0, 0], [0, 0, 1]]
    assert answers["uv"].shape == (2, 2)
    shaded = jbt.point(radius=2).expressed("color", [0.5 + 0.5 * jbt.x, abs(jbt.y), 0.2])
    assert shaded.compile()([[1.0, -0.25, 0]]).color[0] == pytest.approx([1, 0.25, 0.2])


def test_formulas() -> None:
    cone = jbt.expression(1 - jbt.sqrt(jbt.x**2 + jbt.y**2) / (1 + jbt.param("bulge", 1.0)))
    assert field(cone, 0, 1, 5) == 0.5
    a, b = jbt.point(radius=3), jbt.point((1, 0, 0), radius=3).group("kind", [0.0])
    blend = jbt.expression(0.7 * a.field * b.field - 0.3 * jbt.square(a.field))
    assert field(blend, 0, 0, 0) == pytest.approx(0.7 * field(b, 0, 0, 0) - 0.3)
    assert [group.name for group in blend.groups] == ["color", "kind"]
    wave = jbt.point(radius=1).warp([jbt.x - 0.5 * jbt.sin(2 * jbt.y), jbt.y, jbt.z])
    assert np.isfinite(wave.within((-2, -2, -2), (2, 2, 2)).support).all()
    soft = jbt.expression(jbt.falloff_of("soft", jbt.length(jbt.x, jbt.y, jbt.z)))
    assert field(soft, 0.5, 0, 0) == pytest.approx(0.5)
    distance = jbt.expression(jbt.length(jbt.x, jbt.y, jbt.z))
    assert field(distance.fading("soft", 2), 1, 0, 0) == pytest.approx(0.5)


def test_numbers() -> None:
    a = jbt.param("a", 2.0)
    assert (1 - a / 4 + a**2 * 3).value == pytest.approx(12.5)
    assert float(-a) == -2
    assert str(2 * a + 1) == "2 * a + 1"
    assert jbt.max(a, 3.0) == jbt.max(a, 3.0)
    assert jbt.min(1.0, 2.0) == 1.0
    with pytest.raises(TypeError):
        a + "1"  # type: ignore[operator]
    with pytest.raises(TypeError, match=r"sqrt\(\): expected a number"):
        jbt.sqrt("x")  # type: ignore[call-overload]


def test_falloffs() -> None:
    ball = jbt.point(radius=1, falloff=jbt.blinn(3, edge="exact"))
    assert "falloff blinn { hardness 3 edge exact }" in str(ball)
    assert jbt.point(radius=1).falloff("wyvill") == jbt.point(radius=1, falloff="wyvill")
    with pytest.raises(ValueError, match="falloff: expected one of soft, wyvill"):
        jbt.point(radius=1, falloff="round")
    with pytest.raises(TypeError, match="falloff: expected a jbt.Falloff or the name of one"):
        jbt.point(radius=1, falloff=3)  # type: ignore[arg-type]
    with pytest.raises(ZeroDivisionError):
        jbt.point(radius=1).falloff_by(lambda r: r * (1 // 0))


def test_warps_may_be_weighted() -> None:
    bar = jbt.segment((-2, 0, 0), (2, 0, 0), radius=0.5)
    pulled = bar.twist("x", rate=1.0)
    weighted = pulled.weighted(jbt.point((0, 0, 1), radius=1.5))
    assert "weighted" in str(weighted)
    weighted.check()


def test_points_from_arrays() -> None:
    rng = np.random.default_rng(3)
    xyz = rng.uniform(-1, 1, (500, 3)).astype(np.float32)
    radius, color = rng.uniform(0.2, 0.4, 500), rng.uniform(0, 1, (500, 3))
    made = jbt.points(xyz, radius=radius, color=color, strength=0.9)
    one_by_one = jbt.sum(
        jbt.point(p, radius=r, color=c, strength=0.9) for p, r, c in zip(xyz, radius, color, strict=True)
    )
    where = rng.uniform(-1, 1, (200, 3))
    assert (made.compile()(where).planes == one_by_one.compile()(where).planes).all()
    assert jbt.points(xyz, radius=0.3, color=(1, 0, 0)).mesh(resolution=24).colors[0].tolist() == [1, 0, 0]


def test_counters(hero: jbt.Model) -> None:
    counts = hero.counters()
    assert counts.all.fused <= counts.all.cached <= counts.all.separate
    assert counts.uses >= counts.instances > 0


def test_repr() -> None:
    ball = jbt.point(radius=1)
    assert repr(ball) == "<jbt.Model of 1 node, 1 leaves>"
    assert repr(jbt.point(radius=-1)) == "<jbt.Model with errors>"


def test_what_overrides_counts_whatever_stands_below() -> None:
    pin = jbt.point(radius=1).constant("material", "brass").color((1, 0, 0))
    over = pin.constant("material", "steel").overriding().color((0, 0, 1)).overriding()
    assert over.owner([[0, 0, 0]]).constants == [{"material": "steel"}]
    assert "override color (0 0 1) { override constant material" in str(over)
    with pytest.raises(ValueError, match="can override, and nothing else"):
        jbt.point(radius=1).overriding()


def test_styles_keep_their_names() -> None:
    def oak(model: jbt.Model) -> jbt.Model:
        return model.constant("material", "oak").attribute("rough", 0.75)

    table = jbt.point(radius=1).styled("oak", oak) + jbt.point((2, 0, 0), radius=1).styled("oak", oak)
    assert str(table).count('style oak = { rough 0.75 constant material "oak" }') == 1
    assert str(table).count("style oak {") == 2
    assert str(jbt.point(radius=1).styled("oak", oak).overriding()).count("override style oak {") == 1
    with pytest.raises(ValueError, match="style: expected"):
        jbt.point(radius=1).styled("oak", lambda model: model.translate((1, 0, 0)))


def test_constants_are_answered_by_owners_and_written(tmp_path: Path) -> None:
    pin = jbt.point((3, 0, 0), radius=1).constant("material", "brass").constant("part", 17)
    model = (jbt.point(radius=1) | pin).constant("material", "steel")
    owners = model.owner([[0.1, 0, 0], [3.1, 0, 0], [9, 0, 0]])
    assert owners.constants == [{"material": "steel"}, {"material": "brass", "part": 17}, {}]
    assert 'constant material "brass"' in str(model)
    mesh = model.mesh(resolution=16)
    assert mesh.constants == {"material": ["steel", "brass"], "part": [17]}
    mesh.save(tmp_path / "pin.obj")
    assert "# material steel, brass\n# part 17\n" in (tmp_path / "pin.obj").read_text()
    with pytest.raises(Exception, match="expected text or a whole number"):
        model.constant("part", 1.5)  # type: ignore[arg-type]
