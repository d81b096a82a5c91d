#!/usr/bin/env python3
"""Times of `equip.solve` and `equip.ensemble` beside heyoka and SciPy, at equal error.

    pip install . heyoka scipy              # a release build, in the folder python
    python benches/speed.py                 # tables of Markdown; --quick in place of ten minutes takes three

For each error asked for, every contestant gets its quickest setting of those that reach it where the next
finer one does too: errors are measured, none is interpolated. The runs of all contestants are then made in
turn, for several rounds, and the medians are printed: CPU time, which other work on the machine disturbs
least, and wall time. A contestant is made ready before; the CPU time of that, of recording H or compiling, is
the column "ready". A setting is a tolerance, or the number of steps in a period (Kepler's, Jupiter's) or in
t = 200.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

import contestants
import numpy as np
from contestants import Contestant, Problem

import equip

#: Short runs are repeated to this many seconds in a round.
LONG_ENOUGH = 0.05
#: Settings that are tried beyond the smallest error asked for: finer steps may need fewer iterations.
FURTHER = 4


@dataclass
class Entry:
    """A contestant's setting for an error, and its times in the rounds, in seconds of one run."""

    contestant: Contestant
    target: float
    setting: float
    error: float
    run: Callable[[], Any]
    ready: float
    cpu: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)


def timed(run: Callable[[], Any], repeats: int = 1) -> tuple[float, float]:
    """CPU and wall seconds of a run."""
    cpu, wall = time.process_time(), time.perf_counter()
    for _ in range(repeats):
        run()
    return (time.process_time() - cpu) / repeats, (time.perf_counter() - wall) / repeats


def error_of(problem: Problem, contestant: Contestant, ends: Any) -> float:
    """The largest error of positions of the members that are compared."""
    if contestant.members is not None:
        error = np.abs(ends - problem.reference[: len(ends)])
    else:
        error = np.abs(ends[problem.compared] - problem.reference)
    return float(error.max()) if np.isfinite(error).all() else float("inf")


def searched(problem: Problem, contestant: Contestant) -> tuple[list[Entry], float]:
    """Its quickest setting for each error it reaches, and the smallest error of all its settings."""
    tried: list[tuple[float, float, Callable[[], Any], float, float]] = []
    beyond = 0
    for setting in contestant.settings:
        begun = time.process_time()
        run = contestant.make(setting)
        ready = time.process_time() - begun
        error = error_of(problem, contestant, run())
        seconds = timed(run)[0]
        if seconds < 1:
            seconds = min(seconds, *(timed(run)[0] for _ in range(2)))
        tried.append((setting, error, run, ready, seconds))
        beyond += error <= min(problem.targets)
        if beyond > FURTHER:
            break
    entries = []
    for target in problem.targets:
        # The finest setting has no finer one to confirm it.
        reach = [k for k in range(len(tried)) if all(e[1] <= target for e in tried[k : k + 2])]
        if reach:
            *chosen, _ = tried[min(reach, key=lambda k: tried[k][-1])]
            entries.append(Entry(contestant, target, *chosen))
    return entries, min(error for _, error, *_ in tried)


def measured(entries: list[Entry], rounds: int) -> None:
    """Runs all in turn; those of more than two seconds once."""
    repeats = {id(e): max(1, round(LONG_ENOUGH / max(timed(e.run)[0], 1e-6))) for e in entries}
    for number in range(rounds):
        for e in entries:
            if number == 0 or e.cpu[0] < 2:
                cpu, wall = timed(e.run, repeats[id(e)])
                e.cpu.append(cpu)
                e.wall.append(wall)


def table(problem: Problem, rounds: int) -> None:
    """A row for each contestant: CPU time, error and setting for each error asked for."""
    found = [(c, *searched(problem, c)) for c in problem.contestants]
    entries = [e for _, of_one, _ in found for e in of_one]
    measured(entries, rounds)
    scale, unit = (1e6, "µs a run") if problem.members > 1 else (1e3, "ms")
    print(f"\n**{problem.title}: CPU {unit} (error, setting)**\n")
    titles = [f"to {power(target)}" for target in problem.targets]
    print(f"| | {' | '.join(titles)} | ready |\n|---|{'---|' * len(titles)}---|")
    for contestant, of_one, smallest in found:
        cells = [cell(problem, of_one, target, scale) for target in problem.targets]
        ready = max((e.ready for e in of_one), default=0.0)
        if not of_one or of_one[-1].target != problem.targets[-1]:
            cells[-1] = f"{power(smallest)} at best"
        print(f"| {contestant.name} | {' | '.join(cells)} | {ready * 1e3:.2g} |")
    ratios = [statistics.median(e.wall) / statistics.median(e.cpu) for e in entries]
    print(f"\nWall time over CPU time: {min(ratios):.2f} to {max(ratios):.2f}.")


def cell(problem: Problem, entries: list[Entry], target: float, scale: float) -> str:
    """CPU time of a run, error and setting; a dash where the error is not reached."""
    e = next((e for e in entries if e.target == target), None)
    if e is None:
        return "–"
    runs = e.contestant.members or problem.members
    setting = power(e.setting) if e.setting < 1 else f"{e.setting:.0f}"
    cpu = statistics.median(e.cpu) * scale / runs
    return f"{cpu:.{0 if cpu >= 100 else 1 if cpu >= 10 else 2}f} ({power(e.error)}, {setting})"


def power(number: float) -> str:
    """1e-6, as the README has it."""
    return f"{number:.0e}".replace("e-0", "e-")


def growth(members: int, rounds: int) -> None:
    """One thread beside two."""
    scene = equip.scenes.henon_heiles(energy="1/12")
    q0, p0 = equip.draw_starts(scene.q0, scene.p0, members, seed=1, spread=0.05)

    def run(threads: int) -> Callable[[], Any]:
        return lambda: equip.ensemble(scene, q0, p0, (0, 200), step=1.0, threads=threads)

    times: dict[int, list[tuple[float, float]]] = {1: [], 2: []}
    for _ in range(2 * rounds + 1):
        for threads, all_times in times.items():
            all_times.append(timed(run(threads)))
    print(f"\n**Threads: {members} starts, s = 8, equal steps**\n")
    print("| threads | CPU ms | wall ms, median | wall ms, smallest |")
    print("|---|---|---|---|")
    for threads, made in times.items():
        cpu = statistics.median(cpu for cpu, _ in made)
        walls = [wall for _, wall in made]
        print(
            f"| {threads} | {cpu * 1e3:.1f} | {statistics.median(walls) * 1e3:.1f} | {min(walls) * 1e3:.1f} |"
        )
    one, two = (min(wall for _, wall in made) for made in times.values())
    cpu_one, cpu_two = (statistics.median(cpu for cpu, _ in made) for made in times.values())
    wall, cpu = one / two / 2, cpu_one / cpu_two
    print(f"\nGrowth with two threads: {wall:.2f} of twice by smallest wall time, {cpu:.2f} by CPU time.")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5, help="rounds of all runs")
    parser.add_argument("--quick", action="store_true", help="two rounds, and fewer starts")
    given = parser.parse_args()
    rounds, members = (2, 64) if given.quick else (given.rounds, 512)
    print(
        f"equip {equip.__version__}, heyoka {version('heyoka')}, SciPy {version('scipy')}, "
        f"NumPy {version('numpy')}, Python {sys.version.split()[0]}; {rounds} rounds"
    )
    for problem in (
        contestants.kepler(),
        contestants.outer_solar_system(),
        contestants.henon_heiles(members),
    ):
        table(problem, rounds)
    growth(8 * members, rounds)


if __name__ == "__main__":
    main()
