"""The field of a gyroid on a grid, as an xarray.Dataset with coordinates: slices, means, distances by label.

python examples/grid.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import jbt
import numpy as np
from jbt import cos, sin, x, y, z


def main(folder: Path) -> None:
    # A gyroid whose walls grow thicker with height, in a box.
    thickness = jbt.param("thickness", 0.3)
    gyroid = sin(3 * x) * cos(3 * y) + sin(3 * y) * cos(3 * z) + sin(3 * z) * cos(3 * x)
    walls = jbt.expression(0.5 + thickness * (1.5 + z) - abs(gyroid), within=[(-1, -1, -1), (1, 1, 1)])

    grid = walls.sample(resolution=96, gradient=True)
    print(grid)
    dataset = grid.to_xarray()
    print(dataset)

    inside = dataset["field"] >= walls.iso
    filled = inside.mean(dim=["x", "y"])
    print("filled at three heights:", filled.sel(z=[-0.8, 0, 0.8], method="nearest").round(3).values)
    slope = np.sqrt(dataset["gx"] ** 2 + dataset["gy"] ** 2 + dataset["gz"] ** 2)
    print("the field's mean slope inside:", round(float(slope.where(inside).mean()), 3))
    np.save(folder / "gyroid.npy", dataset["field"].sel(z=0, method="nearest").values)
    (folder / "gyroid.png").write_bytes(jbt.png(walls.render((480, 360))))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
