"""What bricks of models and of particles have in common: a lattice, and the shape of the whole model."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from distributed import Client, Future


class Bricks:
    """A lattice that is cut into bricks, and the workers that make them.

    Attributes:
        origin: of positions, in the world.
        native: the lattice.
        lattice: the same as numbers: its first corner, the edge of a cell, cells along the axes.
        shape: the model without its rows, as bytes.
        shared: the shape on the workers, under a key of its own.
    """

    def __init__(self, client: Client, retries: int) -> None:
        self.client = client
        self.retries = retries

    def lay(self, model: Any, resolution: int | None, cell: float | None, region: Any) -> None:
        """Makes the lattice of a native model."""
        self.native, origin = model.lattice(resolution, cell, region)
        self.origin = list(origin)
        first, spacing, cells = self.native.parts()
        self.lattice = (list(first), spacing, list(cells))

    def share(self, shape: bytes) -> None:
        """Gives the workers the shape of the whole model."""
        self.shape = shape
        key = "jbt-shape-" + hashlib.sha256(shape).hexdigest()
        self.shared: Future = self.client.submit(bytes, shape, key=key)
