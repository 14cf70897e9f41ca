"""Whether jbt reads files of other programs as those who wrote the samples found them to be.

Asks a jbt binary for the answers at the points of every table (`*.oracle.csv`) of the samples, files of POV-Ray, RenderMan,
three-js-blobtree, BRL-CAD, of molecules and of particles. Tables were computed in f64, from descriptions of the formats.
Prints a line for each table: the worst errors, over one more than the size of what is asked for, and how many sides are wrong.

* fields within 5e-6 (1 + |f|), gradients within 5e-5 (1 + |g|), colours and temperature factors within 5e-6;
* for solids, `field >= iso` exactly where the table says inside; colours where it has one;
* what `expected.json` of a folder tells: atoms and elements, centroids, boxes, volumes within four sigma, errors;
* a structure as PDB and as mmCIF is one model.

    outside/samples.py [JBT] [--samples FOLDER] [--only NAME]

The samples are no part of the project. Without --samples they are in the folder that JBT_SAMPLES names, or in shared/samples
beside the project; where there are none, this says so and ends well.
"""

import argparse
import collections
import csv
import io
import json
import math
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ["particles", "pov", "threejs", "rib", "brlcad"]
FIELD, GRADIENT, COLOR = 5e-6, 5e-5, 5e-6
# The columns of linear colours.
COLORS = {"particles": "lr lg lb", "pov": "r g b", "threejs": "lr lg lb", "rib": "r g b", "brlcad": "lr lg lb"}
# In the library what a difference takes away gives its colour too.
UNCOLORED = {"difference.json"}
# Volumes of the samples were found by random points: four sigma are one in 16,000.
SIGMAS = 4


def skip(reason):
    """Notes for the last line of .ci/run what could not be asked."""
    print(f"skipped: {reason}")
    if notes := os.environ.get("JBT_SKIPPED"):
        with open(notes, "a", encoding="utf-8") as file:
            file.write(f"{reason}\tsamples.py\n")


class Judge:
    def __init__(self, jbt):
        self.jbt, self.checks, self.failures = jbt, 0, []

    def check(self, fine, file, what):
        self.checks += 1
        if not fine:
            self.failures.append(f"{file}: {what}")
            print(f"FAILED  {file}: {what}")

    def run(self, *words, text=None):
        return subprocess.run([str(self.jbt), *map(str, words)], input=text, capture_output=True, text=True, check=False)

    def told(self, *words, text=None):
        """What a command prints, which has to succeed."""
        ran = self.run(*words, text=text)
        if ran.returncode != 0:
            raise SystemExit(f"jbt {' '.join(map(str, words))}\n{ran.stderr}")
        return ran.stdout

    def rows(self, *words, text=None):
        return list(csv.DictReader(io.StringIO(self.told(*words, text=text))))


def subjects(table, files):
    """The files that a table is about, and the options that its name asks for."""
    stem = table.name.removesuffix(".oracle.csv")
    # A table is called like its file, and then by object or form. The ending is there where two files differ.
    heads = {(head, path) for path in files for head in (path.name, path.stem) if stem == head or stem.startswith(head + ".")}
    longest = max((head for head, _ in heads), key=len)
    rest = stem.removeprefix(longest).removeprefix(".")
    return [(path, meant(table.parent.name, rest) if rest else []) for head, path in sorted(heads) if head == longest]


def meant(folder, rest):
    if folder != "particles":
        return ["--object", rest]
    if rest.startswith("R"):
        # The support of a soft point is two radii.
        return ["--radius", str(float(rest[1:]) / 2)]
    return ["--form", rest]


def numbers(row, names):
    return [float(row[name]) for name in names if name in row]


def off(found, expected):
    return max((abs(a - b) for a, b in zip(found, expected)), default=0.0)


