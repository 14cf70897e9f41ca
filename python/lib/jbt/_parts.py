"""What formulas begin with, and other small things."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _jbt
from ._calls import as_falloff
from ._types import FalloffLike, Formula

#: The coordinates of the point, in formulas.
x: _jbt.Term = _jbt.coordinate(0)
y: _jbt.Term = _jbt.coordinate(1)
z: _jbt.Term = _jbt.coordinate(2)

#: The endings of scenes that `load` reads.
SCENE_FORMATS: tuple[str, ...] = tuple(_jbt.scene_formats())
#: The endings of meshes that `Mesh.save` writes.
MESH_FORMATS: tuple[str, ...] = tuple(_jbt.mesh_formats())
#: The names of views of `Model.render`.
VIEWS: tuple[str, ...] = tuple(_jbt.views())


def param(name: str, default: float) -> _jbt.Number:
    """A parameter: a number with a name, which can be set later without compiling anything.

    All uses of a name in one model are one parameter, and have to give the same default.

    >>> import jbt
    >>> bulge = jbt.param("bulge", 0.6)
    >>> 2 * bulge + 1
    <jbt.Number 2 * bulge + 1 = 2.2>
    """
    return _jbt.Number.parameter(name, float(default))


def falloff_of(falloff: FalloffLike, distance: Formula) -> _jbt.Term:
    """The falloff of a distance, of which 1 is the end, in a formula; negative distances count as 0."""
    return _jbt.falloff_of(as_falloff(falloff), distance)


def png(pixels: NDArray[np.uint8]) -> bytes:
    """A picture of `Model.render` as the bytes of a PNG file."""
    return _jbt.encode_png(np.ascontiguousarray(pixels))


class _Compiler:
    """What the compiler of this process has made so far."""

    @property
    def programs(self) -> int:
        """Programs that were compiled: one for each shape and purpose."""
        return _jbt.compile_counters()[0]

    @property
    def models(self) -> int:
        """Programs that were given the numbers of a model."""
        return _jbt.compile_counters()[1]

    def __repr__(self) -> str:
        return f"<jbt: {self.programs} programs compiled, {self.models} models>"

    def __reduce__(self) -> Any:
        return "COMPILER"


#: Counters of the compiler of this process.
COMPILER = _Compiler()
