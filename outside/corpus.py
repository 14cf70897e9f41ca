"""Hashes of everything that two builds of jbt have to agree on to the bit.

    python corpus.py make JBT HASHES [--scenes 2000] [--seed N] [--samples FOLDER]
    python corpus.py compare BEFORE AFTER

`make` asks JBT for field, gradient and attributes at points (`eval`), and for a mesh (`mesh`), of random scenes
and programs, of all examples, and of every scene file below FOLDER, and writes a line for each model:

    name  hash of the answers  hash of the mesh

A model that is refused has its exit code instead of a hash: what is refused stays refused. `compare` prints the models
of which a hash differs, and its exit code is 1 if there is one.

A change of the code's shape makes both files, one with the build before it and one with the build after it.
"""

import argparse
import hashlib
import multiprocessing
import os
import pathlib
import random
import subprocess
import sys
import tempfile

import scenes

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = HERE.parent / "examples"
SAMPLES = HERE.parent.parent / "shared" / "samples"
SCENE_FILES = {".jbt", ".blob", ".scene", ".vm"}
POINTS = 64
RESOLUTION = 16
SECONDS = 120


def point_lines(seed):
    """Points of a cube, some of them far out, as a CSV file."""
    rng = random.Random(seed)
    lines = ["x,y,z"]
    for index in range(POINTS):
        size = 30.0 if index % 16 == 0 else 1.7
        lines.append(",".join(repr(rng.uniform(-size, size)) for _ in range(3)))
    return "\n".join(lines) + "\n"


def run(command, output):
    """The hash of what a command writes, or its exit code."""
    try:
        done = subprocess.run(command, capture_output=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "slow"
    if done.returncode != 0:
        return f"exit-{done.returncode}"
    return hashlib.sha256(pathlib.Path(output).read_bytes()).hexdigest()[:16]


def hashes(job):
    """The line of one model: (binary, name, path or None, text or None, seed)."""
    jbt, name, path, text, seed = job
    with tempfile.TemporaryDirectory() as folder:
        if path is None:
            path = f"{folder}/scene{'.jbt' if text.startswith('jbt') else '.vm'}"
            pathlib.Path(path).write_text(text)
        pathlib.Path(f"{folder}/points.csv").write_text(point_lines(seed))
        answers, mesh = f"{folder}/answers.csv", f"{folder}/mesh.ply"
        ask = [jbt, "eval", "-q", path, "--points", f"{folder}/points.csv", "--query", "all", "--threads", "1",
               "-o", answers]
        make = [jbt, "mesh", "-q", path, "--resolution", str(RESOLUTION), "--threads", "1", "-o", mesh]
        return f"{name} {run(ask, answers)} {run(make, mesh)}"


def jobs(arguments):
    for index in range(arguments.scenes):
        seed = arguments.seed + index
        text = scenes.program(seed) if index % 10 == 9 else scenes.scene(seed).text()
        yield arguments.jbt, f"random-{seed}", None, text, seed
    for folder in (EXAMPLES, pathlib.Path(arguments.samples)):
        for path in sorted(folder.rglob("*")):
            if path.suffix in SCENE_FILES and path.is_file():
                yield arguments.jbt, str(path.relative_to(folder)).replace(" ", "_"), str(path), None, 1


def make(arguments):
    with multiprocessing.Pool(os.cpu_count()) as pool, open(arguments.hashes, "w") as file:
        for count, line in enumerate(pool.imap(hashes, jobs(arguments), chunksize=4)):
            file.write(line + "\n")
    print(f"{count + 1} models")


def compare(arguments):
    def read(path):
        return {line.split()[0]: line.split()[1:] for line in open(path)}

    before, after = read(arguments.before), read(arguments.after)
    if before.keys() != after.keys():
        sys.exit("the files are of other models")
    wrong = [name for name in before if before[name] != after[name]]
    for name in wrong:
        print(name, *before[name], "->", *after[name])
    print(f"{len(before)} models, {len(wrong)} differ")
    sys.exit(1 if wrong else 0)


def main():
    parser = argparse.ArgumentParser()
    commands = parser.add_subparsers(required=True)
    maker = commands.add_parser("make")
    maker.add_argument("jbt")
    maker.add_argument("hashes")
    maker.add_argument("--scenes", type=int, default=2000)
    maker.add_argument("--seed", type=int, default=1_000_000)
    maker.add_argument("--samples", default=str(SAMPLES))
    maker.set_defaults(run=make)
    judge = commands.add_parser("compare")
    judge.add_argument("before")
    judge.add_argument("after")
    judge.set_defaults(run=compare)
    arguments = parser.parse_args()
    arguments.run(arguments)


if __name__ == "__main__":
    main()
