"""A folder of parts: what workers have written, and its index."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from .. import _jbt, _mesh
from .._mesh import Mesh

INDEX = "index.json"
VERSION = 1


@dataclass(frozen=True)
class Parts:
    """A mesh in parts.

    Attributes:
        folder: where the parts are.
        index: what `index.json` says: the lattice, and of each part its file, its SHA-256, where it is, and
            how many vertices and triangles it has.
    """

    folder: Path
    index: dict[str, Any]

    def __len__(self) -> int:
        return len(self.index["parts"])

    def __iter__(self) -> Iterator[bytes]:
        """The bytes of the parts, one after the other, checked."""
        for part in self.index["parts"]:
            path = self.folder / part["file"]
            content = path.read_bytes()
            if hashlib.sha256(content).hexdigest() != part["sha256"]:
                raise ValueError(f"{path}: it is not what the index says (SHA-256)")
            yield content

    @property
    def vertices(self) -> int:
        """Vertices of the whole."""
        return sum(part["vertices"] for part in self.index["parts"])

    @property
    def triangles(self) -> int:
        """Triangles of the whole."""
        return sum(part["triangles"] for part in self.index["parts"])

    @property
    def closed(self) -> bool:
        """Whether the mesh has no rim."""
        return not any(part["open"] for part in self.index["parts"])

    def mesh(self) -> Mesh:
        """The whole mesh: seams are welded, and it has the bytes of one machine's."""
        made = _jbt.join(list(self))
        made["spacing"] = self.index["spacing"]
        return _mesh.of_native(made)

    def __repr__(self) -> str:
        return f"<jbt.dask.Parts: {len(self)} parts of {self.triangles} triangles in {self.folder}>"


def index_of(results: dict[Any, dict[str, Any]], facts: dict[str, Any]) -> dict[str, Any]:
    names = ("place", "file", "sha256", "bytes", "vertices", "triangles", "open", "cut_sides")
    parts = [{name: result[name] for name in names} for result in results.values() if "file" in result]
    return {"jbt_parts": VERSION, **facts, "parts": sorted(parts, key=lambda part: part["place"])}


def read(folder: str | PathLike[str]) -> Parts:
    """The parts of a folder.

    Raises:
        FileNotFoundError: the folder has no index: whoever wrote it has not ended.
        ValueError: the index is none of this version.
    """
    where = Path(folder)
    index = json.loads((where / INDEX).read_text())
    if (
        not isinstance(index, dict)
        or index.get("jbt_parts") != VERSION
        or not isinstance(index.get("parts"), list)
    ):
        raise ValueError(f"{where / INDEX}: expected an index of version {VERSION}")
    for part in index["parts"]:
        if Path(part["file"]).name != part["file"]:
            raise ValueError(f"{where / INDEX}: a part is a file of the folder, and not {part['file']!r}")
    return Parts(where, index)
