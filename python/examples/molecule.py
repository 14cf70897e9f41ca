"""Caffeine: a smooth surface around its atoms, a slice through it, and which atom is nearest where.

python examples/molecule.py [FOLDER]
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import jbt
import numpy as np

# Positions of atoms in angstroms, as an XYZ file has them.
CAFFEINE = """
H -3.3804130 -1.1272367  0.5733036
N  0.9668296 -1.0737425 -0.8198227
C  0.0567293  0.8527195  0.3923156
N -1.3751742 -1.0212243 -0.0570552
C -1.2615018  0.2590713  0.5234135
C -0.3068337 -1.6836331 -0.7169344
C  1.1394235  0.1874122 -0.2700900
N  0.5602627  2.0839095  0.8251589
O -0.4926797 -2.8180554 -1.2094732
C -2.6328073 -1.7303959 -0.0060953
O -2.2301338  0.7988624  1.0899730
H  2.5496990  2.9734977  0.6229590
C  2.0527432 -1.7360887 -1.4931279
H -2.4807715 -2.7269528  0.4882631
H -3.0089039 -1.9025254 -1.0498023
H  2.9176101 -1.8481516 -0.7857866
H  2.3787863 -1.1211917 -2.3743655
H  1.7189877 -2.7489920 -1.8439205
C -0.1518450  3.0970046  1.5348347
C  1.8934096  2.1181245  0.4193193
N  2.2861252  0.9968439 -0.2440298
H -0.1687028  4.0436553  0.9301094
H  0.3535322  3.2979060  2.5177747
H -1.2074498  2.7537592  1.7203047
"""

# Radii of van der Waals (Bondi 1964), in angstroms, and the usual colours of elements, as linear light.
RADII = {"H": 1.2, "C": 1.7, "N": 1.55, "O": 1.52}
COLORS = {"H": (0.9, 0.9, 0.9), "C": (0.08, 0.08, 0.08), "N": (0.03, 0.08, 0.9), "O": (0.85, 0.02, 0.02)}


def main(folder: Path) -> None:
    rows = [line.split() for line in CAFFEINE.split("\n") if line]
    elements = [row[0] for row in rows]
    places = np.array([row[1:] for row in rows], float)

    # Each atom's own surface is at its radius; sums of fields blend where atoms meet.
    atoms = [
        jbt.point(place, surface_radius=0.85 * RADII[element], falloff="wyvill", color=COLORS[element])
        for element, place in zip(elements, places, strict=True)
    ]
    molecule = jbt.ricci(atoms, exponent=4)
    mesh = molecule.mesh(cell=0.06)
    mesh.save(folder / "caffeine.glb")
    print(f"volume {mesh.volume:.1f} cubic angstroms, surface {mesh.area:.1f} square angstroms")

    # Who decides at the vertices: how many of them each element has.
    owners = molecule.owner(mesh.vertices[::10])
    names = dict(enumerate(elements))
    numbers = [int(path.split("/")[1].split(".")[0]) for path in owners.path if path]
    print("the surface belongs to", dict(Counter(names[number] for number in numbers)))

    normal = np.linalg.svd(places - places.mean(axis=0))[2]
    slice = molecule.contours([places.mean(axis=0), normal[0], normal[1]], svg=folder / "caffeine.svg")
    print(f"a slice through its plane: {slice}, {slice.area:.1f} square angstroms")
    (folder / "caffeine.png").write_bytes(jbt.png(molecule.render((480, 360), direction=(0.3, -0.4, 1))))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
