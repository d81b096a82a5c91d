"""Ctrl-C and threads."""

import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import equip

CALLS = {
    "solve": "equip.solve(h, q, p, (0, 1e9), step=0.01, record='ends')",
    "double-double": "equip.solve(h, q, p, (0, 1e9), step=0.01, record='ends', precision='dd')",
    "steps": "all(equip.steps(h, q, p, step=0.01))",
    "suggest_step": "equip.suggest_step(h, q, p, (0, 2e5), 1e-9)",
    "ensemble": "equip.ensemble(h, [q] * 8, [p] * 8, (0, 1e9), step=0.01)",
}

PROGRAM = """
import signal, time, numpy as np, equip
# Where this is run in the background Ctrl-C may be ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
h, q, p = equip.Hamiltonian(lambda q, p: .5 * p @ p - 1 / np.sqrt(q @ q), 2), [.4, 0], [0, 2.]
print("ready", flush=True)
try:
    {call}
except KeyboardInterrupt:
    print(time.time())
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_ends_a_run_within_a_tenth_of_a_second(name):
    def latency():
        program = PROGRAM.format(call=CALLS[name])
        with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout.readline() == "ready\n"
            time.sleep(0.3)
            sent = time.time()
            process.send_signal(signal.SIGINT)
            try:
                ended = float(process.communicate(timeout=20)[0])
            finally:
                process.kill()
        return ended - sent

    # The best of three: others may be using the machine.
    assert min(latency() for _ in range(3)) < 0.1


def test_other_threads_run_meanwhile():
    h = equip.Hamiltonian(lambda q, p: 0.5 * p @ p - 1 / np.sqrt(q @ q), 2)
    done = threading.Event()
    counts = []

    def count():
        while not done.is_set():
            counts.append(time.perf_counter())
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    begun = time.perf_counter()
    equip.solve(h, [0.4, 0], [0, 2.0], (0, 20000), step=0.05, record="ends")
    ended = time.perf_counter()
    done.set()
    counter.join()
    assert sum(begun < t < ended for t in counts) > 50 * (ended - begun)
