"""Kepler's problem over a thousand periods: write H, choose a step, read what was conserved."""

import numpy as np

import equip

# 1. Write H, nothing else: no gradient, no Hessian. Numbers and arrays are captured as in any function.
mu = 1.0
kepler = equip.Hamiltonian(lambda q, p: 0.5 * p @ p - mu / np.sqrt(q @ q), shape=2)

# 2. Choose a method and a step, and integrate from (q, p) over an interval of time.
period = 2 * np.pi
sol = equip.solve(
    kepler,
    [0.4, 0.0],
    [0.0, 2.0],
    (0, 1000.5 * period),
    method=equip.Equip(stages=16),
    step=period / 12,
    invariants={"angular momentum": lambda q, p: q[0] * p[1] - q[1] * p[0]},
)

# 3. Read what was conserved: measured, not promised.
print(sol.certificate)
# After 1000.5 periods the exact position is the apocentre. (After 1000 it would be the initial position.)
print(f"error after 1000.5 periods  {np.abs(sol.q[-1] - [-1.6, 0.0]).max():.1e}")
assert sol.success and sol.certificate.energy_conserved_on_every_step
