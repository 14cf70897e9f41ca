"""Compares `jbt eval` with the evaluator of this folder over random scenes.

    python agree.py JBT [--scenes 300] [--seed N] [--points 200] [--first 5]

Both get the same points, rounded to f32. An answer may be off by

    tolerance * scale + SHIFT * change + rough,

where scale is the largest value of its kind on the way to the answer (of the fields, or of the gradients, of
all nodes at that point, at least 1; of attributes their own size), change is how much the answer changes
within STEP of the point, as f32 answers are those of a place nearby, and rough how much it changes where
results of formulas are rounded to f32. Tolerances are those of TOLERANCE and ATTRIBUTE, and CURVES in scenes
with Bezier or Catmull-Rom curves, of which the docs promise less.

A point is left out for a quantity where a decision is near: where the second difference of the quantity over
STEP, along one of some directions, or what rounding of formulas changes, is more than CREASE * scale; for a
gradient also where the nearest place of a skeleton is hard to tell; for attributes where the field of a node
is 0 but for rounding, or two leaves are nearly even in a dominant group.

Exit code 1 where anything disagrees.
"""

import argparse
import csv
import io
import subprocess
import sys
import tempfile
import time

import numpy as np

import scenes
from blobtree import programs
from blobtree.evaluate import evaluate
from blobtree.formulas import Rounding
from blobtree.text import read
from evaluator import columns

STEP = 1e-5
BACK = 0.7      # steps back are shorter, so that a crease at the point itself is seen
TOLERANCE = {"field": 1e-5, "gradient": 2e-5}
ATTRIBUTE = 1e-4
CURVES = {"field": 1e-4, "gradient": 1e-3}
SHIFT = 0.3
CREASE = 1e-4

DIRECTIONS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, -0.5, 0.62], [-0.55, -0.6, 0.58]])


def is_scene(text):
    return text.startswith("jbt")


def read_any(text, settings=None):
    return read(text, settings) if is_scene(text) else programs.read(text)


def set_parameters(scene, rng):
    """Other values for some of the parameters, as `-D` sets them."""
    return {name: round(value * rng.uniform(0.9, 1.1), 3) for name, value in scene.params.items()
            if rng.random() < 0.4}


