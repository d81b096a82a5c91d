"""An ensemble over the workers of Dask."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import equip

distributed = pytest.importorskip("distributed")
NAMES = ("t", "q", "p", "energy_defect", "energy_kept", "steps")


@pytest.fixture
def client():
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.Client(**options) as client:
        yield client


def starts(n):
    angles = np.linspace(0, 0.5, n)
    zero = np.zeros(n)
    return np.stack([0.4 + 0.1 * angles, zero], axis=1), np.stack([zero, 2 - angles], axis=1)


def same(one, other):
    return all(getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in NAMES)


def test_the_bytes_of_one_process(kepler, client):
    q0, p0 = starts(23)
    here = equip.ensemble(kepler, q0, p0, (0, 5))
    for chunk in (1, 5, 100):
        there = equip.ensemble(kepler, q0, p0, (0, 5), executor=client.get_executor(), chunk=chunk)
        assert there.success and same(here, there)


def test_a_killed_worker_loses_nothing(kepler, client):
    """Dask makes the chunks of a worker that died again, by itself."""
    q0, p0 = starts(16)
    span = (0, 3000)
    here = equip.ensemble(kepler, q0, p0, span, step=0.1)
    killed = []

    def kill():
        time.sleep(0.2)
        pids = client.run(os.getpid)
        killed.append(next(iter(pids.values())))
        os.kill(killed[0], signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    there = equip.ensemble(kepler, q0, p0, span, step=0.1, executor=client.get_executor(), chunk=1)
    killer.join()
    assert killed
    # Whatever was lost would be made by `resume`.
    if len(there.lost):
        there = equip.ensemble(kepler, q0, p0, span, step=0.1, resume=there)
    assert there.success and same(here, there)
