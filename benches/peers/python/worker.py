"""The Python peers: reads one request a line, runs it, answers one line.

Request: {"key", "peer", "variant", "system", "parameters", "q", "v", "end", "setting", "turn", "repeats"}.
         {"peer": "versions"} asks for the versions alone.
Answer:  {"seconds", "q", "v", "steps"} or {"error"}; numbers of the state as decimal text.

Integrators are built once for each key and setting: what compiling takes is not timed. Timed is the CPU time of this
thread over the call that propagates, less what the same call takes when there is nothing to propagate.
"""

import json
import sys
from time import thread_time

import heyoka
import rebound
import scipy

import heyoka_peer
import rebound_peer
import scipy_peer

PEERS = {"heyoka": heyoka_peer, "rebound": rebound_peer, "scipy": scipy_peer}
built = {}


def timed(run):
    begun = thread_time()
    run()
    return thread_time() - begun


def versions():
    return {"heyoka": heyoka.__version__, "rebound": rebound.__version__, "scipy": scipy.__version__}


def answer(request):
    if request["peer"] == "versions":
        return versions()
    key = (request["key"], request["setting"])
    if key not in built:
        built[key] = PEERS[request["peer"]].build(request)
    runner = built[key]
    runner.reset()
    first = timed(runner.run)
    seconds = []
    if first > request["turn"]:
        seconds.append(first)
    while len(seconds) < request["repeats"] and sum(seconds) < request["turn"]:
        runner.reset()
        seconds.append(timed(runner.run))
    q, v, steps = runner.end()
    empty = min(timed(runner.nothing) for _ in range(9))
    seconds.sort()
    return {
        "seconds": max(seconds[len(seconds) // 2] - empty, 0.0),
        "empty": empty,
        "q": q,
        "v": v,
        "steps": steps,
    }


def main():
    for line in sys.stdin:
        try:
            reply = answer(json.loads(line))
        except Exception as error:  # whatever a peer throws is its result
            reply = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(reply), flush=True)


main()
