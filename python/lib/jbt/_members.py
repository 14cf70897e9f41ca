"""What there is to build with. tools/members.py wrote it from the lists of Rust and docs/."""

# fmt: off

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, overload

from ._calls import apply, falloff_of, function, operator, pattern, primitive
from ._jbt import Falloff, Number, Pattern, Term
from ._types import Axis, FalloffLike, Formula, Matrix, Models, Points, Real, Reals, Vector

if TYPE_CHECKING:
    from ._model import Model

__all__ = [
    "ModelMembers",
    "point",
    "segment",
    "disc",
    "ring",
    "cylinder",
    "cuboid",
    "triangle",
    "polyline",
    "polygon",
    "bezier",
    "catmull_rom",
    "sphere",
    "torus",
    "cone",
    "round_cone",
    "rectangle",
    "arc",
    "helix",
    "half_space",
    "ellipsoid",
    "lmetric",
    "superquadric",
    "soft",
    "wyvill",
    "quartic",
    "metaball",
    "hermite",
    "quintic",
    "linear",
    "degree",
    "blinn",
    "arctan",
    "inverse_power",
    "blanc",
    "sum",
    "ricci",
    "product",
    "union",
    "intersection",
    "difference",
    "symmetric_difference",
    "smooth_union",
    "smooth_intersection",
    "smooth_difference",
    "rfunction",
    "rfunction_power",
    "rfunction_order",
    "checker",
    "stripes",
    "gradient",
    "noise",
    "rings",
    "marble",
    "sqrt",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "abs",
    "sign",
    "floor",
    "ceil",
    "round",
    "mod",
    "exp",
    "ln",
    "square",
    "min",
    "max",
    "clamp",
    "mix",
    "step",
    "length",
    "pow",
]


def point(at: Vector = (0, 0, 0), *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""``d = |p - at|``: the skeleton of a ball (Blinn 1982).

    Args:
        at: where it is; 3 numbers, default (0, 0, 0).
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.point((0.1, 0.2, 0.3), radius=1))
    jbt 1
    iso 0.5
    point { at (0.1 0.2 0.3) radius 1 }
    """
    return primitive("point", [at], radius, surface_radius, falloff, strength, color)


def segment(from_: Vector, to: Vector, *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""The straight line between two points: ``d = |p - from - t (to - from)|`` with t the
    projection, clamped to [0, 1]. The skeleton of a capsule. Equal ends make it a point.

    Args:
        from_: one end; 3 numbers, required.
        to: the other end; 3 numbers, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.segment((0.1, 0.2, 0.3), (0.1, 0.2, 0.4), radius=1))
    jbt 1
    iso 0.5
    segment { from (0.1 0.2 0.3) to (0.1 0.2 0.4) radius 1 }
    """
    return primitive("segment", [from_, to], radius, surface_radius, falloff, strength, color)


def disc(center: Vector = (0, 0, 0), normal: Axis | Vector = (0, 0, 1), *, disc_radius: Real, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A filled circle: ``d^2 = h^2 + max(0, rho - radius)^2``, h the height above its plane, rho
    the distance from its axis. With radius 0 it is a point.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        normal: the direction that it faces, either of the two; 3 numbers, not all 0, or "x", "y",
            "z", default (0, 0, 1).
        disc_radius: how far it reaches from the middle; a number >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.disc((0.1, 0.2, 0.3), "y", disc_radius=1.25, radius=1))
    jbt 1
    iso 0.5
    disc { center (0.1 0.2 0.3) normal (0 1 0) disc_radius 1.25 radius 1 }
    """
    return primitive("disc", [center, normal, disc_radius], radius, surface_radius, falloff, strength, color)


def ring(center: Vector = (0, 0, 0), normal: Axis | Vector = (0, 0, 1), *, ring_radius: Real, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A circle that is not filled: ``d^2 = h^2 + (rho - radius)^2``. The skeleton of a torus. With
    radius 0 it is a point; on the axis the gradient has no part across it.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        normal: the direction of its axis; 3 numbers, not all 0, or "x", "y", "z", default (0, 0,
            1).
        ring_radius: its distance from the middle; a number >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.ring((0.1, 0.2, 0.3), "y", ring_radius=1.25, radius=1))
    jbt 1
    iso 0.5
    ring { center (0.1 0.2 0.3) normal (0 1 0) ring_radius 1.25 radius 1 }
    """
    return primitive("ring", [center, normal, ring_radius], radius, surface_radius, falloff, strength, color)


def cylinder(from_: Vector, to: Vector, cylinder_radius: Real, *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A solid cylinder with flat ends: ``d^2 = max(0, |z| - half)^2 + max(0, rho - radius)^2``, z
    along the axis from its middle. With radius 0 it is a segment. Equal ends make it a disc whose
    axis is z.

    Args:
        from_: one end of the axis; 3 numbers, required.
        to: the other end of the axis; 3 numbers, required.
        cylinder_radius: how far it reaches from the axis; a number >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.cylinder((0.1, 0.2, 0.3), (0.1, 0.2, 0.4), 1.25, radius=1))
    jbt 1
    iso 0.5
    cylinder { from (0.1 0.2 0.3) to (0.1 0.2 0.4) cylinder_radius 1.25 radius 1 }
    """
    return primitive("cylinder", [from_, to, cylinder_radius], radius, surface_radius, falloff, strength, color)


def cuboid(center: Vector = (0, 0, 0), *, half: Vector, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A solid box along the axes: ``d^2 = sum max(0, |x_i - center_i| - half_i)^2``. Half sizes of
    0 make it a rectangle, a segment or a point; a map turns it.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        half: half its sides; 3 numbers >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.cuboid((0.1, 0.2, 0.3), half=(0.3, 0.2, 0.1), radius=1))
    jbt 1
    iso 0.5
    box { center (0.1 0.2 0.3) half (0.3 0.2 0.1) radius 1 }
    """
    return primitive("cuboid", [center, half], radius, surface_radius, falloff, strength, color)


def triangle(a: Vector, b: Vector, c: Vector, *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A filled triangle: the height above its plane where the point is above it, else the distance
    from the nearest of its sides. Corners on a line make it a segment, equal ones a point.

    Args:
        a: a corner; 3 numbers, required.
        b: a corner; 3 numbers, required.
        c: a corner; 3 numbers, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.triangle((0.1, 0.2, 0.3), (0.1, 0.2, 0.4), (0.1, 0.2, 0.5), radius=1))
    jbt 1
    iso 0.5
    triangle { a (0.1 0.2 0.3) b (0.1 0.2 0.4) c (0.1 0.2 0.5) radius 1 }
    """
    return primitive("triangle", [a, b, c], radius, surface_radius, falloff, strength, color)


def polyline(points: Points, radii: Reals = (), closed: bool = False, *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""Straight lines from point to point. With radii each line is a round cone (see above).

    Args:
        points: at least two; points, required.
        radii: none: it is thin; one for all points; or one for each; numbers >= 0, default ().
        closed: whether a line leads from the last point to the first; True or False, default False.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.polyline([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [0.1], True, radius=1))
    jbt 1
    iso 0.5
    polyline { points ((0 0 0) (1 0 0) (0 1 0) (0 0 1)) radii (0.1) closed yes radius 1 }
    """
    return primitive("polyline", [points, radii, closed], radius, surface_radius, falloff, strength, color)


def polygon(points: Points, *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A filled flat region between corners, in either sense of rotation, concave or not: ``d^2 =
    z^2`` where the point is above the inside, else the distance from the nearest edge. Where edges
    cross, the inside is what a ray leaves through an odd number of edges, so the middle of a
    pentagram is a hole; edges always belong to it. The corners have to be in one plane, within 1e-5
    of the polygon's size, and to have an area.

    Args:
        points: the corners, at least three; points, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.polygon([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], radius=1))
    jbt 1
    iso 0.5
    polygon { points ((0 0 0) (1 0 0) (0 1 0) (0 0 1)) radius 1 }
    """
    return primitive("polygon", [points], radius, surface_radius, falloff, strength, color)


def bezier(points: Points, radii: Reals = (), *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A chain of cubic Bezier curves: 3 n + 1 points for n curves, the last of one being the first
    of the next. It is smooth at a joint that is on the line between its neighbours. Radii are
    Bezier coefficients, as points are.

    There is no closed form. The curve is halved into nearly straight pieces, and Newton's method
    finds the nearest ball of each. The answer is never too small, and off by less than 1e-5 of the
    support radius at nearly all points (3e-4 at worst was seen, near a centre of curvature).
    Gradients are off by up to 1e-3 of the slope there.

    Args:
        points: 4, 7, 10, .. of them; points, required.
        radii: none: it is thin; one for all points; or one for each; numbers >= 0, default ().
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.bezier([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [0.1], radius=1))
    jbt 1
    iso 0.5
    bezier { points ((0 0 0) (1 0 0) (0 1 0) (0 0 1)) radii (0.1) radius 1 }
    """
    return primitive("bezier", [points, radii], radius, surface_radius, falloff, strength, color)


