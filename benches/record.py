#!/usr/bin/env python3
"""Keeps records of `compare`, and the table of one of them in README.md.

    record.py run [ARGUMENT ...]     builds and runs `compare --json ARGUMENT ...`, and writes benches/record/<cpu>/<date>.csv
    record.py table [RECORD.csv]     writes the table of a record (the newest one, if none is named) into README.md
    record.py check                  fails if README.md's table is not that of the record which it names

A record is a CSV file: comments (`# command: ...`, `# cpu: ...`, `# rustc: ...`, `# commit: ...`), a row of names, and a row for
each line of JSON; `compare --help` says what the keys are. <cpu> names the model and its best instruction set, or the one that
`--level` or JBT_LEVEL asks for, so that numbers of different CPUs and levels are in different folders; <date> is that of the run, in UTC. A second run on a day replaces the first.

The table stands in README.md between `<!-- benches:begin -->` and `<!-- benches:end -->`. It has one row for each case, or for each
of its works where the column `of` names some: of several rows the largest of those that most contestants took part in.

Exit codes: 0 fine; 1 what was asked for failed, or a contestant disagreed (the record is written all the same); 2 usage.
"""

import argparse
import csv
import datetime
import io
import json
import os
import platform
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RECORDS = ROOT / "benches" / "record"
README = ROOT / "README.md"
BEGIN, END = "<!-- benches:begin -->", "<!-- benches:end -->"

CARGO = ["cargo", "run", "--release", "-p", "jbt-benches", "--features", "peers", "--bin", "compare", "--", "--json"]

# Other contestants than ours, the limit and fidget, in the order in which they are named.
OTHERS = ["searched", "whole", "one_thread", "apart", "lanes", "splashsurf", "walk", "separate"]
CONTESTANTS = ["ours", "limit", "fidget_jit", "fidget_vm", *OTHERS]

# Columns of a record: these first and in this order, then any others by name, then the check.
FIRST = ["case", "what", "of", "primitives", "points", "unit"]
FIRST += [name + suffix for name in CONTESTANTS for suffix in ("_ns", "_form")]
FIRST += ["ratio_limit", "ratio_fidget", "ratio_threads", "ratio_machine"]
LAST = ["checksum"]


class Failure(Exception):
    """What was asked for cannot be done, in words for people."""


# The CPU


def cpu(cpuinfo, machine, bound=None):
    """A description of the CPU and the name of its folder, from the text of /proc/cpuinfo (or ""), the machine's architecture, and the
    instruction set that was asked for, if one was."""
    fields = {}
    for line in cpuinfo.splitlines():
        name, _, value = line.partition(":")
        fields.setdefault(name.strip(), value.strip())
    model = fields.get("model name") or fields.get("CPU implementer") or "unknown"
    numbers = []
    for words in (("cpu family", "family"), ("model", "model"), ("CPU part", "part")):
        if words[0] in fields:
            numbers.append(f"{words[1]} {fields[words[0]]}")
    level = bound or instruction_set(set(fields.get("flags", "").split()), machine)
    return f"{model} ({', '.join([*numbers, level])})", slug(" ".join([model, *numbers, level]))


def instruction_set(flags, machine):
    """The best instruction set that the hand-written programs can use; of other machines than x86-64, the architecture."""
    if machine.lower() not in ("x86_64", "amd64"):
        return machine or "unknown"
    if {"avx2", "fma"} <= flags:
        return "avx512" if "avx512f" in flags else "avx2"
    return "sse2"


def slug(text):
    """A name for a folder: lower-case letters, digits, single hyphens."""
    text = re.sub(r"\((r|tm)\)", " ", text.lower())
    return re.sub(r"[^a-z0-9]+", "-", text).strip("-")


def this_cpu(bound=None):
    """The description and the folder's name of the CPU that this runs on, bounded to an instruction set or not."""
    path = Path("/proc/cpuinfo")
    return cpu(path.read_text() if path.exists() else "", platform.machine(), bound)


def bound(arguments, environment):
    """The instruction set that arguments of `compare` or the environment ask for, if they do."""
    for place, argument in enumerate(arguments):
        name, _, value = argument.partition("=")
        if name == "--level":
            return value or next(iter(arguments[place + 1 :]), None)
    return environment.get("JBT_LEVEL") or None


# Records


def columns(rows):
    """The names of all columns that rows have."""
    names = {name for row in rows for name in row}
    between = sorted(names - set(FIRST) - set(LAST))
    return [name for name in [*FIRST, *between, *LAST] if name in names]


