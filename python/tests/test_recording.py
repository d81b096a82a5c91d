"""What NumPy and Python do to q and p is recorded."""

import pickle
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from scipy import special

import equip

MATRIX = np.array([[2.0, 1.0], [1.0, 3.0]])


def stored(q):
    row = np.zeros_like(q)
    row[1] = q[0]
    return row


#: Each is evaluated on floats by NumPy and recorded by equip; the two must agree.
FORMULAS = {
    "matmul": lambda q, p: q @ MATRIX @ q + p @ q,
    "dot": lambda q, p: np.dot(q, p) + np.inner(q, p) + np.vdot(q, p) + np.tensordot(q, p, 1),
    "einsum": lambda q, p: np.einsum("i,ij,j->", q, MATRIX, p) + np.einsum("i,i->", p, p),
    "norm": lambda q, p: np.linalg.norm(q) + np.linalg.norm(p, ord=1) + np.linalg.norm(np.outer(q, p), axis=1).sum(),
    "sums": lambda q, p: sum(q) + np.sum(p) + q.mean() + q.var() + p.std() + np.prod(q) + np.cumsum(p)[1],
    "minimum": lambda q, p: np.minimum(q, 0.5).sum() + q.min() + np.min(p) + np.fmin(0.3, q[0]),
    "maximum": lambda q, p: np.maximum(0.5, q).sum() + q.max() + np.max(p) + np.fmax(p, q).sum(),
    "clip": lambda q, p: np.clip(q, 0.2, 0.4).sum() + p.clip(0.1, 0.9).sum(),
    "abs": lambda q, p: abs(q[0] - 1) + np.abs(p - 0.4).sum() + np.fabs(q[1] - 0.3),
    "arctan2": lambda q, p: np.arctan2(1.0, q[0]) + np.arctan2(q[1], 2) + np.arctan2(q, p).sum() + np.arctan2(0.3, q).sum(),
    "hypot": lambda q, p: np.hypot(3, q[0]) + np.hypot(q, p).sum() + np.hypot(p, 1.0)[0],
    "powers": lambda q, p: (q @ q) ** -0.5 + (2.0**q).sum() + q[0] ** p[0] + (q**3).sum() + np.power(q, 1.5)[0] + q[1] ** -2,
    "exponentials": lambda q, p: (np.exp(q) + np.expm1(p) + np.exp2(q) + np.log(q) + np.log1p(p)).sum(),
    "logarithms": lambda q, p: np.log10(q[0]) + np.log2(p[1]) + np.sqrt(q).sum() + np.square(p).sum() + np.reciprocal(q)[0],
    "circular": lambda q, p: (np.sin(q) + np.cos(p) + np.tan(q) + np.arcsin(q) + np.arccos(p) + np.arctan(q)).sum(),
    "inverse hyperbolic": lambda q, p: (np.arcsinh(q) + np.arccosh(1 + p) + np.arctanh(q) + np.cbrt(p)).sum() + np.cbrt(-q[0]),
    "errors": lambda q, p: equip.erf(q).sum() + equip.erfc(p[0]) + special.erf(p).sum() + special.erfc(q[1]) + equip.erf(0.3),
    "signs": lambda q, p: (np.sign(q - 0.5) * p).sum() + np.sign(q[0] - 0.6),
    "hyperbolic": lambda q, p: (np.sinh(q) + np.cosh(p) + np.tanh(q)).sum(),
    "degrees": lambda q, p: np.degrees(q[0]) + np.radians(p[1]) + np.deg2rad(q).sum() + np.rad2deg(p).sum(),
    "slices": lambda q, p: (q[:, None] - p[None, :]).ravel()[1:3].sum() + np.triu(np.outer(q, q)).sum() + q[::-1] @ p,
    "stacks": lambda q, p: np.stack([q[0], p[1]]) @ np.array([1.0, 2.0]) + (np.concatenate([q, p]) ** 2).sum(),
    "lists": lambda q, p: np.array([q[0], p[1], 1.0]).sum() + np.maximum(np.stack([q[0], 0.4]), 0.3).sum(),
    "products": lambda q, p: np.cross(np.append(q, 0), np.append(p, 0))[2] + np.kron(q, p).sum() + np.outer(q, p).trace(),
    "where": lambda q, p: np.where([True, False], q, 0.0).sum() + np.where(True, q[0], p[0]),
    "masks": lambda q, p: ((q > 0.1) * q**2).sum() + p[0] * (p[0] < 5.0) + (q[0] > 1.0) * 2.0,
    "where by q": lambda q, p: np.where(q > 0.5, q**2, p).sum() + np.where(q < p, q, 0.0)[1] + np.where(0.4 <= q, 1, p).sum(),
    "where by one": lambda q, p: np.where(q[0] > p[0], q, p) @ MATRIX @ q + np.where(q[0] >= 0.5, 2.0, q[0]) + np.where(0.5 > p[1], p[0], 1),
    "where by two": lambda q, p: np.where((q > 0.3) & (p < 0.7), q, p).sum() + np.where((q > 0.6) | ~(p > 0.4), p, 1.5).sum(),
    "where by logic": lambda q, p: np.where(np.logical_and(q > 0.3, np.logical_not(p > 0.6)), q, p).sum()
    + np.where(np.logical_or(q <= 0.3, np.array([True, False])), q, p).sum(),
    "differences": lambda q, p: np.diff(q)[0] + np.roll(q, 1) @ p,
    "chain": lambda q, p: (1 - np.cos(np.diff(np.concatenate([[0.0], q, [0.0]])))).sum() + p @ p,
    "r_": lambda q, p: np.sin(np.r_[0.0, q, 1]).sum() + np.exp(np.c_[q, [1.0, 2.0]]).sum() + np.tan(np.pad(p, 1)).sum(),
    "append": lambda q, p: np.sqrt(np.append(q, 2)).sum() + np.cbrt(np.stack([q[0], 2.0])).sum() + np.fabs(np.append(p, -1)).sum(),
    "stored in zeros": lambda q, p: np.cosh(stored(q)).sum() + np.degrees(np.append(q, 1)).sum() + np.log1p(np.hstack([p, 2])).sum(),
    "where and numbers": lambda q, p: np.log(np.where([True, False], q, 2.0)).sum() + np.arctan2(np.append(q, 1), np.append(p, 2)).sum(),
    "arctan2 of stacks": lambda q, p: np.arctan2(2.0, np.stack([q[0], p[0]])).sum() + np.hypot(2.0, np.stack([q[0], 3.0])).sum(),
    "norms": lambda q, p: np.linalg.norm(q, 3) + np.linalg.norm(p, np.inf) + np.linalg.norm(np.outer(q, p), -np.inf, axis=0).sum() + np.linalg.norm(np.outer(q, p), 4, axis=1)[1],
    "polynomials": lambda q, p: np.polyval([1, 2, 3], q[0]) + np.poly1d([1.0, 2.0])(p[1]) + np.polyval([1, 2, 3], q).sum(),
    "sums by masks": lambda q, p: np.sum(q, where=[True, False]) + p.sum(where=np.array([False, True])) + np.prod(q, where=[True, False]),
    "logaddexp": lambda q, p: np.logaddexp(q[0], 1) + np.logaddexp(q, p).sum() + np.logaddexp(np.append(q, 0.3), 30)[2],
    "item": lambda q, p: q[0].item() + q.sum().item() + p.item(1),
    "scalars": lambda q, p: np.float64(2) * q[0] + 3 * p[0] + q[1] / np.int64(7) - np.float32(0.5) * p[1] + True * q[0],
    "arrays of one": lambda q, p: np.array(2.0) * q[0] + (q[0] * np.array([1.0, 2.0]))[1] + (np.array([1, 2]) - p[0]) @ q,
    "loop": lambda q, p: sum(0.5 * p[i] ** 2 + (q[i] - q[i - 1]) ** 2 for i in range(2)),
}  # fmt: skip


