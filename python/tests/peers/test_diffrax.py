"""An example of diffrax's documentation: its page on coupled equations."""

import numpy as np
import pytest

import equip

diffrax = pytest.importorskip("diffrax")


def test_coupled_equations():
    """Prey and predators, to t = 140: H in the logarithms q = ln prey, p = ln predators."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    a, b, c, d = 0.1, 0.02, 0.4, 0.02
    times = np.linspace(0, 140, 1000)

    def slope(t, y, args):
        prey, predators = y
        return a * prey - b * prey * predators, -c * predators + d * prey * predators

    def theirs(solver, **options):
        sol = diffrax.diffeqsolve(
            diffrax.ODETerm(slope),
            solver,
            t0=0,
            t1=140,
            dt0=0.1,
            y0=(jnp.array(10.0), jnp.array(10.0)),
            saveat=diffrax.SaveAt(ts=jnp.array(times)),
            max_steps=100_000,
            **options,
        )
        return np.array(sol.ys).T

    h = equip.Hamiltonian(lambda q, p: a * p[0] - b * np.exp(p[0]) + c * q[0] - d * np.exp(q[0]), 1)
    ours = equip.solve(h, [np.log(10)], [np.log(10)], (0, 140), t_eval=times, tolerance=1e-12)
    # As that page has it: Tsit5 in equal steps of 0.1; then by a tolerance.
    plain = np.abs(np.exp(ours.y) - theirs(diffrax.Tsit5())).max()
    control = diffrax.PIDController(rtol=1e-12, atol=1e-12)
    fine = np.abs(np.exp(ours.y) - theirs(diffrax.Dopri8(), stepsize_controller=control)).max()
    print("largest difference", plain, fine)
    assert plain < 1e-4 and fine < 1e-8
    assert ours.certificate.energy_conserved_on_every_step