def catmull_rom(points: Points, radii: Reals = (), closed: bool = False, *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A curve through points (Catmull and Rom 1974), with the tangent ``(p_(i+1) - p_(i-1)) / 2``
    at each; at an open end it is the way to the only neighbour. Radii go through theirs likewise,
    but change at a point by at most 3 times the radius there, so that they never fall below 0.
    Errors are those of ``bezier``.

    Args:
        points: at least two; points, required.
        radii: none: it is thin; one for all points; or one for each; numbers >= 0, default ().
        closed: whether the curve leads on from the last point to the first; then there are at least
            three; True or False, default False.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.catmull_rom([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [0.1], True, radius=1))
    jbt 1
    iso 0.5
    catmull_rom { points ((0 0 0) (1 0 0) (0 1 0) (0 0 1)) radii (0.1) closed yes radius 1 }
    """
    return primitive("catmull_rom", [points, radii, closed], radius, surface_radius, falloff, strength, color)


def sphere(center: Vector = (0, 0, 0), *, sphere_radius: Real, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A solid ball, whose field has a core of full strength: ``d = max(0, |p - center| -
    radius)``. With radius 0 it is a point.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        sphere_radius: how far it reaches from the middle; a number >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.sphere((0.1, 0.2, 0.3), sphere_radius=0.75, radius=1))
    jbt 1
    iso 0.5
    sphere { center (0.1 0.2 0.3) sphere_radius 0.75 radius 1 }
    """
    return primitive("sphere", [center, sphere_radius], radius, surface_radius, falloff, strength, color)


def torus(center: Vector = (0, 0, 0), normal: Axis | Vector = (0, 0, 1), *, ring_radius: Real, tube_radius: Real, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""All points within ``tube_radius`` of a circle: the ring's distance less that, and 0 inside.
    A tube of radius 0 is the ring itself, a circle of radius 0 makes a ball.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        normal: the direction of its axis; 3 numbers, not all 0, or "x", "y", "z", default (0, 0,
            1).
        ring_radius: the radius of the circle in the middle of the tube; a number >= 0, required.
        tube_radius: the radius of the tube; a number >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.torus((0.1, 0.2, 0.3), "y", ring_radius=1.25, tube_radius=1.75, radius=1))
    jbt 1
    iso 0.5
    torus { center (0.1 0.2 0.3) normal (0 1 0) ring_radius 1.25 tube_radius 1.75 radius 1 }
    """
    return primitive("torus", [center, normal, ring_radius, tube_radius], radius, surface_radius, falloff, strength, color)


def cone(from_: Vector, to: Vector, from_radius: Real, to_radius: Real = 0, *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A solid cone or, with two radii, a frustum, with flat ends: the distance from a figure of
    three sides in the half plane of axis and radius. Equal radii make it a cylinder, radii of 0 a
    segment; equal ends make it a disc of the larger radius whose axis is z.

    Args:
        from_: one end of the axis; 3 numbers, required.
        to: the other end of the axis; 3 numbers, required.
        from_radius: how far it reaches from the axis at ``from``; a number >= 0, required.
        to_radius: how far it reaches from the axis at ``to``; a number >= 0, default 0.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.cone((0.1, 0.2, 0.3), (0.1, 0.2, 0.4), 1.25, 1.75, radius=1))
    jbt 1
    iso 0.5
    cone { from (0.1 0.2 0.3) to (0.1 0.2 0.4) from_radius 1.25 to_radius 1.75 radius 1 }
    """
    return primitive("cone", [from_, to, from_radius, to_radius], radius, surface_radius, falloff, strength, color)


def round_cone(from_: Vector, to: Vector, from_radius: Real, to_radius: Real, *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""The hull of two balls, also called cone-sphere or tapered capsule: all balls along the axis
    whose radii change evenly. The nearest of them is at ``tau = clamp(z + y k / sqrt(1 - k^2),
    ends)``, k the change of the radius for each unit of length, y the distance from the axis. Where
    one ball holds the other (|k| >= 1), it is the skeleton alone.

    Args:
        from_: the middle of one ball; 3 numbers, required.
        to: the middle of the other ball; 3 numbers, required.
        from_radius: the radius of the ball at ``from``; a number >= 0, required.
        to_radius: the radius of the ball at ``to``; a number >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.round_cone((0.1, 0.2, 0.3), (0.1, 0.2, 0.4), 1.25, 1.75, radius=1))
    jbt 1
    iso 0.5
    round_cone { from (0.1 0.2 0.3) to (0.1 0.2 0.4) from_radius 1.25 to_radius 1.75 radius 1 }
    """
    return primitive("round_cone", [from_, to, from_radius, to_radius], radius, surface_radius, falloff, strength, color)


def rectangle(center: Vector = (0, 0, 0), normal: Axis | Vector = (0, 0, 1), along: Axis | Vector = (1, 0, 0), *, half_length: Real, half_width: Real, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A flat rectangle any way round. With a half size of 0 it is a segment, with two a point.
    ``along`` may not lie along the normal.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        normal: the direction that it faces, either of the two; 3 numbers, not all 0, or "x", "y",
            "z", default (0, 0, 1).
        along: the direction of its length: only the part across the normal counts; 3 numbers, not
            all 0, or "x", "y", "z", default (1, 0, 0).
        half_length: how far it reaches along ``along``; a number >= 0, required.
        half_width: how far it reaches across ``along``; a number >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.rectangle((0.1, 0.2, 0.3), "y", "y", half_length=1.75, half_width=2.25, radius=1))
    jbt 1
    iso 0.5
    rectangle { center (0.1 0.2 0.3) normal (0 1 0) along (0 1 0) half_length 1.75 half_width 2.25 radius 1 }
    """
    return primitive("rectangle", [center, normal, along, half_length, half_width], radius, surface_radius, falloff, strength, color)


def arc(center: Vector = (0, 0, 0), normal: Axis | Vector = (0, 0, 1), start: Axis | Vector = (1, 0, 0), *, degrees: Real, arc_radius: Real, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A part of a circle: where the point's angle is within the arc the ring's distance, else that
    of the nearer end. With radius 0 or angle 0 it is a point, with 360 degrees a ring. ``start``
    may not lie along the normal.

    Args:
        center: the middle of its circle; 3 numbers, default (0, 0, 0).
        normal: the axis: seen from its tip the arc goes counterclockwise; 3 numbers, not all 0, or
            "x", "y", "z", default (0, 0, 1).
        start: where the arc begins: only the part across the normal counts; 3 numbers, not all 0,
            or "x", "y", "z", default (1, 0, 0).
        degrees: how far it goes; 0 .. 360, required.
        arc_radius: the radius of the circle; a number >= 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.arc((0.1, 0.2, 0.3), "y", "y", degrees=90, arc_radius=2.25, radius=1))
    jbt 1
    iso 0.5
    arc { center (0.1 0.2 0.3) normal (0 1 0) start (0 1 0) degrees 90 arc_radius 2.25 radius 1 }
    """
    return primitive("arc", [center, normal, start, degrees, arc_radius], radius, surface_radius, falloff, strength, color)


def helix(center: Vector = (0, 0, 0), normal: Axis | Vector = (0, 0, 1), start: Axis | Vector = (1, 0, 0), *, helix_radius: Real, pitch: Real, turns: Real, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""A screw line about an axis, of any number of turns. Its nearest place is found by a fixed
    number of Newton's steps: it is too far by at most 2^-19 of the larger of the radius and pitch /
    2 pi (at its centres of curvature), elsewhere by rounding alone. With 0 turns it is a point.
    ``start`` may not lie along the normal, and ``pitch`` may not be 0.

    Args:
        center: the middle of its axis; 3 numbers, default (0, 0, 0).
        normal: the axis: seen from its tip the helix goes counterclockwise; 3 numbers, not all 0,
            or "x", "y", "z", default (0, 0, 1).
        start: where it begins: only the part across the normal counts; 3 numbers, not all 0, or
            "x", "y", "z", default (1, 0, 0).
        helix_radius: how far it is from the axis; a number >= 0, required.
        pitch: how far it rises along the axis in a turn: below 0 it falls, and is left-handed; any
            number, required.
        turns: how many turns it has, whole or not; 0 .. 4096, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.helix((0.1, 0.2, 0.3), "y", "y", helix_radius=1.75, pitch=2.25, turns=2048.0, radius=1))
    jbt 1
    iso 0.5
    helix { center (0.1 0.2 0.3) normal (0 1 0) start (0 1 0) helix_radius 1.75 pitch 2.25 turns 2048 radius 1 }
    """
    return primitive("helix", [center, normal, start, helix_radius, pitch, turns], radius, surface_radius, falloff, strength, color)


def half_space(at: Vector = (0, 0, 0), normal: Axis | Vector = (0, 0, 1), *, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""All that is behind a plane: ``d = max(0, (p - at) . normal)``, normal of length 1. It has no
    end, and so a model of it alone has none: give a mesh a ``--region``, or intersect it with
    something.

    Args:
        at: a point of the plane; 3 numbers, default (0, 0, 0).
        normal: the direction out of the half space; 3 numbers, not all 0, or "x", "y", "z", default
            (0, 0, 1).
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.half_space((0.1, 0.2, 0.3), "y", radius=1))
    jbt 1
    iso 0.5
    half_space { at (0.1 0.2 0.3) normal (0 1 0) radius 1 }
    """
    return primitive("half_space", [at, normal], radius, surface_radius, falloff, strength, color)


def ellipsoid(center: Vector = (0, 0, 0), *, stretch: Vector, radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""``d^2 = (x / a)^2 + (y / b)^2 + (z / c)^2`` with (a b c) the stretch: the field of a ball
    under a scale.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        stretch: how many times it reaches as far as the radius; 3 numbers > 0, required.
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.ellipsoid((0.1, 0.2, 0.3), stretch=(1, 2, 3), radius=1))
    jbt 1
    iso 0.5
    ellipsoid { center (0.1 0.2 0.3) stretch (1 2 3) radius 1 }
    """
    return primitive("ellipsoid", [center, stretch], radius, surface_radius, falloff, strength, color)


def lmetric(center: Vector = (0, 0, 0), *, exponent: Real, stretch: Vector = (1, 1, 1), radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""``d^l = |x / a|^l + |y / b|^l + |z / c|^l``: from the octahedron (l = 1) over the ball (2)
    to the cube (many). It is computed from the largest of the three terms, so no power overflows.
    Where a coordinate is 0, the gradient jumps for l = 1, and turns quickly for l < 2.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        exponent: l; 1 .. 1024, required.
        stretch: how many times it reaches as far as the radius; 3 numbers > 0, default (1, 1, 1).
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.lmetric((0.1, 0.2, 0.3), exponent=512.5, stretch=(1, 2, 3), radius=1))
    jbt 1
    iso 0.5
    lmetric { center (0.1 0.2 0.3) exponent 512.5 stretch (1 2 3) radius 1 }
    """
    return primitive("lmetric", [center, exponent, stretch], radius, surface_radius, falloff, strength, color)


def superquadric(center: Vector = (0, 0, 0), *, e1: Real, e2: Real, stretch: Vector = (1, 1, 1), radius: Real | None = None, surface_radius: Real | None = None, falloff: FalloffLike = "soft", strength: Real = 1, color: Reals | None = None) -> Model:
    r"""``d^(2/e1) = (|x / a|^(2/e2) + |y / b|^(2/e2))^(e2/e1) + |z / c|^(2/e1)`` (Barr 1981). e1
    shapes the profile along z and e2 the slices across it: 1 is round, towards 0 square, 2 has flat
    facets. Pinched shapes, with exponents above 2, are refused: their distance is infinitely steep
    at the planes where a coordinate is 0. Kinks are those of ``lmetric``.

    Args:
        center: its middle; 3 numbers, default (0, 0, 0).
        e1: Barr's exponent along z; 0.001953125 .. 2, required.
        e2: Barr's exponent across z; 0.001953125 .. 2, required.
        stretch: how many times it reaches as far as the radius; 3 numbers > 0, default (1, 1, 1).
        radius: where the field reaches zero, the support radius; a number > 0. This or the next
            one.
        surface_radius: where the surface of this primitive alone is; a number > 0.
        falloff: how the field fades: a falloff, or the name of one; default "soft".
        strength: a factor of the field; any number, default 1. A negative one carves in sums.
        color: linear red, green and blue.

    >>> import jbt
    >>> print(jbt.superquadric((0.1, 0.2, 0.3), e1=1.0009765625, e2=1.0009765625, stretch=(1, 2, 3), radius=1))
    jbt 1
    iso 0.5
    superquadric { center (0.1 0.2 0.3) e1 1.0009765625 e2 1.0009765625 stretch (1 2 3) radius 1 }
    """
    return primitive("superquadric", [center, e1, e2, stretch], radius, surface_radius, falloff, strength, color)


def soft() -> Falloff:
    r"""``1 - 22/9 s + 17/9 s^2 - 4/9 s^3 = u^2 (5 + 4u) / 9``: soft objects (Wyvill, McPheeters and
    Wyvill 1986). It is the one that is taken if none is written; with iso 1/2 the surface is at
    half the radius.

    >>> import jbt
    >>> jbt.soft()
    <jbt.Falloff soft>
    """
    return falloff_of("soft", [])


def wyvill() -> Falloff:
    r"""``u^3``: Wyvill's cubic, also Galin's and Blender's.

    >>> import jbt
    >>> jbt.wyvill()
    <jbt.Falloff wyvill>
    """
    return falloff_of("wyvill", [])


def quartic() -> Falloff:
    r"""``u^2``: Murakami and Ichihara (1987), and POV-Ray's blobs.

    >>> import jbt
    >>> jbt.quartic()
    <jbt.Falloff quartic>
    """
    return falloff_of("quartic", [])


def metaball() -> Falloff:
    r"""``1 - 3 r^2`` for r up to 1/3, then ``3/2 (1 - r)^2`` (Nishimura et al. 1985).

    >>> import jbt
    >>> jbt.metaball()
    <jbt.Falloff metaball>
    """
    return falloff_of("metaball", [])


def hermite() -> Falloff:
    r"""``1 - 3 r^2 + 2 r^3``, the cubic Hermite polynomial of Hart's sphere tracing (1996).

    >>> import jbt
    >>> jbt.hermite()
    <jbt.Falloff hermite>
    """
    return falloff_of("hermite", [])


def quintic() -> Falloff:
    r"""``1 - 10 r^3 + 15 r^4 - 6 r^5``: Perlin's fade function (2002), reversed. Its curvature is
    continuous at both ends.

    >>> import jbt
    >>> jbt.quintic()
    <jbt.Falloff quintic>
    """
    return falloff_of("quintic", [])


def linear() -> Falloff:
    r"""``1 - r``: a cone, whose tip is at the skeleton. It gives formulas a distance: ``r = 1 -
    field(a)`` is the distance to a's skeleton in radii, so any falloff can be written as a formula
    of it. Where the formula is 0 for r = 1, the support stays that of the primitive.

    >>> import jbt
    >>> jbt.linear()
    <jbt.Falloff linear>
    """
    return falloff_of("linear", [])


def degree(exponent: Real) -> Falloff:
    r"""``u^n``, Stolte's family: ``quartic`` for n = 2, ``wyvill`` for n = 3. Whole exponents up to
    64 are chains of products, others powers. Below n = 1 the slope grows without bounds towards the
    rim; gradients stay finite.

    Args:
        exponent: n; 0.001 .. 1024, required.

    >>> import jbt
    >>> jbt.degree(512.0005)
    <jbt.Falloff degree { exponent 512.0005 }>
    """
    return falloff_of("degree", [exponent])


def blinn(hardness: Real = 2, cutoff: Real = 2, edge: Literal["exact", "smooth"] = "smooth") -> Falloff:
    r"""``exp(-h (c r)^2)`` (Blinn 1982). With his ``b exp(-a d^2)``, b is the strength and ``a = h
    c^2 / R^2``. An exact edge jumps by ``exp(-h c^2)``, 0.00034 for the defaults.

    Args:
        hardness: h, how fast it falls; 0.001 .. 1000, default 2.
        cutoff: c, the support radius in units of the radius that the hardness is meant for; 0.01 ..
            16, default 2.
        edge: what happens at the support radius; one of exact, smooth, default "smooth".

    >>> import jbt
    >>> jbt.blinn(500.0005, 8.005, "smooth")
    <jbt.Falloff blinn { hardness 500.0005 cutoff 8.005 }>
    """
    return falloff_of("blinn", [hardness, cutoff, edge])


def arctan(stiffness: Real = 50, edge: Literal["exact", "smooth"] = "exact") -> Falloff:
    r"""``1/2 + atan(p (1 - 2r)) / (2 atan p)`` (Kacic-Alesic and Wyvill 1991): a step at half the
    radius, as steep as one likes. It has a tip of slope ``-p / ((1 + p^2) atan p)`` in r at the
    skeleton, and the same slope at the rim: a crease, which a smooth edge takes away.

    Args:
        stiffness: p; 0.01 .. 1000, default 50.
        edge: what happens at the support radius; one of exact, smooth, default "exact".

    >>> import jbt
    >>> jbt.arctan(500.005, "smooth")
    <jbt.Falloff arctan { stiffness 500.005 edge smooth }>
    """
    return falloff_of("arctan", [stiffness, edge])


def inverse_power(exponent: Real = 2, cutoff: Real = 4, edge: Literal["exact", "smooth"] = "smooth") -> Falloff:
    r"""``1 / (1 + (c r)^n)``: a potential like ``1 / d^n`` that is finite at the skeleton; n = 2 is
    Cauchy's and Lorentz's curve. An exact edge jumps by ``1 / (1 + c^n)``, 1/17 for the defaults.
    Whole exponents are products.

    Args:
        exponent: n; 1 .. 16, default 2.
        cutoff: c, the support radius in units of the distance at which the field is 1/2; 0.01 ..
            16, default 4.
        edge: what happens at the support radius; one of exact, smooth, default "smooth".

    >>> import jbt
    >>> jbt.inverse_power(8.5, 8.005, "smooth")
    <jbt.Falloff inverse_power { exponent 8.5 cutoff 8.005 }>
    """
    return falloff_of("inverse_power", [exponent, cutoff, edge])


def blanc(hardness: Real = 0) -> Falloff:
    r"""Two rational pieces with a hardness p (Blanc and Schlick 1995):

    1 - 9 s^2 / (p + (9/2 - 4p) s) s <= 1/4 (1 - s)^2 / (3/4 - p + (3/2 + 4p) s) s >= 1/4

    It is 1/2 at half the radius whatever p is; the larger p, the nearer it is to a step there.

    Args:
        hardness: p; 0 .. 100, default 0.

    >>> import jbt
    >>> jbt.blanc(50.0)
    <jbt.Falloff blanc { hardness 50 }>
    """
    return falloff_of("blanc", [hardness])


def sum(*models: Models) -> Model:
    r"""The sum of fields: the plain blend (Blinn 1982). Negative fields count.

    Args:
        models: models, or lists of them; at least one.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.sum(ball, ball))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    sum {
        use n1
        use n1
    }
    """
    return operator("sum", [], models)


def ricci(*models: Models, exponent: Real) -> Model:
    r"""Ricci's super-elliptic blend (1973): 1 is the sum, large exponents are near the union.
    Negative exponents are near the intersection: 0 where any field is. Fields are scaled by the
    largest (the smallest), so no exponent overflows. The exponent is a number from 1 to 1024 or
    from -1024 to -1. With exponent 1 negative fields count as in ``sum``; otherwise, and where the
    exponent depends on a parameter, what is negative counts as 0. ``blend ricci 3`` is the same as
    ``ricci 3``.

    Args:
        models: models, or lists of them; at least one.
        exponent: any number, required.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.ricci(ball, ball, exponent=0.25))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    blend ricci 0.25 {
        use n1
        use n1
    }
    """
    return operator("ricci", [exponent], models)


def product(*models: Models) -> Model:
    r"""Each field in units of the iso-value: of two ``f_1 f_2 / c``. It is an intersection that
    blends, c where all fields are c; a child that is larger than c fattens the others.

    Args:
        models: models, or lists of them; at least one.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.product(ball, ball))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    product {
        use n1
        use n1
    }
    """
    return operator("product", [], models)


def union(*models: Models) -> Model:
    r"""The largest field. Of equals the first child wins. The gradient jumps where the winner
    changes.

    Args:
        models: models, or lists of them; at least one.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.union(ball, ball))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    union {
        use n1
        use n1
    }
    """
    return operator("union", [], models)


def intersection(*models: Models) -> Model:
    r"""The smallest field. Of equals the first child wins.

    Args:
        models: models, or lists of them; at least one.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.intersection(ball, ball))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    intersection {
        use n1
        use n1
    }
    """
    return operator("intersection", [], models)


def difference(*models: Models) -> Model:
    r"""The first child without the others. ``2c - f`` has the surface of f with inside and outside
    exchanged; clamped at 0, it leaves the field non-negative and within the support of the first
    child. Far from what is subtracted it limits the field to 2c. A subtracted child decides only
    where it is strictly smaller.

    Args:
        models: models, or lists of them; at least one.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.difference(ball, ball))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    difference {
        use n1
        use n1
    }
    """
    return operator("difference", [], models)


def symmetric_difference(*models: Models) -> Model:
    r"""What is inside of exactly one of two; of more, folded from the left, inside of an odd
    number.

    Args:
        models: models, or lists of them; at least one.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.symmetric_difference(ball, ball))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    symmetric_difference {
        use n1
        use n1
    }
    """
    return operator("symmetric_difference", [], models)


def smooth_union(*models: Models, width: Real) -> Model:
    r"""``max(a, b) + D`` with the quadratic kernel of smooth distances (Quilez 2013):

    k is the ``width``, in units of the field and > 0. L limits it where the fields are small: K is
    k where a + b is at least 2k, and never above a + b. So D is exactly 0 where a side is, and the
    supports are those of the plain union. Up to a width of 2/3 c all of the surface has K = k.
    Negative fields are not rounded.

    Args:
        models: models, or lists of them; at least one.
        width: a number > 0, required.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.smooth_union(ball, ball, width=0.25))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    smooth_union 0.25 {
        use n1
        use n1
    }
    """
    return operator("smooth_union", [width], models)


def smooth_intersection(*models: Models, width: Real) -> Model:
    r"""``min(a, b) - D``, with the same D. Up to a width of 4/3 c all of the surface has K = k.

    Args:
        models: models, or lists of them; at least one.
        width: a number > 0, required.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.smooth_intersection(ball, ball, width=0.25))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    smooth_intersection 0.25 {
        use n1
        use n1
    }
    """
    return operator("smooth_intersection", [width], models)


def smooth_difference(*models: Models, width: Real) -> Model:
    r"""The smooth intersection of a and the complement ``b' = max(0, 2c - b)``, whose width is
    limited twice, by b and then by the sum of the two: ``min(a, b') - D`` with ``K = L(L(k, b), a +
    b')``. Limited by b, it leaves a alone where b is not there. Up to a width of 1/3 c all of the
    surface has K = k.

    Args:
        models: models, or lists of them; at least one.
        width: a number > 0, required.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.smooth_difference(ball, ball, width=0.25))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    smooth_difference 0.25 {
        use n1
        use n1
    }
    """
    return operator("smooth_difference", [width], models)


def rfunction(*models: Models, set: Literal["union", "intersection", "difference"], alpha: Real = 0) -> Model:
    r"""R-functions (Rvachev 1963, 1982): set operations of functions whose sign is the inside. With
    ``x = a / c - 1`` and ``y = b / c - 1``, ``rfunction union`` takes ``R(x, y)``, ``rfunction
    intersection`` ``-R(-x, -y)``, ``rfunction difference`` ``-R(-x, y)``.

    An ``rfunction`` of several children folds from the left, as all operators of this section do.
    ``power`` keeps its digits, in field, gradient and weights, also where p is large or one field
    is far above the other.

    As they are published, R-functions have no support: R_0 of two fields that are 0 is not 0. So
    the field is ``max(0, c (1 - R / B))``, B the value of R where both fields are 0: 0 where all
    fields are, and with the same surface. A lone field is changed too (0.3 becomes 0.22 by the
    union of R_0 with c = 1/2), and the intersection is not 0 where one field alone is (by R_0 0.29
    where the other one is 1, with c = 1/2): all of them reach as far as the hull of the children.
    Gradients are continuous but for the corner x = y = 0, where the root's derivative counts as 0
    (by ``power`` the gradient there is that of one side), and ties of alpha 1. R_0^m is not
    monotone.

    Args:
        models: models, or lists of them; at least one.
        set: one of union, intersection, difference, required.
        alpha: -0.9 .. 1: 1 is the maximum, 0 is R_0, which is taken if none is written; -0.9 .. 1,
            default 0.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.rfunction(ball, ball, set="difference", alpha=0.04999999999999999))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    rfunction difference alpha 0.04999999999999999 {
        use n1
        use n1
    }
    """
    return operator("rfunction", [set, alpha], models)


def rfunction_power(*models: Models, set: Literal["union", "intersection", "difference"], power: Real) -> Model:
    r"""R-functions (Rvachev 1963, 1982): set operations of functions whose sign is the inside. With
    ``x = a / c - 1`` and ``y = b / c - 1``, ``rfunction union`` takes ``R(x, y)``, ``rfunction
    intersection`` ``-R(-x, -y)``, ``rfunction difference`` ``-R(-x, y)``.

    An ``rfunction`` of several children folds from the left, as all operators of this section do.
    ``power`` keeps its digits, in field, gradient and weights, also where p is large or one field
    is far above the other.

    As they are published, R-functions have no support: R_0 of two fields that are 0 is not 0. So
    the field is ``max(0, c (1 - R / B))``, B the value of R where both fields are 0: 0 where all
    fields are, and with the same surface. A lone field is changed too (0.3 becomes 0.22 by the
    union of R_0 with c = 1/2), and the intersection is not 0 where one field alone is (by R_0 0.29
    where the other one is 1, with c = 1/2): all of them reach as far as the hull of the children.
    Gradients are continuous but for the corner x = y = 0, where the root's derivative counts as 0
    (by ``power`` the gradient there is that of one side), and ties of alpha 1. R_0^m is not
    monotone.

    Args:
        models: models, or lists of them; at least one.
        set: one of union, intersection, difference, required.
        power: 1.1 .. 64: 2 is R_0; 1.1 .. 64, required.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.rfunction_power(ball, ball, set="difference", power=32.55))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    rfunction difference power 32.55 {
        use n1
        use n1
    }
    """
    return operator("rfunction_power", [set, power], models)


def rfunction_order(*models: Models, set: Literal["union", "intersection", "difference"], order: int) -> Model:
    r"""R-functions (Rvachev 1963, 1982): set operations of functions whose sign is the inside. With
    ``x = a / c - 1`` and ``y = b / c - 1``, ``rfunction union`` takes ``R(x, y)``, ``rfunction
    intersection`` ``-R(-x, -y)``, ``rfunction difference`` ``-R(-x, y)``.

    An ``rfunction`` of several children folds from the left, as all operators of this section do.
    ``power`` keeps its digits, in field, gradient and weights, also where p is large or one field
    is far above the other.

    As they are published, R-functions have no support: R_0 of two fields that are 0 is not 0. So
    the field is ``max(0, c (1 - R / B))``, B the value of R where both fields are 0: 0 where all
    fields are, and with the same surface. A lone field is changed too (0.3 becomes 0.22 by the
    union of R_0 with c = 1/2), and the intersection is not 0 where one field alone is (by R_0 0.29
    where the other one is 1, with c = 1/2): all of them reach as far as the hull of the children.
    Gradients are continuous but for the corner x = y = 0, where the root's derivative counts as 0
    (by ``power`` the gradient there is that of one side), and ties of alpha 1. R_0^m is not
    monotone.

    Args:
        models: models, or lists of them; at least one.
        set: one of union, intersection, difference, required.
        order: 1, 2, 3 or 4; it is code and depends on no parameter; a whole number, 1 .. 4,
            required.

    >>> import jbt
    >>> ball = jbt.point(radius=1); print(jbt.rfunction_order(ball, ball, set="difference", order=4))
    jbt 1
    iso 0.5
    let n1 = point { radius 1 }
    rfunction difference order 4 {
        use n1
        use n1
    }
    """
    return operator("rfunction_order", [set, order], models)


def checker(size: Real = 1) -> Pattern:
    r"""Cubes in turn: ``t = (floor(x / size) + floor(y / size) + floor(z / size)) mod 2``. A face
    of a solid that lies exactly between two layers belongs to neither: shift the pattern.

    Args:
        size: the side of a cube; a number > 0, default 1.

    >>> import jbt
    >>> print(jbt.point(radius=1).textured("rough", jbt.checker(0.25), 0, 1))
    jbt 1
    iso 0.5
    attribute rough 1 default 0 blend
    rough checker { a 0 b 1 size 0.25 } { point { radius 1 } }
    """
    return pattern("checker", [size])


def stripes(along: Axis | Vector = (1, 0, 0), width: Real = 1) -> Pattern:
    r"""Layers in turn: ``t = floor(p . along / width) mod 2``, ``along`` of length 1.

    Args:
        along: the direction in which they follow each other; 3 numbers, not all 0, or "x", "y",
            "z", default (1, 0, 0).
        width: how thick each is; a number > 0, default 1.

    >>> import jbt
    >>> print(jbt.point(radius=1).textured("rough", jbt.stripes("y", 0.75), 0, 1))
    jbt 1
    iso 0.5
    attribute rough 1 default 0 blend
    rough stripes { a 0 b 1 along (0 1 0) width 0.75 } { point { radius 1 } }
    """
    return pattern("stripes", [along, width])


def gradient(from_: Vector, to: Vector) -> Pattern:
    r"""A ramp: ``t = clamp((p - from) . (to - from) / |to - from|^2, 0, 1)``. Equal places give 0
    everywhere.

    Args:
        from_: where t begins to rise; 3 numbers, required.
        to: where t has become 1; 3 numbers, required.

    >>> import jbt
    >>> print(jbt.point(radius=1).textured("rough", jbt.gradient((0.1, 0.2, 0.3), (0.1, 0.2, 0.4)), 0, 1))
    jbt 1
    iso 0.5
    attribute rough 1 default 0 blend
    rough gradient { a 0 b 1 from (0.1 0.2 0.3) to (0.1 0.2 0.4) } { point { radius 1 } }
    """
    return pattern("gradient", [from_, to])


def noise(size: Real = 1, octaves: Real = 1, seed: Real = 0) -> Pattern:
    r"""Value noise, in octaves (after Perlin 1985): every corner of a lattice of cubes has a random
    number, by Jenkins' one-at-a-time hash (1997) of its whole coordinates, as 32-bit words ``(x +
    seed + 0x9e3779b9 k, y, z)`` in octave k (from 0), of which the upper 23 bits over 2^23 are the
    number; in a cube they are mixed by ``3 t^2 - 2 t^3`` along each axis. Octave k has cubes of
    ``size / 2^k`` and half the weight of the one before; the weights add up to 1.

    Args:
        size: the side of a cube of the first octave; a number > 0, default 1.
        octaves: how many, at most 8; less than one is one. A fraction gives the last one a part of
            its weight; a number > 0, default 1.
        seed: the nearest whole number, up to 2^21 in magnitude, tells one noise from another; any
            number, default 0.

    >>> import jbt
    >>> print(jbt.point(radius=1).textured("rough", jbt.noise(0.25, 0.75, 1.25), 0, 1))
    jbt 1
    iso 0.5
    attribute rough 1 default 0 blend
    rough noise { a 0 b 1 size 0.25 octaves 0.75 seed 1.25 } { point { radius 1 } }
    """
    return pattern("noise", [size, octaves, seed])


def rings(along: Axis | Vector = (0, 0, 1), width: Real = 1, turbulence: Real = 0.5, size: Real = 1, seed: Real = 0) -> Pattern:
    r"""Shells around an axis through the origin, as of a tree: a wave of v = (distance from the
    axis / width + turbulence * noise). The wave is ``3 w^2 - 2 w^3`` of ``w = 1 - |2 fract(v) -
    1|``: 0 at whole v, 1 halfway between.

    Args:
        along: the direction of the axis; 3 numbers, not all 0, or "x", "y", "z", default (0, 0, 1).
        width: the distance from one ring to the next; a number > 0, default 1.
        turbulence: how many widths the noise, of three octaves, moves them; any number, default
            0.5.
        size: the size of the noise's first octave; a number > 0, default 1.
        seed: tells one noise from another; any number, default 0.

    >>> import jbt
    >>> print(jbt.point(radius=1).textured("rough", jbt.rings("y", 0.75, 1.25, 1.75, 2.25), 0, 1))
    jbt 1
    iso 0.5
    attribute rough 1 default 0 blend
    rough rings { a 0 b 1 along (0 1 0) width 0.75 turbulence 1.25 size 1.75 seed 2.25 } { point { radius 1 } }
    """
    return pattern("rings", [along, width, turbulence, size, seed])


def marble(along: Axis | Vector = (1, 0, 0), width: Real = 1, turbulence: Real = 1.5, size: Real = 1, seed: Real = 0) -> Pattern:
    r"""Veins across a direction (Perlin 1985): the same wave of (p . along / width + turbulence *
    noise).

    Args:
        along: the direction across the veins; 3 numbers, not all 0, or "x", "y", "z", default (1,
            0, 0).
        width: the length of a wave; a number > 0, default 1.
        turbulence: how many widths the noise, of three octaves, moves them; any number, default
            1.5.
        size: the size of the noise's first octave; a number > 0, default 1.
        seed: tells one noise from another; any number, default 0.

    >>> import jbt
    >>> print(jbt.point(radius=1).textured("rough", jbt.marble("y", 0.75, 1.25, 1.75, 2.25), 0, 1))
    jbt 1
    iso 0.5
    attribute rough 1 default 0 blend
    rough marble { a 0 b 1 along (0 1 0) width 0.75 turbulence 1.25 size 1.75 seed 2.25 } { point { radius 1 } }
    """
    return pattern("marble", [along, width, turbulence, size, seed])


@overload
def sqrt(x: Term) -> Term: ...
@overload
def sqrt(x: Real) -> Number: ...
def sqrt(x: Formula) -> Any:
    r"""``sqrt(x)``: the square root.

    Where it has no value, or a kink: of what is negative: 0; its derivative at 0 is 0.

    >>> import jbt
    >>> float(jbt.sqrt(0.25))
    0.5
    """
    return function("sqrt", x)


@overload
def sin(x: Term) -> Term: ...
@overload
def sin(x: Real) -> Number: ...
def sin(x: Formula) -> Any:
    r"""``sin(x)``: of radians.

    Where it has no value, or a kink: |
    [![sin](pictures/members/expressions/sin.png)](members/expressions/sin.jbt)
    [![cos](pictures/members/expressions/cos.png)](members/expressions/cos.jbt) |.

    >>> import jbt
    >>> float(jbt.sin(0.25))
    0.24740395925452294
    """
    return function("sin", x)


@overload
def cos(x: Term) -> Term: ...
@overload
def cos(x: Real) -> Number: ...
def cos(x: Formula) -> Any:
    r"""``cos(x)``: of radians.

    Where it has no value, or a kink: |
    [![sin](pictures/members/expressions/sin.png)](members/expressions/sin.jbt)
    [![cos](pictures/members/expressions/cos.png)](members/expressions/cos.jbt) |.

    >>> import jbt
    >>> float(jbt.cos(0.25))
    0.9689124217106447
    """
    return function("cos", x)


@overload
def tan(x: Term) -> Term: ...
@overload
def tan(x: Real) -> Number: ...
def tan(x: Formula) -> Any:
    r"""``tan(x)``: of radians.

    Where it has no value, or a kink: large at its poles.

    >>> import jbt
    >>> float(jbt.tan(0.25))
    0.25534192122103627
    """
    return function("tan", x)


@overload
def asin(x: Term) -> Term: ...
@overload
def asin(x: Real) -> Number: ...
def asin(x: Formula) -> Any:
    r"""``asin(x)``: radians.

    Where it has no value, or a kink: beyond -1 and 1: as at the nearer end.

    >>> import jbt
    >>> float(jbt.asin(0.25))
    0.25268025514207865
    """
    return function("asin", x)


@overload
def acos(x: Term) -> Term: ...
@overload
def acos(x: Real) -> Number: ...
def acos(x: Formula) -> Any:
    r"""``acos(x)``: radians.

    Where it has no value, or a kink: beyond -1 and 1: as at the nearer end.

    >>> import jbt
    >>> float(jbt.acos(0.25))
    1.318116071652818
    """
    return function("acos", x)


@overload
def atan(x: Term) -> Term: ...
@overload
def atan(x: Real) -> Number: ...
def atan(x: Formula) -> Any:
    r"""``atan(x)``: radians.

    Where it has no value, or a kink: |
    [![atan](pictures/members/expressions/atan.png)](members/expressions/atan.jbt) |.

    >>> import jbt
    >>> float(jbt.atan(0.25))
    0.24497866312686414
    """
    return function("atan", x)


@overload
def atan2(y: Term, x: Formula) -> Term: ...
@overload
def atan2(y: Real, x: Term) -> Term: ...
@overload
def atan2(y: Real, x: Real) -> Number: ...
def atan2(y: Formula, x: Formula) -> Any:
    r"""``atan2(y, x)``: the angle of the point (x, y), in [-pi, pi].

    Where it has no value, or a kink: at the origin 0, its derivative too; it jumps on the negative
    x axis.

    >>> import jbt
    >>> float(jbt.atan2(0.25, 0.5))
    0.4636476090008061
    """
    return function("atan2", y, x)


@overload
def abs(x: Term) -> Term: ...
@overload
def abs(x: Real) -> Number: ...
def abs(x: Formula) -> Any:
    r"""``abs(x)``: the magnitude.

    Where it has no value, or a kink: a kink at 0.

    >>> import jbt
    >>> float(jbt.abs(0.25))
    0.25
    """
    return function("abs", x)


@overload
def sign(x: Term) -> Term: ...
@overload
def sign(x: Real) -> Number: ...
def sign(x: Formula) -> Any:
    r"""``sign(x)``: -1, 0 or 1.

    Where it has no value, or a kink: jumps at 0.

    >>> import jbt
    >>> float(jbt.sign(0.25))
    1.0
    """
    return function("sign", x)


@overload
def floor(x: Term) -> Term: ...
@overload
def floor(x: Real) -> Number: ...
def floor(x: Formula) -> Any:
    r"""``floor(x)``: down, up to a whole number.

    Where it has no value, or a kink: jumps; numbers beyond 2^22 count as whole.

    >>> import jbt
    >>> float(jbt.floor(0.25))
    0.0
    """
    return function("floor", x)


@overload
def ceil(x: Term) -> Term: ...
@overload
def ceil(x: Real) -> Number: ...
def ceil(x: Formula) -> Any:
    r"""``ceil(x)``: down, up to a whole number.

    Where it has no value, or a kink: jumps; numbers beyond 2^22 count as whole.

    >>> import jbt
    >>> float(jbt.ceil(0.25))
    1.0
    """
    return function("ceil", x)


@overload
def round(x: Term) -> Term: ...
@overload
def round(x: Real) -> Number: ...
def round(x: Formula) -> Any:
    r"""``round(x)``: to the nearest whole number, ties to the even one.

    Where it has no value, or a kink: jumps; likewise.

    >>> import jbt
    >>> float(jbt.round(0.25))
    0.0
    """
    return function("round", x)


@overload
def mod(x: Term, y: Formula) -> Term: ...
@overload
def mod(x: Real, y: Term) -> Term: ...
@overload
def mod(x: Real, y: Real) -> Number: ...
def mod(x: Formula, y: Formula) -> Any:
    r"""``mod(x, y)``: what is left after whole multiples of y: at least 0 and below the magnitude
    of y.

    Where it has no value, or a kink: by 0: 0.

    >>> import jbt
    >>> float(jbt.mod(0.25, 0.5))
    0.25
    """
    return function("mod", x, y)


@overload
def exp(x: Term) -> Term: ...
@overload
def exp(x: Real) -> Number: ...
def exp(x: Formula) -> Any:
    r"""``exp(x)``: | overflow ends at the largest field, see below.

    Where it has no value, or a kink:
    [![exp](pictures/members/expressions/exp.png)](members/expressions/exp.jbt) |.

    >>> import jbt
    >>> float(jbt.exp(0.25))
    1.2840254166877414
    """
    return function("exp", x)


@overload
def ln(x: Term) -> Term: ...
@overload
def ln(x: Real) -> Number: ...
def ln(x: Formula) -> Any:
    r"""``ln(x)``: | below 2^-126: as at 2^-126.

    Where it has no value, or a kink:
    [![ln](pictures/members/expressions/ln.png)](members/expressions/ln.jbt) |.

    >>> import jbt
    >>> float(jbt.ln(0.25))
    -1.3862943611198906
    """
    return function("ln", x)


@overload
def square(x: Term) -> Term: ...
@overload
def square(x: Real) -> Number: ...
def square(x: Formula) -> Any:
    r"""``square(x)``: x times x.

    Where it has no value, or a kink: |
    [![square](pictures/members/expressions/square.png)](members/expressions/square.jbt) |.

    >>> import jbt
    >>> float(jbt.square(0.25))
    0.0625
    """
    return function("square", x)


@overload
def min(*values: Real) -> Number: ...  # type: ignore[overload-overlap]
@overload
def min(*values: Formula) -> Term: ...
def min(*values: Formula) -> Any:
    r"""``min(x, ..)``: the smallest, the largest of any number.

    Where it has no value, or a kink: kinks at ties.

    >>> import jbt
    >>> float(jbt.min(0.25))
    0.25
    """
    return function("min", *values)


@overload
def max(*values: Real) -> Number: ...  # type: ignore[overload-overlap]
@overload
def max(*values: Formula) -> Term: ...
def max(*values: Formula) -> Any:
    r"""``max(x, ..)``: the smallest, the largest of any number.

    Where it has no value, or a kink: kinks at ties.

    >>> import jbt
    >>> float(jbt.max(0.25))
    0.25
    """
    return function("max", *values)


@overload
def clamp(x: Term, low: Formula, high: Formula) -> Term: ...
@overload
def clamp(x: Real, low: Term, high: Formula) -> Term: ...
@overload
def clamp(x: Real, low: Real, high: Term) -> Term: ...
@overload
def clamp(x: Real, low: Real, high: Real) -> Number: ...
def clamp(x: Formula, low: Formula, high: Formula) -> Any:
    r"""``clamp(x, low, high)``: x, but not below ``low`` and not above ``high``.

    Where it has no value, or a kink: kinks at the limits.

    >>> import jbt
    >>> float(jbt.clamp(0.25, 0.5, 0.75))
    0.5
    """
    return function("clamp", x, low, high)


@overload
def mix(a: Term, b: Formula, t: Formula) -> Term: ...
@overload
def mix(a: Real, b: Term, t: Formula) -> Term: ...
@overload
def mix(a: Real, b: Real, t: Term) -> Term: ...
@overload
def mix(a: Real, b: Real, t: Real) -> Number: ...
def mix(a: Formula, b: Formula, t: Formula) -> Any:
    r"""``mix(a, b, t)``: from a to b as t goes from 0 to 1.

    Where it has no value, or a kink: |
    [![mix](pictures/members/expressions/mix.png)](members/expressions/mix.jbt) |.

    >>> import jbt
    >>> float(jbt.mix(0.25, 0.5, 0.75))
    0.4375
    """
    return function("mix", a, b, t)


@overload
def step(edge: Term, x: Formula) -> Term: ...
@overload
def step(edge: Real, x: Term) -> Term: ...
@overload
def step(edge: Real, x: Real) -> Number: ...
def step(edge: Formula, x: Formula) -> Any:
    r"""``step(edge, x)``: 0 where x is below the edge, else 1.

    Where it has no value, or a kink: a jump.

    >>> import jbt
    >>> float(jbt.step(0.25, 0.5))
    1.0
    """
    return function("step", edge, x)


@overload
def length(*values: Real) -> Number: ...  # type: ignore[overload-overlap]
@overload
def length(*values: Formula) -> Term: ...
def length(*values: Formula) -> Any:
    r"""``length(x, ..)``: the root of the sum of squares, of any number.

    Where it has no value, or a kink: its derivative at 0 is 0.

    >>> import jbt
    >>> float(jbt.length(0.25))
    0.25
    """
    return function("length", *values)


@overload
def pow(x: Term, y: Formula) -> Term: ...
@overload
def pow(x: Real, y: Term) -> Term: ...
@overload
def pow(x: Real, y: Real) -> Number: ...
def pow(x: Formula, y: Formula) -> Any:
    r"""``pow(x, y)``: powers. A whole exponent without parameters and coordinates, as ``2`` or
    ``sqrt(9)``, from -1024 to 1024, but for 0, is a chain of products and takes any sign.

    Where it has no value, or a kink: else what is negative counts as 0; 0 to a negative power: 0.

    >>> import jbt
    >>> float(jbt.pow(0.25, 0.5))
    0.5
    """
    return function("pow", x, y)


class ModelMembers:
    """Maps, warps and operators of one model, as methods of it."""

    __slots__ = ()

    def complement(self) -> Model:
        r"""``2c - f``: inside and outside exchanged. It is 2c where f is 0, so it has no end; a
        model whose root it is has to be given a region. Intersected with something bounded it is
        bounded.

        >>> import jbt
        >>> print(jbt.point(radius=1).complement())
        jbt 1
        iso 0.5
        complement {
            point { radius 1 }
        }
        """
        return apply(self, "operator", "complement", [])

    def clamp(self, low: Real, high: Real) -> Model:
        r"""The field, but at least ``low`` and at most ``high``, ``low`` being at most ``high``.
        With 0 between the two the support stays, else the field is not 0 anywhere. A clamp to an
        interval without c leaves no surface. The gradient jumps at the limits.

        Args:
            low: any number, required.
            high: any number, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).clamp(0.25, 0.75))
        jbt 1
        iso 0.5
        clamp low 0.25 high 0.75 {
            point { radius 1 }
        }
        """
        return apply(self, "operator", "clamp", [low, high])

    def shell(self, thickness: Real) -> Model:
        r"""A sheet around the surface: ``max(0, c - |f - c|) c / (c - t/2)``. Inside is where f
        differs from c by less than t/2: the ``thickness`` t is in units of the field, in length
        about t over the gradient, > 0 and below 2c. It is 0 where the child is, and deep inside,
        from 2c on; on the child's surface its gradient jumps.

        Args:
            thickness: a number > 0, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).shell(0.25))
        jbt 1
        iso 0.5
        shell 0.25 {
            point { radius 1 }
        }
        """
        return apply(self, "operator", "shell", [thickness])

    def offset(self, by: Real) -> Model:
        r"""``f c / (c - t)``: the surface of level c - t becomes that of c, so a positive ``by`` t
        fattens and a negative one thins; it is below c. It is a factor and no shift, so what is 0
        stays 0: the surface moves by about t over the gradient, and never out of the support.

        Args:
            by: any number, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).offset(0.25))
        jbt 1
        iso 0.5
        offset 0.25 {
            point { radius 1 }
        }
        """
        return apply(self, "operator", "offset", [by])

    def translate(self, by: Vector) -> Model:
        r"""Moves by a vector.

        Args:
            by: 3 numbers, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).translate((0.1, 0.2, 0.3)))
        jbt 1
        iso 0.5
        translate (0.1 0.2 0.3) { point { radius 1 } }
        """
        return apply(self, "map", "translate", [by])

    def rotate(self, axis: Axis | Vector, degrees: Real) -> Model:
        r"""Turns about an axis through the origin, right-handed: ``axis`` is ``x``, ``y``, ``z`` or
        a vector of any length but 0, and the angle is in ``degrees`` or ``radians``; both are
        required. Quarter turns in degrees are exact.

        Args:
            axis: 3 numbers, not all 0, or "x", "y", "z", required.
            degrees: any number, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).rotate("y", 0.75))
        jbt 1
        iso 0.5
        rotate axis (0 1 0) degrees 0.75 { point { radius 1 } }
        """
        return apply(self, "map", "rotate", [axis, degrees])

    def rotate_radians(self, axis: Axis | Vector, radians: Real) -> Model:
        r"""Turns about an axis through the origin, right-handed: ``axis`` is ``x``, ``y``, ``z`` or
        a vector of any length but 0, and the angle is in ``degrees`` or ``radians``; both are
        required. Quarter turns in degrees are exact.

        Args:
            axis: 3 numbers, not all 0, or "x", "y", "z", required.
            radians: any number, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).rotate_radians("y", 0.75))
        jbt 1
        iso 0.5
        rotate axis (0 1 0) radians 0.75 { point { radius 1 } }
        """
        return apply(self, "map", "rotate_radians", [axis, radians])

    def scale(self, by: Real) -> Model:
        r"""By one factor, or by one along each axis. A negative one mirrors; 0 is an error.

        Args:
            by: any number, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).scale(0.25))
        jbt 1
        iso 0.5
        scale 0.25 { point { radius 1 } }
        """
        return apply(self, "map", "scale", [by])

    def scale_axes(self, by: Vector) -> Model:
        r"""By one factor, or by one along each axis. A negative one mirrors; 0 is an error.

        Args:
            by: 3 numbers, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).scale_axes((0.1, 0.2, 0.3)))
        jbt 1
        iso 0.5
        scale (0.1 0.2 0.3) { point { radius 1 } }
        """
        return apply(self, "map", "scale_axes", [by])

    def reflect(self, axis: Axis | Vector) -> Model:
        r"""A mirror image in the plane through the origin across the ``axis``. (The warp ``mirror``
        makes two halves equal.)

        Args:
            axis: 3 numbers, not all 0, or "x", "y", "z", required.

        >>> import jbt
        >>> print(jbt.point(radius=1).reflect("y"))
        jbt 1
        iso 0.5
        reflect axis (0 1 0) { point { radius 1 } }
        """
        return apply(self, "map", "reflect", [axis])

    def stretch(self, axis: Axis | Vector, by: Real) -> Model:
        r"""A scale along the direction ``axis`` alone, by the factor ``by``.

        Args:
            axis: 3 numbers, not all 0, or "x", "y", "z", required.
            by: any number, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).stretch("y", 0.75))
        jbt 1
        iso 0.5
        stretch axis (0 1 0) by 0.75 { point { radius 1 } }
        """
        return apply(self, "map", "stretch", [axis, by])

    def shear(self, axis: Axis | Vector, by: Vector) -> Model:
        r"""What is at height h along the ``axis`` moves by h times the vector ``by``.

        Args:
            axis: 3 numbers, not all 0, or "x", "y", "z", required.
            by: 3 numbers, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).shear("y", (0.1, 0.2, 0.4)))
        jbt 1
        iso 0.5
        shear axis (0 1 0) by (0.1 0.2 0.4) { point { radius 1 } }
        """
        return apply(self, "map", "shear", [axis, by])

    def affine(self, rows: Matrix) -> Model:
        r"""Any 3x4 matrix, child to parent, by rows: 12 numbers.

        Args:
            rows: 3 rows of 4 numbers, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).affine([(1, 0, 0, 2), (0, 1, 0, 0), (0, 0, 1, 0)]))
        jbt 1
        iso 0.5
        affine (1 0 0 2 0 1 0 0 0 0 1 0) { point { radius 1 } }
        """
        return apply(self, "map", "affine", [rows])

    def twist(self, axis: Axis | Vector = "z", *, rate: Real) -> Model:
        r"""Slices across the axis turn in proportion to their height h, by ``rate * h`` (Barr
        1984). Volumes stay.

        Args:
            axis: the axis; "x", "y" or "z", default "z".
            rate: radians for each unit of length; any number, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).twist("x", rate=0.75))
        jbt 1
        iso 0.5
        twist axis x rate 0.75 { point { radius 1 } }
        """
        return apply(self, "warp", "twist", [axis, rate])

    def taper(self, axis: Axis | Vector = "z", *, from_: Real, to: Real, start: Real = 1, end: Real) -> Model:
        r"""Slices across the axis are scaled by a factor that goes linearly from one height to
        another, and stays what it is beyond (Barr 1984). A factor of 0 makes a tip; factors below
        2^-16 count as that, so that everything is finite: beyond a tip there is a needle of that
        width. The gradient has creases at the two heights, which have to differ.

        Args:
            axis: the axis; "x", "y" or "z", default "z".
            from_: the height at which the scale begins to change; any number, required.
            to: the height at which it ends, above or below; any number, required.
            start: the scale at the first height; a number >= 0, default 1.
            end: the scale at the second; a number >= 0, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).taper("x", from_=0.75, to=1.25, start=1.75, end=2.25))
        jbt 1
        iso 0.5
        taper axis x from 0.75 to 1.25 start 1.75 end 2.25 { point { radius 1 } }
        """
        return apply(self, "warp", "taper", [axis, from_, to, start, end])

    def bend(self, axis: Axis | Vector = "z", *, rate: Real, from_: Real, to: Real, center: Real = 0) -> Model:
        r"""A straight spine becomes an arc (Barr 1984). It runs through the origin along the axis
        behind ``axis`` (y for x, z for y, x for z) and bends towards the one behind that, if the
        rate is positive. Between ``from`` and ``to`` a length s of it turns by ``rate * s``;
        beyond, everything goes on straight. Digits stay as the rate goes to 0, and 0 changes
        nothing.

        With s along the spine from ``center``, h towards the centre of curvature, k the rate and g
        its sign, the child is asked at (s', h'):

        What the child has behind the centre of curvature, farther than 1/rate, is not seen inside
        the bend. A bend ends at half a turn to one side. At the centre of curvature all of the
        spine meets: within 2^-16 of the radius of it the map fades, so that everything is finite.

        Args:
            axis: the axis about which it turns; "x", "y" or "z", default "z".
            rate: radians for each unit of length, up to 1e6 in magnitude; any number, required.
            from_: one end of what is bent; any number, required.
            to: the other end, another place; any number, required.
            center: the place on the spine that stays; any number, default 0.

        >>> import jbt
        >>> print(jbt.point(radius=1).bend("x", rate=0.75, from_=1.25, to=1.75, center=2.25))
        jbt 1
        iso 0.5
        bend axis x rate 0.75 from 1.25 to 1.75 center 2.25 { point { radius 1 } }
        """
        return apply(self, "warp", "bend", [axis, rate, from_, to, center])

    def mirror(self, axis: Axis | Vector = "z") -> Model:
        r"""What the child has on the positive side of the plane through the origin across the axis
        stands on both sides: the inverse map takes the magnitude of the coordinate. Where the child
        meets the plane at an angle there is a crease.

        Args:
            axis: the axis across the plane; "x", "y" or "z", default "z".

        >>> import jbt
        >>> print(jbt.point(radius=1).mirror("x"))
        jbt 1
        iso 0.5
        mirror axis x { point { radius 1 } }
        """
        return apply(self, "warp", "mirror", [axis])

    def repeat(self, axis: Axis | Vector = "z", *, spacing: Real, count: Real = 0) -> Model:
        r"""Copies of the child at equal steps along the axis, of which the child is the first. A
        point belongs to the copy that is nearest along the axis, so copies cost nothing; what
        reaches out of its cell ends at a wall halfway between, so the child should be centred at
        the origin and no longer than the spacing. The first cell has no lower wall, the last no
        upper one. Without a count, or with 0, copies go on without end (2^21 to both sides), and a
        mesh needs a region. A lattice is a repetition of a repetition.

        Args:
            axis: the axis; "x", "y" or "z", default "z".
            spacing: the distance from a copy to the next; a number > 0, required.
            count: how many there are, 0 for no end; a whole number >= 0, default 0.

        >>> import jbt
        >>> print(jbt.point(radius=1).repeat("x", spacing=0.75, count=3))
        jbt 1
        iso 0.5
        repeat axis x spacing 0.75 count 3 { point { radius 1 } }
        """
        return apply(self, "warp", "repeat", [axis, spacing, count])

    def repeat_around(self, axis: Axis | Vector = "z", *, count: Real) -> Model:
        r"""Copies of the child at equal angles about the axis, like spokes. The child stands about
        the first direction across (x for z, y for x, z for y) and is the first copy. A point
        belongs to the copy whose direction is nearest; what reaches out of its sector ends at the
        wall. Copies that meet at the axis meet without a jump.

        Args:
            axis: the axis; "x", "y" or "z", default "z".
            count: how many there are, at least 1; a whole number >= 0, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).repeat_around("x", count=3))
        jbt 1
        iso 0.5
        repeat_around axis x count 3 { point { radius 1 } }
        """
        return apply(self, "warp", "repeat_around", [axis, count])

    def space_map(self, from_: Vector, to: Vector, radius: Real) -> Model:
        r"""Pulls what is at one point to another, within a ball (HyperFun's ``hfSpaceMapCubic``):
        the inverse is ``p - f(t) (to - from)`` with ``t = |p - to| / radius`` and ``f(t) = (1 -
        t)^3 / (1 + t)``, 0 for t >= 1. At ``to`` the map has a cone's tip, where the gradient
        jumps. With a radius below four times the distance of the two points space folds, and some
        of the child is seen more than once.

        Args:
            from_: whatever is here ...; 3 numbers, required.
            to: ... appears here; 3 numbers, required.
            radius: how far around ``to`` anything moves; a number > 0, required.

        >>> import jbt
        >>> print(jbt.point(radius=1).space_map((0.1, 0.2, 0.3), (0.1, 0.2, 0.4), 1.25))
        jbt 1
        iso 0.5
        space_map from (0.1 0.2 0.3) to (0.1 0.2 0.4) radius 1.25 { point { radius 1 } }
        """
        return apply(self, "warp", "space_map", [from_, to, radius])

    def deform(self, by: Vector = (0, 0, 0), axis: Axis | Vector = (0, 0, 1), degrees: Real = 0, size: Vector = (1, 1, 1), center: Vector = (0, 0, 0)) -> Model:
        r"""Scaled about a centre, turned about an axis through it, and moved. By itself it is an
        affine map that costs more than one; it is there to be weighted, so that the field of
        another subtree says where it happens and how much.

        Args:
            by: how far the centre moves; 3 numbers, default (0, 0, 0).
            axis: the axis of the turn; 3 numbers, not all 0, or "x", "y", "z", default (0, 0, 1).
            degrees: the turn, right-handed; any number, default 0.
            size: the factors along the axes, before the turn; from 1e-6 to 1e6 in magnitude; 3
                numbers, default (1, 1, 1).
            center: the point about which it is scaled and turned; 3 numbers, default (0, 0, 0).

        >>> import jbt
        >>> print(jbt.point(radius=1).deform((0.1, 0.2, 0.3), "y", 1.25, (0.1, 0.2, 0.6), (0.1, 0.2, 0.7)))
        jbt 1
        iso 0.5
        deform by (0.1 0.2 0.3) axis (0 1 0) degrees 1.25 size (0.1 0.2 0.6) center (0.1 0.2 0.7) { point { radius 1 } }
        """
        return apply(self, "warp", "deform", [by, axis, degrees, size, center])
