"""Two balls that grow together: a model, its answers, its mesh, its picture.

python examples/peanut.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import jbt
import numpy as np


def main(folder: Path) -> None:
    orange = jbt.point((0, 0.4, 0), radius=1, color=(1, 0.6, 0.1))
    blue = jbt.point((0, -0.4, 0), radius=1, color=(0.1, 0.4, 1))
    peanut = orange + blue

    # A model is its text, which `jbt mesh peanut.jbt` reads, too.
    (folder / "peanut.jbt").write_text(str(peanut))

    # Field, gradient and colour at points come out of one evaluation of each primitive.
    answers = peanut.compile()(np.array([[0.0, 0.1, 0.0], [0.3, 0.0, 0.0]]))
    print("field   ", answers.field)
    print("gradient", answers.gradient.tolist())
    print("colour  ", answers.color.tolist())

    mesh = peanut.mesh(resolution=128)
    mesh.save(folder / "peanut.glb")
    print(mesh, f"volume {mesh.volume:.4f}, the solid has {peanut.volume:.4f}")

    (folder / "peanut.png").write_bytes(jbt.png(peanut.render((480, 360))))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
