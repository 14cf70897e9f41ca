"""Answers at the points of a lattice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._types import Doubles, Floats


@dataclass(eq=False, repr=False)
class Grid:
    """Answers at the points of a lattice: arrays with an index for x, one for y and one for z.

    Attributes:
        planes: one array of the shape (nx, ny, nz) for each of `names`; x is the fastest in memory.
        names: `field`, `gx`, `gy`, `gz`, `color.r`, ...
        groups: groups of attributes: name, first plane, number of planes.
        origin: the first point, in the world.
        spacing: the edge of a cell.
    """

    planes: list[Floats]
    names: list[str]
    groups: list[tuple[str, int, int]]
    origin: tuple[float, float, float]
    spacing: float

    @property
    def field(self) -> Floats:
        """The field, (nx, ny, nz)."""
        return self.planes[0]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Points along x, y and z."""
        nx, ny, nz = self.field.shape
        return nx, ny, nz

    @property
    def gradient(self) -> Floats:
        """The gradient, (nx, ny, nz, 3), copied."""
        return np.stack([self["gx"], self["gy"], self["gz"]], axis=-1)

    @property
    def color(self) -> Floats:
        """Linear red, green and blue, (nx, ny, nz, 3), copied."""
        return self["color"]

    def __getitem__(self, name: str) -> Floats:
        """A plane by its name, or a group of attributes, (nx, ny, nz, width), copied."""
        for group, first, width in self.groups:
            if group == name and width > 1:
                return np.stack(self.planes[first : first + width], axis=-1)
        if name not in self.names:
            raise KeyError(f"{name}: there are {', '.join(self.names)}")
        return self.planes[self.names.index(name)]

    @property
    def axes(self) -> tuple[Doubles, Doubles, Doubles]:
        """The coordinates along x, y and z, in the world."""
        pairs = zip(self.origin, self.shape, strict=True)
        x, y, z = (
            np.float64(first) + self.spacing * np.arange(count, dtype=np.float64) for first, count in pairs
        )
        return x, y, z

    def to_xarray(self) -> Any:
        """As `xarray.Dataset` with the coordinates x, y and z: a variable for each plane."""
        import xarray

        coordinates = dict(zip("xyz", self.axes, strict=True))
        variables = {
            name: (("x", "y", "z"), plane) for name, plane in zip(self.names, self.planes, strict=True)
        }
        return xarray.Dataset(variables, coordinates, {"spacing": self.spacing})

    def to_pyvista(self) -> Any:
        """As `pyvista.ImageData`: point data for each plane."""
        import pyvista

        made = pyvista.ImageData(dimensions=self.shape, spacing=(self.spacing,) * 3, origin=self.origin)
        for name, plane in zip(self.names, self.planes, strict=True):
            made.point_data[name] = plane.reshape(-1, order="F")
        return made

    def __repr__(self) -> str:
        return f"<jbt.Grid of {', '.join(self.names)} at {' x '.join(map(str, self.shape))} points>"


def of_native(made: dict[str, Any]) -> Grid:
    """A grid from what the native module tells."""
    x, y, z = made.pop("origin")
    return Grid(**made, origin=(x, y, z))
