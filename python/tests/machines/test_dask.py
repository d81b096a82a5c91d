"""An ensemble over the workers of Dask."""

import functools
import os
import signal

import numpy as np
import pytest

import equip

distributed = pytest.importorskip("distributed")
NAMES = ("t", "q", "p", "energy_error", "energy_conserved", "steps")


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


def dies_once(marker, sol):
    """The end of a run; the first worker that is asked for it dies."""
    try:
        os.close(os.open(marker, os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return sol.q[-1].tolist()
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_killed_worker_loses_nothing(kepler, client, tmp_path):
    """Dask makes the chunks of a worker that died again, by itself."""
    q0, p0 = starts(16)
    marker = tmp_path / "died"
    here = equip.ensemble(kepler, q0, p0, (0, 5), step=0.1)
    output = functools.partial(dies_once, str(marker))
    how = {"step": 0.1, "output": output}
    there = equip.ensemble(kepler, q0, p0, (0, 5), executor=client.get_executor(), chunk=1, **how)
    assert marker.exists()
    # Whatever was lost would be made by `resume`.
    if len(there.lost):
        there = equip.ensemble(kepler, q0, p0, (0, 5), resume=there, **how)
    assert there.success and same(here, there)
    assert [list(end) for end in there.outputs] == here.q.tolist()