def table_line(judge, table, path, options):
    """Compares all answers of a file at the points of a table, and prints its line."""
    folder, scene = table.parent.name, [path, *options]
    with table.open(encoding="utf-8") as file:
        expected = list(csv.DictReader(file))
    found = judge.rows("eval", "-q", *scene, "--points", table, "--query", "all", "-o", "-")
    judge.check(len(found) == len(expected) > 50, table.name, f"{len(found)} answers to {len(expected)} points")
    worst = collections.Counter()
    iso = json.loads(judge.told("check", *scene, "--json"))["files"][0]["model"]["iso"]
    reached = reached_by_negative(judge, scene, table, found) if folder == "pov" else [False] * len(found)
    for answer, row, is_reached in zip(found, expected, reached):
        is_colored = path.name not in UNCOLORED and not is_reached
        compare(worst, answer, row, iso, COLORS[folder].split() if is_colored else [])
    name = f"{path.name} {options[-1] if options else ''}"
    for what, limit in [("field", FIELD), ("gradient", GRADIENT), ("colour", COLOR), ("bfac", COLOR), ("sides", 0)]:
        judge.check(worst[what] <= limit, name, f"{what} is off by {worst[what]:.2g}, and may be by {limit}")
    shown = [f"{worst[what]:9.1e}" if what in worst else f"{'-':>9}" for what in ("field", "gradient", "colour", "bfac")]
    sides = f"{worst['judged']}, {worst['sides']} wrong"
    print(f"{name:34} {len(found):6} {' '.join(shown)}  {sides}")


def reached_by_negative(judge, scene, table, found):
    """The points where a component of negative strength reaches, to which POV-Ray gives its colour too: with its strength
    turned round, the field is another one there."""
    text = judge.told("convert", "-q", *scene, "-o", "-")
    if "strength -" not in text:
        return [False] * len(found)
    text = text.replace("strength -", "strength ")
    turned = judge.rows("eval", "-q", "-", "--points", table, "--query", "all", "-o", "-", text=text)
    return [answer["field"] != other["field"] for answer, other in zip(found, turned, strict=True)]


def compare(worst, answer, row, iso, colors):
    """Keeps the largest errors of one point."""
    field = float(answer["field"])
    inside = row["inside"] == "1" if "inside" in row else float(row["field"]) >= iso
    worst["judged"] += 1
    worst["sides"] += (field >= iso) != inside
    if "field" in row:
        value = float(row["field"])
        worst["field"] = max(worst["field"], abs(field - value) / (1 + abs(value)))
        slopes = numbers(row, ["gx", "gy", "gz"])
        error = off(numbers(answer, ["gx", "gy", "gz"]), slopes) / (1 + math.hypot(*slopes))
        worst["gradient"] = max(worst["gradient"], error)
    color = numbers(row, colors)
    has_color = inside if "inside" in row else float(row["field"]) > 0
    if color and has_color and all(map(math.isfinite, color)):
        mixed = numbers(answer, ["color.r", "color.g", "color.b"])
        worst["colour"] = max(worst["colour"], off(mixed, color) if len(mixed) == 3 else math.inf)
    if "bfac" in row and "bfac" in answer and has_color:
        value = float(row["bfac"])
        worst["bfac"] = max(worst["bfac"], abs(float(answer["bfac"]) - value) / (1 + abs(value)))


def is_refused(judge, path, *words):
    """A file that has to be an error, with its place and what it is about."""
    ran = judge.run("check", path)
    is_told = ran.returncode == 1 and all(word in ran.stderr for word in words)
    judge.check(is_told, path.name, f"exit {ran.returncode}: {ran.stderr}")


