"""Energies that other code computes."""

import math
import pickle

import numpy as np
import pytest

import equip

Q0, P0 = np.array([0.4, 0.0]), np.array([0.0, 2.0])


def value(q, p):
    return p @ p / 2 - 1 / math.hypot(*q)


def gradient(q, p):
    return q / math.hypot(*q) ** 3, p


KEPLER = equip.Hamiltonian.external(value, gradient, shape=2)
RECORDED = equip.Hamiltonian(lambda q, p: p @ p / 2 - 1 / np.sqrt(q @ q), shape=2)


def test_it_moves_as_the_recorded_energy():
    """Kepler's ellipse of eccentricity .6 closes after 2π."""
    options = {"method": equip.Equip(8), "tolerance": 1e-12}
    run = equip.solve(KEPLER, Q0, P0, (0, 2 * math.pi), **options)
    assert np.abs(np.concatenate([run.q[-1] - Q0, run.p[-1] - P0])).max() < 1e-10
    assert run.certificate.energy_conserved_on_every_step
    assert abs(value(run.q[-1], run.p[-1]) - value(Q0, P0)) < 1e-14
    same = equip.solve(RECORDED, Q0, P0, (0, 2 * math.pi), **options)
    np.testing.assert_allclose(run.q[-1], same.q[-1], atol=1e-10)


def test_values_and_derivatives():
    np.testing.assert_allclose(KEPLER(Q0, P0), RECORDED(Q0, P0), rtol=1e-15)
    for found, known in zip(KEPLER.gradient(Q0, P0), RECORDED.gradient(Q0, P0)):
        np.testing.assert_allclose(found, known, rtol=1e-14)
    np.testing.assert_allclose(KEPLER.hessian(Q0, P0), RECORDED.hessian(Q0, P0), atol=1e-6)
    assert KEPLER.is_external and not RECORDED.is_external
    assert repr(KEPLER) == "<Hamiltonian of shape (2,), external>"


def test_axes_are_the_users():
    def energy(q, p):
        assert q.shape == p.shape == (3, 2)
        return np.sum(p**2) / 2 + np.sum(q**2) / 2

    springs = equip.Hamiltonian.external(energy, lambda q, p: (q, p), shape=(3, 2))
    run = equip.solve(springs, np.ones((3, 2)), np.zeros((3, 2)), (0, 1), method=equip.Gauss(4), step=0.1)
    np.testing.assert_allclose(run.q[-1], math.cos(1.0), atol=1e-10)


def test_steps_and_many_runs():
    starts = np.tile(Q0, (2, 1)), np.tile(P0, (2, 1))
    steps = equip.steps(KEPLER, Q0, P0, method=equip.Equip(6), step=0.05)
    end = steps.advance_to(1.0)
    many = equip.ensemble(KEPLER, *starts, (0, 1), method=equip.Equip(6), step=0.05)
    np.testing.assert_allclose(many.q, np.tile(end.q, (2, 1)), rtol=1e-13)


class Broken(Exception):
    pass


def test_exceptions_are_handed_on():
    """Those of a function in the midst of a run, unchanged."""

    def broken(q, p):
        if q[0] < 0:
            raise Broken("no data there")
        return value(q, p)

    def pulled(q, p):
        broken(q, p)
        return gradient(q, p)

    for h in (
        equip.Hamiltonian.external(broken, gradient, 2),
        equip.Hamiltonian.external(value, pulled, 2),
    ):
        with pytest.raises(Broken, match="no data there"):
            equip.solve(h, Q0, P0, (0, 3), step=0.05)
        with pytest.raises(Broken):
            equip.steps(h, Q0, P0, step=0.05).advance_to(3)
        with pytest.raises(Broken):
            equip.ensemble(h, [Q0], [P0], (0, 3), step=0.05)
        # The run ends at once, and nothing of it is left.
        assert equip.solve(h, Q0, P0, (0, 0.2), step=0.05).success
    with pytest.raises(Broken):
        equip.Hamiltonian.external(broken, gradient, 2)([-1.0, 0.0], P0)


def test_the_first_exception_ends_the_run():
    calls = 0

    def broken(q, p):
        nonlocal calls
        calls += 1
        if calls == 100:
            raise Broken
        return gradient(q, p)

    h = equip.Hamiltonian.external(value, broken, 2)
    with pytest.raises(Broken):
        equip.solve(h, Q0, P0, (0, 100))
    assert calls == 100


@pytest.mark.parametrize("precision", [np.float32, np.float64])
def test_gradients_in_single_precision(precision):
    def rounded(q, p):
        return gradient(q, p)[0].astype(precision), p

    declared = equip.Hamiltonian.external(value, rounded, 2, accuracy=2.0**-23)
    assert equip.solve(declared, Q0, P0, (0, 3)).success
    exact = equip.Hamiltonian.external(value, rounded, 2)
    if precision is np.float32:
        with pytest.raises(ValueError, match="single precision"):
            equip.solve(exact, Q0, P0, (0, 3))
    else:
        assert equip.solve(exact, Q0, P0, (0, 3)).success
    # At states in single precision a gradient in doubles may be in single precision too.
    spring = equip.Hamiltonian.external(lambda q, p: (q @ q + p @ p) / 2, lambda q, p: (q, p), 2)
    for state in np.random.default_rng(1).random((20, 4)).astype(np.float32):
        spring.gradient(state[:2], state[2:])
    assert equip.solve(spring, state[:2], state[2:], (0, 3)).success


