"""Systems that several tests use."""

import numpy as np
import pytest

import equip


@pytest.fixture(scope="session")
def kepler() -> equip.Hamiltonian:
    """Kepler's problem in the plane, μ = 1."""
    return equip.Hamiltonian(lambda q, p: 0.5 * p @ p - 1 / np.sqrt(q @ q), shape=2)


@pytest.fixture(scope="session")
def pendulum() -> equip.Hamiltonian:
    return equip.Hamiltonian(lambda q, p: 0.5 * p[0] ** 2 - np.cos(q[0]), shape=1)
