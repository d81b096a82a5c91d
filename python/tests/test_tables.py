"""Splines through data within H, against SciPy's."""

import pickle

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, RectBivariateSpline

import equip

X = np.array([-2.0, -1.2, -0.3, 0.5, 1.1, 2.0, 3.5])
Y = np.sin(X) + 0.1 * X**2


@pytest.mark.parametrize(
    "ends", ["not-a-knot", "natural", "clamped", ((1, 0.4), (1, -0.3)), ((2, 1.0), (2, 0.5))]
)
def test_as_scipy(ends):
    table, spline = equip.table(X, Y, ends, extrapolate=True), CubicSpline(X, Y, bc_type=ends)
    x = np.linspace(-3, 4, 50)
    assert np.allclose(table(x), spline(x), rtol=0, atol=1e-13) and isinstance(table(0.3), float)
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + table(q).sum() + 2 * table(q[0] * p[1]), 2)
    q, p = np.array([0.7, -0.4]), np.array([0.2, 1.3])
    assert h(q, p) == pytest.approx(p @ p / 2 + spline(q).sum() + 2 * spline(q[0] * p[1]), abs=1e-13)
    slope = spline(q, 1) + [2 * spline(q[0] * p[1], 1) * p[1], 0]
    assert np.allclose(h.gradient(q, p)[0], slope, rtol=0, atol=1e-12)
    assert table.range == [(-2.0, 3.5)]


def test_surfaces_as_scipy():
    y = np.linspace(-1, 2, 6)
    z = np.cos(X[:, None] - 0.3 * y)
    table, spline = equip.table2(X, y, z), RectBivariateSpline(X, y, z)
    points = np.random.default_rng(4).uniform([-2, -1], [3.5, 2], size=(40, 2))
    assert np.allclose(table(*points.T), spline(*points.T, grid=False), rtol=0, atol=1e-13)
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + table(q[0], q[1]) + table(q, 0.5).sum(), 2)
    q = points[0]
    expected = spline(*q, grid=False) + spline(q, 0.5, grid=False).sum()
    assert h(q, [0, 0]) == pytest.approx(float(expected), abs=1e-13)


def test_runs_keep_the_energy_of_a_table():
    x = np.linspace(-4, 4, 81)
    well = equip.table(x, -np.cos(x))
    swing = equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2 + well(q[0]), 1)
    pendulum = equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2 - np.cos(q[0]), 1)
    runs = [equip.solve(h, [1.0], [0.0], (0, 20), step=0.1) for h in (swing, pendulum)]
    # The spline is within 1.3e-7 of the cosine, its slope within 7e-6.
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-4
    # The third derivative jumps at the knots, which most steps pass: 5.3e-9, where the cosine has 4e-16.
    assert np.abs(runs[0].energy_error).max() < 1e-8
    again = pickle.loads(pickle.dumps(swing))
    assert np.array_equal(equip.solve(again, [1.0], [0.0], (0, 20), step=0.1).y, runs[0].y)
    assert pickle.loads(pickle.dumps(well))(0.3) == well(0.3)


def test_a_run_that_leaves_a_table_ends_with_an_error():
    hill = equip.table(X, Y)
    h = equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2 + hill(q[0]), 1)
    for options in ({"step": 0.05}, {"tolerance": 1e-9}, {"step": 0.05, "method": equip.Gauss(4)}):
        sol = equip.solve(h, [0.0], [3.0], (0, 20), **options)
        assert not sol.success and "argument of a table in H" in sol.message and "to 3.5e0" in sol.message
        # The run has every step that stays within the table: with steps of 0.05 it ends near the edge.
        assert (3.2 if "step" in options else 1.0) < sol.q[-1, 0] <= 3.5 and sol.t[-1] < 2
    further = equip.table(X, Y, extrapolate=True)
    h = equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2 + further(q[0]), 1)
    again = pickle.loads(pickle.dumps(h))
    for either in (h, again):
        assert equip.solve(either, [0.0], [3.0], (0, 2), step=0.05).success
    with pytest.raises(ValueError, match="4e0 is outside the range of the table, -2e0 to 3.5"):
        hill(4.0)
    assert further(4.0) == pytest.approx(float(CubicSpline(X, Y)(4.0)), abs=1e-13)
    with pytest.raises(equip.IntegrationError, match="argument of a table in H"):
        equip.steps(equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2 + hill(q[0]), 1), [5.0], [0.0], step=0.1)
    two = equip.table2(X, X, np.outer(X, X))
    with pytest.raises(ValueError, match="outside the range of the table"):
        two(0.0, 4.0)
    assert equip.table2(X, X, np.outer(X, X), extrapolate=True)(0.0, 4.0) == pytest.approx(0.0)


def test_refusals():
    with pytest.raises(ValueError, match="knot 2 is not larger than the knot before; sort the knots"):
        equip.table([0, 2, 1, 3], [0, 0, 0, 0])
    with pytest.raises(ValueError, match="this spline needs at least 4 knots, not 2"):
        equip.table([0, 1], [0, 1])
    with pytest.raises(ValueError, match="3 values were given for 4 knots"):
        equip.table([0, 1, 2, 3], [0, 1, 2])
    with pytest.raises(ValueError, match="bc_type is 'periodic'; it must be 'not-a-knot', 'natural'"):
        equip.table(X, Y, "periodic")
    with pytest.raises(ValueError, match=r"z has shape \(7,\); for these x and y it must have \(7, 7\)"):
        equip.table2(X, X, Y)
    with pytest.raises(TypeError, match="this table has 2 variables; it was called with 1"):
        equip.table2(X, X, np.outer(X, X))(0.3)


@pytest.mark.parametrize("ends", [(1, 2), ((1, 0.0),), ((1,), (1,)), "flat", None, 3, ((1, 0.0), (2, 0.0))])
def test_ends_of_splines(ends):
    with pytest.raises(ValueError, match=r"bc_type is .*; it must be 'not-a-knot', 'natural', 'clamped'"):
        equip.table([0, 1, 2, 3], [0, 1, 2, 3], bc_type=ends)
