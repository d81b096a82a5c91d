"""Variable steps that are the same backwards."""

import numpy as np
import pytest

import equip


@pytest.mark.parametrize("rule", ["explicit", "integral"])
@pytest.mark.parametrize("sigma", [None, lambda q, p: (q @ q) ** 0.75])
def test_there_and_back(kepler, rule, sigma):
    steps = equip.Reversible(0.2, sigma, rule)
    there = equip.solve(kepler, [0.4, 0.0], [0.0, 2.0], (0, 2 * np.pi * 10), step=steps)
    assert there.success and there.certificate.energy_kept_on_every_step
    # A whole number of periods: measured 1e-10 and less.
    assert np.abs(there.q[-1] - [0.4, 0.0]).max() < 1e-8
    sizes = np.diff(there.t)[:-1]
    assert sizes.max() > 3 * sizes.min()
    back = equip.solve(kepler, there.q[-1], there.p[-1], (there.t[-1], 0.0), step=steps)
    assert np.abs(back.q[-1] - [0.4, 0.0]).max() < 1e-10


def test_steps_one_by_one_and_ensembles(kepler):
    steps = equip.Reversible(0.2)
    sol = equip.solve(kepler, [0.4, 0.0], [0.0, 2.0], (0, 10), step=steps)
    run = equip.steps(kepler, [0.4, 0.0], [0.0, 2.0], step=steps)
    for i in range(1, 10):
        assert np.array_equal(next(run).q, sol.q[i])
    run.restart([0.4, 0.0], [0.0, 2.0])
    assert np.array_equal(next(run).q, sol.q[1])
    ends = equip.ensemble(kepler, [[0.4, 0.0]] * 3, [[0.0, 2.0]] * 3, (0, 10), step=steps, threads=2)
    assert all(np.array_equal(q, sol.q[-1]) for q in ends.q)


def test_refusals(kepler):
    start = ([0.4, 0.0], [0.0, 2.0], (0, 1))
    with pytest.raises(ValueError, match="epsilon"):
        equip.solve(kepler, *start, step=equip.Reversible(-1.0))
    with pytest.raises(ValueError, match="rule is 'other'"):
        equip.solve(kepler, *start, step=equip.Reversible(0.1, rule="other"))
    with pytest.raises(ValueError, match="a step or a tolerance, not both"):
        equip.solve(kepler, *start, step=equip.Reversible(0.1), tolerance=1e-9)
    with pytest.raises(ValueError, match="max_step"):
        equip.solve(kepler, *start, step=equip.Reversible(0.1), max_step=1.0)
    with pytest.raises(ValueError, match="sigma is made for shape"):
        equip.solve(
            kepler, *start, step=equip.Reversible(0.1, equip.Hamiltonian(lambda q, p: 1 + q[0] ** 2, 1))
        )
    with pytest.raises((ValueError, equip.IntegrationError), match="positive"):
        equip.solve(kepler, *start, step=equip.Reversible(0.1, lambda q, p: -1 - q @ q))
