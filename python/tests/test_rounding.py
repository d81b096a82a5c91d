"""Rounding to integers within H: values as NumPy has them, derivatives, and runs over the jumps."""

import math
import pickle
from fractions import Fraction

import numpy as np
import pytest

import equip

FORMULAS = {
    "floor": lambda x: np.floor(x),
    "ceil": lambda x: np.ceil(x),
    "trunc": lambda x: np.trunc(x),
    "fix": lambda x: np.fix(x),
    "rint": lambda x: np.rint(x),
    "round": lambda x: np.round(x),
    "two decimals": lambda x: np.round(x, 2),
    "hundreds": lambda x: np.round(1000 * x, -2),
    "mod": lambda x: np.mod(x, 0.7),
    "remainder": lambda x: np.remainder(x, -0.7),
    "modulo": lambda x: x % 0.7,
    "modulo of": lambda x: 0.7 % x,
    "fmod": lambda x: np.fmod(x, 0.7),
    "fmod of": lambda x: np.fmod(0.7, x),
    "floor division": lambda x: x // 0.7,
    "divided by": lambda x: 1.7 // x,
    "divmod": lambda x: divmod(x, 0.7)[0] + 3 * divmod(x, 0.7)[1],
    "np.divmod": lambda x: np.divmod(x, 0.7)[0] + 3 * np.divmod(x, 0.7)[1],
    "modf": lambda x: np.modf(x)[0] + 3 * np.modf(x)[1],
}
SCALARS = {
    "round()": lambda x: round(x),
    "round(x, 1)": lambda x: round(x, 1),
    "math.floor": lambda x: math.floor(x) + 3 * math.ceil(x) + 5 * math.trunc(x),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_values_are_those_of_numpy(name):
    f = FORMULAS[name]
    x = np.random.default_rng(3).uniform(-3, 3, size=(200, 3))
    h = equip.Hamiltonian(lambda q, p: f(q).sum(), 3)
    assert h(x, x) == pytest.approx(f(x).sum(axis=1), rel=1e-14, abs=1e-13)
    one = equip.Hamiltonian(lambda q, p: f(q[0]), 3)
    assert one(x, x) == pytest.approx(f(x)[:, 0], rel=1e-14, abs=1e-13)


@pytest.mark.parametrize("name", SCALARS)
def test_values_are_those_of_python(name):
    f = SCALARS[name]
    h = equip.Hamiltonian(lambda q, p: f(q[0]), 1)
    for x in np.random.default_rng(4).uniform(-3, 3, size=50).tolist():
        assert h([x], [0.0]) == pytest.approx(f(x), rel=1e-14)


def test_derivatives_are_those_of_the_smooth_part():
    h = equip.Hamiltonian(lambda q, p: ((q - 2 * np.round(q / 2)) ** 4).sum() + p @ p / 2, 2)
    q = np.array([[0.3, 5.1], [-3.7, 2.6]])
    nearest = q - 2 * np.round(q / 2)
    assert h.gradient(q, q)[0] == pytest.approx(4 * nearest**3, rel=1e-13)
    assert h.hessian(q[0], q[0])[0, 0] == pytest.approx(12 * nearest[0, 0] ** 2, rel=1e-13)
    # One operation and none of a derivative: 4 x³ of a remainder.
    again = pickle.loads(pickle.dumps(h))
    assert again == h and again(q[0], q[0]) == h(q[0], q[0])


def test_digits_of_double_double():
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + (q[0] % Fraction(1, 3)) ** 2, 1)
    sol = equip.solve(h, ["0.1"], ["0.1"], (0, "0.5"), precision="dd", tolerance=1e-28)
    # An oscillator within one box: q = 0.1 (cos ωt + sin ωt/ω), ω = √2.
    import decimal

    decimal.getcontext().prec = 40
    omega = decimal.Decimal(2).sqrt()
    x, cos, sin, term = omega / 2, decimal.Decimal(0), decimal.Decimal(0), decimal.Decimal(1)
    for k in range(40):
        cos, sin = (cos + term, sin) if k % 2 == 0 else (cos, sin + term)
        term = term * x / (k + 1) * (-1 if k % 2 else 1)
    exact = (cos + sin / omega) / 10
    assert abs(decimal.Decimal(sol.q_text()[-1, 0]) - exact) < decimal.Decimal("1e-28")


