"""Runs that go on from a file, bit for bit."""

import contextlib
import json
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import equip

START = ([0.4, 0.0], [0.0, 2.0])


@pytest.mark.parametrize("precision", ["f64", "dd"])
@pytest.mark.parametrize("how", [{"step": 0.125}, {"tolerance": 1e-10}])
def test_bits_of_the_run_that_had_not_stopped(kepler, tmp_path, how, precision):
    path = tmp_path / "kepler.checkpoint"
    whole = equip.solve(kepler, *START, (0, 40), precision=precision, **how)
    # A fixed step ends on its grid; a variable one meets the end with a step of its own.
    first = equip.solve(kepler, *START, (0, 20), checkpoint=path, precision=precision, **how)
    second = equip.solve(kepler, *START, (0, 40), checkpoint=path, precision=precision, **how)
    assert first.t[-1] == second.t[0] == 20 and second.t[-1] == 40
    counts = (first.certificate.counts.steps, second.certificate.counts.steps)
    assert counts == (len(first.t) - 1, len(first.t) + len(second.t) - 2)
    if "step" in how:
        assert np.array_equal(np.concatenate([first.y, second.y[1:]]), whole.y)
        assert np.array_equal(np.concatenate([first.y_low, second.y_low[1:]]), whole.y_low)
        assert second.certificate.energy == whole.certificate.energy
    else:
        # The period is 2π; what is left is the tolerance of the two runs.
        assert np.abs(second.y[-1] - whole.y[-1]).max() < 1e-7


def test_a_finished_run_is_not_made_again(kepler, tmp_path):
    path = tmp_path / "kepler.checkpoint"
    first = equip.solve(kepler, *START, (0, 5), step=0.125, checkpoint=path)
    again = equip.solve(kepler, *START, (0, 5), step=0.125, checkpoint=path)
    assert again.t.tolist() == [5.0] and np.array_equal(again.y[0], first.y[-1])
    assert again.certificate.counts.steps == first.certificate.counts.steps == 40


