"""What goes wrong: exceptions that say where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Diagnostic:
    """A message about a model.

    Attributes:
        severity: "error", "warning" or "limit".
        file: the name of the text, if the model came from one.
        line: the line in it, from 1.
        column: the column in the line, from 1.
        message: what is wrong, with the numbers in it.
        hint: what was expected instead, or what to do.
    """

    severity: str
    file: str | None
    line: int | None
    column: int | None
    message: str
    hint: str | None


class SceneError(ValueError):
    """A scene or model is wrong. Its text shows each place with a caret; `diagnostics` has the parts.

    >>> import jbt
    >>> try:
    ...     jbt.loads("jbt 1\\npoint { radius 1 } }")
    ... except jbt.SceneError as error:
    ...     print(error)
    ...     print(error.diagnostics[0].line, error.diagnostics[0].column)
    <text>:2:20: error: unexpected `}`
      2 | point { radius 1 } }
        |                    ^ no block is open here
    2 20
    """

    def __init__(self, text: str, diagnostics: tuple[Diagnostic, ...] = ()) -> None:
        super().__init__(text)
        self.diagnostics = diagnostics

    @classmethod
    def _of(cls, text: str, rows: list[tuple[Any, ...]]) -> SceneError:
        """Made by the native module, of tuples."""
        return cls(text, tuple(Diagnostic(*row) for row in rows))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.diagnostics)


class LimitError(ValueError):
    """The task is larger than a limit allows, or than this machine has room for."""


class OpenMeshWarning(UserWarning):
    """The region cuts the surface: the mesh is open there. To refuse such meshes,
    `warnings.simplefilter("error", jbt.OpenMeshWarning)`."""


class SceneWarning(UserWarning):
    """Something in a file is odd, and was read as best it could be."""
