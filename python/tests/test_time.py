"""H(t, q, p)."""

import pickle
from concurrent.futures import ProcessPoolExecutor
from decimal import Decimal
from multiprocessing import get_context

import numpy as np
import pytest

import equip


def driven(t, q, p):
    return (p @ p + q @ q) / 2 - q[0] * np.cos(t / 2)


@pytest.fixture
def pushed():
    return equip.Hamiltonian.with_time(driven, shape=1)


def exact(t):
    """From rest at 0: q'' = -q + cos(t/2)."""
    return 4 / 3 * (np.cos(t / 2) - np.cos(t)), 4 / 3 * (np.sin(t) - np.sin(t / 2) / 2)


def test_values_and_derivatives(pushed):
    assert pushed.has_time and pushed.shape == (1,) and pushed.degrees_of_freedom == 1
    assert "of time" in repr(pushed)
    t, q, p = np.random.default_rng(1).normal(size=(3, 20))
    value = (p**2 + q**2) / 2 - q * np.cos(t / 2)
    assert np.allclose(pushed(q[:, None], p[:, None], t), value, rtol=1e-15, atol=1e-15)
    by_q, by_p = pushed.gradient(q[:, None], p[:, None], t)
    assert np.allclose(by_q[:, 0], q - np.cos(t / 2), rtol=1e-15, atol=1e-15)
    assert np.array_equal(by_p[:, 0], p)
    assert np.array_equal(pushed.hessian([1.0], [2.0], 0.5), np.eye(2))
    many = pushed([1.0], [0.0], np.linspace(0, 1, 5))
    assert many.shape == (5,) and many[0] == -0.5


def test_shapes_of_several_axes():
    h = equip.Hamiltonian.with_time(lambda t, q, p: (p**2).sum() / 2 + t * (q**3).sum(), shape=(2, 3))
    q, p = np.arange(6.0).reshape(2, 3), np.ones((2, 3))
    assert h(q, p, 2.0) == 3 + 2 * (q**3).sum()
    by_q, by_p = h.gradient(q, p, 2.0)
    assert np.array_equal(by_q, 6 * q**2) and np.array_equal(by_p, p)
    assert np.array_equal(h.hessian(q, p, 2.0), np.diag([*12 * q.ravel(), *np.ones(6)]))


def test_a_function_of_time_is_called_once():
    calls = []

    def h(t, q, p):
        calls.append(t)
        return p @ p / 2 + (1 + len(calls)) * q @ q / 2 + 0 * t

    h = equip.Hamiltonian.with_time(h, shape=1)
    assert len(calls) == 1
    run = equip.solve(h, [1.0], [0.0], (0, 10))
    assert abs(run.q[-1, 0] - np.cos(10 * np.sqrt(2))) < 1e-10


@pytest.mark.parametrize("how", [{"step": 0.1}, {"tolerance": 1e-13}])
def test_closed_form(pushed, how):
    sol = equip.solve(pushed, [0.0], [0.0], (0, 50), dense_output=True, **how)
    q, p = exact(sol.t)
    # Measured 1e-13 and less.
    assert np.abs(sol.q[:, 0] - q).max() < 2e-12 and np.abs(sol.p[:, 0] - p).max() < 2e-12
    # H less the energy that has gone in is kept; H is not.
    assert np.abs(sol.energy_error).max() < 1e-13
    assert np.ptp(pushed(sol.q, sol.p, sol.t)) > 1
    times = np.linspace(0, 50, 77)
    assert np.abs(sol.sol(times)[0][:, 0] - exact(times)[0]).max() < 1e-11


