"""Examples of SciPy's documentation of `solve_ivp`: the same figures from H alone."""

import numpy as np
import pytest

import equip

solve_ivp = pytest.importorskip("scipy.integrate").solve_ivp


def test_the_cannon():
    """A ball thrown upwards, with the ground as a terminal event and the apex as another one."""

    def hit_ground(t, y):
        return y[0]

    def apex(t, y):
        return y[1]

    hit_ground.terminal, hit_ground.direction = True, -1
    theirs = solve_ivp(lambda t, y: [y[1], -0.5], [0, 100], [0, 10], events=(hit_ground, apex))

    def ground(t, q, p):
        return q[0]

    ground.terminal, ground.direction = True, -1
    ball = equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2 + 0.5 * q[0], 1)
    ours = equip.solve(ball, [0], [10], (0, 100), events=(ground, lambda t, q, p: p[0]), dense_output=True)
    for sol in (theirs, ours):
        assert sol.success and len(sol.t_events[0]) == len(sol.t_events[1]) == 1
    # The motion is a parabola: both are exact but for rounding.
    assert abs(ours.t_events[0][0] - 40) < 1e-12 and abs(ours.t_events[1][0] - 20) < 1e-12
    assert abs(ours.t_events[0][0] - theirs.t_events[0][0]) < 1e-10
    assert abs(ours.sol(ours.t_events[1][0])[0][0] - 100) < 1e-12
    assert ours.t[-1] == ours.t_events[0][0]


def test_lotka_and_volterra():
    """Hunters and prey, x' = x (a - b y), y' = -y (c - d x): H in the logarithms q = ln x, p = ln y."""
    a, b, c, d = 1.5, 1.0, 3.0, 1.0
    times = np.linspace(0, 15, 300)

    def slope(t, z):
        x, y = z
        return [a * x - b * x * y, -c * y + d * x * y]

    theirs = solve_ivp(slope, [0, 15], [10, 5], t_eval=times, method="DOP853", rtol=1e-13, atol=1e-13)
    h = equip.Hamiltonian(lambda q, p: a * p[0] - b * np.exp(p[0]) + c * q[0] - d * np.exp(q[0]), 1)
    ours = equip.solve(h, [np.log(10)], [np.log(5)], (0, 15), t_eval=times, tolerance=1e-12)
    difference = np.abs(np.exp(ours.y) - theirs.y.T).max()
    print("largest difference of", np.abs(theirs.y).max(), "is", difference)
    assert difference < 1e-8
    # As that page has it, with the default method and tolerance of 1e-3.
    coarse = solve_ivp(slope, [0, 15], [10, 5], t_eval=times)
    assert np.abs(np.exp(ours.y) - coarse.y.T).max() < 10
    assert ours.certificate.energy_conserved_on_every_step
