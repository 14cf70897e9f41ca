"""Every member of Rust's lists is in the package, with its documentation."""

from __future__ import annotations

import importlib.util
import inspect
from pathlib import Path
from types import ModuleType
from typing import Any

import jbt
import pytest
from jbt import _jbt, _members

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("generator", HERE.parent / "tools" / "members.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_file_is_what_the_lists_say() -> None:
    expected = generator().text(_jbt)
    assert Path(_members.__file__).read_text() == expected, "run python/tools/members.py"


@pytest.mark.parametrize("row", _jbt.members(), ids=lambda row: f"{row['family']}-{row['name']}")
def test_every_member_is_there(row: dict[str, Any]) -> None:
    found = getattr(jbt.Model if row["takes_one"] else jbt, row["name"])
    given = inspect.signature(found).parameters
    for name, word, _, _, default in row["fields"]:
        word = "from_" if word == "from" else word
        assert word in given, f"{row['name']} has a parameter {name}"
        assert (given[word].default is inspect.Parameter.empty) == (default is None)
    assert found.__doc__
    assert len(found.__doc__) > 80, "it says what it is"
    assert ">>> " in found.__doc__, "it has an example"


def test_every_function_is_there() -> None:
    for name, least, _ in _jbt.functions():
        function = getattr(jbt, name)
        numbers = [0.25, 0.5, 0.75][: max(least, 1)]
        assert isinstance(function(*numbers), jbt.Number)
        assert isinstance(function(jbt.x, *numbers[1:]), jbt.Term)
        assert function.__doc__


def test_scenes_of_all_members_are_read_and_written() -> None:
    scenes = sorted((ROOT / "docs" / "members").glob("*/*.jbt")) + sorted((ROOT / "examples").glob("*.jbt"))
    assert len(scenes) > 100
    for scene in scenes:
        model = jbt.load(scene)
        assert jbt.loads(str(model)) == model, scene
        assert model.check() is model


def test_engines_agree_on_all_members() -> None:
    import numpy as np

    points = np.random.default_rng(2).uniform(-1, 1, (200, 3)).astype(np.float32)
    for scene in sorted((ROOT / "docs" / "members").glob("*/*.jbt")):
        compared = jbt.compare_engines(jbt.load(scene), points)
        assert compared.equal, (scene, compared.differing)
        assert "jit" in compared.engines
        assert len(compared.engines) == 3


def test_star_takes_no_names_of_pythons_own() -> None:
    import builtins

    assert not [name for name in jbt.__all__ if hasattr(builtins, name)]
    assert all(hasattr(jbt, name) for name in jbt.__all__)