def lattice():
    """Sixteen atoms near the places of a square lattice, in a periodic box of length 4."""
    draw = np.random.default_rng(5)
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0))
    q = np.stack([x.ravel(), y.ravel()], axis=1) + draw.uniform(-0.05, 0.05, size=(16, 2))
    return 1.1 * q, draw.normal(scale=0.7, size=(16, 2))


L = 4.4
WAYS = {
    "round": lambda d: d - L * np.round(d / L),
    "floor": lambda d: d - L * np.floor(d / L + 0.5),
    "mod": lambda d: (d + L / 2) % L - L / 2,
    "select": lambda d: np.select([d > L / 2, d < -L / 2], [d - L, d + L], d),
}


def test_three_ways_to_write_a_periodic_box_agree():
    """Atoms in a box: values, gradients and runs."""
    q, p = lattice()
    i, j = np.triu_indices(16, 1)

    def with_images(nearest):
        def energy(q, p):
            d = nearest(q[i] - q[j])
            # Smooth in the nearest image: of period L, so that no way can differ.
            return (p * p).sum() / 2 + (np.exp(-3 * (d * d).sum(axis=1))).sum()

        return equip.Hamiltonian(energy, (16, 2))

    all_ways = {name: with_images(nearest) for name, nearest in WAYS.items()}
    ends, values, forces = {}, {}, {}
    for name, h in all_ways.items():
        values[name], forces[name] = h(q, p), h.gradient(q, p)[0]
        sol = equip.solve(h, q, p, (0, 0.5), tolerance=1e-9)
        assert sol.success and sol.certificate.counts.discontinuities_crossed > 0
        assert np.abs(sol.energy_error).max() < 1e-2
        ends[name] = sol.q[-1]
    for name in WAYS:
        assert values[name] == pytest.approx(values["round"], rel=1e-13)
        assert np.abs(forces[name] - forces["round"]).max() < 1e-13
        assert np.abs(ends[name] - ends["round"]).max() < 1e-6, name


def test_a_particle_that_crosses_the_box_many_times():
    """H = p²/2 + (x - 1/2)², x = q mod 1: through one box x - 1/2 = A sin √2 t, A² = H, and the force jumps at
    each wall."""
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + (q[0] % 1.0 - 0.5) ** 2, 1)
    start = 1.5
    amplitude = math.sqrt(start**2 / 2 + 0.25)
    period = 2 * math.asin(0.5 / amplitude) / math.sqrt(2)
    for way in (1, -1):
        sol = equip.solve(h, [0.0], [way * start], (0, 20.5 * period), tolerance=1e-12)
        assert sol.success and sol.q[-1, 0] == pytest.approx(way * 20.5, abs=1e-10)
        assert sol.certificate.counts.discontinuities_crossed == 20
        assert sol.certificate.energy.max < 1e-11


def test_choices_as_sympy_writes_them():
    sympy = pytest.importorskip("sympy")
    x = sympy.symbols("x")
    bend = sympy.Piecewise((x**2, x < 0), (x**3, x < 1), (2 * x - 1, True))
    f = sympy.lambdify(x, bend, "numpy")
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + f(q[0]), 1)
    for at in (-0.7, 0.4, 1.6):
        assert h([at], [0.0]) == pytest.approx(float(bend.subs(x, at)), rel=1e-15)
        assert h.gradient([at], [0.0])[0][0] == pytest.approx(
            float(sympy.diff(bend, x).subs(x, at)), rel=1e-14
        )
    partly = sympy.lambdify(x, sympy.Piecewise((x**2, x < 0)), "numpy")
    with pytest.raises(TypeError, match="np.select has no value where none of its conditions holds"):
        equip.Hamiltonian(lambda q, p: partly(q[0]), 1)


def test_select_of_arrays():
    h = equip.Hamiltonian(lambda q, p: np.select([q < 0, q > 1], [q**2, 2 * q], 0.5).sum(), 3)
    assert h([-2.0, 0.5, 3.0], np.zeros(3)) == 4 + 0.5 + 6
    first = equip.Hamiltonian(lambda q, p: np.select([True, q[0] > 1], [q[0], 7.0]), 1)
    assert first([3.0], [0.0]) == 3
    with pytest.raises(ValueError, match="np.select has 1 conditions and 2 choices"):
        equip.Hamiltonian(lambda q, p: np.select([q < 0], [q, q]).sum(), 3)
