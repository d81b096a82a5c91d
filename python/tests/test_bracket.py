"""Systems y' = B(y) ∇H(y) whose bracket is not canonical."""

import pickle

import numpy as np
import pytest

from equip import Equip, Hamiltonian, Hbvm, solve

INERTIA = np.array([1.0, 2.0, 3.0])


def rigid_body():
    """Euler's equations m' = m × ω, y = (m, 0), with a quartic term that no Gauss method conserves."""

    def energy(q, p):
        m = (q[0], q[1], p[0])
        return sum(m**2 / i for m, i in zip(m, INERTIA)) / 2 + q[0] ** 4 / 4

    return Hamiltonian(energy, 2).with_bracket(lambda q, p: {(0, 1): -p[0], (0, 2): q[1], (1, 2): -q[0]})


def rate(t, m):
    omega = m / INERTIA + np.array([m[0] ** 3, 0, 0])
    return np.cross(m, omega)


def test_a_rigid_body_beside_scipy():
    scipy = pytest.importorskip("scipy.integrate")
    start = np.array([0.9, 0.2, 0.4])
    body = rigid_body()
    assert not body.is_canonical
    method = Equip(stages=6)
    run = solve(body, start[:2], [start[2], 0.0], (0, 10), method=method, tolerance=1e-12)
    found = np.concatenate([run.q[-1], run.p[-1]])
    expected = scipy.solve_ivp(rate, (0, 10), start, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    np.testing.assert_allclose(found[:3], expected, atol=1e-11)
    assert found[3] == 0
    assert abs(found @ found - start @ start) < 1e-14
    assert np.abs(run.energy_error).max() < 1e-14


def test_a_pickled_one_is_the_same():
    body = rigid_body()
    again = pickle.loads(pickle.dumps(body))
    assert again == body and not again.is_canonical
    plain = Hamiltonian(lambda q, p: q @ q + p @ p, 2)
    assert plain.is_canonical and plain.with_bracket(lambda q, p: {(0, 1): q[0]}) != plain


@pytest.mark.parametrize(
    "bracket, error, text",
    [
        (lambda q, p: {(0, 4): q[0]}, ValueError, "outside of the 4 components"),
        (lambda q, p: {(0, -1): q[0]}, ValueError, "outside of the 4 components"),
        (lambda q, p: {(1, 1): q[0]}, ValueError, "diagonal"),
        (lambda q, p: {(0, 1): q[0], (1, 0): q[0]}, ValueError, "twice"),
        (lambda q, p: [[0, 1], [-1, 0]], TypeError, "dict"),
        (lambda q, p: {0: q[0]}, TypeError, "no place"),
        (lambda q, p: {(0, 1): q}, TypeError, "array of shape"),
        (lambda q: {}, TypeError, "function of"),
        (lambda q, p: {(0, 1): 1 if q[0] > 0 else 2}, TypeError, "compar"),
        (lambda q, p: {(0, 1): np.nan}, ValueError, "NaN"),
    ],
)
def test_what_is_no_bracket_is_refused(bracket, error, text):
    energy = Hamiltonian(lambda q, p: q @ q + p @ p, 2)
    with pytest.raises(error, match=text):
        energy.with_bracket(bracket)


def test_energies_without_a_bracket_are_refused():
    external = Hamiltonian.external(lambda q, p: q @ q, lambda q, p: (2 * q, 0 * p), 1)
    with pytest.raises(TypeError, match="external"):
        external.with_bracket(lambda q, p: {(0, 1): 1})
    timed = Hamiltonian.with_time(lambda t, q, p: t * q @ q, 1)
    with pytest.raises(ValueError, match="depends on time"):
        timed.with_bracket(lambda q, p: {(0, 1): 1})


def test_hbvm_conserves_h_with_a_constant_bracket_only():
    energy = Hamiltonian(lambda q, p: (q @ q + 2 * p @ p) / 2 + q[1] ** 4 + 0.3 * q[0] * p[0], 2)
    constant = energy.with_bracket(lambda q, p: {(0, 1): 1, (0, 2): 0.3, (1, 2): -0.5})
    body = energy.with_bracket(lambda q, p: {(0, 1): -p[0], (0, 2): q[1], (1, 2): -q[0]})
    errors = [
        np.abs(solve(h, [0.9, 0.2], [0.4, 0.0], (0, 20), method=Hbvm(8, 2), step=0.4).energy_error).max()
        for h in (constant, body)
    ]
    assert errors[0] < 1e-14 and errors[1] > 1e-8
