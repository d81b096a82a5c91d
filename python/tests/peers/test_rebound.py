"""An example of REBOUND's documentation: a star with two planets of its page on MEGNO."""

import numpy as np
import pytest

import equip

rebound = pytest.importorskip("rebound")

END = 5e2 * 2 * np.pi


def simulation():
    sim = rebound.Simulation()
    sim.integrator = "ias15"
    sim.add(m=1.0)
    sim.add(m=0.000954, a=5.204, M=0.600, omega=0.257, e=0.048)
    sim.add(m=0.000285, a=7.0, M=0.871, omega=1.616, e=0.1)
    sim.move_to_com()
    return sim


def test_two_planets():
    sim = simulation()
    m, q0, v0 = (np.array([getattr(b, name) for b in sim.particles]) for name in ("m", "xyz", "vxyz"))
    i, j = np.triu_indices(3, 1)
    h = equip.Hamiltonian(
        lambda q, p: (
            (p**2 / (2 * m[:, None])).sum() - (m[i] * m[j] / np.linalg.norm(q[i] - q[j], axis=1)).sum()
        ),
        (3, 3),
    )
    ours = equip.solve(h, q0, m[:, None] * v0, (0, END), record="ends", chaos=True)
    sim.integrate(END)
    difference = np.abs(ours.q[-1] - [b.xyz for b in sim.particles]).max()
    sim = simulation()
    # Its deviation at the start is drawn by its own generator.
    sim.init_megno(seed=1)
    sim.integrate(END)
    theirs = sim.megno() if hasattr(sim, "megno") else sim.calculate_megno()
    print("largest difference", difference, "MEGNO", ours.certificate.megno, theirs)
    assert difference < 1e-8
    # Regular motion: both tend to 2, from starts of their own. Printed there: 2.05.
    assert abs(ours.certificate.megno - 2) < 0.3 and abs(theirs - 2) < 0.3
    assert abs(sim.energy() - h(q0, m[:, None] * v0)) < 1e-15