def test_what_is_refused():
    wrong = equip.Hamiltonian.external(value, lambda q, p: (q, p), 2)
    with pytest.raises(ValueError, match="gradient"):
        equip.solve(wrong, Q0, P0, (0, 1), step=0.1)
    with pytest.raises(ValueError, match="accuracy"):
        equip.Hamiltonian.external(value, gradient, 2, accuracy=0.0)
    with pytest.raises(TypeError, match="must be a function of q and p"):
        equip.Hamiltonian.external(value, 1.0, 2)
    with pytest.raises(TypeError, match=r"shape \(3,\); it must be \(2,\)"):
        equip.Hamiltonian.external(value, lambda q, p: (np.zeros(3), p), 2).gradient(Q0, P0)
    with pytest.raises(TypeError, match="two arrays"):
        equip.Hamiltonian.external(value, lambda q, p: q, 2).gradient(Q0, P0)
    with pytest.raises(TypeError, match="one number"):
        equip.Hamiltonian.external(lambda q, p: q, gradient, 2)(Q0, P0)
    with pytest.raises(TypeError, match="can be recorded"):
        equip.solve(RECORDED, Q0, P0, (0, 1), step=0.1, invariants={"E": KEPLER})


MASSES = np.array([[1.0], [2.0], [0.5]])


def bonds(q):
    return np.sum((np.roll(q, -1, axis=0) - q) ** 4) / 4 + np.sum(q**2) / 2


def bond_gradient(q):
    stretched = (np.roll(q, -1, axis=0) - q) ** 3
    return np.roll(stretched, 1, axis=0) - stretched + q


RING = equip.Hamiltonian.external_potential(bonds, bond_gradient, shape=(3, 2), masses=MASSES)


def test_a_potential_with_masses():
    """Three particles in the plane, in half the gradients of the same H as a whole."""
    whole = equip.Hamiltonian.external(
        lambda q, p: np.sum(p**2 / MASSES) / 2 + bonds(q),
        lambda q, p: (bond_gradient(q), p / MASSES),
        shape=(3, 2),
    )
    recorded = equip.Hamiltonian(lambda q, p: np.sum(p**2 / MASSES) / 2 + bonds(q), shape=(3, 2))
    q, p = np.array([[1.0, 0.2], [-0.4, 0.7], [0.1, -0.9]]), np.array([[0.3, 0.1], [0.5, -0.2], [0.0, 0.4]])
    np.testing.assert_allclose(RING(q, p), recorded(q, p), rtol=1e-15)
    np.testing.assert_allclose(RING.hessian(q, p), recorded.hessian(q, p), atol=1e-7)
    assert RING.separable and RING.is_external
    options = {"method": equip.Equip(6), "tolerance": 1e-12}
    runs = [equip.solve(h, q, p, (0, 5), **options) for h in (RING, whole, recorded)]
    for run in runs:
        assert run.certificate.energy_conserved_on_every_step
        np.testing.assert_allclose(run.q[-1], runs[2].q[-1], atol=1e-9)
    assert runs[0].nfev < 0.7 * runs[1].nfev


def test_what_is_refused_of_a_potential():
    potential = equip.Hamiltonian.external_potential
    with pytest.raises(ValueError, match="mass 2 is 0e0"):
        potential(bonds, bond_gradient, (3, 2), masses=[[1.0], [0.0], [1.0]])
    with pytest.raises(ValueError, match=r"masses has shape \(2, 3\)"):
        potential(bonds, bond_gradient, (3, 2), masses=np.ones((2, 3)))
    with pytest.raises(TypeError, match=r"value must be a function of \(q\)"):
        potential(lambda q, p: 0.0, bond_gradient, (3, 2))
    with pytest.raises(TypeError, match=r"shape \(2,\); it must be \(3, 2\)"):
        potential(bonds, lambda q: q[0], (3, 2)).gradient(np.ones((3, 2)), np.ones((3, 2)))
    with pytest.raises(ValueError, match="gradient"):
        equip.solve(potential(bonds, lambda q: q, (3, 2)), np.eye(3, 2), np.zeros((3, 2)), (0, 1), step=0.1)


def test_it_is_pickled_by_its_functions(tmp_path):
    for h in (KEPLER, RING):
        again = pickle.loads(pickle.dumps(h))
        assert again == h and hash(again) == hash(h) and again != RECORDED
    run = equip.solve(KEPLER, Q0, P0, (0, 0.2), step=0.05)
    with pytest.raises(ValueError, match="an external energy cannot be stored"):
        run.save(tmp_path / "run.npz")


def test_ensembles_are_told_apart(tmp_path):
    """By values, since the code of an external energy is not known."""
    potential = equip.Hamiltonian.external_potential
    soft, stiff = (
        potential(lambda q: q @ q / 2, lambda q: q, 1),
        potential(lambda q: 2 * q @ q, lambda q: 4 * q, 1),
    )
    starts, path = ([[1.0], [2.0]], [[0.0], [0.0]]), tmp_path / "rows.npz"
    first = equip.ensemble(soft, *starts, (0, 1.0), checkpoint=path)
    np.testing.assert_allclose(first.q, np.cos(1.0) * np.array(starts[0]), rtol=1e-10)
    again = equip.ensemble(soft, *starts, (0, 1.0), checkpoint=path)
    assert np.array_equal(again.q, first.q)
    others = [
        (stiff, *starts, (0, 1.0)),
        (soft, [[5.0], [7.0]], starts[1], (0, 1.0)),
        (soft, *starts, (0, 9.0)),
    ]
    for other in others:
        with pytest.raises(ValueError, match="other"):
            equip.ensemble(*other, checkpoint=path)
        with pytest.raises(ValueError, match="resume has runs with another H"):
            equip.ensemble(*other, resume=first)
