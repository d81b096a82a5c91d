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
from .chunks import Executor, Task, check_executor, made_elsewhere, made_here
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
    chunk: int = 256,
    resume: Optional[Ensemble] = None,
    checkpoint: Optional[Path] = None,
    progress: bool = False,
) -> Ensemble:
    """Integrates from N starts over the same span. All numbers are in the units of H.

    Every bit is that of a run of its own, whatever the number of threads, processes and machines. Python runs
    meanwhile, and Ctrl-C ends all runs of this process within a tenth of a second or a step.

    Parameters
    ----------
    h
        The energy: H(q, p), or H(t, q, p) by `Hamiltonian.with_time`.
    q0, p0
        Positions and momenta at the starts, (N, *h.shape); with `n`, of one start, h.shape.
    span
        Start and end of the interval, both finite; runs go back in time if the end lies before the start.
    n, seed, spread
        Draws n starts around one, by `equip.draw_starts`: each from the seed and its own number alone,
        whatever threads, chunks and executors.
    output
        A function of each run that succeeds, as a `Solution` with all its steps; `Ensemble.outputs` has what
        it returns, and what it raises ends the ensemble. It is called in threads, and travels with the chunks
        to an executor; each run is then made ready anew, and Ctrl-C waits for those that are under way.
    t_eval, dense_output, events, precision
        What the `Solution` that `output` is given has, as in `equip.solve`; with "dd" it is of a run in
        double-double. They are refused without `output`.
    method
        `equip.Equip`, `equip.Gauss` or `equip.FixedAlpha`, with the number of stages.
    step, tolerance
        A fixed step without a sign, or an error per step relative to the motion within
        it: one of them. Without both, the tolerance is 1e-12.
    preserve
        Further quantities f(q, p) by name that are kept like the energy; of (t, q, p) where H is.
    measure_energy
        Whether methods that do not solve for the energy evaluate it, for `Ensemble.energy_error`.
    chaos
        Whether `Ensemble` has the largest Lyapunov exponents and MEGNO.
    first_step, min_step, max_step, max_steps
        Of steps by tolerance: sizes, in the unit of time, and their number.
    rtol, atol
        Of steps by tolerance: errors of a step relative to its motion, in place of `tolerance`, and errors
        that are allowed in addition. A number, or a pair for positions and momenta of numbers or arrays of
        the shape `h.shape`.
    threads
        Threads of the machine, at most one for each run; all by default, with an executor one for each chunk.
    executor
        Makes the runs elsewhere, `chunk` starts at a time: an executor of `concurrent.futures` with
        processes, `mpi4py.futures.MPIPoolExecutor`, Dask's `client.get_executor()`. H travels as its
        recording, so that it may be a lambda; `output` is a function of a module. If a worker dies, the runs
        that were not finished are `lost`, and all others are kept.
    chunk
        Starts that an executor is given at a time, or that are made between two looks at the checkpoint.
    resume
        An ensemble of the same H, starts, span and options: its rows are taken, and only its `lost` runs are
        made.
    checkpoint
        A file for rows: HDF5 if its name ends in `.h5`, else a NumPy archive. Finished rows are written while
        the others are made, and when an exception, Ctrl-C or SIGTERM ends them; the same call, in this
        process or a later one, makes only what is missing. With it runs are made `chunk` starts at a time, by
        threads too. One process at a time may have it. `Ensemble.load` reads the file.
    progress
        Whether to show a bar; asks for the package tqdm.

    Returns
    -------
    Ensemble
        A row for each start, in their order. A start that cannot be used is in `Ensemble.errors`, as is a run
        that failed.

    Raises
    ------
    ValueError
        For options that cannot be used, and a checkpoint or an ensemble to resume of other runs.
    FileFormatError
        A ValueError: for a checkpoint that is damaged, or no file of rows.
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
            "t_eval, dense_output, events and precision are for the Solution that output is given: give "
            "output, a function of a Solution"
        )
    if n is not None:
        q0, p0 = draw_starts(q0, p0, n, seed=0 if seed is None else seed, spread=spread)
    elif seed is not None:
        raise ValueError("seed draws starts around one: give their number n as well")
    q, p = starts_of(q0, h.shape, "q0"), starts_of(p0, h.shape, "p0")
    if q.shape != p.shape:
        raise ValueError(f"q0 has {len(q)} starts, but p0 has {len(p)}")
    workers = (os.cpu_count() or 1) if threads is None else whole(threads, "threads", 1)
    start, end = interval_of(span)
    times = (start[0], end[0])
    if isinstance(step, (int, float)) and (end[0] - start[0]) * step < 0:
        raise ValueError(
            f"steps of {step} lead from {start[0]} away from {end[0]}; give a step without a sign"
        )
    chunk = whole(chunk, "chunk", 1)
    check_executor(executor)
    if checkpoint is not None and (resume is not None or output is not None):
        raise ValueError(
            "checkpoint has the rows of its own runs: leave out resume and output, or checkpoint"
        )
    # Faults of the options are found here; in double-double every run finds them.
    if precision == "f64":
        _native.ensemble(h._recorded, [], [], times, given, 1, None)
    at_once = min(workers, max(len(q), 1)) if executor is None or threads is not None else 1
    task = _task(h, times, given, precision, at_once, output)
    digest = digest_of(task, q, p)
    if resume is not None:
        check_resume(resume, digest, q.shape, times[1])
    with ExitStack() as stack:
        kept = None
        if checkpoint is not None:
            kept = stack.enter_context(closing(Checkpoint(checkpoint, digest)))
            stack.enter_context(terminating())
        before = resume if kept is None else kept.read()
        rows = Rows(len(q), h.shape, before, output is not None)
        which = np.arange(len(q)) if before is None else before.lost
        show = stack.enter_context(_bar(len(which), progress))
        if kept is not None:
            stack.enter_context(kept.of(rows))
        if executor is None:
            at_once = max(len(which), 1) if kept is None else chunk
            parts = made_here(task, which, (q, p), at_once, show)
        else:
            parts = made_elsewhere(executor, task, which, (q, p), chunk, show)
        with closing(parts):
            for numbers, made, is_lost in parts:
                rows.take(numbers, made, is_lost)
                if kept is not None:
                    kept.write_if_due()
        if show is not None:
            show(len(which))
        return rows.ensemble(digest)


def _task(
    h: Hamiltonian,
    times: tuple[float, float],
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
