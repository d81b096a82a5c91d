"""Random formulas: value against NumPy, gradient against the complex step on functions written for complex numbers."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy import special

import equip

M = 3


class Complex:
    """The functions of a formula at complex points that are all but real: analytic, or piecewise by the real part."""

    @staticmethod
    def minimum(x, y):
        return np.where(np.real(x) < np.real(y), x, y)

    @staticmethod
    def maximum(x, y):
        return np.where(np.real(x) < np.real(y), y, x)

    @staticmethod
    def clip(x, low, high):
        return Complex.minimum(Complex.maximum(x, low), high)

    @staticmethod
    def abs(x):
        return np.where(np.real(x) < 0, -x, x)

    @staticmethod
    def arctan2(y, x):
        y, x = np.broadcast_arrays(np.asarray(y, complex), np.asarray(x, complex))
        # The derivative of the angle is that of Im log(x + iy) along the real direction.
        real = np.arctan2(y.real, x.real)
        return real + 1j * (x.real * y.imag - y.real * x.imag) / (x.real**2 + y.real**2)

    @staticmethod
    def hypot(x, y):
        return np.sqrt(x * x + y * y)

    @staticmethod
    def norm(x):
        return np.sqrt((x * x).sum())

    @staticmethod
    def variance(x):
        return ((x - x.mean()) ** 2).mean()

    @staticmethod
    def deg2rad(x):
        return x * (np.pi / 180)

    @staticmethod
    def smallest(x):
        return x[np.argmin(np.real(x))]

    @staticmethod
    def cbrt(x):
        return x ** (1 / 3)

    @staticmethod
    def erf(x):
        return special.erf(np.asarray(x, complex))

    @staticmethod
    def where_above(x, y, a, b):
        return np.where(np.real(x) > np.real(y), a, b)

    @staticmethod
    def where_between(x, a, b):
        return np.where((np.real(x) >= -0.5) & ~(np.real(x) > 0.5), a, b)

    def __getattr__(self, name):
        return getattr(np, name)


class Real:
    """The same functions as the user of equip writes them."""

    norm, smallest, variance = (staticmethod(f) for f in (np.linalg.norm, np.min, np.var))
    erf = staticmethod(equip.erf)

    @staticmethod
    def where_above(x, y, a, b):
        return np.where(x > y, a, b)

    @staticmethod
    def where_between(x, a, b):
        return (
            np.where((x >= -0.5) & ~(x > 0.5), a, b)
            if np.ndim(x)
            else np.where(np.logical_and(x >= -0.5, np.logical_not(x > 0.5)), a, b)
        )

    def __getattr__(self, name):
        return getattr(np, name)


MATRIX = np.array([[1.0, 0.5, 0.0], [0.25, -1.0, 2.0], [0.0, 3.0, 0.5]])

#: Of numbers, with arguments brought to where the functions are defined and of moderate size.
UNARY = {
    "sqrt": lambda f, x: f.sqrt(1.5 + x * x),
    "root of a power": lambda f, x: (2 + x * x) ** -1.5,
    "power": lambda f, x: f.power(1 + x * x, 0.3),
    "exp": lambda f, x: f.exp(f.tanh(x)),
    "expm1": lambda f, x: f.expm1(f.sin(x)),
    "exp2": lambda f, x: f.exp2(f.cos(x)),
    "log": lambda f, x: f.log(2 + x * x),
    "log1p": lambda f, x: f.log1p(x * x),
    "log2": lambda f, x: f.log2(1 + x * x),
    "log10": lambda f, x: f.log10(3 + x * x),
    "sin": lambda f, x: f.sin(x),
    "cos": lambda f, x: f.cos(x),
    "tan": lambda f, x: f.tan(f.sin(x)),
    "arcsin": lambda f, x: f.arcsin(0.9 * f.sin(x)),
    "arccos": lambda f, x: f.arccos(0.9 * f.cos(x)),
    "arctan": lambda f, x: f.arctan(x),
    "sinh": lambda f, x: f.sinh(f.sin(x)),
    "cosh": lambda f, x: f.cosh(f.cos(x)),
    "tanh": lambda f, x: f.tanh(x),
    "arcsinh": lambda f, x: f.arcsinh(x),
    "arccosh": lambda f, x: f.arccosh(1.5 + x * x),
    "arctanh": lambda f, x: f.arctanh(0.9 * f.sin(x)),
    "cbrt": lambda f, x: f.cbrt(1.5 + x * x),
    "erf": lambda f, x: f.erf(f.sin(x)),
    "where": lambda f, x: f.where_between(x, f.sin(x), 0.3),
    "abs": lambda f, x: f.abs(x),
    "neg": lambda f, x: -x,
    "square": lambda f, x: f.square(f.tanh(x)),
    "cube": lambda f, x: f.cos(x) ** 3,
    "reciprocal": lambda f, x: f.reciprocal(1.25 + x * x),
    "inverse": lambda f, x: (1.25 + x * x) ** -2,
    "constant to the power": lambda f, x: 1.75 ** f.sin(x),
    "clip": lambda f, x: f.clip(x, -0.7, 0.9),
    "degrees": lambda f, x: f.sin(f.deg2rad(x)),
    "above a constant": lambda f, x: f.maximum(0.25, x),
    "below a constant": lambda f, x: f.minimum(x, 0.75),
    "angle above a constant": lambda f, x: f.arctan2(x, 1.5),
    "angle of a constant": lambda f, x: f.arctan2(1.5, x),
    "beside a constant": lambda f, x: f.hypot(0.5, x),
}

BINARY = {
    "+": lambda f, x, y: x + y,
    "-": lambda f, x, y: x - y,
    "*": lambda f, x, y: f.tanh(x) * y,
    "/": lambda f, x, y: x / (1.5 + y * y),
    "**": lambda f, x, y: (1.5 + x * x) ** f.sin(y),
    "minimum": lambda f, x, y: f.minimum(x, y),
    "maximum": lambda f, x, y: f.maximum(x, y),
    "arctan2": lambda f, x, y: f.arctan2(x, 2 + y * y),
    "arctan2 turned": lambda f, x, y: f.arctan2(1 + x * x, y),
    "hypot": lambda f, x, y: f.hypot(1 + x, y),
    "where": lambda f, x, y: f.where_above(x, y, x, 2 * y),
    "where against a constant": lambda f, x, y: f.where_above(0.3, x, y, x),
}

#: Of arrays.
ARRAYS = {
    "dot": lambda f, a, b: a @ b,
    "form": lambda f, a, b: a @ MATRIX @ b,
    "sum": lambda f, a, b: (a * b).sum(),
    "mean": lambda f, a, b: f.mean(a - b),
    "variance": lambda f, a, b: f.variance(a + b),
    "einsum": lambda f, a, b: f.einsum("i,ij,j->", a, MATRIX, b),
    "norm": lambda f, a, b: f.norm(a + 2 * b),
    "outer": lambda f, a, b: f.outer(a, b)[0, 2],
    "prod": lambda f, a, b: f.prod(f.cos(a)) + b[0],
    "smallest": lambda f, a, b: f.smallest(a * b),
    "largest of each": lambda f, a, b: f.maximum(a, b).sum(),
    "angles": lambda f, a, b: f.arctan2(a, 2 + b * b).sum(),
    "clipped": lambda f, a, b: f.clip(a, -0.5, 0.5) @ b,
    "where of arrays": lambda f, a, b: f.where_above(a, b, a * b, 0.5).sum(),
    "where by one": lambda f, a, b: f.where_above(a[0], b[1], a, b).sum(),
    "where between": lambda f, a, b: f.where_between(a, a * b, b).sum(),
    "errors": lambda f, a, b: f.erf(a) @ b,
    "loop": lambda f, a, b: sum((a[i] - b[i - 1]) ** 2 for i in range(M)),
    "stack": lambda f, a, b: f.stack([a[0], b[2]]) @ np.array([2.0, -1.0]),
    "roll": lambda f, a, b: f.roll(a, 1) @ b[::-1],
}

leaves = st.one_of(
    st.tuples(st.just("variable"), st.sampled_from("qp"), st.integers(0, M - 1)),
    st.tuples(st.just("constant"), st.sampled_from([0.5, -1.25, 3, 0.1])),
    st.tuples(st.just("arrays"), st.sampled_from(sorted(ARRAYS)), st.sampled_from(["qp", "pq", "qq", "pp"])),
)
formulas = st.recursive(
    leaves,
    lambda parts: st.one_of(
        st.tuples(st.just("unary"), st.sampled_from(sorted(UNARY)), parts),
        st.tuples(st.just("binary"), st.sampled_from(sorted(BINARY)), parts, parts),
    ),
    max_leaves=8,
)


def value(formula, f, q, p):
    kind, *parts = formula
    if kind == "variable":
        return (q if parts[0] == "q" else p)[parts[1]]
    if kind == "constant":
        return parts[0]
    if kind == "arrays":
        a, b = ({"q": q, "p": p}[name] for name in parts[1])
        return ARRAYS[parts[0]](f, a, b)
    if kind == "unary":
        return UNARY[parts[0]](f, value(parts[1], f, q, p))
    return BINARY[parts[0]](f, value(parts[1], f, q, p), value(parts[2], f, q, p))


STEP = 1e-30


def settings_of(examples):
    return settings(
        max_examples=examples, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
    )


@settings_of(400)
@given(formulas, st.integers(0, 2**32 - 1))
def test_value_and_gradient(formula, seed):
    check(formula, seed)


@pytest.mark.long
@settings_of(2000)
@given(formulas, st.integers(0, 2**32 - 1))
def test_value_and_gradient_of_2000(formula, seed):
    check(formula, seed)


def check(formula, seed):
    q, p = np.random.default_rng(seed).normal(size=(2, M))
    h = equip.Hamiltonian(lambda q, p: value(formula, Real(), q, p), M)
    expected = float(value(formula, Real(), q, p))
    assert math.isclose(h(q, p), expected, rel_tol=1e-12, abs_tol=1e-12)

    y = np.concatenate([q, p])
    slopes = []
    for j in range(2 * M):
        moved = y + 1j * STEP * np.eye(2 * M)[j]
        slopes.append(np.imag(value(formula, Complex(), moved[:M], moved[M:])) / STEP)
    found = np.concatenate(h.gradient(q, p))
    assert np.allclose(
        found, np.array(slopes, dtype=float), rtol=1e-10, atol=1e-11 * (1 + np.abs(found).max())
    )
