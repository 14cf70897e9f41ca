"""The surface of 50,000 particles of a fluid, from arrays, with the speed as an attribute of its own.

python examples/particles.py [FOLDER]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import jbt
import numpy as np
from numpy.typing import NDArray


def splash(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places and speeds of particles: a drop, the crown that it throws up, and a pool."""
    rng = np.random.default_rng(20)
    angle = rng.uniform(0, 2 * np.pi, count)
    part = rng.uniform(0, 1, count)
    # The crown: a wall that leans outwards, with waves on its rim.
    height = 0.7 * part * (1 + 0.25 * np.sin(9 * angle)) ** 2
    distance = 0.9 + 0.4 * height + rng.normal(0, 0.02, count)
    crown = np.column_stack([distance * np.cos(angle), distance * np.sin(angle), height])
    pool = np.column_stack([rng.uniform(-1.6, 1.6, (count, 2)), rng.uniform(-0.15, 0, count)])
    drop = rng.normal(0, 0.09, (count, 3)) + [0, 0, 0.9]
    kind = rng.choice(3, count, p=[0.45, 0.5, 0.05])[:, None]
    places = np.where(kind == 0, crown, np.where(kind == 1, pool, drop))
    speed = np.where(kind[:, 0] == 0, 0.4 + height, np.where(kind[:, 0] == 1, 0.1, 1.0))
    return places, speed


def main(folder: Path) -> None:
    places, speed = splash(50_000)
    slow, fast = np.array([0.02, 0.12, 0.35]), np.array([0.75, 0.9, 1.0])
    part = np.clip(speed, 0, 1)[:, None]

    begun = time.perf_counter()
    fluid = jbt.points(places, radius=0.075, color=(1 - part) * slow + part * fast)
    made = time.perf_counter()
    mesh = fluid.mesh(cell=0.015, progress=lambda done: print(f"\r{done:4.0%}", end=""))
    meshed = time.perf_counter()
    print(f"\rmodel {made - begun:.2f} s, mesh {meshed - made:.2f} s: {mesh}")
    mesh.save(folder / "splash.ply")
    (folder / "splash.png").write_bytes(jbt.png(fluid.render((480, 360), direction=(1, -0.6, 0.7))))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
