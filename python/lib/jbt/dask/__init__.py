"""Past one machine: meshes, samples, sweeps and sequences on the workers of Dask distributed.

>>> import jbt
>>> import jbt.dask  # doctest: +SKIP
>>> mesh = jbt.dask.mesh(model, cell=0.01)  # doctest: +SKIP

`docs/dask.md` tells how. What is shipped is plain bytes, which workers check: the programs of the whole
model, once, and for each brick the rows that reach it. Every worker compiles these programs once, and results
have the bits of one machine.
"""

from __future__ import annotations

from ._cloud import Cloud, files, points
from ._frames import frames
from ._mesh import mesh
from ._parts import Parts, read
from ._run import BrickError
from ._sample import sample, sample_grid
from ._sweep import sweep

__all__ = [
    "BrickError",
    "Cloud",
    "Parts",
    "files",
    "frames",
    "mesh",
    "points",
    "read",
    "sample",
    "sample_grid",
    "sweep",
]