def write_record(comments, rows):
    """The text of a record: pairs of name and text, then rows, which are dicts."""
    out = io.StringIO()
    for name, value in comments:
        out.write(f"# {name}: {value}\n")
    writer = csv.DictWriter(out, columns(rows), restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()


def read_record(text):
    """The comments (a dict) and the rows (dicts of texts without the empty ones) of a record's text."""
    lines = text.splitlines(keepends=True)
    heads = [line for line in lines if line.startswith("# ")]
    comments = dict(line[2:].rstrip("\n").split(": ", 1) for line in heads if ": " in line)
    table = csv.DictReader(line for line in lines if not line.startswith("#"))
    rows = [{name: value for name, value in row.items() if name and value} for row in table]
    missing = [name for name in ("case", "primitives", "unit", "checksum") if name not in (table.fieldnames or [])]
    if missing or not rows:
        raise Failure(f"it has no column `{missing[0]}`" if missing else "it has no rows")
    return comments, rows


def load_record(path):
    """As read_record, of a file; failures name it."""
    try:
        return read_record(path.read_text())
    except OSError as error:
        raise Failure(f"cannot read the record {shown(path)}: {error.strerror}") from error
    except (Failure, csv.Error, UnicodeDecodeError) as error:
        raise Failure(f"{shown(path)} is not a record: {error}") from error


def shown(path):
    """A path as it is written in README.md: from the repository's root, if it is in there."""
    path = Path(path).resolve()
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else str(path)


def newest():
    """The record with the latest date."""
    records = sorted(RECORDS.glob("*/*.csv"), key=lambda path: (path.name, path.parent.name))
    if not records:
        raise Failure(f"there is no record in {shown(RECORDS)}; `benches/record.py run` makes one")
    return records[-1]


def replace(path, text):
    """Writes a file that appears whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=path.parent, prefix=path.name, suffix=".part", delete=False) as part:
        try:
            part.write(text)
            part.close()
            os.chmod(part.name, 0o644)
            os.replace(part.name, path)
        except BaseException:
            os.unlink(part.name)
            raise


# The table


def time(nanoseconds):
    """A time with three digits and its unit."""
    for limit, scale, unit in ((1e3, 1, "ns"), (1e6, 1e3, "µs"), (1e9, 1e6, "ms"), (float("inf"), 1e9, "s")):
        if nanoseconds < limit:
            number = nanoseconds / scale
            digits = 0 if number >= 100 else 1 if number >= 10 else 2 if number >= 1 else 3
            return f"{number:.{digits}f} {unit}"
    raise Failure(f"{nanoseconds} is not a time")


def ratio(text):
    """A ratio with three digits: `1,234`, `12.3`, `1.23`."""
    number = float(text)
    return f"{number:,.{0 if number >= 100 else 1 if number >= 10 else 2}f}"


def chosen(rows):
    """One row for each work of each case, in the order of the record: the largest of those that most contestants took part in."""
    best = {}
    for row in rows:
        rank = (sum(name + "_ns" in row for name in CONTESTANTS), int(row["primitives"]))
        work = (row["case"], row.get("of"))
        if work not in best or rank > best[work][0]:
            best[work] = (rank, row)
    return [row for _, row in best.values()]


def cells(row):
    """The cells of the table's row."""

    def timed(*names):
        times = [float(row[name + "_ns"]) for name in names if name + "_ns" in row]
        return time(min(times)) if times else ""

    others = [f"{name.replace('_', ' ')} {timed(name)}" for name in OTHERS if timed(name)]
    if "published_evaluations_per_second" in row:
        others.append(f"published {time(1e9 / float(row['published_evaluations_per_second']))}")
    if "ratio_threads" in row:
        others.append(f"one thread / ours {ratio(row['ratio_threads'])}")
    if "ratio_machine" in row:
        others.append(f"of the machine's {ratio(row['ratio_machine'])}")
    if row["checksum"] != "ok":
        others.append(row["checksum"])
    ratios = [ratio(row[name]) if name in row else "" for name in ("ratio_limit", "ratio_fidget")]
    primitives = f"{int(row['primitives']):,}"
    fidget = timed("fidget_jit", "fidget_vm")
    said = ": ".join(row[name] for name in ("what", "of") if name in row)
    what = [f"`{row['case']}`", said, primitives, row["unit"]]
    return [*what, timed("ours"), timed("limit"), fidget, *ratios, ", ".join(others)]


HEAD = "case|what is done|primitives|time of a|ours|limit|fidget|ours / limit|fidget / ours|others"
ALIGN = "---|---|---:|---|---:|---:|---:|---:|---:|---"


def table(path):
    """What stands between the markers for a record."""
    comments, rows = load_record(path)
    name = shown(path)
    lines = [
        f"Record: [`{name}`]({name})  ",
        f"CPU: {comments.get('cpu', 'unknown')}  ",
        f"Command: `{comments.get('command', 'unknown')}`",
        "",
        f"|{HEAD}|",
        f"|{ALIGN}|",
    ]
    try:
        for row in chosen(rows):
            lines.append("|" + "|".join(cell.replace("|", "\\|") for cell in cells(row)) + "|")
    except (KeyError, ValueError) as error:
        raise Failure(f"{name} is not a record: a row has no good {error}") from error
    return "\n".join(lines)


def parts(readme):
    """What stands in README.md before, between and after the markers."""
    if readme.count(BEGIN) != 1 or readme.count(END) != 1 or readme.index(BEGIN) > readme.index(END):
        raise Failure(f"README.md needs one line `{BEGIN}`, and below it one line `{END}`: the table stands between them")
    before, rest = readme.split(BEGIN)
    between, after = rest.split(END)
    return before, between.strip("\n"), after


def with_table(readme, text):
    """README.md's text with another table."""
    before, _, after = parts(readme)
    return f"{before}{BEGIN}\n{text}\n{END}{after}"


# Commands


def run(arguments):
    """Runs `compare` and writes a record. Returns the exit code."""
    command = [*CARGO, *(argument for argument in arguments if argument != "--json")]
    rows = []
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            rows.append(json.loads(line))
            note = f"{rows[-1]['case']}, {rows[-1]['primitives']} primitives: {rows[-1]['checksum']}"
            print(note, file=sys.stderr, flush=True)
    if not rows:
        raise Failure(f"`{' '.join(command)}` failed with exit code {process.returncode}")
    if process.returncode not in (0, 1):
        raise Failure(f"`compare` stopped after {len(rows)} rows, with exit code {process.returncode}")
    description, folder = this_cpu(bound(arguments, os.environ))
    comments = [
        ("command", " ".join(command)),
        ("cpu", f"{description}, {os.cpu_count()} threads"),
        ("rustc", output("rustc", "--version")),
        ("commit", commit()),
    ]
    date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")
    path = RECORDS / folder / f"{date}.csv"
    replace(path, write_record(comments, rows))
    print(shown(path))
    return process.returncode


def output(*command):
    """What a command prints."""
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()


def commit():
    """The commit that is checked out, and whether files of the repository differ from it."""
    changed = output("git", "status", "--porcelain", "--untracked-files=no")
    return output("git", "rev-parse", "--short=12", "HEAD") + (", with changes" if changed else "")


def write_table(record):
    """Writes the table of a record into README.md. Returns what to say."""
    path = Path(record) if record else newest()
    replace(README, with_table(README.read_text(), table(path)))
    return f"README.md has the table of {shown(path)}"


def check():
    """Fails if README.md has not the table of the record that it names. Returns what to say."""
    readme = README.read_text()
    _, between, _ = parts(readme)
    named = re.search(r"`(benches/record/[^`]+\.csv)`", between)
    if not named:
        raise Failure("README.md names no record; `benches/record.py table` writes the table of the newest")
    if with_table(readme, table(ROOT / named[1])) != readme:
        raise Failure(f"README.md's table is not that of {named[1]}; `benches/record.py table {named[1]}` writes it")
    return f"README.md's table is that of {named[1]}"


def main(arguments):
    """Runs a command. Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True, metavar="run|table|check")
    commands.add_parser("run", help="make a record; arguments are those of compare", allow_abbrev=False)
    of = commands.add_parser("table", help="write the table of a record into README.md")
    of.add_argument("record", nargs="?", metavar="RECORD.csv", help="the newest one, if none is named")
    commands.add_parser("check", help="see whether README.md's table is that of its record")
    chosen_command, rest = parser.parse_known_args(arguments)
    if rest and chosen_command.command != "run":
        parser.error(f"unknown arguments: {' '.join(rest)}")
    try:
        if chosen_command.command == "run":
            return run(rest)
        print(write_table(chosen_command.record) if chosen_command.command == "table" else check())
    except Failure as failure:
        print(f"record.py: {failure}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
