"""A million particles, from an array to a mesh; and how long Rust takes for the same.

    python benches/million.py [PROGRAM]

PROGRAM is the binary `python_peer` of jbt-benches, if its time is wanted.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time

import jbt
import numpy as np

COUNT = 1_000_000
RADIUS = 0.02
RESOLUTION = 256


def main() -> None:
    rng = np.random.default_rng(1)
    xyz = rng.uniform(-1, 1, (COUNT, 3))
    begun = time.perf_counter()
    model = jbt.points(xyz, radius=RADIUS)
    made = time.perf_counter()
    model.compile(attributes=False)
    compiled = time.perf_counter()
    mesh = model.mesh(resolution=RESOLUTION)
    meshed = time.perf_counter()
    print(f"{COUNT:,} particles: model {made - begun:.2f} s, compiled {compiled - made:.2f} s")
    print(f"  mesh {meshed - compiled:.2f} s, in all {meshed - begun:.2f} s: {mesh}")
    if len(sys.argv) > 1:
        with tempfile.NamedTemporaryFile() as file:
            xyz.tofile(file.name)
            command = [sys.argv[1], "particles", file.name, str(RADIUS), str(RESOLUTION)]
            done = subprocess.run(command, capture_output=True, check=True)
        theirs = float(done.stdout)
        print(f"  Rust takes {theirs:.2f} s for it: {(meshed - begun) / theirs:.3f} times as long")


if __name__ == "__main__":
    main()
