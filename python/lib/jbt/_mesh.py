"""Meshes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from os import fspath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _jbt
from ._types import Doubles, Floats, Path


@dataclass(eq=False, repr=False)
class Creases:
    """Corners of triangles whose normals and attributes are not those of their vertex, because an edge of
    the surface is there. Each shows a *side* of a vertex.

    Attributes:
        vertices: uint32, (k,): the vertex of each side.
        normals: float32, (k, 3): the normal of each side.
        corners: uint32, (m, 2): three times the face plus the corner, and the side that it shows.
        attributes: float32, (k, width) for each attribute of the mesh.
    """

    vertices: NDArray[np.uint32] = field(default_factory=lambda: np.zeros(0, np.uint32))
    normals: Floats = field(default_factory=lambda: np.zeros((0, 3), np.float32))
    corners: NDArray[np.uint32] = field(default_factory=lambda: np.zeros((0, 2), np.uint32))
    attributes: dict[str, Floats] = field(default_factory=dict)


@dataclass(eq=False, repr=False)
class Mesh:
    """Triangles with normals and attributes. The arrays own their memory and may be changed.

    Attributes:
        vertices: float32, (n, 3): positions, counting from `origin`.
        faces: uint32, (m, 3): three vertices each, counter-clockwise from outside, in right-handed axes.
        normals: float32, (n, 3), of length 1, outwards.
        attributes: float32, (n, width) for each group of the model: `color`, ...
        creases: where corners of faces have other normals and attributes: see `split`.
        origin: where positions count from, in the world: 0 unless the model is far away.
        up: the axis that points up, "z" or "y", as the model has it.
        handed: the hand of the axes, "right" or "left", as the model has it.
        closed: whether every edge has two triangles.
        cut_sides: the sides of the region that cut the surface: "none", or as "-x +z".
        spacing: the edge of a cell.
        constants: what the leaves of the model are of: the values of each constant, by its name.
        info: what it took: evaluations, the engine, places with parts thinner than a cell, and so on.
    """

    vertices: Floats
    faces: NDArray[np.uint32]
    normals: Floats
    attributes: dict[str, Floats] = field(default_factory=dict)
    creases: Creases = field(default_factory=Creases)
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    up: str = "z"
    handed: str = "right"
    closed: bool = True
    cut_sides: str = "none"
    spacing: float = 0.0
    constants: dict[str, list[str | int]] = field(default_factory=dict)
    info: dict[str, Any] = field(default_factory=dict)

    def split(self) -> Mesh:
        """The mesh with a vertex for each side of its creases, behind the others, for programs whose
        vertices have one normal each. It is closed by its positions alone."""
        sides = self.creases
        if not len(sides.corners):
            return self
        faces = self.faces.copy()
        faces.reshape(-1)[sides.corners[:, 0]] = np.uint32(len(self.vertices)) + sides.corners[:, 1]
        return replace(
            self,
            vertices=np.concatenate([self.vertices, self.vertices[sides.vertices]]),
            normals=np.concatenate([self.normals, sides.normals]),
            attributes={
                name: np.concatenate([values, sides.attributes[name]])
                for name, values in self.attributes.items()
            },
            faces=faces,
            creases=Creases(),
        )

    @property
    def colors(self) -> Floats:
        """Linear red, green and blue for each vertex, (n, 3); white where the mesh has no colours."""
        found = self.attributes.get("color")
        return np.ones_like(self.vertices) if found is None else found

    @property
    def srgb(self) -> NDArray[np.uint8]:
        """Colours as screens have them: bytes of sRGB, (n, 3)."""
        return srgb(self.colors)

    @property
    def world(self) -> Doubles:
        """Positions in the world, as float64, (n, 3)."""
        return self.vertices.astype(np.float64) + np.asarray(self.origin, np.float64)

    def right_handed(self) -> Mesh:
        """The mirror image in right-handed axes of a mesh in left-handed ones; else this mesh."""
        if self.handed == "right":
            return self
        turn = np.array([1, 1, -1] if self.up == "y" else [1, -1, 1], np.float32)
        x, y, z = (float(number) for number in np.asarray(self.origin) * turn)
        return replace(
            self,
            # A sum with 0 makes no zero a negative one; a mirror turns every triangle around.
            vertices=self.vertices * turn + np.float32(0),
            normals=self.normals * turn + np.float32(0),
            faces=np.ascontiguousarray(self.faces[:, [0, 2, 1]]),
            creases=self._mirrored(turn),
            origin=(x, y, z),
            handed="right",
        )

    def _mirrored(self, turn: Floats) -> Creases:
        """The creases of a mesh whose faces are turned around."""
        sides = self.creases
        corners = sides.corners.copy()
        corners[:, 0] = corners[:, 0] // 3 * 3 + np.array([0, 2, 1], np.uint32)[corners[:, 0] % 3]
        corners = corners[np.argsort(corners[:, 0], kind="stable")]
        return replace(sides, normals=sides.normals * turn + np.float32(0), corners=corners)

    @property
    def bounds(self) -> Doubles:
        """The smallest and the largest corner, in the world, (2, 3)."""
        if not len(self.vertices):
            raise ValueError("the mesh is empty: it has no bounds")
        world = self.world
        return np.stack([world.min(axis=0), world.max(axis=0)])

    @property
    def area(self) -> float:
        """The area of the triangles."""
        return float(np.linalg.norm(self._doubled(), axis=1).sum() / 2)

    @property
    def volume(self) -> float:
        """The volume inside, of a closed mesh."""
        if not self.closed:
            raise ValueError("the mesh is open: it has no volume")
        first = self.vertices.astype(np.float64)[self.faces[:, 0]]
        return float((first * self._doubled()).sum() / 6)

    def _doubled(self) -> Doubles:
        """Twice the area of each triangle, along its normal."""
        a, b, c = (self.vertices.astype(np.float64)[self.faces[:, corner]] for corner in range(3))
        return np.cross(b - a, c - a)

    def to_trimesh(self) -> Any:
        """As `trimesh.Trimesh`: positions in the world, colours as bytes of sRGB, attributes by name."""
        import trimesh

        mesh = self.right_handed()
        others: Any = {name: values for name, values in self.attributes.items() if name != "color"}
        return trimesh.Trimesh(
            vertices=mesh.world,
            faces=mesh.faces.astype(np.int64),
            vertex_normals=mesh.normals,
            vertex_colors=np.column_stack([self.srgb, np.full(len(self.vertices), 255, np.uint8)]),
            vertex_attributes=others,
            process=False,
        )

    def to_pyvista(self) -> Any:
        """As `pyvista.PolyData`: `rgb` are bytes of sRGB, for `plot(scalars="rgb", rgb=True)`;
        attributes are linear."""
        import pyvista

        mesh = self.right_handed()
        faces: Any = mesh.faces.astype(np.int64)
        made = pyvista.PolyData.from_regular_faces(mesh.world, faces)
        made.point_data["Normals"] = mesh.normals
        made.point_data["rgb"] = self.srgb
        for name, values in self.attributes.items():
            made.point_data[name] = values[:, 0] if values.shape[1] == 1 else values
        return made

    def to_meshio(self) -> Any:
        """As `meshio.Mesh`: positions in the world, normals and linear attributes as point data."""
        import meshio

        mesh = self.right_handed()
        data = {"normals": mesh.normals, **self.attributes}
        flat = {name: values[:, 0] if values.shape[1] == 1 else values for name, values in data.items()}
        return meshio.Mesh(mesh.world, [("triangle", mesh.faces.astype(np.int64))], point_data=flat)

    def save(
        self,
        path: Path,
        *,
        format: str | None = None,
        up: str | None = None,
        colors: str | None = None,
    ) -> None:
        """Writes a file, which appears whole or not at all.

        Args:
            path: its ending says the format: .glb, .ply, .obj or .stl.
            format: the format, where the ending does not say it.
            up: the axis of the file that points up, "y" or "z"; as a rule what readers of the format expect.
            colors: "srgb" or "linear"; likewise.
        """
        attributes = [
            (name, np.ascontiguousarray(values, np.float32)) for name, values in self.attributes.items()
        ]
        vertices, normals = (np.ascontiguousarray(a, np.float32) for a in (self.vertices, self.normals))
        faces = np.ascontiguousarray(self.faces, np.uint32)
        sides = self.creases
        kept = bool(len(sides.corners))
        creases = (
            np.ascontiguousarray(sides.vertices, np.uint32),
            np.ascontiguousarray(sides.normals, np.float32),
            np.ascontiguousarray(sides.corners, np.uint32),
            [np.ascontiguousarray(sides.attributes[name], np.float32) for name in self.attributes if kept],
        )
        _jbt.save_mesh(
            fspath(path),
            list(self.origin),
            (self.up, self.handed),
            vertices,
            normals,
            faces,
            attributes,
            creases,
            format,
            up,
            colors,
            list(self.constants.items()),
        )

    def __repr__(self) -> str:
        state = "closed" if self.closed else "open"
        return f"<jbt.Mesh of {len(self.faces)} triangles and {len(self.vertices)} vertices, {state}>"


def srgb(linear: Floats) -> NDArray[np.uint8]:
    """Linear light from 0 to 1 as bytes of sRGB (IEC 61966-2-1)."""
    x = np.clip(linear.astype(np.float64), 0.0, 1.0)
    curved = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return (curved * 255 + 0.5).astype(np.uint8)


def of_native(made: dict[str, Any]) -> Mesh:
    """A mesh from what the native module tells."""
    arrays = {name: made.pop(name) for name in ("vertices", "faces", "normals", "attributes")}
    facts = {name: made.pop(name) for name in ("up", "handed", "closed", "cut_sides", "spacing")}
    x, y, z = made.pop("origin")
    creases = Creases(**made.pop("creases"))
    constants = made.pop("constants", {})
    return Mesh(**arrays, creases=creases, origin=(x, y, z), **facts, constants=constants, info=made)
