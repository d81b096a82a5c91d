"""What cannot be recorded is refused at the user's own line, and the text says what to write instead."""

import math
import traceback

import numpy as np
import pytest
from scipy import sparse

import equip

ONCE = "H(q, p) is called once, before any state is known, to record its formula. "
OUTSIDE = "or choose between two Hamiltonians outside H"
COMPARED = (
    "a variable of H cannot be compared: "
    + ONCE
    + "Use np.where on the condition, np.minimum, np.maximum, np.clip or abs() on q and p, on lists "
    "of variables after np.stack (np.array makes an array that compares), " + OUTSIDE
)
ARRAYS_COMPARED = (
    "variables of H cannot be compared: "
    + ONCE
    + "Use np.where on a condition with <, <=, > or >=, np.minimum, np.maximum, np.clip or abs() on q and p, "
    + OUTSIDE
)
TRUTH = (
    "a variable of H is neither true nor false: "
    + ONCE
    + "Use np.where, np.minimum, np.maximum, np.clip or abs() on q and p, "
    + OUTSIDE
)
NUMBER = (
    "a variable of H is not a number: "
    + ONCE
    + "Use np.sin, np.sqrt, ... in place of math.sin, math.sqrt; leave out "
    "float() and int(); collect variables with np.stack or in a list, not in an array of floats"
)
STORED = (
    "variables of H cannot be stored in an array of numbers: collect them with np.stack or in a list, or make the array "
    "with dtype=object"
)
HASHED = (
    "a variable of H has no value, so that it cannot be a key of a dict or a member of a set. Use lists, and the "
    "positions in them"
)
COMPLEX = "H is real: use no complex numbers in it"
MAY_USE = (
    " cannot be recorded: H may use + - * / ** @, sums, products, einsum, norms, exponentials, logarithms, trigonometric "
    "and hyperbolic functions, np.arctan2, np.hypot, np.minimum, np.maximum, np.clip, np.where, np.select, np.floor, "
    "np.round, % and abs(), equip.erf and equip.table of q and p, and any function of numbers alone"
)


MODULUS = "pow(x, n, modulus) of a variable of H cannot be recorded: write x**n % modulus"
SELECTED = (
    "q and p cannot be selected by a comparison of variables of H: write np.where(condition, q, 0), or select by an array "
    "of booleans"
)
SPARSE = "a sparse matrix cannot be multiplied with variables of H: write A.toarray() @ q"


def instead(name, advice):
    return f"the function {name} of variables of H cannot be recorded: {advice}"


def mixed(name):
    return f"np.{name} cannot be recorded of variables and numbers in np.array: make it with np.stack"


def store_where(q):
    row = q.copy()
    row[q > 0] = 0
    return row.sum()


def store_one(q):
    row = np.zeros(2)
    row[0] = q[0]
    return row.sum()


def store_all(q):
    row = np.zeros(2)
    row[:] = q
    return row.sum()


def add_to_floats(q):
    row = np.zeros(2)
    row += q
    return row.sum()


