"""Rows of ensembles in files: saved, read, and written while others are made."""

import dataclasses
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import equip

NAMES = ("t", "q", "p", "energy_error", "energy_conserved", "steps", "lyapunov", "megno")


def starts(n):
    angles = np.linspace(0, 0.5, n)
    zero = np.zeros(n)
    return np.stack([0.4 + 0.1 * angles, zero], axis=1), np.stack([zero, 2 - angles], axis=1)


def same(one, other):
    rows = all(getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in NAMES)
    return rows and one.errors == other.errors and one.lost.tolist() == other.lost.tolist()


@pytest.mark.parametrize("name", ["ends.npz", "ends.h5"])
def test_saved_and_read(kepler, tmp_path, name):
    if name.endswith("h5"):
        pytest.importorskip("h5py")
    q0, p0 = starts(6)
    q0[2] = np.nan
    ends = equip.ensemble(kepler, q0, p0, (0, 5), chaos=True)
    ends.save(str(tmp_path / name))
    read = equip.Ensemble.load(tmp_path / name)
    assert same(ends, read) and list(read.errors) == [2] and read.outcome.tolist() == ends.outcome.tolist()
    assert read.q.dtype == ends.q.dtype and read.energy_conserved.dtype == bool


def test_files_are_checked(kepler, tmp_path):
    q0, p0 = starts(2)
    with_outputs = equip.ensemble(kepler, q0, p0, (0, 1), output=len_of_run)
    with pytest.raises(ValueError, match="outputs cannot be saved"):
        with_outputs.save(tmp_path / "a.npz")
    dataclasses.replace(with_outputs, outputs=()).save(tmp_path / "a.npz")
    assert same(equip.Ensemble.load(tmp_path / "a.npz"), with_outputs)
    with pytest.raises(ValueError, match="is not a solution written by Solution.save"):
        equip.load(tmp_path / "a.npz")
    equip.solve(kepler, q0[0], p0[0], (0, 1)).save(tmp_path / "b.npz")
    with pytest.raises(ValueError, match="is not an ensemble written by Ensemble.save"):
        equip.Ensemble.load(tmp_path / "b.npz")


def len_of_run(sol):
    return len(sol.t)


@pytest.mark.parametrize("by_executor", [False, True])
def test_a_checkpoint_changes_no_bits_and_is_not_made_again(kepler, tmp_path, monkeypatch, by_executor):
    q0, p0 = starts(11)
    q0[4] = np.nan
    plain = equip.ensemble(kepler, q0, p0, (0, 5))
    path = tmp_path / "ends.npz"
    how = {"checkpoint": path, "chunk": 3}
    with ThreadPoolExecutor(2) as pool:
        made = equip.ensemble(kepler, q0, p0, (0, 5), executor=pool if by_executor else None, **how)
    assert same(plain, made) and same(plain, equip.Ensemble.load(path))

    asked = []
    native = equip._native.ensemble
    monkeypatch.setattr(
        equip._native, "ensemble", lambda h, q, *rest: asked.append(len(q)) or native(h, q, *rest)
    )
    again = equip.ensemble(kepler, q0, p0, (0, 5), threads=1, **how)
    assert same(plain, again) and sum(asked) == 0
    assert os.listdir(tmp_path) == ["ends.npz"]


class Later:
    def __init__(self, executor, function, arguments):
        self.parts = executor, function, arguments

    def cancel(self):
        pass

    def result(self):
        executor, function, arguments = self.parts
        if executor.chunks == 0:
            raise KeyboardInterrupt
        executor.chunks -= 1
        return function(*arguments)


class Interrupted:
    """An executor that makes some chunks, and is then interrupted."""

    def __init__(self, chunks):
        self.chunks = chunks

    def submit(self, function, *arguments):
        return Later(self, function, arguments)


def test_an_interrupted_ensemble_goes_on(kepler, tmp_path):
    q0, p0 = starts(20)
    path = tmp_path / "ends.npz"
    how = {"checkpoint": path, "chunk": 3}
    with pytest.raises(KeyboardInterrupt):
        equip.ensemble(kepler, q0, p0, (0, 5), executor=Interrupted(2), **how)
    part = equip.Ensemble.load(path)
    assert part.lost.tolist() == list(range(6, 20)) == list(part.errors)
    assert "not finished" in part.errors[6] and np.isfinite(part.q[:6]).all() and np.isnan(part.q[6:]).all()
    plain = equip.ensemble(kepler, q0, p0, (0, 5))
    assert same(plain, equip.ensemble(kepler, q0, p0, (0, 5), resume=part))
    assert same(plain, equip.ensemble(kepler, q0, p0, (0, 5), **how))


