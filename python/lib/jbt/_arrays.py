"""Arguments that are arrays: what they have to be, and messages that say what came instead."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._types import Doubles, Region

#: Coordinates along one axis, of float32 or float64.
Column = NDArray[Any]


def described(value: Any) -> str:
    """An array in words, for messages."""
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} with the shape {value.shape}"
    return f"{value!r:.60} ({type(value).__name__})"


def numeric(name: str, value: Any, expected: str) -> NDArray[Any]:
    """An array of float32 or float64: these stay what they are, other numbers become float64."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: expected {expected}, got rows of different lengths ({error})") from None
    if array.dtype == np.float32 or array.dtype == np.float64:
        return array
    if array.dtype.kind in "iu" or (array.dtype.kind == "f" and array.dtype.itemsize <= 8):
        return array.astype(np.float64)
    raise TypeError(
        f"{name}: expected {expected}, of float32, float64 or whole numbers; got {described(array)}"
    )


def columns(points: Any, y: Any, z: Any) -> tuple[tuple[Column, Column, Column], tuple[int, ...], bool]:
    """Points as three arrays of one dimension; the shape of the answers; whether points are rows."""
    expected = "an array of the shape (n, 3) or (3, n), or three arrays of one shape"
    if (y is None) != (z is None):
        raise TypeError(f"points: expected {expected}, got two arrays")
    if y is not None:
        return separate((points, y, z), expected)
    is_triple = isinstance(points, (tuple, list)) and len(points) == 3
    shapes = [part.shape for part in points if isinstance(part, np.ndarray)] if is_triple else []
    # Three arrays of three numbers each are three points, as a list of three vectors is.
    if len(shapes) == 3 and shapes != [(3,)] * 3:
        return separate(tuple(points), expected)
    array = numeric("points", points, expected)
    if array.ndim == 2 and array.shape[1] == 3:
        return (array[:, 0], array[:, 1], array[:, 2]), (array.shape[0],), True
    if array.ndim == 2 and array.shape[0] == 3:
        return (array[0], array[1], array[2]), (array.shape[1],), False
    if array.size == 0 and array.ndim == 1:
        return (array, array, array), (0,), True
    raise ValueError(f"points: expected {expected}, got {described(array)}")


def separate(
    parts: tuple[Any, ...], expected: str
) -> tuple[tuple[Column, Column, Column], tuple[int, ...], bool]:
    x, y, z = (numeric(name, part, "an array") for name, part in zip("xyz", parts, strict=True))
    if not x.shape == y.shape == z.shape:
        raise ValueError(f"points: expected {expected}, got {x.shape}, {y.shape} and {z.shape}")
    return (x.reshape(-1), y.reshape(-1), z.reshape(-1)), x.shape, False


def matrix(name: str, value: Any, width: int = 3) -> Doubles:
    """Rows of numbers, as float64, all finite."""
    array = numeric(name, value, f"an array of the shape (n, {width})")
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name}: expected the shape (n, {width}), got {described(array)}")
    finite(name, array)
    return np.ascontiguousarray(array, dtype=np.float64)


def per_item(name: str, value: Any, count: int) -> Doubles:
    """One number for all, or one for each of so many, as float64, all finite."""
    array = numeric(name, value, f"a number, or {count} of them")
    if array.shape not in ((), (count,)):
        raise ValueError(f"{name}: expected a number or the shape ({count},), got {described(array)}")
    finite(name, array)
    return np.ascontiguousarray(np.atleast_1d(array), dtype=np.float64)


def finite(name: str, array: NDArray[Any]) -> None:
    """Refuses NaN and infinities, naming the first one."""
    if array.size and not np.isfinite(array).all():
        place = np.argwhere(~np.isfinite(np.atleast_1d(array)))[0]
        index = ", ".join(str(int(part)) for part in place)
        raise ValueError(
            f"{name}: expected finite numbers, got {np.atleast_1d(array)[tuple(place)]} at [{index}]"
        )


def region(name: str, value: Region | None) -> list[list[float]] | None:
    """A box: two corners, or six numbers in a row."""
    if value is None:
        return None
    array = numeric(name, value, "two corners of 3 numbers")
    if array.size != 6 or array.ndim not in (1, 2):
        raise ValueError(f"{name}: expected two corners of 3 numbers, got {described(array)}")
    low, high = array.reshape(2, 3).astype(float).tolist()
    return [low, high]
