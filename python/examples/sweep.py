"""A parameter sweep: how volume and area of a bottle follow two of its numbers. Nothing is compiled twice.

python examples/sweep.py [FOLDER]
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import jbt
import numpy as np


def bottle() -> jbt.Model:
    """A hollow bottle, whose belly and neck are parameters."""
    belly, neck = jbt.param("belly", 0.6), jbt.param("neck", 0.2)
    body = jbt.round_cone((0, 0, 0), (0, 0, 0.9), belly / 2, neck / 2, surface_radius=0.1)
    throat = jbt.cylinder((0, 0, 0.8), (0, 0, 1.6), neck / 2, surface_radius=0.1)
    hollow = jbt.segment((0, 0, -0.1), (0, 0, 2), surface_radius=neck / 3)
    return jbt.smooth_union(body, throat, width=0.3) - hollow


def main(folder: Path) -> None:
    model = bottle()
    model.mesh(resolution=64)
    programs = jbt.COMPILER.programs
    with open(folder / "bottle.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["belly", "neck", "volume", "area"])
        for belly in np.linspace(0.4, 0.9, 5):
            for neck in (0.15, 0.25):
                mesh = model.with_parameters(belly=belly, neck=neck).mesh(resolution=64)
                table.writerow([f"{belly:.3f}", neck, f"{mesh.volume:.4f}", f"{mesh.area:.4f}"])
    print((folder / "bottle.csv").read_text())
    print(f"{jbt.COMPILER.programs - programs} programs were compiled for the sweep")

    # The same for a point: an evaluator takes new values while it is in use.
    ev = model.compile(gradient=False, attributes=False)
    for neck in (0.15, 0.25):
        ev.update(neck=neck)
        print(f"neck {neck}: field {ev([[0.2, 0, 0.7]]).field[0]:.4f}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
