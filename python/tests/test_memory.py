"""What runs leave behind in memory."""

import sys

import numpy as np
import pytest

import equip

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="/proc")


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


def everything(n):
    for _ in range(n):
        h = equip.Hamiltonian(lambda q, p: 0.5 * p @ p - "1.5" / np.sqrt(q @ q), 2)
        sol = equip.solve(h, [0.4, 0], [0, 2.0], (0, 2), dense_output=True, events=lambda t, q, p: q[1])
        sol.sol(1.0), sol.certificate.to_dict(), h.hessian([1, 2], [3, 4])
        next(equip.steps(h, [0.4, 0], [0, 2.0], tangent_vectors=np.eye(4)))


def test_memory_stays_flat():
    everything(200)
    before = resident()
    everything(600)
    # A leak of 1 KiB a round would be 0.6 MiB.
    assert resident() - before < 600 * 1024


@pytest.mark.long
def test_memory_stays_flat_over_100000_solves(kepler):
    """Runs of one system, each of its own recording, and ensembles, failing ones among them."""

    def solves(n):
        for i in range(n):
            h = equip.Hamiltonian(lambda q, p: p @ p / 2 - 1 / np.sqrt(q @ q), 2) if i % 4 == 0 else kepler
            sol = equip.solve(h, [0.4, 0], [0, 2.0 - 1e-7 * i], (0, 1), dense_output=i % 2 == 0)
            assert sol.success
            if i % 1000 == 0:
                ends = equip.ensemble(h, [[0.4, 0], [0, np.nan]], [[0, 2.0], [0, 1]], (0, 1))
                assert sorted(ends.errors) == [1]
                with pytest.raises(ValueError):
                    equip.solve(h, [0.4, 0], [0, np.nan], (0, 1))

    solves(10_000)
    sizes = [resident()]
    for _ in range(10):
        solves(10_000)
        sizes.append(resident())
    print("MiB after each 10 000 solves:", [round(size / 2**20, 2) for size in sizes])
    # A leak of 10 bytes a solve would be 1 MB.
    assert sizes[-1] - sizes[0] < 1_000_000