@pytest.mark.parametrize("name", FORMULAS)
def test_formulas_of_numpy_are_recorded(name):
    formula = FORMULAS[name]
    h = equip.Hamiltonian(formula, 2)
    rng = np.random.default_rng(1)
    for q, p in 0.15 + 0.7 * rng.random((20, 2, 2)):
        assert h(q, p) == pytest.approx(float(formula(q.copy(), p.copy())), rel=4e-15)


def test_arrays_change_in_place():
    def energy(q, p):
        total = q.copy()
        total += p
        total[0] *= 2
        return total @ total

    assert equip.Hamiltonian(energy, 2)([1.0, 2.0], [3.0, 5.0]) == 64 + 49


def test_arrays_have_the_shape_of_the_user():
    seen = []

    def energy(q, p):
        seen.append((type(q).__mro__[1], q.shape, p.shape, q.dtype))
        r = q[:, None] - q[None, :]
        i, j = np.triu_indices(6, 1)
        return (p**2).sum() / 2 - (1 / np.linalg.norm(r[i, j], axis=-1)).sum()

    h = equip.Hamiltonian(energy, (6, 3))
    assert seen == [(np.ndarray, (6, 3), (6, 3), np.dtype(object))]
    assert h.shape == (6, 3) and h.degrees_of_freedom == 18 and h.separable and not h.quadratic
    q, p = np.random.default_rng(2).normal(size=(2, 5, 7, 6, 3))
    assert h(q, p).shape == (5, 7)
    assert [x.shape for x in h.gradient(q, p)] == [(5, 7, 6, 3)] * 2
    assert h.hessian(q, p).shape == (5, 7, 36, 36)
    assert h(q, p)[2, 3] == h(q[2, 3], p[2, 3])
    assert np.array_equal(h.gradient(q, p)[0][2, 3], h.gradient(q[2, 3], p[2, 3])[0])
    assert np.array_equal(h.gradient(q, p)[1][2, 3], p[2, 3])
    assert isinstance(h(q[0, 0], p[0, 0]), float)
    with pytest.raises(ValueError, match=r"q has shape \(6,\), but this Hamiltonian needs \(6, 3\)"):
        h(np.zeros(6), p)


