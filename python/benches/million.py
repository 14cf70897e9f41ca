"""A million particles, from arrays to a mesh; and how long the program takes for the same scene.

    python benches/million.py [PROGRAM]

PROGRAM is the binary `jbt`, if its time is wanted: it reads the same particles as a text.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import jbt
import numpy as np

COUNT = 1_000_000
RESOLUTION = 256


def main() -> None:
    rng = np.random.default_rng(1)
    xyz = rng.uniform(-1, 1, (COUNT, 3))
    begun = time.perf_counter()
    model = jbt.points(xyz, radius=0.02)
    made = time.perf_counter()
    model.compile(attributes=False)
    compiled = time.perf_counter()
    mesh = model.mesh(resolution=RESOLUTION)
    meshed = time.perf_counter()
    print(f"{COUNT:,} particles: model {made - begun:.2f} s, compiled {compiled - made:.2f} s")
    print(f"  mesh {meshed - compiled:.2f} s, in all {meshed - begun:.2f} s: {mesh}")
    if len(sys.argv) > 1:
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "particles.jbt"
            scene.write_text(str(model))
            begun = time.perf_counter()
            wanted = ["--resolution", str(RESOLUTION), "-q", "-o", f"{folder}/x.glb"]
            command = [sys.argv[1], "mesh", str(scene), *wanted]
            subprocess.run(command, check=True)
            print(f"  the program, from the text to the file: {time.perf_counter() - begun:.2f} s")


if __name__ == "__main__":
    main()