def sample_points(scene, count, rng):
    """Half of them near the surface, a quarter where the field is not 0, a quarter anywhere."""
    wide = rng.uniform(-1.7, 1.7, (4 * count, 3))
    narrow = rng.uniform(-0.9, 0.9, (4 * count, 3))
    cloud = np.concatenate([wide, narrow])
    field = evaluate(scene, cloud)["field"]
    inside, outside = cloud[field >= scene.iso], cloud[field < scene.iso]
    found = []
    if len(inside) and len(outside):
        want = count // 2
        a = inside[rng.integers(len(inside), size=want)]
        b = outside[rng.integers(len(outside), size=want)]
        for _ in range(10):
            middle = 0.5 * (a + b)
            keep = (evaluate(scene, middle)["field"] >= scene.iso)[:, None]
            a, b = np.where(keep, middle, a), np.where(keep, b, middle)
        found.append(a + rng.normal(0, 0.02, a.shape))
    active = cloud[(field != 0) & np.isfinite(field)]
    if len(active):
        found.append(active[rng.permutation(len(active))[:count // 4]])
    missing = count - sum(len(x) for x in found)
    found.append(wide[rng.permutation(len(wide))[:missing]])
    return np.float32(np.concatenate(found)).astype(float)


def ask(jbt, text, points, settings):
    """The columns of `jbt eval`."""
    with tempfile.TemporaryDirectory() as folder:
        name = "scene.jbt" if is_scene(text) else "scene.vm"
        with open(f"{folder}/{name}", "w") as file:
            file.write(text)
        with open(f"{folder}/points.csv", "w") as file:
            file.write("x,y,z\n")
            for p in points:
                file.write(",".join(repr(float(v)) for v in p) + "\n")
        command = [jbt, "eval", "-q", f"{folder}/{name}", "--points", f"{folder}/points.csv",
                   "--query", "all", "-o", f"{folder}/out.csv"]
        for name, value in settings.items():
            command += ["-D", f"{name}={value}"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr.strip()[:500])
        with open(f"{folder}/out.csv") as file:
            rows = list(csv.reader(io.StringIO(file.read())))
    values = np.array(rows[1:], float)
    return {name: values[:, k] for k, name in enumerate(rows[0])}


def kind_of(name):
    if name == "field":
        return "field"
    if name in ("gx", "gy", "gz"):
        return "gradient"
    return name.split(".")[0]


class Judgement:
    """What one scene gave: for each kind, answers compared and left out, and the worst error."""

    def __init__(self):
        self.compared = {}
        self.left = {}
        self.silent = {}
        self.worst = {}
        self.ratio = {}
        self.faults = []        # (name of the quantity, point, theirs, ours, allowed)
        self.columns = None

    def count(self, table, kind, n):
        table[kind] = table.get(kind, 0) + n


def judge(jbt, text, points, settings):
    settings = {name: value for name, value in settings.items() if f"param {name} " in text}
    scene = read_any(text, settings)
    theirs = ask(jbt, text, points, settings)
    n = len(points)
    size = STEP * (1.0 + np.abs(points).max(1, keepdims=True))
    shifted = [points]
    for direction in DIRECTIONS:
        shifted += [points + size * direction, points - BACK * size * direction]
    answer = evaluate(scene, np.concatenate(shifted))
    ours = columns(scene, answer)
    Rounding.on = True
    rounded = columns(scene, evaluate(scene, points))
    Rounding.on = False
    scale_f = np.maximum(1.0, answer["scale"].reshape(-1, n).max(0))
    scale_g = np.maximum(1.0, answer["slope"].reshape(-1, n).max(0))
    doubt = answer["doubt"].reshape(-1, n).any(0)
    hard = answer["hard"].reshape(-1, n).any(0)
    # The page of skeletons promises less of curves.
    curves = "bezier" in text or "catmull_rom" in text
    result = Judgement()
    if list(ours) != [name for name in theirs if name not in "xyz"]:
        result.columns = (list(theirs), list(ours))
    left_any = np.zeros(n, bool)
    for name, values in ours.items():
        if name not in theirs:
            continue
        values = values.reshape(-1, n)
        here = values[0]
        known = np.isfinite(values).all(0)
        scale = {"field": scale_f, "gradient": scale_g}.get(kind_of(name), np.maximum(1.0, np.abs(here)))
        plus, minus = values[1::2], values[2::2]
        crease = np.abs(BACK * (plus - here) + (minus - here)).max(0)
        change = np.maximum(np.abs(plus - here), np.abs(minus - here)).max(0)
        rough = np.abs(rounded[name] - here)
        crease = np.maximum(crease, rough)
        with np.errstate(invalid="ignore"):
            decision = crease > CREASE * scale
            error = np.abs(theirs[name] - here)
            tolerance = (CURVES if curves else TOLERANCE).get(kind_of(name), ATTRIBUTE)
            allowed = tolerance * scale + SHIFT * change + rough
        if kind_of(name) not in ("field", "gradient"):
            decision |= doubt
        if kind_of(name) == "gradient":
            decision |= hard
        compare = known & ~decision
        bad = compare & ~(error <= allowed)
        kind = kind_of(name)
        result.count(result.compared, kind, int(compare.sum()))
        result.count(result.left, kind, int((known & decision).sum()))
        result.count(result.silent, kind, int((~known).sum()))
        left_any |= decision
        if compare.any():
            good = compare & ~bad
            if good.any():
                worst = float((error / scale)[good].max())
                result.worst[kind] = max(result.worst.get(kind, 0.0), worst)
                ratio = float((error / allowed)[good].max())
                result.ratio[kind] = max(result.ratio.get(kind, 0.0), ratio)
        for i in np.flatnonzero(bad):
            result.faults.append((name, points[i], theirs[name][i], here[i], allowed[i]))
    return result


def reduce(jbt, scene, points, settings, kinds, budget=250):
    """A smaller scene in which the same kind of quantity disagrees."""
    def fails(candidate):
        try:
            found = judge(jbt, candidate.text(), points, settings)
        except Exception:
            return False
        return any(kind_of(fault[0]) in kinds for fault in found.faults)

    def trees(candidate):
        return [tree for _, tree in candidate.lets] + [candidate.root]

    def copy(candidate):
        return scenes.SceneText(list(candidate.statements), [(n, t.copy()) for n, t in candidate.lets],
                                candidate.root.copy())

    def paths(tree, path=()):
        yield path
        for k, child in enumerate(tree.children):
            yield from paths(child, path + (k,))

    def at(tree, path):
        for k in path:
            tree = tree.children[k]
        return tree

    def candidates(current):
        for index, tree in enumerate(trees(current)):
            for path in paths(tree):
                node = at(tree, path)
                for k in range(len(node.children)):
                    new = copy(current)
                    target = at(trees(new)[index], path)
                    child = target.children[k]
                    target.head, target.children, target.fixed = child.head, child.children, child.fixed
                    yield new
                if node.head.startswith("use "):
                    new = copy(current)
                    target = at(trees(new)[index], path)
                    part = dict(new.lets)[node.head[4:]].copy()
                    target.head, target.children, target.fixed = part.head, part.children, part.fixed
                    yield new
                if not node.fixed and len(node.children) > 1:
                    for k in range(len(node.children)):
                        new = copy(current)
                        del at(trees(new)[index], path).children[k]
                        yield new
        for k in range(len(current.statements)):
            new = copy(current)
            del new.statements[k]
            yield new

    tried, progress = 0, True
    while progress and tried < budget:
        progress = False
        for candidate in candidates(scene):
            tried += 1
            if tried > budget:
                break
            if len(candidate.text()) <= len(scene.text()) * 1.5 and candidate.text() != scene.text():
                if size_of(candidate) < size_of(scene) and fails(candidate):
                    scene, progress = candidate, True
                    break
    return scene


def size_of(scene):
    text = scene.text()
    return (text.count("{"), len(text))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("jbt")
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--points", type=int, default=200)
    parser.add_argument("--first", type=int, default=5, help="how many disagreements are reduced and printed")
    parser.add_argument("--list", action="store_true", help="a line for each scene that disagrees")
    parser.add_argument("--screen-colours", action="store_true", help="also colours as screens have them")
    args = parser.parse_args()

    began = time.time()
    totals = {"compared": {}, "left": {}, "silent": {}}
    worst, ratio = {}, {}
    failed, errors, shown = 0, 0, 0
    for number in range(args.seed, args.seed + args.scenes):
        # Every tenth is a program of instructions.
        made = scenes.scene(number, screen=args.screen_colours) if number % 10 else None
        text = made.text() if made else scenes.program(number)
        rng = np.random.default_rng(number)
        try:
            settings = set_parameters(read_any(text), rng)
            points = sample_points(read_any(text, settings), args.points, rng)
            result = judge(args.jbt, text, points, settings)
        except Exception as error:
            errors += 1
            print(f"scene {number}: {type(error).__name__}: {error}")
            continue
        for name, table in totals.items():
            for kind, n in getattr(result, name).items():
                table[kind] = table.get(kind, 0) + n
        for kind, value in result.worst.items():
            worst[kind] = max(worst.get(kind, 0.0), value)
        for kind, value in result.ratio.items():
            ratio[kind] = max(ratio.get(kind, 0.0), value)
        if result.columns:
            print(f"scene {number}: columns {result.columns}")
        if not result.faults:
            continue
        failed += 1
        kinds = sorted({kind_of(fault[0]) for fault in result.faults})
        if args.list:
            print(f"scene {number}: {len(result.faults)} answers disagree: {', '.join(kinds)}")
        if shown < args.first:
            shown += 1
            focus = {"field"} if "field" in kinds else set(kinds)
            small = reduce(args.jbt, made, points, settings, focus).text() if made else text
            faults = judge(args.jbt, small, points, settings).faults
            faults = [f for f in faults if kind_of(f[0]) in focus]
            print(f"--- scene {number}: {len(result.faults)} answers disagree ({', '.join(kinds)}); reduced:")
            print(small)
            for name, value in settings.items():
                print(f"    -D {name}={value}")
            for name, point, theirs, ours, allowed in faults[:3]:
                place = " ".join(repr(float(v)) for v in point)
                print(f"    {name} at {place}: binary {theirs:.7g}, here {ours:.7g}, allowed {allowed:.1g}")
    print(f"{'quantity':10} {'compared':>9} {'left out':>9} {'':>7} {'silent':>8} {'worst error':>12} "
          f"{'of allowed':>10}")
    for kind in totals["compared"]:
        n, left = totals["compared"][kind], totals["left"][kind]
        share = 100.0 * left / max(1, n + left)
        print(f"{kind:10} {n:9} {left:9} {share:6.2f}% {totals['silent'][kind]:8} "
              f"{worst.get(kind, 0.0):12.2e} {ratio.get(kind, 0.0):10.2f}")
    print(f"{args.scenes} scenes from seed {args.seed}, {args.points} points each, "
          f"{time.time() - began:.0f} s: {failed} disagree, {errors} could not be asked")
    return 1 if failed or errors else 0


if __name__ == "__main__":
    sys.exit(main())