def test_hessian_is_the_derivative_of_the_gradient(kepler):
    q, p, d = np.array([0.7, -0.3]), np.array([0.2, 0.5]), 1e-6
    columns = []
    for j in range(2):
        step = np.eye(2)[j] * d
        columns.append(
            (np.concatenate(kepler.gradient(q + step, p)) - np.concatenate(kepler.gradient(q - step, p)))
            / (2 * d)
        )
    assert np.allclose(kepler.hessian(q, p)[:, :2], np.array(columns).T, atol=1e-8)
    assert np.array_equal(kepler.hessian(q, p)[2:, 2:], np.eye(2))


def test_half_integer_powers_are_roots():
    by_power = equip.Hamiltonian(lambda q, p: (q @ q) ** -0.5, 2)
    by_root = equip.Hamiltonian(lambda q, p: 1 / np.sqrt(q @ q), 2)
    assert by_power.operations == by_root.operations


@pytest.mark.parametrize("q", [[1j, 0], np.array(["2020", "2021"], dtype="M8[Y]")])
def test_states_are_real(kepler, q):
    for f in (kepler, kepler.gradient, kepler.hessian):
        with pytest.raises(
            ValueError, match="q is of dtype (complex128|datetime64.*); it must be real numbers"
        ):
            f(q, [0, 1])


def test_captured_arrays_are_read_once():
    masses = np.array([1.0, 2.0])
    h = equip.Hamiltonian(lambda q, p: (masses * p * p).sum(), 2)
    masses[:] = 100
    assert h([0, 0], [1, 1]) == 3


def test_repeated_operations_are_counted_once():
    assert equip.Hamiltonian(lambda q, p: np.sin(q[0] * p[0]) + np.cos(p[0] * q[0]), 1).operations == 4


@pytest.mark.parametrize(
    "third",
    [Fraction(1, 3), "0.33333333333333333333333333333333333333", Decimal(1) / Decimal(3), Fraction(10**40, 3 * 10**40),
     Fraction(10**40 + 1, 3 * 10**40 + 3)],
)  # fmt: skip
def test_constants_are_exact_in_double_double(third):
    # q' = 1/3: after t = 3 it has moved by 1, to the digits of the constant.
    h = equip.Hamiltonian(lambda q, p: third * p[0], 1)
    end = equip.solve(h, [0], [1], (0, 3), step=1, precision="dd")
    error = (end.q[-1, 0] - 1) + end.q_low[-1, 0]
    assert abs(error) < (1e-27 if isinstance(third, Decimal) else 1e-30)
    assert h([0.0], [1.0]) == 1 / 3


