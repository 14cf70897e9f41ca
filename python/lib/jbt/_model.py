"""Models."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import fspath
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from . import _contours, _grid, _hits, _jbt, _mesh
from ._arrays import columns, matrix, region
from ._calls import as_falloff, flat
from ._contours import Contours
from ._errors import OpenMeshWarning, SceneWarning
from ._evaluator import Evaluator
from ._grid import Grid
from ._hits import Hits, Owners, Weights
from ._members import ModelMembers
from ._mesh import Mesh
from ._progress import watcher
from ._types import Doubles, Engine, FalloffLike, Formula, Models, Path, Progress, Real, Reals, Region, Vector


@dataclass(frozen=True)
class Group:
    """A group of attributes: numbers that ride on the field.

    Attributes:
        name: its name.
        default: the value of leaves without the attribute; as long as the group is wide.
        mixing: "blend", the mean by weights, or "dominant", that of the leaf with the largest weight.
        direction: whether values are directions, which turn with maps and warps.
    """

    name: str
    default: tuple[float, ...]
    mixing: str
    direction: bool = False


@dataclass(frozen=True)
class Measures:
    """How large a solid is.

    Attributes:
        volume: about.
        least: the volume is at least this.
        most: the volume is at most this.
        area: of the surface, about; cuts by the region do not count.
        center: the centre of mass, about; None for an empty solid.
        cell: the edge of the smallest boxes.
    """

    volume: float
    least: float
    most: float
    area: float
    center: tuple[float, float, float] | None
    cell: float


@dataclass(frozen=True)
class PointCounts:
    """Distances to skeletons that one point takes.

    Attributes:
        separate: by one walk of the tree for each answer.
        cached: by such walks that remember what they have met at the point.
        fused: by the compiled program.
    """

    separate: int
    cached: int
    fused: int


@dataclass(frozen=True)
class ModelCounts:
    """What a model takes.

    Attributes:
        field, gradient, attributes, all: for the field alone, with its gradient, with attributes, with both.
        uses: paths from the root to a leaf.
        instances: leaves at a position, once each.
    """

    field: PointCounts
    gradient: PointCounts
    attributes: PointCounts
    all: PointCounts
    uses: int
    instances: int


class Model(ModelMembers):
    """A BlobTree and what its field means. Models never change: methods make others, and share what is alike.

    ======== ================================ ==============================================================
    written  what it is                       more than two
    ======== ================================ ==============================================================
    `a + b`  the sum: they blend              `jbt.sum(a, b, c)`, `sum(models)`
    `a | b`  the union                        `jbt.union(models)`
    `a & b`  the intersection                 `jbt.intersection(models)`
    `a - b`  a without b                      `jbt.difference(a, b, c)`
    `a ^ b`  what is in one of them           `jbt.symmetric_difference(models)`
    `~a`     inside and outside exchanged
    ======== ================================ ==============================================================

    `str(model)` is the model in the text format, which `jbt.loads` reads. What was compiled of a model is
    kept, and serves other models of the same shape.

    >>> import jbt
    >>> peanut = jbt.point((0, 0.4, 0), radius=1) + jbt.point((0, -0.4, 0), radius=1)
    >>> print(peanut.twist("y", rate=0.5))
    jbt 1
    iso 0.5
    twist axis y rate 0.5 {
        sum {
            point { at (0 0.4 0) radius 1 }
            point { at (0 -0.4 0) radius 1 }
        }
    }
    >>> peanut.mesh(resolution=32).closed
    True
    """

    __slots__ = ("_native",)

    def __init__(self, native: _jbt.Model) -> None:
        if not isinstance(native, _jbt.Model):
            raise TypeError("models are made by jbt.load, jbt.loads, jbt.point and so on")
        self._native = native

    # Operators.

    def _with(self, name: str, other: object) -> Model:
        if not isinstance(other, Model):
            return cast(Model, NotImplemented)
        return Model(_jbt.Model.combine(name, [], [self._native, other._native]))

    def __add__(self, other: Model) -> Model:
        return self._with("sum", other)

    def __radd__(self, other: int) -> Model:
        """`sum(models)` begins with 0."""
        return self if other == 0 else NotImplemented

    def __or__(self, other: Model) -> Model:
        return self._with("union", other)

    def __and__(self, other: Model) -> Model:
        return self._with("intersection", other)

    def __sub__(self, other: Model) -> Model:
        return self._with("difference", other)

    def __xor__(self, other: Model) -> Model:
        return self._with("symmetric_difference", other)

    def __invert__(self) -> Model:
        return self.complement()

    def __eq__(self, other: object) -> bool:
        """The same nodes with the same numbers and settings."""
        return isinstance(other, Model) and self._native == other._native

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        return self._native.text()

    def __repr__(self) -> str:
        try:
            nodes, leaves = self._native.size()
        except ValueError:
            return "<jbt.Model with errors>"
        return f"<jbt.Model of {nodes} {'node' if nodes == 1 else 'nodes'}, {leaves} leaves>"

    def __copy__(self) -> Model:
        return self

    def __deepcopy__(self, memory: dict[int, Any]) -> Model:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_text, (self._native.text(),)

    # What primitives and leaves have.

    def color(self, rgb: Reals) -> Model:
        """Linear red, green and blue for every leaf below that has no nearer colour."""
        return self.attribute("color", rgb)

    def attribute(self, name: str, values: Reals) -> Model:
        """An attribute for every leaf below that has no nearer one of this name. A group that the model does
        not have yet is declared, with zeros as its default and blended: see `group`.

        >>> import jbt
        >>> ball = jbt.point(radius=1).attribute("rough", 0.9)
        >>> ball.groups[1]
        Group(name='rough', default=(0.0,), mixing='blend', direction=False)
        """
        return Model(self._native.attribute(name, values))

    def constant(self, name: str, value: str | int) -> Model:
        """A constant for every leaf below that has no nearer one of this name: text or a whole number, as a
        material or the number of a part. It costs nothing: `owner` answers it.

        >>> import jbt
        >>> pin = jbt.point(radius=1).constant("material", "brass").constant("part", 17)
        >>> pin.owner([[0, 0, 0.1]]).constants
        [{'material': 'brass', 'part': 17}]
        """
        return Model(self._native.constant(name, value))

    def overriding(self) -> Model:
        """The same, but the attribute, constant or style that it begins with counts for all leaves below,
        whatever stands nearer to them. Of several that override, the one that was put around the others
        counts.

        >>> import jbt
        >>> pin = jbt.point(radius=1).constant("part", 17)
        >>> pin.constant("part", 1).overriding().owner([[0, 0, 0.1]]).constants
        [{'part': 1}]
        """
        return Model(self._native.overriding())

    def styled(self, name: str, style: Callable[[Model], Model]) -> Model:
        """With attributes and constants that have a name together: what `style` puts around the model. Texts
        have it once, as `style`.

        >>> import jbt
        >>> oak = lambda model: model.constant("material", "oak").color((0.5, 0.25, 0.125))
        >>> bowl = jbt.point(radius=1).styled("oak", oak)
        >>> 'style oak = { color (0.5 0.25 0.125) constant material "oak" }' in str(bowl)
        True
        """
        return Model(style(self)._native.styled(name, self._native))

    def textured(self, name: str, pattern: _jbt.Pattern, a: Reals, b: Reals) -> Model:
        """An attribute by a pattern: `a` where it is 0, `b` where it is 1, mixed in between. It lies in the
        space of this model: maps of the whole move it, maps below do not."""
        return Model(self._native.textured(name, pattern, a, b))

    def expressed(self, name: str, values: Sequence[Formula]) -> Model:
        """An attribute by formulas of `jbt.x`, `jbt.y` and `jbt.z`: one for each channel of the group."""
        return Model(self._native.expressed(name, list(values)))

    def uv(
        self,
        name: str = "uv",
        *,
        scale: Sequence[Real] = (1.0, 1.0),
        degrees: Real = 0.0,
        shift: Sequence[Real] = (0.0, 0.0),
    ) -> Model:
        """The uv of its skeleton for every leaf below: scaled, then turned about (0, 0), then shifted."""
        return Model(self._native.uv(name, list(scale), degrees, list(shift)))

    def falloff(self, falloff: FalloffLike) -> Model:
        """The same with this falloff in every primitive."""
        return Model(self._native.with_falloff(as_falloff(falloff)))

    def falloff_by(self, formula: Callable[[_jbt.Term], Formula]) -> Model:
        """The same with the falloff of every primitive given by a formula of r, from 0 at the skeleton to 1
        at the support radius, where it has to be 0 exactly.

        >>> import jbt
        >>> ball = jbt.point(radius=2).falloff_by(lambda r: (1 - r) * (1 - r))
        >>> float(ball.compile()([[1.0, 0, 0]]).field[0])
        0.25
        """
        return Model(self._native.falloff_by(formula))

    def strength(self, strength: Real) -> Model:
        """The same with this strength in every primitive; negative ones push surfaces away."""
        return Model(self._native.with_strength(strength))

    # Formulas.

    @property
    def field(self) -> _jbt.Term:
        """Its field as a part of a formula, where `+ - * / **` are arithmetic: see `jbt.expression`."""
        return self._native.field()

    def within(self, low: Vector, high: Vector) -> Model:
        """The same, and 0 outside of the box between two corners."""
        return Model(self._native.within(low, high))

    def fading(self, falloff: FalloffLike, radius: Real) -> Model:
        """Its field, taken as a distance, fades as that of a primitive with this support radius."""
        return Model(self._native.fading(as_falloff(falloff), radius))

    def warp(self, coordinates: Sequence[Formula]) -> Model:
        """Deformed by three formulas of `jbt.x`, `jbt.y` and `jbt.z`, which say where this model is asked. It
        reaches everywhere, as far as anybody knows: `within` a box it ends."""
        return Model(self._native.warp_by(list(coordinates)))

    def weighted(self, weight: Model) -> Model:
        """This model, whose root is a warp, with the warp weighted by the field of another model."""
        return Model(self._native.weighted(flat([weight])[0]))

    # What is said of the whole.

    @property
    def iso(self) -> float:
        """The field value of the surface: inside is where the field is at least this."""
        return self._native.iso.value

    def with_iso(self, iso: Real) -> Model:
        """The same with another iso-value."""
        return Model(self._native.with_iso(iso))

    @property
    def origin(self) -> tuple[float, float, float] | None:
        """Where its local coordinates begin, if that is set; else it is found where the model is far away."""
        found = self._native.origin
        return None if found is None else (found[0], found[1], found[2])

    def with_origin(self, origin: Sequence[float] | None) -> Model:
        """The same with its local coordinates beginning at a point of the world."""
        return Model(self._native.with_origin(None if origin is None else [float(x) for x in origin]))

    @property
    def orientation(self) -> tuple[str, str]:
        """How it stands: the axis that points up, "z" or "y", and the hand of its axes, "right" or "left"."""
        return self._native.orientation

    def with_orientation(self, up: Literal["y", "z"], handed: Literal["right", "left"] = "right") -> Model:
        """The same, standing so. It changes no coordinate: pictures and files show it the right way up."""
        return Model(self._native.with_orientation(up, handed))

    @property
    def groups(self) -> tuple[Group, ...]:
        """Its groups of attributes, `color` first."""
        return tuple(
            Group(name, tuple(default), mixing, direction)
            for name, default, mixing, direction in self._native.groups()
        )

    def group(
        self,
        name: str,
        default: Sequence[float],
        *,
        mixing: Literal["blend", "dominant"] = "blend",
        direction: bool = False,
    ) -> Model:
        """The same with a group of attributes declared so; it is as wide as its default. A direction turns
        with maps and warps.

        >>> import jbt
        >>> jbt.point(radius=1).group("grain", (0, 0, 1), direction=True).groups[1].direction
        True
        """
        return Model(self._native.group(name, [float(number) for number in default], mixing, direction))

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters and their values."""
        return dict(self._native.parameters())

    def with_parameters(self, settings: Mapping[str, float] | None = None, /, **parameters: float) -> Model:
        """The same with other values of parameters. Nothing is compiled for it.

        >>> import jbt
        >>> ball = jbt.point(surface_radius=jbt.param("size", 1.0))
        >>> [round(ball.with_parameters(size=size).volume, 2) for size in (1, 2)]
        [4.19, 33.51]
        """
        given = {**(settings or {}), **parameters}
        return Model(self._native.with_parameters([(name, float(value)) for name, value in given.items()]))

    def check(self) -> Model:
        """This model, if nothing is wrong with it; else `SceneError` says all that is."""
        self._native.check()
        return self

    # Questions.

    def compile(
        self, *, gradient: bool = True, attributes: bool = True, engine: Engine | None = None
    ) -> Evaluator:
        """What answers at points.

        Args:
            gradient: whether the gradient of the field is asked for.
            attributes: whether colours and other attributes are.
            engine: "jit" (machine code), "lanes" (the interpreter) or "scalar" (the reference), which give
                the same bits. As a rule the fastest that this machine has.
        """
        native = self._native.compile(gradient, attributes, engine)
        return Evaluator(native, (self, gradient, attributes, engine))

    def counters(self) -> ModelCounts:
        """Distances to skeletons that a point takes, compared with walks of the tree.

        >>> import jbt
        >>> ball = jbt.point(radius=1)
        >>> (ball + ball.translate((1, 0, 0))).counters().all
        PointCounts(separate=12, cached=8, fused=2)
        """
        rows, uses, instances = self._native.counters()
        counts = {name: PointCounts(separate, cached, fused) for name, separate, cached, fused in rows}
        return ModelCounts(**counts, uses=uses, instances=instances)

    def mesh(
        self,
        resolution: int | None = None,
        *,
        cell: float | None = None,
        region: Region | None = None,
        thin: bool = True,
        sharp: bool = True,
        engine: Engine | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Mesh:
        """The surface as triangles.

        Args:
            resolution: cells along the longest side of the region; 128 if nothing is said.
            cell: the edge of a cell, in units of the model, instead.
            region: a box, as two corners. As a rule the model's support; a model without end needs one.
                Where it cuts the solid, the mesh is open, and `OpenMeshWarning` says so.
            thin: whether to search for parts thinner than a cell: `info` says what was found.
            sharp: whether vertices go to edges and corners of the surface, as of a union or a formula's
                `max`: see `Mesh.creases`. Smooth models have none.
            engine: see `compile`.
            threads: how many work; as a rule as many as there are CPUs. The mesh is the same.
            progress: who is told how far it is: a callable that takes a number from 0 to 1, or True for a bar
                of tqdm. An exception of it stops the work, as Ctrl-C does.
        """
        with watcher(progress, "mesh") as told:
            box = _region(region)
            native = self._native.mesh(resolution, cell, box, thin, sharp, engine, threads, told)
            made = _mesh.of_native(native)
        if not made.closed:
            sides = f"at its sides {made.cut_sides}" if made.cut_sides != "none" else "somewhere"
            text = f"the region cuts the surface {sides}: the mesh is open there"
            warnings.warn(text, OpenMeshWarning, stacklevel=2)
        return made

    def sample(
        self,
        resolution: int | None = None,
        *,
        cell: float | None = None,
        region: Region | None = None,
        gradient: bool = False,
        attributes: bool = False,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Grid:
        """The answers at all points of a lattice; most of what does not matter there is not evaluated.

        Args:
            resolution, cell, region, threads, progress: see `mesh`.
            gradient: whether the gradient is among the answers.
            attributes: whether attributes are.
        """
        with watcher(progress, "sample") as told:
            box = _region(region)
            made = self._native.sample(gradient, attributes, resolution, cell, box, threads, told)
        return _grid.of_native(made)

    def contours(
        self,
        plane: Any = "z=0",
        resolution: int | None = None,
        *,
        cell: float | None = None,
        region: Region | None = None,
        svg: Path | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Contours:
        """The contour in a plane, as closed loops.

        Args:
            plane: as "z=0.3" or ("z", 0.3), or three vectors: a point, u, and v.
            resolution, cell, threads, progress: see `mesh`.
            region: a rectangle in coordinates of the plane, as two corners.
            svg: a path, to which the contour is written too.

        >>> import jbt
        >>> slice = jbt.ring(ring_radius=1, radius=0.5).contours()
        >>> [loop.is_hole for loop in slice.loops]
        [False, True]
        """
        rectangle = None if region is None else matrix("region", region, 2).tolist()
        path = None if svg is None else fspath(svg)
        with watcher(progress, "contours") as told:
            text = _contours.plane_text(plane)
            made = self._native.contour(text, rectangle, resolution, cell, path, threads, told)
        return _contours.of_native(made)

    def trace(
        self,
        origins: Any,
        directions: Any,
        *,
        tolerance: float | None = None,
        span: tuple[float, float] | None = None,
        threads: int | None = None,
    ) -> Hits:
        """The first hit of each ray `origin + t * direction`. A ray that begins inside hits where it leaves.

        Args:
            origins: (n, 3), or a single point for all.
            directions: (n, 3), or a single one for all, of any length but 0.
            tolerance: a length: no longer stretch of a ray inside is missed. As a rule 1/1000 of the model.
            span: the smallest and the largest t; as a rule from 0 to behind the model.
            threads: see `mesh`.

        >>> import jbt
        >>> ball = jbt.point(surface_radius=1)
        >>> hits = ball.trace([[0, 0, 5], [3, 0, 5]], [0, 0, -1])
        >>> hits.hit.tolist(), round(float(hits.t[0]), 3), hits.normal[0].tolist()
        ([True, False], 4.0, [0.0, 0.0, 1.0])
        """
        given = _rays(self, origins, directions, tolerance, span)
        made = _hits.of_native(self._native.trace(*given, False, threads))
        return _hits.by_ray(made, len(given[0]))

    def trace_all(
        self,
        origins: Any,
        directions: Any,
        *,
        tolerance: float | None = None,
        span: tuple[float, float] | None = None,
        threads: int | None = None,
    ) -> Hits:
        """All hits of each ray, by ray and then by t: see `trace`."""
        return _hits.of_native(
            self._native.trace(*_rays(self, origins, directions, tolerance, span), True, threads)
        )

    def render(
        self,
        size: tuple[int, int] = (800, 600),
        *,
        view: str | None = None,
        direction: Sequence[float] | None = None,
        eye: Sequence[float] | None = None,
        target: Sequence[float] | None = None,
        up: Sequence[float] | None = None,
        lens: float = 28.0,
        zoom: float = 1.0,
        orthographic: bool = False,
        mode: str = "shaded",
        quality: Literal["draft", "good", "best"] = "good",
        antialias: int = 2,
        background: Literal["studio", "transparent"] | tuple[int, int, int] | None = None,
        ground: bool = True,
        region: Region | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> NDArray[np.uint8]:
        """A picture: rows from the top, columns from the left, red, green, blue and opacity as screens take
        them. `jbt.png` makes a file of it.

        Args:
            size: pixels of a row, and rows.
            view: "three-quarter", "iso", "front", "back", "left", "right", "top" or "bottom".
            direction: where one looks from, instead: how far to the front, to the left and up, which is along
                x, y and z where z is up.
            eye: where the camera stands, instead; then `target` is what it looks at, (0, 0, 0) if not given.
            up: what is up in the picture.
            lens: the angle from the bottom to the top of the picture, in degrees.
            zoom: a factor of all sizes.
            orthographic: without perspective.
            mode: "shaded", "normal", "depth", "evaluations", or the name of a group of attributes.
            quality: the effort for light.
            antialias: rays along each side of a pixel.
            background: where the model is not; a colour is 3 numbers from 0 to 255.
            ground: whether a ground catches the shadow.
            region: a box that cuts the model open.
            threads, progress: see `mesh`.
        """
        wish = {
            "size": list(size),
            "view": view,
            "direction": _list(direction),
            "eye": _list(eye),
            "target": _list(target),
            "up": _list(up),
            "lens": lens,
            "zoom": zoom,
            "orthographic": orthographic,
            "mode": mode,
            "quality": quality,
            "antialias": antialias,
            "background": list(background) if isinstance(background, tuple) else background,
            "ground": ground,
            "bounds": _region(region),
        }
        with watcher(progress, "render") as told:
            return self._native.render(wish, threads, told)

    def _repr_png_(self) -> bytes | None:
        """What a notebook shows."""
        try:
            return _jbt.encode_png(self.render((480, 360)))
        except ValueError:
            # The model has errors or no end: its text has to do.
            return None

    # The solid.

    @property
    def support(self) -> Doubles:
        """The box outside of which the field is 0, in the world: (2, 3). Its sides may be infinite."""
        found = self._native.support()
        if found is None:
            raise ValueError("the model is empty: its field is zero everywhere")
        return np.array(found)

    @property
    def bounds(self) -> Doubles:
        """A box around the solid, in the world: (2, 3), within a thousandth of the model's size."""
        return self.tight_bounds()

    def tight_bounds(self, tolerance: float | None = None, *, region: Region | None = None) -> Doubles:
        """A box around the solid, in the world: (2, 3). Nothing of the solid is outside, and each side is
        within the tolerance, a length; as a rule a thousandth of the model's size."""
        box = _region(region)
        length = _size(self, box) / 1000 if tolerance is None else tolerance
        found, _ = self._native.tight_bounds(length, box)
        if found is None:
            raise ValueError("the model is empty: nothing is inside")
        return np.array(found)

    @property
    def volume(self) -> float:
        """The volume of the solid, about: see `measure`."""
        return self.measure().volume

    @property
    def area(self) -> float:
        """The area of the surface, about: see `measure`."""
        return self.measure().area

    def measure(
        self,
        resolution: int | None = None,
        *,
        cell: float | None = None,
        region: Region | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Measures:
        """Volume, with proven bounds, area and centre of mass. The arguments are those of `mesh`."""
        with watcher(progress, "measure") as told:
            made = self._native.measure(resolution, cell, _region(region), threads, told)
        center = made.pop("center")
        return Measures(**made, center=None if center is None else (center[0], center[1], center[2]))

    def contains(
        self, points: Any, y: Any = None, z: Any = None, *, threads: int | None = None
    ) -> NDArray[np.bool_]:
        """Whether points are inside; points as an evaluator takes them.

        >>> import jbt
        >>> jbt.point(surface_radius=1).contains([[0, 0, 0.99], [0, 0, 1.01]]).tolist()
        [True, False]
        """
        sides = Evaluator(self._native.sides(), (self, False, False, None))
        return sides(points, y, z, threads=threads).field >= np.float32(sides._native.iso)

    def owner(self, points: Any, y: Any = None, z: Any = None, *, threads: int | None = None) -> Owners:
        """The leaf that decides the field at each point; points as an evaluator takes them.

        >>> import jbt
        >>> model = jbt.point((0, 0, 0), radius=1) | jbt.point((2, 0, 0), radius=1)
        >>> model.owner([[0.1, 0, 0], [1.9, 0, 0], [9, 0, 0]]).path
        ['0.union/0.point', '0.union/1.point', None]
        """
        given, _, _ = columns(points, y, z)
        rows = np.column_stack(given).astype(np.float64)
        return Owners(**self._native.owner(rows, threads))

    def weights(
        self,
        points: Any,
        y: Any = None,
        z: Any = None,
        *,
        of: Sequence[str] | None = None,
        threads: int | None = None,
    ) -> Weights:
        """How much each leaf has to say at each point: the coefficients by which attributes mix. With the
        weight of nobody they add up to 1.

        Args:
            points: points as an evaluator takes them.
            y: where `points` is the array of x.
            z: likewise.
            of: paths of names, as "body/arm.1", each for all leaves below it. As a rule each leaf by itself.
            threads: how many work, from 1 on. As a rule as many as there are CPUs.

        >>> import jbt
        >>> model = jbt.point((0, 0, 0), radius=2) + jbt.point((1, 0, 0), radius=2)
        >>> weights = model.weights([[0.5, 0, 0], [9, 0, 0]])
        >>> weights.names, weights.values.tolist(), weights.default.tolist()
        (('0.sum/0.point', '0.sum/1.point'), [[0.5, 0.5], [0.0, 0.0]], [0.0, 1.0])
        """
        named = None if of is None else list(dict.fromkeys(of))
        native = self._native.weights(named)
        answers = Evaluator(native, (self, False, True, None))(points, y, z, threads=threads)
        # The field comes first, and what nobody has last.
        columns = answers.planes[1:-1]
        names = [name.removeprefix("weights.") for name in answers.names[1:-1]]
        return Weights(tuple(named or names), columns.T, answers.planes[-1])


def _region(given: Region | None) -> list[list[float]] | None:
    return region("region", given)


def _list(given: Sequence[float] | None) -> list[float] | None:
    return None if given is None else [float(number) for number in given]


def _size(model: Model, box: list[list[float]] | None) -> float:
    """The longest side of a region, or of the support."""
    corners = model.support if box is None else np.array(box)
    longest = float((corners[1] - corners[0]).max())
    if not np.isfinite(longest):
        raise ValueError("the model is unbounded: give a region or a tolerance")
    return longest


def _rays(
    model: Model, origins: Any, directions: Any, tolerance: float | None, span: tuple[float, float] | None
) -> tuple[Doubles, Doubles, list[float], float]:
    """Arguments of the native module: rows of equal number, the span, the tolerance."""
    rows = [
        matrix(name, np.atleast_2d(given))
        for name, given in (("origins", origins), ("directions", directions))
    ]
    count = max(map(len, rows))
    if not all(len(row) in (1, count) for row in rows):
        raise ValueError(f"directions: expected the shape of origins, {rows[0].shape}, got {rows[1].shape}")
    start, way = (np.ascontiguousarray(np.broadcast_to(row, (count, 3))) for row in rows)
    length = np.linalg.norm(way, axis=1)
    if (length == 0).any():
        raise ValueError(
            f"directions: expected vectors of any length but 0, got (0, 0, 0) at [{int(length.argmin())}]"
        )
    if span is None or tolerance is None:
        try:
            corners = model.support
        except ValueError:
            corners = np.zeros((2, 3))
        if not np.isfinite(corners).all():
            raise ValueError("the model is unbounded: give a span and a tolerance")
        reach = np.abs(start[:, None] - corners[None]).max(axis=1)
        far = float((np.linalg.norm(reach, axis=1) / length).max(initial=1.0))
        span = span or (0.0, far)
        tolerance = tolerance or max(float((corners[1] - corners[0]).max()), 1e-9) / 1000
    return start, way, [float(span[0]), float(span[1])], float(tolerance)


def _from_text(text: str) -> Model:
    """A model from what a pickle has of it."""
    return Model(_jbt.Model.loads("<text>", text.encode(), None, []))


def load(path: Path, object: str | None = None, /, **parameters: float) -> Model:
    """Reads a file: .jbt, or one of another system, by its ending (`jbt.SCENE_FORMATS`).

    Args:
        path: the file.
        object: the object to read, of a file that holds several; those that nothing refers to without it.
        parameters: values of the scene's parameters, instead of their defaults.

    Raises:
        SceneError: everything that is wrong with its text, with line, column and a caret.
        OSError: the file cannot be read.
    """
    return _read(_jbt.Model.load(fspath(path), object, _settings(parameters)))


def loads(
    text: str | bytes, name: str = "<text>", object: str | None = None, /, **parameters: float
) -> Model:
    """Reads a text. The ending of the name says what it is, as of a file; without one the text does. An
    object is chosen as by `load`.

    >>> import jbt
    >>> jbt.loads("jbt 1 param size = 1 point { radius size }", size=2).parameters
    {'size': 2.0}
    """
    data = text.encode() if isinstance(text, str) else bytes(text)
    return _read(_jbt.Model.loads(name, data, object, _settings(parameters)))


def _settings(parameters: dict[str, float]) -> list[tuple[str, float]]:
    return [(name, float(value)) for name, value in parameters.items()]


def _read(native: _jbt.Model) -> Model:
    for text in native.warnings:
        warnings.warn(text, SceneWarning, stacklevel=3)
    return Model(native)


def select(which: Real, *models: Models) -> Model:
    """The model whose place, from 0, is nearest to `which`; the others do not count. `which` is a parameter
    as a rule.

    >>> import jbt
    >>> frames = [jbt.point(surface_radius=size) for size in (1, 2, 3)]
    >>> film = jbt.select(jbt.param("frame", 0), frames)
    >>> [round(float(film.with_parameters(frame=n).bounds[1, 0]), 1) for n in range(3)]
    [1.0, 2.0, 3.0]
    """
    return Model(_jbt.Model.select(which, flat(models)))


def expression(formula: Formula, *, within: Region | None = None) -> Model:
    """A field by a formula of `jbt.x`, `jbt.y`, `jbt.z`, of fields of models, and of numbers.

    Args:
        formula: what `+ - * / **` and functions as `jbt.sqrt` make of these.
        within: a box, as two corners, outside of which the field is 0. Without one, a formula that is not 0
            where all its fields are reaches everywhere.

    >>> import jbt
    >>> from jbt import x, y, z
    >>> gyroid = jbt.sin(x) * jbt.cos(y) + jbt.sin(y) * jbt.cos(z) + jbt.sin(z) * jbt.cos(x)
    >>> model = jbt.expression(0.5 + gyroid, within=[(-3, -3, -3), (3, 3, 3)])
    >>> model.mesh(resolution=32).closed
    True
    """
    box = region("within", within)
    low, high = (None, None) if box is None else (box[0], box[1])
    return Model(_jbt.Model.expression(formula, low, high))
