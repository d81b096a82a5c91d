#!/usr/bin/env python3
"""Errors of variable steps relative to the tolerance, compared with DOP853 of SciPy (`rtol` = `atol` = tolerance).

    pip install ./python scipy
    python benches/tolerances.py            # prints a Markdown table, three minutes

The error is the largest of all components of (q, p) at the end, each in its own unit. The reference is EQUIP
with 16 stages and tolerance 1e-19 in double-double; its difference from 12 stages and 1e-17 is printed.
Tolerances are 1e-4 … 1e-13. Each row has the error divided by the tolerance for four of them; the largest
ratio of the errors of EQUIP and DOP853 above round-off; and the largest growth of an error above its
tolerance from one tolerance to the next smaller one.
"""

from __future__ import annotations

import sys

import equip
import numpy as np
from equip import scenes
from scipy.integrate import solve_ivp

TOLERANCES = [10.0**-k for k in range(4, 14)]
SHOWN = [1e-4, 1e-7, 1e-10, 1e-13]
STAGES = [6, 8, 12]


def comet(mass):
    masses = [1.0, 1e-3, mass]

    def energy(q, p):
        h = sum((p[i] @ p[i]) / (2 * masses[i]) for i in range(3))
        for i in range(3):
            for j in range(i):
                d = q[i] - q[j]
                h = h - masses[i] * masses[j] / np.sqrt(d @ d)
        return h

    planet, speed = np.sqrt(1.001), np.sqrt(5 * 0.05 / 1.95)
    q = np.array([[0.0, 0.0], [1.0, 0.0], [-0.39, 0.0]])
    p = np.array([[0.0, -1e-3 * planet], [0.0, 1e-3 * planet], [0.0, -mass * speed]])
    return equip.Hamiltonian(energy, (3, 2)), q, p, 20.0


def units(unit):
    """Kepler's problem, and a quartic oscillator whose q and p are those of another unit."""

    def energy(q, p):
        x, v = q[2] / unit, p[2] * unit
        kinetic = 0.5 * (p[0] ** 2 + p[1] ** 2)
        return kinetic - 1 / np.sqrt(q[0] ** 2 + q[1] ** 2) + 0.5 * v**2 + 0.25 * x**4

    q = np.array([0.7, 0.0, unit])
    p = np.array([0.0, np.sqrt(1.3 / 0.7), 0.3 / unit])
    return equip.Hamiltonian(energy, 3), q, p, 20.0, np.array([1, 1, 1 / unit, 1, 1, unit])


def wedge():
    return equip.Hamiltonian(lambda q, p: 0.5 * p[0] ** 2 + abs(q[0]), 1), [1.0], [0.3], 50.0


def bent():
    h = equip.Hamiltonian(lambda q, p: 0.5 * p[0] ** 2 + 0.5 * q[0] ** 2 + 0.3 * q[0] * abs(q[0]), 1)
    return h, [1.0], [0.0], 50.0


def cubic():
    h = equip.Hamiltonian(lambda q, p: 0.5 * p[0] ** 2 + 0.5 * q[0] ** 2 + abs(q[0]) ** 3 / 6, 1)
    return h, [1.0], [0.0], 50.0


def bar():
    def energy(q, p):
        square = q[0] ** 2 + q[1] ** 2
        x = np.sqrt(square) / 0.8
        r = np.minimum(x, 1) ** 3 - np.maximum(x, 1) ** -3 - 1
        turning = 1.85 * (q[0] * p[1] - q[1] * p[0])
        return (
            0.5 * (p[0] ** 2 + p[1] ** 2)
            - turning
            + 0.5 * np.log(square)
            + 0.01 * r * (q[0] ** 2 - q[1] ** 2) / square
        )

    return equip.Hamiltonian(energy, 2), [1.0, 0.1], [1.2, 0.6], 50.0


def table(intervals):
    x = np.linspace(-4, 4, intervals + 1)
    spline = equip.table(x, -np.cos(x))
    h = equip.Hamiltonian(lambda q, p: 0.5 * p[0] ** 2 + spline(q[0]), 1)
    return h, [0.0], [1.5], 50.0


def scene(found, periods=10.0):
    # Not after whole periods, where standing still has no error.
    return found, found.q0, found.p0, 0.97 * min(found.end, periods * found.period)


