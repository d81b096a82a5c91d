"""`ensemble`: many runs of one system, over threads, or over processes and machines by an executor."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from typing import Any, Literal, Optional, Union

import numpy as np

from .. import _native
from .._events import Event
from .._files import Path
from .._hamiltonian import Function, Hamiltonian, of_recording
from .._methods import Equip, Method
from .._numbers import whole
from .._solution import Solution
from .._solve import interval_of, options, outputs
from .._terminate import terminating
from .checkpoint import Checkpoint, check_resume, digest_of
from .chunks import Executor, Task, Times, check_executor, made_elsewhere, made_here
from .rows import Ensemble, Rows
from .starts import draw_starts, starts_of


def ensemble(
    h: Hamiltonian,
    q0: Any,
    p0: Any,
    span: tuple[float, float],
    *,
    n: Optional[int] = None,
    seed: Optional[int] = None,
    spread: float = 0.01,
    output: Optional[Callable[[Solution], Any]] = None,
    t_eval: Any = None,
    dense_output: bool = False,
    events: Union[None, Event, Sequence[Event]] = None,
    precision: Literal["f64", "dd"] = "f64",
    method: Method = Equip(stages=8),
    step: Optional[float] = None,
    tolerance: Optional[float] = None,
    preserve: Optional[Mapping[str, Function]] = None,
    measure_energy: bool = True,
    chaos: bool = False,
    first_step: Optional[float] = None,
    min_step: float = 0.0,
    max_step: float = np.inf,
    max_steps: Optional[int] = None,
    rtol: Any = None,
    atol: Any = None,
    threads: Optional[int] = None,
    executor: Optional[Executor] = None,
    chunk: Optional[int] = None,
    resume: Optional[Ensemble] = None,
    checkpoint: Optional[Path] = None,
    progress: bool = False,
) -> Ensemble:
    """Integrates from N initial conditions over the same interval. Times, positions and momenta are in
    the units in which H is written.

    Every row has the bits of a single run, for any number of threads, processes and machines. Other Python
    threads continue to run. Ctrl-C ends all runs of this process within a tenth of a second or one step.

    Parameters
    ----------
    h
        The energy: H(q, p), or H(t, q, p) by `Hamiltonian.with_time`.
    q0, p0
        Initial positions and momenta, (N, *h.shape); with `n`, one initial condition, h.shape.
    span
        Start and end of the interval, both finite; runs go backward in time if the end lies before the start.
    n, seed, spread
        Draws n initial conditions near (q0, p0), as `equip.draw_starts` does. Each depends on the seed and
        its number alone.
    output
        A function of each successful run, a `Solution` with all its steps. `Ensemble.outputs` has the return
        values. An exception of the function ends the ensemble. The function is called in threads, or sent to
        the executor with the chunks. Runs are then prepared one by one. Ctrl-C waits for the current runs.
    t_eval, dense_output, events, precision
        Options of the `Solution` that `output` receives, as in `equip.solve`. They need `output`.
    method
        Any of the six methods; `equip.AveragedVectorField`, `equip.Trapezoidal` and `equip.Hbvm` of degree 1
        need `step`.
    step, tolerance
        Either a fixed step size without a sign, or a tolerance: the error of a step relative to the change of
        the state over the step. The default is the tolerance 1e-12.
    preserve
        Further quantities f(q, p) by name, conserved like the energy; f(t, q, p) if H depends on time.
    measure_energy
        Whether methods without free α evaluate the energy, for `Ensemble.energy_error`.
    chaos
        Whether `Ensemble` has the largest Lyapunov exponents and MEGNO.
    first_step, min_step, max_step, max_steps
        Of variable steps: step sizes, in the unit of time, and the largest number of steps.
    rtol, atol
        Of variable steps: `rtol` replaces `tolerance`, component by component; `atol` is an absolute error
        that is always allowed. A number, or a pair for positions and momenta of numbers or arrays of the
        shape `h.shape`.
    threads
        Number of threads, at most one for each run. The default is all; with an executor, one for each chunk.
    executor
        Makes the runs elsewhere, `chunk` runs at a time: an executor of `concurrent.futures` with
        processes, `mpi4py.futures.MPIPoolExecutor`, or `client.get_executor()` of Dask. H is sent as its
        recorded formula, so it may be a lambda; `output` must be a function of a module. If a worker dies,
        its unfinished runs are `lost`, and all other rows remain.
    chunk
        Number of runs in a task of the executor, or between two updates of the checkpoint. The default is a
        quarter of the runs of one worker, or a sixteenth of all runs with a checkpoint, but at most 256.
    resume
        An ensemble with the same H, initial conditions, span and options. Only its `lost` runs are repeated.
    checkpoint
        A file for rows: HDF5 if its name ends in `.h5`, otherwise a NumPy archive. Finished rows are written
        during the computation, and when an exception, Ctrl-C or SIGTERM ends it. The same call, in this
        process or a later one, computes only the missing rows. Runs are then made `chunk` at a time, also by
        threads. Only one process at a time may use the file. `Ensemble.load` reads it.
    progress
        Whether to show a progress bar; needs the package tqdm.

    Returns
    -------
    Ensemble
        A row for each initial condition, in the same order. `Ensemble.errors` has invalid initial conditions
        and failed runs.

    Raises
    ------
    ValueError
        For invalid options, and for a checkpoint or a `resume` of other runs.
    FileFormatError
        A ValueError: for a damaged checkpoint, or another file.
    FileInUseError
        For a checkpoint that another process is writing.
    TypeError
        For an executor without `submit`, and an `output` that cannot be sent to its workers.

    Examples
    --------
    >>> pendulum = Hamiltonian(lambda q, p: p @ p / 2 - np.cos(q[0]), shape=1)
    >>> ends = ensemble(pendulum, np.linspace(0, 3, 100)[:, None], np.zeros((100, 1)), (0, 10), step=0.2)
    >>> ends.q.shape, ends.success
    ((100, 1), True)
    """
    given = options(
        h,
        method,
        step,
        tolerance,
        precision,
        first_step=first_step,
        min_step=min_step,
        max_step=max_step,
        max_steps=max_steps,
        rtol=rtol,
        atol=atol,
        preserve=preserve,
        measure_energy=measure_energy,
        chaos=chaos,
    )
    given["record"] = 0
    at_times = outputs(h, given, t_eval, dense_output, events, precision)
    if output is None and (at_times or dense_output or events is not None or precision == "dd"):
        raise ValueError(
            "t_eval, dense_output, events and precision need output: give output, a function of a Solution"
        )
    if n is not None:
        q0, p0 = draw_starts(q0, p0, n, seed=0 if seed is None else seed, spread=spread)
    elif seed is not None:
        raise ValueError("seed draws initial conditions: give their number n as well")
    q, p = starts_of(q0, h.shape, "q0", precision), starts_of(p0, h.shape, "p0", precision)
    if q.shape != p.shape:
        raise ValueError(f"q0 has {len(q)} initial conditions, but p0 has {len(p)}")
    workers = (os.cpu_count() or 1) if threads is None else whole(threads, "threads", 1)
    start, end = interval_of(span)
    if isinstance(step, (int, float)) and (end[0] - start[0]) * step < 0:
        raise ValueError(
            f"steps of {step} from {start[0]} lead away from {end[0]}; give a step without a sign"
        )
    check_executor(executor)
    if chunk is None:
        tasks = 16 if executor is None else 4 * (getattr(executor, "_max_workers", None) or workers)
        chunk = min(256, max(1, -(-len(q) // tasks)))
    chunk = whole(chunk, "chunk", 1)
    if checkpoint is not None and (resume is not None or output is not None):
        raise ValueError("checkpoint cannot be combined with resume or output: omit these, or checkpoint")
    # Faults of the options are found here; in double-double every run finds them.
    if precision == "f64":
        _native.ensemble(h._recorded, [], [], (start[0], end[0]), given, 1, None)
    at_once = min(workers, max(len(q), 1)) if executor is None or threads is not None else 1
    task = _task(h, (start, end), given, precision, at_once, output)
    digest = digest_of(task, q, p)
    if resume is not None:
        check_resume(resume, digest, (len(q), *h.shape), end[0])
    with ExitStack() as stack:
        stored = None
        if checkpoint is not None:
            stored = stack.enter_context(closing(Checkpoint(checkpoint, digest)))
            stack.enter_context(terminating())
        before = resume if stored is None else stored.read()
        rows = Rows(len(q), h.shape, before, output is not None)
        which = np.arange(len(q)) if before is None else before.lost
        show = stack.enter_context(_bar(len(which), progress))
        if stored is not None:
            stack.enter_context(stored.of(rows))
        if executor is None:
            at_once = max(len(which), 1) if stored is None else chunk
            parts = made_here(task, which, (q, p), at_once, show)
        else:
            parts = made_elsewhere(executor, task, which, (q, p), chunk, show)
        with closing(parts):
            for numbers, made, is_lost in parts:
                rows.take(numbers, made, is_lost)
                if stored is not None:
                    stored.write_if_due()
        if show is not None:
            show(len(which))
        return rows.ensemble(digest)


def _task(
    h: Hamiltonian,
    times: Times,
    given: dict[str, Any],
    precision: str,
    threads: int,
    output: Optional[Callable[[Solution], Any]],
) -> Task:
    """What all chunks have in common; recordings in it can be pickled."""
    keep = {name: of_recording(f, h.shape) for name, f in given["preserve"]}
    events = [(name, of_recording(f, h.shape), *rest) for name, f, *rest in given["events"]]
    every = {**given, "preserve": keep, "events": events}
    return Task(h, times, every, precision, threads, output)


@contextmanager
def _bar(total: int, progress: bool) -> Iterator[Optional[Callable[[int], None]]]:
    if not progress:
        yield None
        return
    from tqdm.auto import tqdm

    with tqdm(total=total, unit="run") as bar:
        yield lambda done: bar.update(done - bar.n)
