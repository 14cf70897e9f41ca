"""Where rays hit the surface, and who decides at points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._types import Doubles, Floats


@dataclass(eq=False, repr=False)
class Hits:
    """Where rays hit. Of `trace` there is a row for each ray, of `trace_all` a row for each hit.

    Attributes:
        ray: the index of the ray of each row.
        hit: whether there is a hit; of `trace_all` everywhere.
        t: where on the ray: the position is origin + t * direction. NaN without a hit.
        position: (n, 3), in the world. NaN without a hit.
        normal: (n, 3), of length 1, outwards. NaN without a hit, or where the gradient vanishes.
        entering: whether the ray enters the solid there.
        attributes: (n, width) for each group of the model. NaN without a hit.
    """

    ray: NDArray[np.uint64]
    hit: NDArray[np.bool_]
    t: Doubles
    position: Doubles
    normal: Doubles
    entering: NDArray[np.bool_]
    attributes: dict[str, Floats]

    @property
    def color(self) -> Floats:
        """Linear red, green and blue, (n, 3)."""
        return self.attributes["color"]

    def __len__(self) -> int:
        return len(self.ray)

    def __repr__(self) -> str:
        return f"<jbt.Hits: {int(self.hit.sum())} of {len(self)}>"


def of_native(made: dict[str, Any]) -> Hits:
    """Hits from what the native module tells: a row for each hit."""
    answers = made["answers"]
    gradient = answers[:, 1:4].astype(np.float64)
    length = np.linalg.norm(gradient, axis=1, keepdims=True)
    normal = np.divide(-gradient, length, out=np.full_like(gradient, np.nan), where=length > 0) + 0.0
    attributes = {name: answers[:, first : first + width] for name, first, width in made["groups"]}
    hit = np.ones(len(made["ray"]), np.bool_)
    return Hits(made["ray"], hit, made["t"], made["position"], normal, made["entering"], attributes)


def by_ray(hits: Hits, count: int) -> Hits:
    """At most one hit for each ray, as a row for each ray."""

    def spread(values: NDArray[Any]) -> NDArray[Any]:
        whole = np.full((count, *values.shape[1:]), np.nan, values.dtype)
        whole[hits.ray] = values
        return whole

    hit, entering = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    hit[hits.ray] = True
    entering[hits.ray] = hits.entering
    attributes = {name: spread(values) for name, values in hits.attributes.items()}
    rays = np.arange(count, dtype=np.uint64)
    return Hits(rays, hit, spread(hits.t), spread(hits.position), spread(hits.normal), entering, attributes)


@dataclass(eq=False, repr=False)
class Owners:
    """The leaf that decides the field at each point.

    Attributes:
        leaf: its number, the same for the same leaf; -1 where nobody decides.
        particle: which of the particles of the leaf it is; 0 of others, -1 where nobody decides.
        share: its part of the weight, up to 1; less than 1 where fields blend.
        path: the way to it from the root, as "0.union/0.color/0.point"; None for nobody.
        line: the line of its text, from 1; 0 if the model came from none.
        constants: the constants that it has, by name; empty for nobody.
    """

    leaf: NDArray[np.int64]
    particle: NDArray[np.int64]
    share: Doubles
    path: list[str | None]
    line: NDArray[np.int64]
    constants: list[dict[str, str | int]]

    def __len__(self) -> int:
        return len(self.leaf)

    def __repr__(self) -> str:
        return f"<jbt.Owners of {len(self)} points>"


@dataclass(eq=False, repr=False)
class Weights:
    """How much each leaf, or what has a name, has to say at each point.

    Attributes:
        names: the way to each leaf from the root, as "0.union/0.point", or the names that were asked for.
        values: (n, len(names)), from 0 to 1: the coefficients by which attributes mix.
        default: (n,), the weight of nobody, which is that of an attribute's default: 1 where no leaf decides.
    """

    names: tuple[str, ...]
    values: Floats
    default: Floats

    def __getitem__(self, name: str) -> Floats:
        if name not in self.names:
            raise KeyError(f"{name}: there are {', '.join(self.names)}")
        column: Floats = self.values[:, self.names.index(name)]
        return column

    def __len__(self) -> int:
        return len(self.default)

    def __repr__(self) -> str:
        return f"<jbt.Weights of {', '.join(self.names)} at {len(self)} points>"
