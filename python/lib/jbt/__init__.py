"""jbt compiles BlobTrees, trees of soft implicit surfaces, to machine code: fields, colours, meshes.

>>> import jbt
>>> orange = jbt.point((0, 0.4, 0), radius=1, color=(1, 0.6, 0.1))
>>> blue = jbt.point((0, -0.4, 0), radius=1, color=(0.1, 0.4, 1))
>>> peanut = (orange + blue).twist("y", rate=0.5)
>>> mesh = peanut.mesh(resolution=64)
>>> mesh.closed, mesh.vertices.dtype, mesh.colors.shape == mesh.vertices.shape
(True, dtype('float32'), True)

`docs/python.md` tells the rest in five minutes.
"""

from __future__ import annotations

import builtins

from . import _jbt, _members
from ._contours import Contours, Loop
from ._errors import Diagnostic, LimitError, OpenMeshWarning, SceneError, SceneWarning
from ._evaluator import Answers, Comparison, Counters, Evaluator, compare_engines
from ._grid import Grid
from ._hits import Hits, Owners, Weights
from ._jbt import Falloff, Number, Pattern, Term
from ._members import *  # noqa: F403
from ._mesh import Creases, Mesh
from ._model import (
    Group,
    Measures,
    Model,
    ModelCounts,
    PointCounts,
    expression,
    load,
    loads,
    select,
)
from ._parts import COMPILER, MESH_FORMATS, SCENE_FORMATS, VIEWS, falloff_of, param, png, x, y, z
from ._points import points

__version__: str = _jbt.__version__

# `from jbt import *` takes no names of Python's own.
__all__ = [
    "COMPILER",
    "MESH_FORMATS",
    "SCENE_FORMATS",
    "VIEWS",
    "Answers",
    "Comparison",
    "Contours",
    "Counters",
    "Creases",
    "Diagnostic",
    "Evaluator",
    "Falloff",
    "Grid",
    "Group",
    "Hits",
    "LimitError",
    "Loop",
    "Measures",
    "Mesh",
    "Model",
    "ModelCounts",
    "Number",
    "OpenMeshWarning",
    "Owners",
    "Pattern",
    "PointCounts",
    "SceneError",
    "SceneWarning",
    "Term",
    "Weights",
    "compare_engines",
    "expression",
    "falloff_of",
    "load",
    "loads",
    "param",
    "png",
    "points",
    "select",
    "x",
    "y",
    "z",
]
__all__ += [name for name in _members.__all__ if not hasattr(builtins, name) and name != "ModelMembers"]