REFUSALS = {
    "if": (lambda q, p: q[0] if q[0] > 0 else p[0], COMPARED),
    "equal": (lambda q, p: q[0] if q[0] == p[0] else p[0], COMPARED),
    "max": (lambda q, p: max(q), COMPARED),
    "min": (lambda q, p: min(q[0], 1.0), COMPARED),
    "sorted": (lambda q, p: sorted(q)[0], COMPARED),
    "np.sort": (lambda q, p: np.sort(q)[0], COMPARED),
    "np.argmax": (lambda q, p: q[np.argmax(q)], COMPARED),
    "np.maximum of np.array": (lambda q, p: np.maximum(np.array([q[0], q[1]]), 0).sum(), COMPARED),
    "chain": (lambda q, p: np.where(0 < q[0] < 1, q[0], 0), COMPARED),
    "condition of an array": (lambda q, p: q[0] if (q > 0).all() else p[0], COMPARED),
    "and": (lambda q, p: np.where(q[0] > 0 and p[0] > 0, 1, 2) * q[0], COMPARED),
    "array == 0": (lambda q, p: np.where(q == 0, q, 1).sum(), ARRAYS_COMPARED),
    "np.where of one": (lambda q, p: np.where(q > 0), ARRAYS_COMPARED),
    "np.heaviside": (lambda q, p: np.heaviside(q, 0).sum(), ARRAYS_COMPARED),
    "np.where of text": (
        lambda q, p: np.where(q[0] > 0, None, 0),
        "np.where chooses between numbers and variables of H: collect others with np.stack",
    ),
    "condition returned": (
        lambda q, p: q[0] > 0,
        "H(q, p) must return one number made of q and p; it returned Condition",
    ),
    "np.isnan": (lambda q, p: np.isnan(q).any(), ARRAYS_COMPARED),
    "truth": (lambda q, p: q[0] and p[0], TRUTH),
    "not": (lambda q, p: not q[0], TRUTH),
    "math.sin": (lambda q, p: math.sin(q[0]), NUMBER),
    "math.sqrt": (lambda q, p: math.sqrt(q @ q), NUMBER),
    "float": (lambda q, p: float(q[0]), NUMBER),
    "int": (lambda q, p: int(q[0]), NUMBER),
    "complex": (lambda q, p: complex(q[0]), NUMBER),
    "store one": (lambda q, p: store_one(q), NUMBER),
    "store all": (lambda q, p: store_all(q), NUMBER),
    "astype": (lambda q, p: q.astype(float).sum(), NUMBER),
    "asarray": (lambda q, p: np.asarray(q, float).sum(), NUMBER),
    "add to floats": (lambda q, p: add_to_floats(q), STORED),
    "dict": (lambda q, p: {q[0]: 1}, HASHED),
    "1j": (lambda q, p: 1j * q[0], COMPLEX),
    "array of 1j": (lambda q, p: (1j * q).sum(), COMPLEX),
    "pow of three": (lambda q, p: pow(q[0], 2, 5), MODULUS),
    "np.linalg.inv": (
        lambda q, p: np.linalg.inv(np.outer(q, q))[0, 0],
        instead("inv", "write the inverse out, or invert a matrix of numbers outside H"),
    ),
    "np.linalg.solve": (
        lambda q, p: np.linalg.solve(np.eye(2), q).sum(),
        instead("solve", "write the solution out, or np.linalg.inv(A) @ q with a matrix A of numbers"),
    ),
    "np.interp": (
        lambda q, p: np.interp(q[0], [0, 1], [1, 2]),
        instead("interp", "make a spline of the data by equip.table"),
    ),
    "np.sinc": (lambda q, p: np.sinc(q).sum(), instead("sinc", "write np.sin(np.pi * x) / (np.pi * x)")),
    "np.copysign": (lambda q, p: np.copysign(q, p).sum(), instead("copysign", "write abs(x) * np.sign(y)")),
    "np.nextafter": (lambda q, p: np.nextafter(q, p).sum(), "the function nextafter" + MAY_USE),
    "norm of order 0": (
        lambda q, p: np.linalg.norm(q, 0),
        "the norm of order 0 cannot be recorded: it jumps. Use orders from 1 to np.inf",
    ),
    "selection": (lambda q, p: q[q > 0.5].sum(), SELECTED),
    "selected store": (lambda q, p: store_where(q), SELECTED),
    "sum where": (
        lambda q, p: np.sum(q, where=q > 0),
        "where= cannot be a comparison of variables of H: write np.where(condition, q, 0).sum()",
    ),
    "sine of a comparison": (
        lambda q, p: np.sin(q > 0).sum(),
        "a comparison of variables of H is not a number: choose by np.where(condition, a, b)",
    ),
    "cos of np.array": (lambda q, p: np.cos(np.array([q[0], 2.0])).sum(), mixed("cos")),
    "arctan2 of np.array": (lambda q, p: np.arctan2(2.0, np.array([q[0], p[0]])).sum(), mixed("arctan2")),
    "hypot of np.array": (lambda q, p: np.hypot(2, np.array([q[0], p[0]])).sum(), mixed("hypot")),
    "sparse @ q": (lambda q, p: q @ (sparse.csr_array(np.eye(2)) @ q), SPARSE),
    "q @ sparse": (lambda q, p: (q @ sparse.csr_matrix(np.eye(2))) @ q, SPARSE),
    "sparse.dot": (lambda q, p: sparse.csr_matrix(np.eye(2)).dot(q) @ q, SPARSE),
    "masked": (
        lambda q, p: (q * np.ma.array([1.0, 2.0], mask=[0, 1])).sum(),
        "a masked array cannot be used in H: write array.filled(value)",
    ),
    "another H": (
        lambda q, p: equip.scenes.kepler()(q, p) + q[0],
        "a Hamiltonian cannot be called within another: call its function",
    ),
    "arity": (lambda q, p, mass: q[0], "H(q, p) must be a function of (q, p); it takes (q, p, mass)"),
    "array": (
        lambda q, p: q,
        "H(q, p) must return one number; it returned an array of shape (2,): sum over it, for instance with .sum() or @",
    ),
    "None": (lambda q, p: None, "H(q, p) must return one number made of q and p; it returned NoneType"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_refusals(name):
    formula, text = REFUSALS[name]
    with pytest.raises(TypeError) as refusal:
        equip.Hamiltonian(formula, 2)
    assert str(refusal.value) == text


def test_the_traceback_names_the_line():
    def energy(q, p):
        kinetic = p @ p / 2
        if q[0] > 0:  # this line
            return kinetic
        return kinetic + q[0]

    with pytest.raises(TypeError) as refusal:
        equip.Hamiltonian(energy, 2)
    last = traceback.extract_tb(refusal.value.__traceback__)[-1]
    assert last.line == "if q[0] > 0:  # this line"


def test_exceptions_of_the_user_come_through():
    with pytest.raises(ZeroDivisionError):
        equip.Hamiltonian(lambda q, p: 1 / 0, 1)
    with pytest.raises(IndexError):
        equip.Hamiltonian(lambda q, p: q[7], 1)


def test_variables_of_another_recording_are_refused():
    kept = []
    equip.Hamiltonian(lambda q, p: kept.append(q[0]) or q[0] * p[0], 1)
    text = (
        "this variable belongs to another call of an H, or to another thread: make all of H from its own q and p and "
        "from plain numbers"
    )
    for formula in (lambda q, p: q[0] + kept[0], lambda q, p: kept[0]):
        with pytest.raises(RuntimeError) as refusal:
            equip.Hamiltonian(formula, 1)
        assert str(refusal.value) == text


def test_recordings_may_be_nested():
    def energy(q, p):
        inner = equip.Hamiltonian(lambda q, p: q[0] ** 2, 1)
        return q[0] * inner([3.0], [0.0]) + p[0]

    assert equip.Hamiltonian(energy, 1)([2.0], [1.0]) == 19


@pytest.mark.parametrize("constant", [float("nan"), float("inf"), "nan"])
def test_constants_must_be_finite(constant):
    with pytest.raises(
        ValueError, match="a constant of the energy is (NaN|infinite); check the captured parameters"
    ):
        equip.Hamiltonian(lambda q, p: q[0] * constant, 1)


@pytest.mark.parametrize("zero", [0, 0.0, np.float64(0), np.zeros(1)])
def test_division_by_zero_is_refused(zero):
    with pytest.raises(ValueError, match="divided by the constant 0; check the captured parameters"):
        equip.Hamiltonian(lambda q, p: (q / zero)[0] + p[0], 1)


def test_texts_must_be_numbers():
    with pytest.raises(ValueError, match="one tenth"):
        equip.Hamiltonian(lambda q, p: q[0] * "one tenth", 1)


@pytest.mark.parametrize("shape", [0, (), (2, 0), -1, 2.7, "2", None, (2, 1.5)])
def test_shapes_are_positive(shape):
    with pytest.raises(ValueError, match="it must be the shape of q: a positive integer or a tuple of such"):
        equip.Hamiltonian(lambda q, p: q.sum(), shape)


def test_the_energy_is_a_function():
    with pytest.raises(TypeError, match="the first argument is the energy: a function of q and p"):
        equip.Hamiltonian(3, 2)


def test_other_functions_are_named():
    def wall(t, q, p):
        return q

    h, start = equip.Hamiltonian(lambda q, p: p @ p / 2 + q @ q, 2), ([1, 0], [0, 1], (0, 1))
    for options, text in [
        ({"events": wall}, r"event 0 \(wall\) must return one number; it returned an array of shape \(2,\)"),
        (
            {"events": [lambda t, y: y[0]]},
            r"event 0 .*must be a function of \(t, q, p\); it takes \(t, y\)",
        ),
        ({"events": lambda t, q, p: None}, r"event 0 .*made of q and p; it returned NoneType"),
        ({"events": 3}, r"events must be a function g\(t, q, p\), or a list of such"),
        ({"invariants": {"L": lambda q, p: q}}, r"invariants\['L'\] must return one number"),
        ({"invariants": {"L": lambda t, q, p: t}}, r"invariants\['L'\] must be a function of \(q, p\)"),
        ({"invariants": {"L": 3}}, r"invariants\['L'\] is 3; it must be a function"),
        ({"invariants": {1: wall}}, "invariants must be a dict of functions by their names"),
        ({"preserve": [wall]}, "preserve must be a dict of functions by their names"),
        ({"method": "gauss"}, "method is 'gauss'; it must be equip.Equip"),
        ({"method": None}, "method is None; it must be"),
        ({"method": equip.Gauss}, "method is <class .*; it must be"),
    ]:
        with pytest.raises(TypeError, match=text):
            equip.solve(h, *start, **options)