@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 60, reason="long double is double here")
def test_long_doubles_are_exact_in_double_double():
    third = np.longdouble(1) / 3
    h = equip.Hamiltonian(lambda q, p: third * p[0], 1)
    end = equip.solve(h, [0], [1], (0, 3), step=1, precision="dd")
    assert 1e-21 < abs((end.q[-1, 0] - 1) + end.q_low[-1, 0]) < 1e-18


def test_large_integers_are_exact():
    h = equip.Hamiltonian(lambda q, p: (2**70 + 1) * q[0] - (2**70) * p[0], 1)
    end = equip.solve(h, [0], [0], (0, 1), step=1, precision="dd")
    assert end.p[-1, 0] == -(2.0**70) and end.p_low[-1, 0] == pytest.approx(-1, abs=1e-9)


def module_level_energy(q, p):
    return p @ p / 2 + q @ q


def test_pickles():
    h = equip.Hamiltonian(lambda q, p: (p**2).sum() / 2 + Fraction(1, 3) * np.cos(q).sum(), (2, 2))
    again = pickle.loads(pickle.dumps(h))
    assert again.shape == (2, 2) and again == h and hash(again) == hash(h) and again != equip.scenes.kepler()
    q, p = np.random.default_rng(3).normal(size=(2, 2, 2))
    runs = [equip.solve(x, q, p, (0, 3), precision="dd") for x in (h, again)]
    assert all(np.array_equal(getattr(runs[0], name), getattr(runs[1], name)) for name in ("t", "y", "y_low"))
    scene = pickle.loads(pickle.dumps(equip.scenes.kepler(e=0.3)))
    assert scene.parameters["e"] == "0.3" and np.array_equal(scene.q0, [0.7, 0])
    momentum = pickle.loads(pickle.dumps(scene.invariants["angular momentum"]))
    assert momentum([1.0, 0.0], [0.0, 2.0]) == 2


def test_error_functions_of_numbers():
    x = np.linspace(-2, 2, 9)
    assert np.allclose(equip.erf(x), special.erf(x), rtol=0, atol=1e-15) and equip.erf(x).dtype == float
    assert equip.erfc(7.0) == pytest.approx(special.erfc(7.0), rel=1e-13) and isinstance(
        equip.erf(0.5), float
    )


def test_recordings_in_bytes_are_checked(kepler):
    recording = kepler.to_bytes()
    assert equip.Hamiltonian.from_bytes(recording, 2) == kepler
    with pytest.raises(ValueError, match="these bytes are not an energy"):
        equip.Hamiltonian.from_bytes(b"something else", 2)
    with pytest.raises(ValueError, match="these bytes are damaged"):
        equip.Hamiltonian.from_bytes(recording[:-1], 2)
    damaged = bytearray(recording)
    damaged[-3] ^= 4
    with pytest.raises(ValueError, match="their checksum is not that of their content"):
        equip.Hamiltonian.from_bytes(bytes(damaged), 2)
    with pytest.raises(ValueError, match="shape is 3, but what was recorded has 2 positions"):
        equip.Hamiltonian.from_bytes(recording, 3)


def test_repr():
    assert (
        repr(equip.Hamiltonian(module_level_energy, 2))
        == "<Hamiltonian of shape (2,), quadratic, 8 operations>"
    )


@pytest.mark.parametrize("n", [2**64 - 1, 2**63 - 1, -(2**63), 2**53 + 1, 2**62 + 3])
def test_arrays_of_integers_are_exact_in_double_double(n):
    free = equip.Hamiltonian(lambda q, p: p @ p / 2, 1)
    q0 = np.array([n], dtype=np.uint64 if n >= 2**63 else np.int64)
    sol = equip.solve(free, q0, [0], (0, 1), precision="dd", step=1)
    assert int(sol.q[0, 0]) + int(sol.q_low[0, 0]) == n
