"""Evaluates a scene at the points of a CSV file in f64, by the rules of docs/."""

import argparse
import csv
import sys

import numpy as np

from blobtree import programs
from blobtree.evaluate import evaluate
from blobtree.text import read


def columns(scene, answer):
    """The columns of an answer, as `jbt eval` names them."""
    found = {"field": answer["field"]}
    for k, name in enumerate(("gx", "gy", "gz")):
        found[name] = answer["gradient"][:, k]
    for group in scene.groups.values():
        for k in range(group.width):
            found[channel(group.name, group.width, k)] = answer[group.name][:, k]
    return found


def channel(name, width, k):
    if width == 1:
        return name
    letters = "rgba" if name == "color" else "xyzw"
    return f"{name}.{letters[k]}" if width <= 4 else f"{name}.{k}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--points", required=True)
    parser.add_argument("-D", dest="settings", action="append", default=[])
    args = parser.parse_args()
    settings = {k: float(v) for k, v in (s.split("=") for s in args.settings)}
    text = open(args.scene).read()
    scene = programs.read(text) if args.scene.endswith(".vm") else read(text, settings)
    with open(args.points) as file:
        points = np.array([[float(row[k]) for k in "xyz"] for row in csv.DictReader(file)])
    answer = columns(scene, evaluate(scene, points))
    writer = csv.writer(sys.stdout)
    writer.writerow(["x", "y", "z", *answer])
    for i, point in enumerate(points):
        writer.writerow([*point, *(float(column[i]) for column in answer.values())])


if __name__ == "__main__":
    main()
