"""What calling from Python costs: nothing is copied, calls are cheap, threads work at once.

    python benches/evaluation.py [PROGRAM]

PROGRAM is the binary `python_peer` of jbt-benches, if the times of Rust are wanted. Runs take turns,
and medians count.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import threading
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import jbt
import numpy as np
from numpy.typing import NDArray

SCENE = Path(__file__).resolve().parents[2] / "examples" / "hero.jbt"
POINTS = 10_000_000
CALLS = 64


def seconds(work: Callable[[], object]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def planes(count: int) -> NDArray[np.float32]:
    """Points in [-1.5, 1.5]^3: a sequence that is the same everywhere."""
    index = np.arange(count, dtype=np.float64)
    fractions = [np.modf(index * step)[0] for step in (0.8191725134, 0.6710436067, 0.5497004779)]
    return (np.stack(fractions) * 3 - 1.5).astype(np.float32)


def process() -> tuple[int, int]:
    """Bytes of memory of this process: now, and at most since the last question. Linux tells it."""
    status = Path("/proc/self/status").read_text()
    now, most = (int(status.split(word)[1].split()[0]) * 1024 for word in ("VmRSS:", "VmHWM:"))
    Path("/proc/self/clear_refs").write_text("5")
    return now, most


def memory(ev: jbt.Evaluator) -> None:
    """What a call allocates beside its answers."""
    points = planes(POINTS)
    ev(points[:, :100].copy())
    resident, _ = process()
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    answers = ev(points)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    grown = process()[1] - resident
    output = answers.planes.nbytes
    print(f"{POINTS:,} points: answers of {output / 2**20:.1f} MiB")
    print(f"  NumPy allocated {(peak - before - output) / 2**10:+.1f} KiB beside them")
    print(f"  the process grew by {(grown - output) / 2**20:+.1f} MiB beside them, at most")


def calls(ev: jbt.Evaluator, rounds: int = 9) -> None:
    """One call, and as many points in several calls."""
    points = planes(1 << 20)
    parts = [np.ascontiguousarray(part) for part in np.split(points, CALLS, axis=1)]
    whole, pieces = ev.empty(1 << 20), [ev.empty(len(part[0])) for part in parts]

    def one() -> None:
        ev(points, out=whole)

    def many() -> None:
        for part, out in zip(parts, pieces, strict=True):
            ev(part, out=out)

    times = [(seconds(one), seconds(many)) for _ in range(rounds)]
    ratio = statistics.median(many / one for one, many in times)
    print(f"2^20 points in one call: {statistics.median(one for one, _ in times) * 1000:.1f} ms")
    print(f"  in {CALLS} calls: {ratio:.3f} times as long")


def threads(ev: jbt.Evaluator, rounds: int = 7) -> None:
    """Two threads of Python, each with one thread of its own, against one."""
    points = planes(1 << 20)
    outs = [ev.empty(1 << 20) for _ in range(2)]

    def ask(out: jbt.Answers) -> None:
        ev(points, out=out, threads=1)

    def both() -> None:
        running = [threading.Thread(target=ask, args=(out,)) for out in outs]
        for thread in running:
            thread.start()
        for thread in running:
            thread.join()

    both()
    times = [(seconds(lambda: ask(outs[0])), seconds(both)) for _ in range(rounds)]
    speed = statistics.median(2 * one / two for one, two in times)
    print(f"two threads of Python evaluate at {speed:.2f} times the speed of one")


def against_rust(ev: jbt.Evaluator, program: str, rounds: int = 5) -> None:
    """The same points and threads in Rust, turn by turn."""
    points = planes(POINTS)
    out = ev.empty(POINTS)
    ev(points, out=out)
    ratios, mine = [], []
    for _ in range(rounds):
        theirs = float(
            subprocess.run(
                [program, "points", str(SCENE), str(POINTS)], capture_output=True, check=True
            ).stdout
        )
        mine.append(seconds(lambda: ev(points, out=out)))
        ratios.append(mine[-1] / theirs)
    took = statistics.median(mine)
    print(f"{POINTS:,} points: {took:.2f} s, {statistics.median(ratios):.3f} times as long as in Rust")


def main() -> None:
    ev = jbt.load(SCENE).compile()
    print(f"the hero, by {ev.engine}")
    memory(ev)
    calls(ev)
    threads(ev)
    if len(sys.argv) > 1:
        against_rust(ev, sys.argv[1])


if __name__ == "__main__":
    main()
