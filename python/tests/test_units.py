"""Quantities with units are refused, wherever they are given: none loses its unit in silence."""

import numpy as np
import pytest

import equip


class Quantity(np.ndarray):
    """An array with a unit, as those of astropy and unyt."""

    unit = "m"


def of_ours(x):
    return np.asarray(x, dtype=float).view(Quantity)


def of_astropy(x):
    units = pytest.importorskip("astropy.units")
    return x * units.m


def of_pint(x):
    return pytest.importorskip("pint").UnitRegistry().Quantity(x, "m")


@pytest.mark.parametrize("quantity", [of_ours, of_astropy, of_pint])
def test_quantities_are_refused(kepler, quantity):
    q, p = [0.4, 0.0], [0.0, 2.0]
    calls = [
        lambda: equip.solve(kepler, quantity(q), p, (0, 1)),
        lambda: equip.solve(kepler, q, quantity(p), (0, 1)),
        lambda: equip.solve(kepler, [quantity(x) for x in q], p, (0, 1)),
        lambda: equip.solve(kepler, q, p, (0, quantity(1.0))),
        lambda: equip.solve(kepler, q, p, (0, 1), step=quantity(0.1)),
        lambda: equip.solve(kepler, q, p, (0, 1), tolerance=quantity(0.1)),
        lambda: equip.solve(kepler, q, p, (0, 1), atol=quantity(0.1)),
        lambda: equip.solve(kepler, q, p, (0, 1), t_eval=quantity([0.5])),
        lambda: equip.steps(kepler, quantity(q), p),
        lambda: equip.steps(kepler, q, p).advance_to(quantity(1.0)),
        lambda: equip.ensemble(kepler, quantity([q]), [p], (0, 1)),
        lambda: equip.draw_starts(quantity(q), p, 3),
        lambda: kepler(quantity(q), p),
        lambda: kepler.gradient(q, quantity(p)),
    ]
    for call in calls:
        with pytest.raises(ValueError, match="has a unit; equip computes with plain numbers"):
            call()


@pytest.mark.parametrize("quantity", [of_ours, of_astropy, of_pint])
def test_quantities_within_h_are_refused(quantity):
    masses = quantity([1.0, 2.0])
    for f in (
        lambda q, p: (p * p / masses).sum(),
        lambda q, p: (masses * q).sum() + p @ p,
        lambda q, p: q @ masses,
        lambda q, p: (q - masses) @ (q - masses),
    ):
        with pytest.raises((TypeError, ValueError)):
            equip.Hamiltonian(f, 2)


@pytest.mark.parametrize("wrong", [10**400, -(10**400)])
def test_numbers_beyond_doubles_are_refused(kepler, wrong):
    start = ([0.4, 0.0], [0.0, 2.0])
    for options in ({"tolerance": wrong}, {"first_step": wrong}, {"rtol": wrong}, {"atol": (wrong, 1.0)}):
        with pytest.raises(ValueError):
            equip.solve(kepler, *start, (0, 1), **options)
    for call in (
        lambda: equip.solve(kepler, [wrong, 0], [0, 1], (0, 1)),
        lambda: equip.solve(kepler, *start, (0, wrong)),
        lambda: equip.solve(kepler, *start, (0, 1), step=wrong),
        lambda: equip.steps(kepler, *start).advance_to(wrong),
        lambda: kepler([wrong, 0], [0, 1]),
        lambda: equip.solve(kepler, *start, (0, 1), method=equip.Equip(8, alpha_bound=wrong)),
    ):
        with pytest.raises(ValueError):
            call()
