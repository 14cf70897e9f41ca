"""Particles from arrays."""

from __future__ import annotations

from typing import Any

from . import _jbt
from ._arrays import matrix, numeric, per_item
from ._calls import as_falloff
from ._model import Model
from ._types import FalloffLike


def points(
    xyz: Any,
    *,
    radius: Any,
    color: Any = None,
    strength: Any = 1.0,
    falloff: FalloffLike = "soft",
) -> Model:
    """One sum of points: any number of particles, from arrays.

    Args:
        xyz: their places, of the shape (n, 3), n at least 1.
        radius: where the field of each reaches zero, > 0: one number, or n of them. Two particles whose
            radii are twice their distance apart or more grow together.
        color: linear red, green and blue: 3 numbers for all, or the shape (n, 3).
        strength: a factor of the field of each: one number, or n of them.
        falloff: how fields fade: a falloff, or the name of one.

    >>> import jbt, numpy as np
    >>> two = jbt.points(np.array([[0, 0.4, 0], [0, -0.4, 0]]), radius=1, color=[[1, 0, 0], [0, 0, 1]])
    >>> round(float(two.compile()(np.array([[0, 0.1, 0]])).field[0]), 6)
    1.294976
    """
    places = matrix("xyz", xyz)
    count = len(places)
    if count == 0:
        raise ValueError("xyz: expected at least one point, got none: a model needs a primitive")
    radii = per_item("radius", radius, count)
    if (radii <= 0).any():
        index = int((radii <= 0).argmax())
        raise ValueError(f"radius: expected numbers above 0, got {radii[index]} at [{index}]")
    strengths = per_item("strength", strength, count)
    colors = None
    if color is not None:
        given = numeric("color", color, f"3 numbers, or an array of the shape ({count}, 3)")
        colors = matrix("color", given.reshape(1, 3) if given.shape == (3,) else given)
        if len(colors) not in (1, count):
            raise ValueError(f"color: expected 3 numbers or the shape ({count}, 3), got {given.shape}")
    return Model(_jbt.points(places, radii, strengths, colors, as_falloff(falloff)))
