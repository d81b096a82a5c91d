"""An ensemble over four ranks of MPI on one machine, by mpi4py.futures."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import equip

pytest.importorskip("mpi4py")

#: The ranks of one machine may be more than its cores, also for the superuser of a container.
ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
}

PROGRAM = """
import numpy as np
from mpi4py import MPI
from mpi4py.futures import MPIPoolExecutor
import equip


def rank(sol):
    return MPI.COMM_WORLD.Get_rank(), sol.q[-1, 0]


if __name__ == "__main__":
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - np.cos(q[0]), 1)
    q0, p0 = np.linspace(0, 2, 24)[:, None], np.zeros((24, 1))
    q0[7] = np.nan
    with MPIPoolExecutor() as pool:
        for chunk in (1, 5):
            there = equip.ensemble(h, q0, p0, (0, 50), executor=pool, chunk=chunk)
            here = equip.ensemble(h, q0, p0, (0, 50))
            for name in ("t", "q", "p", "energy_error", "energy_conserved", "steps"):
                assert getattr(here, name).tobytes() == getattr(there, name).tobytes(), name
            assert here.errors == there.errors and list(there.errors) == [7]
        outputs = equip.ensemble(h, q0, p0, (0, 50), executor=pool, chunk=1, output=rank).outputs
        ranks = {output[0] for output in outputs if output is not None}
        assert all(output is None or output[1] == here.q[i, 0] for i, output in enumerate(outputs))
    print("the same of", sorted(ranks))
"""


def mpiexec(script, *arguments, ranks=4):
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    program = shutil.which("mpiexec", path=path)
    if program is None:
        pytest.skip("mpiexec is not in the path")
    command = [program, "-n", str(ranks), sys.executable, "-m", "mpi4py.futures", str(script), *arguments]
    environment = {**os.environ, **ENVIRONMENT}
    return subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment)


def test_the_bytes_of_one_process(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(PROGRAM)
    ended = mpiexec(script)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    # One rank hands out, three work; a rank that is slow to start may come too late for any chunk.
    assert ended.stdout.startswith("the same of [1, 2"), ended.stdout + ended.stderr


KILLED = """
import os
import signal
import sys
import time
import numpy as np
from mpi4py.futures import MPIPoolExecutor
import equip


def end_after_rows(path):
    # Some rows are written, and then this rank dies.
    while len(equip.Ensemble.load(path).lost) == 40:
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGKILL)


def later(seconds, function, *arguments):
    time.sleep(seconds)
    return function(*arguments)


if __name__ == "__main__":
    path, how = sys.argv[1:]
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - np.cos(q[0]), 1)
    q0, p0 = np.linspace(0, 2, 40)[:, None], np.zeros((40, 1))
    options = {"step": 0.05, "chunk": 2, "checkpoint": path}
    if how == "alone":
        print(equip.ensemble(h, q0, p0, (0, 20), **options).q.tobytes().hex())
        sys.exit()

    class Killer:
        # Ends a rank among the first things it hands out; the last one of all never ends.
        def __init__(self, pool):
            self.pool, self.handed = pool, 0

        def submit(self, function, *arguments):
            self.handed += 1
            if how != "kill":
                return self.pool.submit(function, *arguments)
            if self.handed == 1:
                self.pool.submit(end_after_rows, path)
            return self.pool.submit(later, 1e6 if self.handed == 20 else 0.2, function, *arguments)

    with MPIPoolExecutor() as pool:
        print(equip.ensemble(h, q0, p0, (0, 20), executor=Killer(pool), **options).q.tobytes().hex())
"""


def test_a_killed_rank_loses_nothing_that_was_finished(tmp_path):
    """A rank that dies ends the job, whose finished rows are in the checkpoint: the next job makes the others."""
    script, path = tmp_path / "script.py", tmp_path / "ends.npz"
    script.write_text(KILLED)
    ended = mpiexec(script, str(path), "kill")
    assert ended.returncode != 0, ended.stdout + ended.stderr
    part = equip.Ensemble.load(path)
    assert 0 < len(part.lost) < 40
    again = mpiexec(script, str(path), "go on")
    assert again.returncode == 0, again.stderr
    alone = [sys.executable, str(script), str(tmp_path / "alone.npz"), "alone"]
    alone = subprocess.run(alone, capture_output=True, text=True, timeout=300)
    assert again.stdout == alone.stdout and alone.stdout
    # Some launchers report the dead rank on the standard output.
    assert alone.stdout.strip() not in ended.stdout
    made = equip.Ensemble.load(path)
    finished = [i for i in range(40) if i not in part.lost]
    assert made.success and (made.q[finished] == part.q[finished]).all()