def test_damped_oscillator_beside_scipy():
    integrate = pytest.importorskip("scipy.integrate")
    h = equip.Hamiltonian.with_time(
        lambda t, q, p: np.exp(-0.2 * t) * p[0] ** 2 / 2 + np.exp(0.2 * t) * (1 - np.cos(q[0])), shape=1
    )

    def theirs(t, y):
        return [np.exp(-0.2 * t) * y[1], -np.exp(0.2 * t) * np.sin(y[0])]

    sol = equip.solve(h, [2.0], [0.0], (1, 12), tolerance=1e-12)
    scipy = integrate.solve_ivp(theirs, (1, 12), [2.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-14)
    assert np.abs(sol.y[-1] - scipy.y[:, -1]).max() < 1e-9


def test_outputs_events_and_quantities(pushed):
    def moving(t, q, p):
        return q[0] - t / 10

    sol = equip.solve(
        pushed,
        [0.0],
        [0.0],
        (0, 20),
        events=[lambda t, q, p: p[0], moving],
        t_eval=[1.0, 7.5],
        invariants={"H": driven, "q": lambda t, q, p: q[0]},
    )
    assert np.abs(sol.q[:, 0] - exact(np.array([1.0, 7.5]))[0]).max() < 1e-11
    assert np.abs(exact(sol.t_events[0])[1]).max() < 1e-11 and len(sol.t_events[0]) > 5
    assert np.abs(exact(sol.t_events[1])[0] - sol.t_events[1] / 10).max() < 1e-11
    energy, position = sol.certificate.invariants
    assert energy.max > 0.5 and position.start == 0 and sol.certificate.energy.max < 1e-13
    assert sol.energy_error.shape == (0,)


def test_double_double_has_its_digits():
    h = equip.Hamiltonian.with_time(driven, 1)
    sol = equip.solve(h, ["0"], ["0"], (0, 10), precision="dd", method=equip.Equip(stages=10))
    # 4/3 (cos 5 - cos 10) to 40 digits, by mpmath.
    exact = Decimal("1.496978286052904955634004159116829523806")
    assert abs(Decimal(str(sol.q_text()[-1, 0])) - exact) < Decimal("1e-24")


def test_steps_carry_tangent_vectors(pushed):
    run = equip.steps(pushed, [0.0], [0.0], step=0.1, tangent_vectors=[1.0, 0.0])
    for _ in range(30):
        next(run)
    t = run.last.t
    assert np.abs(run.tangent_vectors - [[np.cos(t), -np.sin(t)]]).max() < 1e-12
    run.tangent_vectors = [[0.0, 1.0]]
    run.restart([0.0], [0.0])
    assert run.last.t == 0 and np.array_equal(run.tangent_vectors, [[0.0, 1.0]])
    kept = equip.solve(pushed, [0.0], [0.0], (0, 100), chaos=True).certificate
    assert abs(kept.lyapunov) < 0.1


def test_recording_travels(pushed, tmp_path):
    again = pickle.loads(pickle.dumps(pushed))
    assert again == pushed and again.has_time
    sol = equip.solve(pushed, [0.0], [0.0], (0, 5))
    assert np.array_equal(equip.solve(again, [0.0], [0.0], (0, 5)).y, sol.y)
    sol.save(tmp_path / "run.npz")
    assert equip.load(tmp_path / "run.npz").hamiltonian == pushed
    path = tmp_path / "checkpoint"
    equip.solve(pushed, [0.0], [0.0], (0, 5), step=0.125, checkpoint=path)
    rest = equip.solve(pushed, [0.0], [0.0], (0, 10), step=0.125, checkpoint=path)
    whole = equip.solve(pushed, [0.0], [0.0], (0, 10), step=0.125)
    assert np.array_equal(rest.y[-1], whole.y[-1])


def test_ensembles(pushed):
    q0, p0 = np.linspace(0, 1, 7)[:, None], np.zeros((7, 1))
    keep = {"preserve": {"q³ of nothing": lambda t, q, p: 0 * t + 0 * q[0] ** 3}}
    here = equip.ensemble(pushed, q0, p0, (0, 10), threads=2)
    for i in range(7):
        assert np.array_equal(equip.solve(pushed, q0[i], p0[i], (0, 10)).q[-1], here.q[i])
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        for how in ({}, keep):
            there = equip.ensemble(pushed, q0, p0, (0, 3), executor=pool, **how)
            assert np.array_equal(there.q, equip.ensemble(pushed, q0, p0, (0, 3), **how).q)


def test_refusals(pushed, kepler):
    with pytest.raises(TypeError, match="H depends on time: give t after q and p"):
        pushed([1.0], [0.0])
    with pytest.raises(TypeError, match="H does not depend on time: leave out t"):
        kepler([1.0, 0.0], [0.0, 1.0], 0.0)
    with pytest.raises(TypeError, match="a function of t, q and p"):
        equip.Hamiltonian.with_time(3, 1)
    with pytest.raises(TypeError, match="compared"):
        equip.Hamiltonian.with_time(lambda t, q, p: q[0] if t > 0 else p[0], 1)
    with pytest.raises(ZeroDivisionError):
        equip.Hamiltonian.with_time(lambda t, q, p: 1 / 0, 1)
    with pytest.raises(TypeError, match=r"H\(t, q, p\) must return one number"):
        equip.Hamiltonian.with_time(lambda t, q, p: "one" if False else None, 1)
    with pytest.raises(ValueError, match=r"invariants\['quantity'\] is made for shape"):
        equip.solve(pushed, [0.0], [0.0], (0, 1), invariants={"quantity": kepler})