def test_an_interrupted_run_goes_on(tmp_path):
    path = tmp_path / "run.checkpoint"
    program = f"""
import signal, threading, time, os, equip
scene = equip.scenes.kepler()
# Where this is run in the background Ctrl-C may be ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)

def interrupt():
    # Half a second of the run, whatever else the machine does.
    begun = time.process_time()
    while time.process_time() < begun + 0.5:
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt).start()
try:
    equip.solve(scene, scene.q0, scene.p0, (0, 1e9), step=0.125, record="ends", checkpoint={str(path)!r})
except KeyboardInterrupt:
    print("interrupted")
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert ended.stdout == "interrupted\n", ended.stderr
    scene = equip.scenes.kepler()
    steps = json.loads(path.read_text())["index"]
    assert steps > 100
    end = 0.125 * (steps + 10)
    rest = equip.solve(scene, scene.q0, scene.p0, (0, end), step=0.125, checkpoint=path)
    assert len(rest.t) == 11 and rest.certificate.counts.steps == steps + 10


def test_other_runs_are_refused(kepler, tmp_path):
    path = tmp_path / "kepler.checkpoint"
    equip.solve(kepler, *START, (0, 1), step=0.125, checkpoint=path)
    with pytest.raises(ValueError, match="start state"):
        equip.solve(kepler, [0.5, 0.0], [0.0, 2.0], (0, 2), step=0.125, checkpoint=path)
    with pytest.raises(ValueError, match="step"):
        equip.solve(kepler, *START, (0, 2), step=0.25, checkpoint=path)
    other = equip.Hamiltonian(lambda q, p: 0.5 * p @ p - 1.01 / np.sqrt(q @ q), shape=2)
    with pytest.raises(ValueError, match="H differs from the H of the checkpoint"):
        equip.solve(other, *START, (0, 2), step=0.125, checkpoint=path)
    path.write_text("{}")
    with pytest.raises(
        ValueError, match="is not a checkpoint of this version: .*; give another path, or remove"
    ):
        equip.solve(kepler, *START, (0, 2), step=0.125, checkpoint=path)
    with pytest.raises(OSError, match="nowhere"):
        equip.solve(kepler, *START, (0, 2), step=0.125, checkpoint=tmp_path / "nowhere" / "x")


@pytest.mark.parametrize("how", [{"step": 0.1}, {"tolerance": 1e-10}])
def test_checkpoints_beyond_the_end_are_refused(kepler, tmp_path, how):
    start, path = ([0.4, 0.0], [0.0, 2.0]), tmp_path / "c"
    first = equip.solve(kepler, *start, (0, 40), checkpoint=path, **how)
    for options in ({}, {"record": "ends"}, {"t_eval": [5.0]}):
        with pytest.raises(ValueError, match="is at t = 40, beyond the end 10 of span: give a later end"):
            equip.solve(kepler, *start, (0, 10), checkpoint=path, **how, **options)
    again = equip.solve(kepler, *start, (0, 40), checkpoint=path, **how)
    assert np.array_equal(again.y[-1], first.y[-1])
    further = equip.solve(kepler, *start, (0, 50), checkpoint=path, **how)
    assert further.t[0] == 40 and further.t[-1] == 50


#: A run of a minute or more with a checkpoint, which says when it has begun.
LONG = """
import signal, sys, threading, time, equip
scene = equip.scenes.kepler()
options = dict(step=0.125, record="ends", checkpoint=sys.argv[1])
print("begun", flush=True)
equip.solve(scene, scene.q0, scene.p0, (0, 1e9), checkpoint_every=float(sys.argv[2]), **options)
"""


@contextlib.contextmanager
def long_run(path, every):
    command = [sys.executable, "-c", LONG, str(path), str(every)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout.readline() == "begun\n", process.stderr.read()
            yield process
        finally:
            process.kill()


def wait_for(condition):
    begun = time.monotonic()
    while not condition():
        assert time.monotonic() < begun + 60
        time.sleep(0.01)


def is_locked(path):
    """Whether a process holds a lock on the file. It makes the file first and locks it then."""
    locks = Path("/proc/locks")
    if not locks.exists():
        time.sleep(0.2)
        return path.exists()
    return path.exists() and f":{path.stat().st_ino} " in locks.read_text()


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_sigterm_writes_the_checkpoint_and_ends_the_process(kepler, tmp_path):
    path = tmp_path / "run.checkpoint"
    with long_run(path, 1e6) as process:
        # The lock is taken before the first step.
        wait_for(lambda: is_locked(tmp_path / "run.checkpoint.lock"))
        time.sleep(0.3)
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=30) == -signal.SIGTERM, process.stderr.read()
    steps = json.loads(path.read_text())["index"]
    scene = equip.scenes.kepler()
    rest = equip.solve(scene, scene.q0, scene.p0, (0, 0.125 * (steps + 3)), step=0.125, checkpoint=path)
    assert steps > 0 and len(rest.t) == 4


def test_handlers_of_the_user_stay(kepler, tmp_path):
    def mine(number, frame):
        raise TimeoutError

    before = signal.signal(signal.SIGTERM, mine)
    try:
        threading.Timer(0.2, signal.raise_signal, [signal.SIGTERM]).start()
        with pytest.raises(TimeoutError):
            equip.solve(kepler, *START, (0, 1e9), step=0.125, record="ends", checkpoint=tmp_path / "c")
        assert signal.getsignal(signal.SIGTERM) is mine and (tmp_path / "c").exists()
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        equip.solve(kepler, *START, (0, 1), step=0.125, checkpoint=tmp_path / "d")
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    finally:
        signal.signal(signal.SIGTERM, before)


def test_checkpoints_are_written_as_often_as_wanted(kepler, tmp_path):
    path = tmp_path / "run.checkpoint"
    with long_run(path, 0.05):
        wait_for(path.exists)
        first = json.loads(path.read_text())["index"]
        wait_for(lambda: json.loads(path.read_text())["index"] > first)
    for every in (0, -1, np.nan, "often"):
        with pytest.raises(ValueError, match="checkpoint_every"):
            equip.solve(kepler, *START, (0, 1), checkpoint=path, checkpoint_every=every)


def test_two_processes_cannot_have_one_checkpoint(kepler, tmp_path):
    path = tmp_path / "run.checkpoint"
    with long_run(path, 60):
        wait_for(lambda: is_locked(tmp_path / "run.checkpoint.lock"))
        text = "another process is writing .*run.checkpoint: give each process its own checkpoint"
        with pytest.raises(equip.FileInUseError, match=text):
            equip.solve(kepler, *START, (0, 1), step=0.125, checkpoint=path)
    # Killed as it was, its lock is gone, and the file of the lock is taken over.
    equip.solve(kepler, *START, (0, 1), step=0.125, checkpoint=path)
    assert [file.name for file in tmp_path.iterdir()] == ["run.checkpoint"]
