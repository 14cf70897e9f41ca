"""Types of arguments. At run time anything of the kind will do: numbers and arrays of NumPy, lists."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, Union

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ._jbt import Falloff, Number, Term
    from ._model import Model

#: A number, or one that follows parameters.
Real: TypeAlias = Union[float, "np.floating[Any]", "np.integer[Any]", "Number"]
#: A part of a formula: a number, or what depends on the point.
Formula: TypeAlias = Union[Real, "Term"]
#: Three numbers.
Vector: TypeAlias = Union[Sequence[Real], "NDArray[Any]"]
#: Any number of numbers; a single one is one.
Reals: TypeAlias = Union[Real, Sequence[Real], "NDArray[Any]"]
#: Any number of points.
Points: TypeAlias = Union[Sequence[Vector], "NDArray[Any]"]
#: Rows of a matrix.
Matrix: TypeAlias = Union[Sequence[Sequence[Real]], "NDArray[Any]"]
#: The name of a coordinate axis.
Axis: TypeAlias = Literal["x", "y", "z"]
#: A falloff, or its name.
FalloffLike: TypeAlias = Union[str, "Falloff"]
#: Models, or lists of them.
Models: TypeAlias = Union["Model", Iterable["Model"]]
#: The name of an engine.
Engine: TypeAlias = Literal["scalar", "lanes", "jit"]
#: A box: its smallest and its largest corner.
Region: TypeAlias = Union[Sequence[Sequence[float]], "NDArray[Any]"]
#: The path of a file.
Path: TypeAlias = Union[str, "PathLike[str]"]
#: Who is told how far work is: a callable that takes a number from 0 to 1, True for a bar of tqdm, or a bar.
Progress: TypeAlias = Callable[[float], object] | bool | Any | None

Floats: TypeAlias = "NDArray[np.float32]"
Doubles: TypeAlias = "NDArray[np.float64]"
