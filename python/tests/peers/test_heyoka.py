"""Examples of heyoka's documentation, solved by both programs from the same start."""

import numpy as np
import pytest

import equip

hy = pytest.importorskip("heyoka")


def test_the_pendulum():
    """Of its page on the adaptive integrator: x' = v, v' = -9.8 sin x, and a grid of times."""
    x, v = hy.make_vars("x", "v")
    theirs = hy.taylor_adaptive([(x, v), (v, -9.8 * hy.sin(x))], [0.05, 0.025])
    grid = np.linspace(0, 20, 201)
    states = theirs.propagate_grid(grid)[-1]
    h = equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2 - 9.8 * np.cos(q[0]), 1)
    ours = equip.solve(h, [0.05], [0.025], (0, 20), t_eval=grid)
    difference = np.abs(ours.y - states).max()
    print("largest difference", difference)
    assert difference < 5e-11
    # Printed there for t = 0.1 and t = 1.
    assert np.allclose(ours.y[1], [0.05003035, -0.024398], rtol=0, atol=6e-9)
    assert np.allclose(ours.y[10], [-0.04990399, -0.02681336], rtol=0, atol=6e-9)


def test_the_restricted_three_body_problem():
    """In the rotating frame, where H is not separable: μ = 0.01, to t = 200."""
    mu = 0.01
    x, y, z, px, py, pz = names = hy.make_vars("x", "y", "z", "px", "py", "pz")
    sun = ((x - mu) ** 2 + y**2 + z**2) ** -1.5
    planet = ((x - mu + 1) ** 2 + y**2 + z**2) ** -1.5
    pull = (1 - mu) * sun + mu * planet
    slopes = [
        px + y,
        py - x,
        pz,
        py - (1 - mu) * sun * (x - mu) - mu * planet * (x - mu + 1),
        -px - pull * y,
        -pull * z,
    ]
    start = [-0.45, 0.80, 0.00, -0.80, -0.45, 0.58]
    theirs = hy.taylor_adaptive(list(zip(names, slopes)), start, tol=1e-18, high_accuracy=True)
    theirs.propagate_until(200.0)

    def energy(q, p):
        sun, planet = q - [mu, 0, 0], q - [mu - 1, 0, 0]
        rotation = q[1] * p[0] - q[0] * p[1]
        return p @ p / 2 + rotation - (1 - mu) / np.linalg.norm(sun) - mu / np.linalg.norm(planet)

    h = equip.Hamiltonian(energy, 3)
    assert not h.separable
    ours = equip.solve(h, start[:3], start[3:], (0, 200), record="ends")
    difference = np.abs(ours.y[-1] - theirs.state).max()
    print("largest difference", difference)
    assert difference < 1e-9
    # Printed there.
    printed = [-0.58042685, 0.54661332, -0.36418594, -0.83390023, -0.62399926, 0.38281904]
    assert np.allclose(ours.y[-1], printed, rtol=0, atol=6e-9)
    assert ours.certificate.energy_conserved_on_every_step


# The outer solar system: Sun with the inner planets, Jupiter, Saturn, Uranus, Neptune and Pluto, in astronomical
# units and units of a day (Applegate et al., Astronomical Journal 92, 176, 1986).
MASSES = np.array([1.00000597682, 1 / 1047.355, 1 / 3501.6, 1 / 22869.0, 1 / 19314.0, 7.4074074e-09])
POSITIONS = np.array(
    [
        [-4.06428567034226e-3, -6.08813756435987e-3, -1.66162304225834e-6],
        [3.40546614227466, 3.62978190075864, 3.42386261766577e-2],
        [6.60801554403466, 6.38084674585064, -1.36145963724542e-1],
        [1.11636331405597e1, 1.60373479057256e1, 3.61783279369958e-1],
        [-3.01777243405203e1, 1.91155314998064, -1.53887595621042e-1],
        [-2.13858977531573e1, 3.20719104739886e1, 2.49245689556096],
    ]
)
VELOCITIES = np.array(
    [
        [6.69048890636161e-6, -6.33922479583593e-6, -3.13202145590767e-9],
        [-5.59797969310664e-3, 5.51815399480116e-3, -2.66711392865591e-6],
        [-4.17354020307064e-3, 3.99723751748116e-3, 1.67206320571441e-5],
        [-3.25884806151064e-3, 2.06438412905916e-3, -2.17699042180559e-5],
        [-2.17471785045538e-4, -3.11361111025884e-3, 3.58344705491441e-5],
        [-1.76936577252484e-3, -2.06720938381724e-3, 6.58091931493844e-4],
    ]
)


def test_the_outer_solar_system():
    """Of its page on Brouwer's law: years of 365 days, 1000 of them; its model of n bodies knows velocities."""
    gravity = (0.01720209895 * 365) ** 2
    system = hy.model.nbody(6, masses=MASSES, Gconst=gravity)
    start = np.hstack([POSITIONS, VELOCITIES * 365])
    theirs = hy.taylor_adaptive(system, start.ravel(), high_accuracy=True, tol=1e-18)
    theirs.propagate_until(1000.0)
    i, j = np.triu_indices(6, 1)
    m = MASSES[:, None]

    def energy(q, p):
        distances = np.linalg.norm(q[i] - q[j], axis=1)
        return (p**2 / (2 * m)).sum() - gravity * (MASSES[i] * MASSES[j] / distances).sum()

    h = equip.Hamiltonian(energy, (6, 3))
    ours = equip.solve(h, POSITIONS, m * VELOCITIES * 365, (0, 1000), record="ends")
    state = theirs.state.reshape(6, 6)
    difference = np.abs(ours.q[-1] - state[:, :3]).max()
    print("largest difference in astronomical units", difference)
    assert difference < 1e-8
    assert np.abs(ours.p[-1] / m - state[:, 3:]).max() < 1e-8
    assert ours.certificate.energy_conserved_on_every_step