def particles(judge, folder):
    """Atoms, their elements by their radii, their middle."""
    with (folder / "elements.csv").open(encoding="utf-8") as file:
        radii = {row["symbol"].upper(): float(row["vdw_angstrom"]) for row in csv.DictReader(file)}
    for name, facts in expectations(folder).items():
        path = folder / name
        if same := facts.get("the same as"):
            told = json.loads(judge.told("diff", path, folder / same, "--json"))
            judge.check(told["same"], name, f"is not {same}: {told}")
            continue
        bare = ["--radius", "1"] if "points" in facts else []
        text = judge.told("convert", *bare, path, "-o", "-")
        places = values(text, "at")
        count = len(places) // 3
        judge.check(count == facts.get("atoms", facts.get("points")), name, f"{count} points")
        if middle := facts.get("centroid"):
            judge.check(off([sum(places[axis::3]) / count for axis in range(3)], middle) < 1e-5, name, "the middle is elsewhere")
        if left_out := facts.get("waters_left_out"):
            with_them = values(judge.told("convert", "--waters", path, "-o", "-"), "at")
            judge.check(len(with_them) // 3 == count + left_out, name, f"{len(with_them) // 3} atoms with those of water")
        sizes = collections.Counter(values(text, "surface_radius"))
        # One number stands for all.
        sizes = collections.Counter({size: count for size in sizes}) if len(sizes) == 1 else sizes
        elements = {word: number for word, number in facts.items() if word in radii}
        wanted = collections.Counter()
        for word, number in elements.items():
            wanted[radii[word]] += number
        judge.check(not elements or sizes == wanted, name, f"radii {dict(sizes)}, expected {dict(wanted)}")


def expectations(folder):
    text = (folder / "expected.json").read_text().strip()
    # One of these files lacks its first brace.
    return json.loads(text if text[0] in "{[" else "{" + text)


def values(text, name):
    """The numbers of a parameter of the printed model."""
    found = re.search(rf"\b{name} (\([-+0-9.e\s()]*\)|[-+0-9.e]+)", text)
    return [float(word) for word in re.findall(r"[-+0-9.e]+", found[1])] if found else []


def brlcad(judge, folder):
    """Boxes and volumes of objects."""
    for facts in expectations(folder):
        path = folder / facts["file"]
        if "error" in facts:
            is_refused(judge, path, "version 4", "g2asc")
            continue
        scene = [path, "--object", facts["object"]]
        what = f"{facts['file']} {facts['object']}"
        told = json.loads(judge.told("stats", *scene, "--json", "--depth", "8"))
        volume, sigma = told["volume"], facts["volume_sigma"]
        is_near = abs(volume["estimate"] - facts["volume"]) <= SIGMAS * sigma
        judge.check(is_near, what, f"the volume is {volume}, expected {facts['volume']} +- {sigma}")
        # What was found inside at random is inside of the outer bounds.
        outer, (low, high) = told["tight"]["outer"], facts["sampled_box_inside"]
        slack = [1e-4 * (abs(a) + abs(b)) for a, b in zip(low, high)]
        is_within = all(outer[axis] <= low[axis] + slack[axis] and high[axis] <= outer[3 + axis] + slack[axis] for axis in range(3))
        judge.check(is_within, what, f"{low} .. {high} is not within {outer}")


def facts(judge, folder):
    """What is known of files beside the tables."""
    if folder.name == "particles":
        particles(judge, folder)
    elif folder.name == "brlcad":
        brlcad(judge, folder)
    elif folder.name == "rib":
        is_refused(judge, folder / "blobplane.rib", "9000", "dbo_plane", ":20:")
        expected = expectations(folder)["iso"]
        told = json.loads(judge.told("check", folder / "first.rib", "--json"))
        judge.check(told["files"][0]["model"]["iso"] == expected, "first.rib", "has another iso-value")
    elif folder.name == "threejs":
        is_refused(judge, folder / "sdf_segment.json", "DistanceFunctor")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("jbt", nargs="?", type=pathlib.Path, default=ROOT / "target/release/jbt")
    beside = ROOT / os.environ.get("JBT_SAMPLES", "../shared/samples")
    parser.add_argument("--samples", type=pathlib.Path, metavar="FOLDER", default=beside, help="the folder with all samples")
    parser.add_argument("--only", metavar="NAME", help="tables and files of this folder")
    arguments = parser.parse_args()
    judge, tables = Judge(arguments.jbt), 0
    print(f"{'file':34} {'points':>6} {'field':>9} {'gradient':>9} {'colour':>9} {'bfac':>9}  sides")
    for name in FOLDERS if arguments.only is None else [arguments.only]:
        folder = arguments.samples / name
        if not folder.is_dir():
            skip(f"there is no folder {name} in the samples: set JBT_SAMPLES")
            continue
        found = sorted(folder.glob("*.oracle.csv"))
        files = [path for path in folder.iterdir() if not path.name.endswith(".oracle.csv")]
        for table in found:
            for path, options in subjects(table, files):
                table_line(judge, table, path, options)
        tables += len(found)
        facts(judge, folder)
    print(f"{tables} tables, {judge.checks} checks, {len(judge.failures)} failed")
    return 1 if judge.failures else 0


if __name__ == "__main__":
    sys.exit(main())
