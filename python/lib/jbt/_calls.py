"""What the functions of `_members.py` call: one for each family of members."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from . import _jbt
from ._types import FalloffLike, Models

if TYPE_CHECKING:
    from ._members import ModelMembers
    from ._model import Model


def as_falloff(given: FalloffLike) -> _jbt.Falloff:
    """A falloff from its name or from itself."""
    if isinstance(given, _jbt.Falloff):
        return given
    if isinstance(given, str):
        return _jbt.Falloff.named(given)
    raise TypeError(
        f"falloff: expected a jbt.Falloff or the name of one, got {given!r} ({type(given).__name__})"
    )


def flat(models: Iterable[Models]) -> list[_jbt.Model]:
    """Models of a call, out of lists."""
    from ._model import Model

    found: list[_jbt.Model] = []
    for item in models:
        for model in (item,) if isinstance(item, Model) else item:
            if not isinstance(model, Model):
                raise TypeError(f"models: expected jbt.Model, got {model!r} ({type(model).__name__})")
            found.append(model._native)
    return found


def primitive(
    name: str,
    values: list[Any],
    radius: Any,
    surface_radius: Any,
    falloff: FalloffLike,
    strength: Any,
    color: Any,
) -> Model:
    """A primitive, by the name of its skeleton."""
    from ._model import Model

    if (radius is None) == (surface_radius is None):
        raise TypeError(
            f"{name}(): expected either radius or surface_radius, got {'none' if radius is None else 'both'}"
        )
    reach = ("radius", radius) if surface_radius is None else ("surface_radius", surface_radius)
    made = Model(_jbt.Model.primitive(name, values, reach, as_falloff(falloff), strength))
    return made if color is None else made.color(color)


def operator(name: str, values: list[Any], models: Iterable[Models]) -> Model:
    """An operator over any number of models."""
    from ._model import Model

    return Model(_jbt.Model.combine(name, values, flat(models)))


def apply(model: ModelMembers, family: str, name: str, values: list[Any]) -> Model:
    """A map, a warp or an operator of one model."""
    from ._model import Model

    assert isinstance(model, Model)
    native = model._native
    if family == "operator":
        return Model(_jbt.Model.combine(name, values, [native]))
    return Model(native.map(name, values) if family == "map" else native.warp(name, values))


def falloff_of(name: str, values: list[Any]) -> _jbt.Falloff:
    """A falloff with numbers."""
    return _jbt.Falloff(name, values)


def pattern(name: str, values: list[Any]) -> _jbt.Pattern:
    """A texture with numbers."""
    return _jbt.Pattern(name, values)


def function(name: str, *values: Any) -> Any:
    """A function of formulas."""
    return _jbt.call(name, list(values))
