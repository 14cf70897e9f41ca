"""Examples in documentation do what they say: docstrings, and the page for Python."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import re
from pathlib import Path
from types import ModuleType

import jbt
import pytest

ROOT = Path(__file__).resolve().parents[2]
MODULES = [
    importlib.import_module(f"jbt.{module.name}")
    for module in pkgutil.iter_modules(jbt.__path__)
    if module.name != "dask"
]


@pytest.mark.parametrize("module", [jbt, *MODULES], ids=lambda module: module.__name__)
def test_docstrings(module: ModuleType) -> None:
    found = doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert found.failed == 0


def test_there_are_enough_docstrings() -> None:
    examples = sum(
        doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE).attempted for module in MODULES
    )
    assert examples > 200


def test_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs" / "python.md").read_text()
    programs = re.findall(r"```python\n(.*?)```", page, flags=re.S)
    assert len(programs) == 5
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for program in programs:
        exec(compile(program, "docs/python.md", "exec"), names)
    assert (tmp_path / "peanut.glb").stat().st_size > 10_000
    assert "<text>:2:1: error: the radius is -1" in capsys.readouterr().out


def test_what_is_public_is_documented() -> None:
    for name in jbt.__all__:
        thing = getattr(jbt, name)
        assert callable(thing) is False or thing.__doc__, name
    for cls in (jbt.Model, jbt.Mesh, jbt.Evaluator, jbt.Answers, jbt.Grid):
        for name, thing in vars(cls).items():
            if not name.startswith("_") and (callable(thing) or isinstance(thing, property)):
                assert thing.__doc__, f"{cls.__name__}.{name}"