CASES = {
    "Kepler, e = 0.1": lambda: scene(scenes.kepler(e=0.1)),
    "Kepler, e = 0.6": lambda: scene(scenes.kepler(e=0.6)),
    "Kepler, e = 0.9": lambda: scene(scenes.kepler(e=0.9)),
    "pendulum": lambda: scene(scenes.pendulum()),
    "quartic": lambda: scene(scenes.quartic()),
    "Hénon–Heiles": lambda: scene(scenes.henon_heiles()),
    "double pendulum": lambda: scene(scenes.double_pendulum(), 5.0),
    "Lotka–Volterra": lambda: scene(scenes.lotka_volterra()),
    "Faou, Hairer, Pham": lambda: scene(scenes.faou_hairer_pham()),
    "charged particle": lambda: scene(scenes.charged_particle()),
    "FPU, ω = 50": lambda: scene(scenes.fpu(), 5.0),
    "FPUT-β": lambda: scene(scenes.fput_beta(n=16), 3.0),
    "sine-Gordon": lambda: scene(scenes.sine_gordon(n=16), 3.0),
    "DNLS": lambda: scene(scenes.dnls(), 2.0),
    "Lennard-Jones": lambda: scene(scenes.lennard_jones(), 5.0),
    "spring pendulum": lambda: scene(scenes.spring_pendulum()),
    "stiff double pendulum": lambda: scene(scenes.stiff_double_pendulum(), 2.0),
    "outer solar system": lambda: scene(scenes.outer_solar_system()),
    "Arenstorf": lambda: scene(scenes.arenstorf(), 0.9),
    "Pythagorean": lambda: scene(scenes.pythagorean(), 0.5),
    "N-body": lambda: scene(scenes.n_body(), 1.0),
    "comet of mass 1e-6": lambda: comet(1e-6),
    "comet of mass 1e-12": lambda: comet(1e-12),
    "units of 1e6": lambda: units(1e6),
    "wedge \\|q\\| (the force jumps)": wedge,
    "½q² + 0.3 q\\|q\\| (∇²H jumps)": bent,
    "½q² + \\|q\\|³/6 (the third derivative jumps)": cubic,
    "rotating bar of two formulas": bar,
    "spline of 64 intervals": lambda: table(64),
    "spline of 1024 intervals": lambda: table(1024),
}


def flat(q, p):
    return np.concatenate([np.ravel(q), np.ravel(p)])


def end(h, q, p, time, stages, tolerance, precision="f64"):
    solution = equip.solve(
        h,
        q,
        p,
        (0.0, time),
        method=equip.Equip(stages=stages),
        tolerance=tolerance,
        record="ends",
        precision=precision,
    )
    return np.ravel(np.asarray(solution.y[-1], dtype=float))


def dop853(h, q, p, time, tolerance):
    shape = np.shape(q)
    half = int(np.prod(shape))

    def slope(_, y):
        at_q, at_p = h.gradient(y[:half].reshape(shape), y[half:].reshape(shape))
        return flat(at_p, -np.asarray(at_q))

    made = solve_ivp(slope, (0.0, time), flat(q, p), "DOP853", rtol=tolerance, atol=tolerance)
    return made.y[:, -1] if made.success else np.full(2 * half, np.nan)


def off(found, right, weights):
    return np.abs((found - right) * weights).max()


def main(names):
    head = " | ".join(f"{tolerance:.0e}" for tolerance in SHOWN)
    print(f"| s = {', '.join(map(str, STAGES))}; DOP853 | {head} | largest ratio | grows |")
    print("|---|" + "---|" * (len(SHOWN) + 2))
    worst = 0.0
    for name, make in CASES.items():
        if names and not any(part in name for part in names):
            continue
        h, q, p, time, *weights = make()
        weights = weights[0] if weights else 1.0
        right = end(h, q, p, time, 16, 1e-19, "dd")
        doubt = off(end(h, q, p, time, 12, 1e-17, "dd"), right, weights)
        # Below this an error is rounding of the run, not of the tolerance.
        size = np.abs(right * weights).max()
        theirs = [off(dop853(h, q, p, time, t), right, weights) for t in TOLERANCES]
        ours = {s: [off(end(h, q, p, time, s, t), right, weights) for t in TOLERANCES] for s in STAGES}
        rounding = 3 * min(min(errors) for errors in ours.values()) + 1e-15 * size
        ratios, growth = [], []
        for errors in ours.values():
            for mine, other in zip(errors, theirs):
                if mine > rounding:
                    ratios.append(mine / other)
            for coarse, fine, tolerance in zip(errors, errors[1:], TOLERANCES[1:]):
                if fine > max(rounding, tolerance):
                    growth.append(fine / coarse)
        cells = []
        for shown in SHOWN:
            k = min(range(len(TOLERANCES)), key=lambda k: abs(np.log(TOLERANCES[k] / shown)))
            mine = ", ".join(f"{ours[s][k] / TOLERANCES[k]:.2g}" for s in STAGES)
            cells.append(f"{mine}; {theirs[k] / TOLERANCES[k]:.2g}")
        ratio, grows = max(ratios, default=0.0), max(growth, default=0.0)
        worst = max(worst, ratio)
        print(f"| {name} | {' | '.join(cells)} | {ratio:.2g} | {grows:.2g} |", flush=True)
        if doubt > 1e-3 * min(TOLERANCES) * max(1.0, size):
            print(f"{name}: the right end is in doubt by {doubt:.1e}", file=sys.stderr)
    print(f"largest ratio: {worst:.2g}", file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