PROGRAM = """
import sys, time, numpy as np, equip
path, how = sys.argv[1:]
h = equip.Hamiltonian(lambda q, p: 0.5 * p @ p - 1 / np.sqrt(q @ q), 2)
x = np.linspace(0.4, 0.5, 64)
q0, p0 = np.stack([x, 0 * x], axis=1), np.stack([0 * x, 2 + 0 * x], axis=1)

class Later:
    def __init__(self, *call):
        self.call = call
    def cancel(self):
        pass
    def result(self):
        function, *arguments = self.call
        if how == "stays":
            # Slower than rows are written, on a slow disk as well: else all are made before some are.
            time.sleep(0.2)
        if how == "stays" and len(equip.Ensemble.load(path).lost) < 60:
            # Some rows are written, and the others are never made.
            print("stays", flush=True)
            time.sleep(1e6)
        return function(*arguments)

class Executor:
    def submit(self, *call):
        return Later(*call)

executor = None if how == "alone" else Executor()
ends = equip.ensemble(h, q0, p0, (0, 60), step=0.05, chunk=1, checkpoint=path, executor=executor)
print(ends.q.tobytes().hex())
"""


def program(path, how):
    return [sys.executable, "-c", PROGRAM, str(path), how]


def test_a_killed_process_loses_nothing_that_was_finished(tmp_path):
    path = tmp_path / "ends.npz"
    with subprocess.Popen(program(path, "stays"), stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "stays\n"
        process.kill()
    part = equip.Ensemble.load(path)
    assert 0 < len(part.lost) < 60
    on = subprocess.run(program(path, "on"), capture_output=True, text=True, timeout=600)
    whole = program(tmp_path / "b.npz", "alone")
    whole = subprocess.run(whole, capture_output=True, text=True, timeout=600)
    assert on.returncode == 0 and on.stdout == whole.stdout, on.stderr
    made = equip.Ensemble.load(path)
    finished = np.setdiff1d(np.arange(64), part.lost)
    assert made.success and np.array_equal(made.q[finished], part.q[finished])


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_sigterm_writes_the_rows_and_ends_the_process(tmp_path):
    path = tmp_path / "ends.npz"
    with subprocess.Popen(program(path, "stays"), stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "stays\n"
        process.terminate()
        assert process.wait(timeout=60) == -signal.SIGTERM
    assert 0 < len(equip.Ensemble.load(path).lost) < 60


def test_two_processes_cannot_have_one_checkpoint(kepler, tmp_path):
    path = tmp_path / "ends.npz"
    with subprocess.Popen(program(path, "stays"), stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "stays\n"
        before = path.read_bytes()
        with pytest.raises(equip.FileInUseError, match="another process is writing .*ends.npz: give each"):
            equip.ensemble(kepler, *starts(4), (0, 1), checkpoint=path)
        assert path.read_bytes() == before
        process.kill()
    path.unlink()
    assert equip.ensemble(kepler, *starts(4), (0, 1), checkpoint=path).success
    assert os.listdir(tmp_path) == ["ends.npz"]


def test_checkpoints_of_other_runs_are_refused(kepler, tmp_path):
    q0, p0 = starts(4)
    path = tmp_path / "ends.npz"
    keep = {"angular momentum": lambda q, p: q[0] * p[1] - q[1] * p[0]}
    equip.ensemble(kepler, q0, p0, (0, 1), step=0.125, checkpoint=path)
    other = equip.Hamiltonian(lambda q, p: 0.5 * p @ p - 1.01 / np.sqrt(q @ q), shape=2)
    for h, start, span, how in [
        (other, q0, (0, 1), {"step": 0.125}),
        (kepler, q0 + 1e-16, (0, 1), {"step": 0.25}),
        (kepler, 2 * q0, (0, 1), {"step": 0.125}),
        (kepler, q0, (0, 2), {"step": 0.125}),
        (kepler, q0, (0, 1), {"tolerance": 1e-9, "atol": q0[0]}),
        (kepler, q0, (0, 1), {"step": 0.125, "preserve": keep}),
        (kepler, q0, (0, 1), {"step": 0.125, "method": equip.Gauss(stages=8)}),
        (kepler, q0[:3], (0, 1), {"step": 0.125}),
    ]:
        with pytest.raises(
            ValueError, match="has runs with another H, other initial conditions, another span or other"
        ):
            equip.ensemble(h, start, p0[: len(start)], span, checkpoint=path, **how)
    with pytest.raises(ValueError, match="omit these, or checkpoint"):
        equip.ensemble(kepler, q0, p0, (0, 1), checkpoint=path, output=len_of_run)
    with pytest.raises(OSError, match="nowhere"):
        equip.ensemble(kepler, q0, p0, (0, 1), checkpoint=tmp_path / "nowhere" / "x.npz")
