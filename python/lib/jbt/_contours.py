"""Contours in a plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._types import Doubles, Floats


@dataclass(eq=False, repr=False)
class Loop:
    """A closed line; the first point follows the last one. The inside is on the left.

    Attributes:
        positions: (n, 2), in coordinates of the plane.
        points: (n, 3), in space.
        is_hole: whether it is the border of a hole.
        parent: the index of the loop around it, if there is one.
        depth: how many loops are around it.
        area: what it encloses; negative for a hole.
        length: along the line.
        attributes: (n, width) for each group of the model.
    """

    positions: Doubles
    points: Doubles
    is_hole: bool
    parent: int | None
    depth: int
    area: float
    length: float
    attributes: dict[str, Floats]

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        return f"<jbt.Loop of {len(self)} points{', a hole' if self.is_hole else ''}>"


@dataclass(eq=False, repr=False)
class Contours:
    """The contour of a model in a plane.

    Attributes:
        loops: closed lines, which neither cross nor touch.
        cell: the edge of a cell.
        cut_sides: whether the rectangle cuts the solid at the left, below, at the right, above.
    """

    loops: list[Loop]
    cell: float
    cut_sides: tuple[bool, bool, bool, bool]

    @property
    def area(self) -> float:
        """The area of the slice."""
        return sum(loop.area for loop in self.loops)

    @property
    def length(self) -> float:
        """The length of all lines."""
        return sum(loop.length for loop in self.loops)

    def __len__(self) -> int:
        return len(self.loops)

    def __repr__(self) -> str:
        return f"<jbt.Contours of {len(self)} loops>"


def of_native(made: dict[str, Any]) -> Contours:
    """Contours from what the native module tells."""
    positions, points, attributes = made["positions"], made["points"], made["attributes"]
    loops = []
    for start, end, is_hole, parent, depth, area, length in made["loops"]:
        mine = {name: values[start:end] for name, values in attributes.items()}
        loops.append(
            Loop(positions[start:end], points[start:end], is_hole, parent, depth, area, length, mine)
        )
    left, below, right, above = made["cut_sides"]
    return Contours(loops, made["cell"], (left, below, right, above))


def plane_text(plane: Any) -> str:
    """A plane as the native module reads it: `z=0.3`, or nine numbers."""
    if isinstance(plane, str):
        return plane
    expected = 'a text as "z=0.3", a pair as ("z", 0.3), or three vectors: a point, u and v'
    if len(plane) == 2 and isinstance(plane[0], str):
        return f"{plane[0]}={float(plane[1])!r}"
    if len(plane) == 3:
        numbers = [float(number) for vector in plane for number in vector]
        if len(numbers) == 9:
            return ",".join(map(repr, numbers))
    raise ValueError(f"plane: expected {expected}, got {plane!r}")
