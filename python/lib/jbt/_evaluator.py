"""Answers at points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from . import _jbt
from ._arrays import columns, described
from ._types import Engine, Floats

if TYPE_CHECKING:
    from ._model import Model


class Answers:
    """The answers at points: named arrays, all of them views of one block of memory.

    Attributes:
        planes: everything, of the shape (planes, n), in the order of `names`.
        names: the name of each plane: `field`, `gx`, `gy`, `gz`, `color.r`, ...
    """

    __slots__ = ("_groups", "_rows", "_shape", "names", "planes")

    def __init__(
        self,
        planes: Floats,
        names: tuple[str, ...],
        groups: tuple[tuple[str, int, int], ...],
        shape: tuple[int, ...],
        rows: bool,
    ) -> None:
        self.planes = planes
        self.names = names
        self._groups = groups
        self._shape = shape
        self._rows = rows

    def _view(self, first: int, width: int) -> Floats:
        """Some planes, shaped as the points were."""
        some: Floats = self.planes[first : first + width]
        return some.T if self._rows else some.reshape((width, *self._shape))

    @property
    def field(self) -> Floats:
        """The field at each point, of the shape (n,), or that of the three arrays."""
        return cast(Floats, self.planes[0].reshape(self._shape))

    @property
    def gradient(self) -> Floats:
        """The gradient of the field: (n, 3) where the points were so, else (3, n)."""
        if "gx" not in self.names:
            raise AttributeError("the gradient was not asked for: compile(gradient=True)")
        return self._view(self.names.index("gx"), 3)

    @property
    def color(self) -> Floats:
        """Linear red, green and blue: (n, 3) where the points were so, else (3, n)."""
        return self["color"]

    @property
    def attributes(self) -> dict[str, Floats]:
        """Every group of attributes by its name: (n, width) where the points were so, else (width, n)."""
        return {name: self._view(first, width) for name, first, width in self._groups}

    def __getitem__(self, name: str) -> Floats:
        for group, first, width in self._groups:
            if group == name:
                return self._view(first, width)
        if name in self.names:
            return cast(Floats, self.planes[self.names.index(name)].reshape(self._shape))
        if not self._groups:
            raise KeyError(f"{name}: attributes were not asked for: compile(attributes=True)")
        raise KeyError(f"{name}: there are {', '.join(self.names)}")

    def __len__(self) -> int:
        return int(self.planes.shape[1])

    def __repr__(self) -> str:
        return f"<jbt.Answers {', '.join(self.names)} at {len(self)} points>"


@dataclass(frozen=True)
class Counters:
    """What an evaluator has done.

    Attributes:
        calls: calls of the kernel.
        points: points that were asked for.
        lanes: points that were computed: blocks are filled up.
        evaluations: distances to skeletons that were computed.
        pruned: distances that were left out, as they do not matter in a region.
        avoided: distances that one walk of the tree for each answer would have computed on top.
    """

    calls: int
    points: int
    lanes: int
    evaluations: int
    pruned: int
    avoided: int


class Evaluator:
    """A compiled model, which answers at points: `Model.compile` makes it.

    It may be called from several threads at once, and runs without the interpreter's lock.

    >>> import jbt, numpy as np
    >>> size = jbt.param("size", 1.0)
    >>> ev = jbt.point(radius=size, color=(1, 0.5, 0)).compile()
    >>> answers = ev(np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]))
    >>> answers.field
    array([1. , 0.5], dtype=float32)
    >>> answers.gradient.shape, answers.color[1]
    ((2, 3), array([1. , 0.5, 0. ], dtype=float32))
    >>> ev.update(size=2)
    >>> round(float(ev([[0.5, 0.0, 0.0]]).field[0]), 4)
    0.8545
    """

    __slots__ = ("_made_of", "_native", "groups", "names")

    def __init__(self, native: _jbt.Evaluator, made_of: tuple[Any, ...]) -> None:
        self._native = native
        self._made_of = made_of
        #: Names of the answers: `field`, `gx`, `gy`, `gz`, `color.r`, ...
        self.names = tuple(native.names())
        #: Groups of attributes: name, first plane, number of planes.
        self.groups = tuple(native.groups())

    def __call__(
        self,
        points: Any,
        y: Any = None,
        z: Any = None,
        *,
        out: Answers | Floats | None = None,
        threads: int | None = None,
        nan: Literal["raise", "propagate"] = "raise",
    ) -> Answers:
        """The answers at points, of the same bits on any engine and any number of threads.

        Args:
            points: an array of the shape (n, 3) or (3, n), or three arrays of one shape; (3, 3) are three
                rows. float32 or float64; whole numbers become float64. Contiguous planes of float32, as
                (3, n) is or three arrays are, are used as they are; anything else is brought into planes
                on the way, 512 points at a time. float64 keeps its digits far from the origin.
            y: where `points` is the array of x.
            z: likewise.
            out: where the answers go: `Answers` of this evaluator for as many points, or an array of
                float32 with the shape (len(ev.names), n). Otherwise they get memory of their own.
            threads: how many work, from 1 on. As a rule as many as there are CPUs; few points take one.
            nan: "raise" refuses points with a NaN; "propagate" gives NaN as their field and gradient.
        """
        given, shape, rows = columns(points, y, z)
        count = given[0].shape[0]
        if nan not in ("raise", "propagate"):
            raise ValueError(f'nan: expected "raise" or "propagate", got {nan!r}')
        planes = self._planes(out, count)
        self._native.eval(list(given), planes, threads, nan == "propagate")
        return Answers(planes, self.names, self.groups, shape, rows)

    def _planes(self, out: Answers | Floats | None, count: int) -> Floats:
        """The array for answers."""
        if out is None:
            return np.empty((len(self.names), count), np.float32)
        planes = out.planes if isinstance(out, Answers) else out
        shape = (len(self.names), count)
        fits = isinstance(planes, np.ndarray) and planes.dtype == np.float32 and planes.shape == shape
        if not fits or not planes.flags.c_contiguous or not planes.flags.writeable:
            expected = f"a writable C-contiguous array of float32 with the shape {shape}"
            raise ValueError(f"out: expected {expected}, got {described(planes)}")
        return planes

    def empty(self, count: int) -> Answers:
        """Room for the answers at so many points, for `out`."""
        planes = np.empty((len(self.names), count), np.float32)
        return Answers(planes, self.names, self.groups, (count,), True)

    def update(self, **parameters: float) -> None:
        """Sets parameters of the model, for all calls to come. Nothing is compiled."""
        self._native.update([(name, float(value)) for name, value in parameters.items()])

    @property
    def parameters(self) -> dict[str, float]:
        """The present values of the parameters."""
        return dict(self._native.parameters())

    @property
    def engine(self) -> str:
        """What runs it: "jit", "lanes" or "scalar"."""
        return self._native.engine

    @property
    def origin(self) -> tuple[float, float, float]:
        """Where its float32 coordinates count from inside: 0 unless the model is far away."""
        x, y, z = self._native.origin
        return x, y, z

    @property
    def counters(self) -> Counters:
        """What it has done so far."""
        return Counters(*self._native.counters())

    def __reduce__(self) -> tuple[Any, ...]:
        return _compiled, (*self._made_of, self.parameters)

    def __repr__(self) -> str:
        return f"<jbt.Evaluator of {', '.join(self.names)} by {self.engine}>"


def _compiled(
    model: Model, gradient: bool, attributes: bool, engine: Engine | None, now: dict[str, float]
) -> Evaluator:
    """An evaluator from what a pickle has of it."""
    made = model.compile(gradient=gradient, attributes=attributes, engine=engine)
    if now:
        made.update(**now)
    return made


@dataclass(frozen=True)
class Comparison:
    """What engines say of the same points.

    Attributes:
        engines: those of this machine.
        answers: what each of them says.
        differing: of how many numbers each has other bits than the first one; two NaNs are alike.
    """

    engines: tuple[str, ...]
    answers: dict[str, Answers]
    differing: dict[str, int]

    @property
    def equal(self) -> bool:
        """Whether all say the same, bit for bit."""
        return not any(self.differing.values())


def compare_engines(
    model: Model, points: Any, *, gradient: bool = True, attributes: bool = True
) -> Comparison:
    """Asks every engine that this machine has, and compares bits. For tests.

    >>> import jbt, numpy as np
    >>> jbt.compare_engines(jbt.point(radius=1), np.random.rand(100, 3)).equal
    True
    """
    from ._errors import LimitError

    answers: dict[str, Answers] = {}
    for engine in _jbt.engines():
        try:
            ev = model.compile(gradient=gradient, attributes=attributes, engine=engine)
        except LimitError:
            continue
        answers[engine] = ev(points, nan="propagate")
    first = bits(next(iter(answers.values())).planes)
    differing = {engine: int((bits(one.planes) != first).sum()) for engine, one in answers.items()}
    return Comparison(tuple(answers), answers, differing)


def bits(planes: Floats) -> NDArray[np.uint32]:
    """Floats as their bits, any NaN as one."""
    return np.where(np.isnan(planes), np.float32(np.nan), planes).view(np.uint32)
