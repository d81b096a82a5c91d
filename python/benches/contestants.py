"""The same problem for equip, heyoka and SciPy: what `speed.py` lets run beside each other.

A problem has a reference and contestants. A contestant makes a run of a setting, from coarse to fine ones;
the run is made ready once, and each call integrates all members anew and returns their positions at the end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal, getcontext
from typing import Any, Optional

import heyoka as hy
import numpy as np
from scipy.integrate import solve_ivp

import equip

# What heyoka compiles it keeps on disk: here each contestant is compiled anew.
hy.llvm_state.set_diskcache_enabled(False)

#: Makes a run ready: of a setting, a function without arguments that returns positions, (members, m).
Maker = Callable[[float], Callable[[], Any]]


@dataclass(frozen=True)
class Contestant:
    name: str
    #: From coarse to fine.
    settings: Sequence[float]
    make: Maker
    #: How many members it makes, if not all.
    members: Optional[int] = None


@dataclass(frozen=True)
class Problem:
    title: str
    #: Errors asked for, from large to small.
    targets: Sequence[float]
    #: Positions at the end, (members, m), of the members `compared`.
    reference: Any
    members: int
    contestants: Sequence[Contestant]
    compared: Any = field(default_factory=lambda: np.array([0]))


def tolerances(largest: int, smallest: int, in_decade: int = 2) -> list[float]:
    """10^-largest … 10^-smallest."""
    return [10.0 ** (-k / in_decade) for k in range(largest * in_decade, smallest * in_decade + 1)]


def counts(first: int, last: int) -> list[float]:
    """Whole numbers, each a twelfth more than the one before."""
    numbers = [first]
    while numbers[-1] < last:
        numbers.append(max(numbers[-1] + 1, round(numbers[-1] * 13 / 12)))
    return [float(n) for n in numbers]


def by_equip(
    name: str,
    record: Callable[[], Any],
    start: Any,
    end: float,
    stages: int,
    unit: Optional[float],
    settings: Any,
) -> Contestant:
    """One run; `unit` is the time that equal steps divide, None makes variable steps."""
    method, (q0, p0) = equip.Equip(stages=stages), start

    def make(setting: float) -> Callable[[], Any]:
        h = record()
        size = {"tolerance": setting} if unit is None else {"step": unit / setting}
        return lambda: equip.solve(h, q0, p0, (0, end), method=method, record="ends", **size).q[-1:]

    return Contestant(name, settings, make)


def by_heyoka(
    name: str, system: Any, start: Any, end: float, positions: Any, settings: Any, **options: Any
) -> Contestant:
    """One run of an integrator that is compiled once for each tolerance."""

    def make(setting: float) -> Callable[[], Any]:
        hy.llvm_state.clear_memcache()
        integrator = hy.taylor_adaptive(system, start, tol=setting, **options)

        def run() -> Any:
            integrator.time = 0.0
            integrator.state[:] = start
            integrator.propagate_until(end)
            return integrator.state[positions][None]

        return run

    return Contestant(name, settings, make)


def by_scipy(name: str, slope: Any, starts: Any, end: float, positions: Any, settings: Any) -> Contestant:
    """DOP853, the right-hand side in plain numbers: for systems this small they are quicker than arrays."""

    def make(setting: float) -> Callable[[], Any]:
        def run() -> Any:
            made = [
                solve_ivp(slope, (0, end), y, method="DOP853", rtol=setting, atol=setting / 100, t_eval=[end])
                for y in starts
            ]
            return np.array([sol.y[positions, -1] for sol in made])

        return run

    return Contestant(name, settings, make, len(starts))


def kepler() -> Problem:
    """e = 0.6, over 1000.3 periods: at whole periods the end is the start."""
    end = 1000.3 * 2 * math.pi
    getcontext().prec = 40
    turn = 2 * Decimal("3.1415926535897932384626433832795028841972")
    anomaly = float(Decimal(end) - 1000 * turn)
    angle = anomaly
    for _ in range(50):
        angle -= (angle - 0.6 * math.sin(angle) - anomaly) / (1 - 0.6 * math.cos(angle))
    reference = np.array([[math.cos(angle) - 0.6, 0.8 * math.sin(angle)]])

    def record() -> Any:
        return equip.Hamiltonian(lambda q, p: 0.5 * p @ p - 1 / np.sqrt(q @ q), shape=2)

    x, y, u, v = hy.make_vars("x", "y", "u", "v")
    cube = (x**2 + y**2) ** -1.5
    system = [(x, u), (y, v), (u, -x * cube), (v, -y * cube)]

    def slope(_: float, z: Any) -> tuple[float, ...]:
        a, b, c, d = z.tolist()
        square = a * a + b * b
        pull = -1 / (square * math.sqrt(square))
        return (c, d, pull * a, pull * b)

    start = [0.4, 0.0, 0.0, 2.0]
    ours = (start[:2], start[2:])
    return Problem(
        "Kepler's problem, e = 0.6, 1000.3 periods",
        (1e-6, 1e-8, 1e-10),
        reference,
        1,
        (
            by_equip("equip, s = 16, equal steps", record, ours, end, 16, 2 * math.pi, counts(8, 30)),
            by_equip("equip, s = 8, equal steps", record, ours, end, 8, 2 * math.pi, counts(14, 80)),
            by_equip("equip, s = 8, variable steps", record, ours, end, 8, None, tolerances(5, 14)),
            by_heyoka("heyoka", system, start, end, [0, 1], tolerances(9, 18)),
            by_heyoka(
                "heyoka, high accuracy", system, start, end, [0, 1], tolerances(9, 18), high_accuracy=True
            ),
            by_scipy("SciPy, DOP853", slope, [start], end, [0, 1], tolerances(10, 13, 1)),
        ),
    )


def outer_solar_system() -> Problem:
    """Sun and five planets, 200 000 days; errors are of positions, in astronomical units."""
    scene, end, gravity = equip.scenes.outer_solar_system(), 200_000.0, 2.95912208286e-4
    masses = 1 / scene.gradient(scene.q0, np.ones(18))[1].reshape(6, 3)[:, 0]
    positions = scene.q0.reshape(6, 3)
    velocities = scene.p0.reshape(6, 3) / masses[:, None]
    fine = equip.solve(
        scene,
        scene.q0,
        scene.p0,
        (0, end),
        method=equip.Equip(stages=16),
        tolerance=1e-19,
        record="ends",
        precision="dd",
    )
    start = np.hstack([positions, velocities]).ravel()
    system = hy.model.nbody(6, masses=masses, Gconst=gravity)
    where = np.arange(36).reshape(6, 6)[:, :3].ravel()
    i, j = np.triu_indices(6, 1)

    def slope(_: float, z: Any) -> Any:
        q, v = z[:18].reshape(6, 3), z[18:]
        d = q[i] - q[j]
        pull = gravity * d / np.einsum("ij,ij->i", d, d)[:, None] ** 1.5
        a = np.zeros((6, 3))
        np.add.at(a, i, -masses[j][:, None] * pull)
        np.add.at(a, j, masses[i][:, None] * pull)
        return np.concatenate([v, a.ravel()])

    flat = np.concatenate([positions.ravel(), velocities.ravel()])
    ours, record = (scene.q0, scene.p0), equip.scenes.outer_solar_system
    return Problem(
        "outer solar system, 200 000 days",
        (1e-6, 1e-8, 1e-10),
        fine.q[-1:],
        1,
        (
            by_equip("equip, s = 8, equal steps", record, ours, end, 8, 4332.0, counts(3, 40)),
            by_equip("equip, s = 8, variable steps", record, ours, end, 8, None, tolerances(5, 14)),
            by_heyoka("heyoka", system, start, end, where, tolerances(7, 18)),
            by_heyoka(
                "heyoka, high accuracy", system, start, end, where, tolerances(7, 18), high_accuracy=True
            ),
            by_scipy("SciPy, DOP853", slope, [flat], end, list(range(18)), tolerances(8, 13, 1)),
        ),
    )


def henon_heiles(members: int) -> Problem:
    """E = 1/12, starts within 5 % of one, to t = 200; every eighth member is compared."""
    scene, end = equip.scenes.henon_heiles(energy="1/12"), 200.0
    q0, p0 = equip.draw_starts(scene.q0, scene.p0, members, seed=1, spread=0.05)
    starts = np.hstack([q0, p0])
    compared = np.arange(0, members, 8)
    fine = [
        equip.solve(
            scene,
            q0[k],
            p0[k],
            (0, end),
            method=equip.Equip(stages=12),
            tolerance=1e-18,
            record="ends",
            precision="dd",
        ).q[-1]
        for k in compared
    ]
    x, y, u, v = hy.make_vars("x", "y", "u", "v")
    system = [(x, u), (y, v), (u, -x - 2.0 * x * y), (v, -y - x**2 + y**2)]

    def ours(name: str, method: Any, unit: Optional[float], settings: Any) -> Contestant:
        def make(setting: float) -> Callable[[], Any]:
            h = equip.scenes.henon_heiles(energy="1/12")
            size = {"tolerance": setting} if unit is None else {"step": unit / setting}
            return lambda: equip.ensemble(h, q0, p0, (0, end), method=method, threads=1, **size).q

        return Contestant(name, settings, make)

    def one_by_one(setting: float) -> Callable[[], Any]:
        hy.llvm_state.clear_memcache()
        integrator = hy.taylor_adaptive(system, starts[0], tol=setting)

        def run() -> Any:
            ends = np.empty((members, 2))
            for k in range(members):
                integrator.time = 0.0
                integrator.state[:] = starts[k]
                integrator.propagate_until(end)
                ends[k] = integrator.state[:2]
            return ends

        return run

    def in_batches(setting: float) -> Callable[[], Any]:
        hy.llvm_state.clear_memcache()
        integrator = hy.taylor_adaptive_batch(system, np.ascontiguousarray(starts[:8].T), tol=setting)

        def run() -> Any:
            ends = np.empty((members, 2))
            for k in range(0, members, 8):
                integrator.set_time(0.0)
                integrator.state[:] = starts[k : k + 8].T
                integrator.propagate_until(end)
                ends[k : k + 8] = integrator.state[:2].T
            return ends

        return run

    def slope(_: float, z: Any) -> tuple[float, ...]:
        a, b, c, d = z.tolist()
        return (c, d, -a - 2 * a * b, -b - a * a + b * b)

    return Problem(
        f"Hénon–Heiles, E = 1/12, t = 200, {members} starts",
        (1e-9, 1e-11, 1e-12),
        np.array(fine),
        members,
        (
            ours("equip, s = 8, variable steps", equip.Equip(stages=8), None, tolerances(6, 14)),
            ours("equip, s = 8, equal steps", equip.Equip(stages=8), end, counts(70, 400)),
            ours("equip, s = 16, equal steps", equip.Equip(stages=16), end, counts(40, 200)),
            ours("equip, Gauss s = 8, equal steps", equip.Gauss(stages=8), end, counts(70, 400)),
            Contestant("heyoka, one by one", tolerances(9, 18), one_by_one),
            Contestant("heyoka, in batches of 8", tolerances(9, 18), in_batches),
            by_scipy("SciPy, DOP853", slope, starts[compared[:2]], end, [0, 1], tolerances(8, 13, 1)),
        ),
        compared,
    )
