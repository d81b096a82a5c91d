"""Chunks of an ensemble: made here over threads, or elsewhere by an executor."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from typing import Any, Optional, Protocol, Union

import numpy as np
from numpy.typing import NDArray

from .. import _native
from .._events import changes_of, raise_of
from .._hamiltonian import Hamiltonian
from .._numbers import Floats
from .._solution import Solution
from .._solve import solution
from .rows import Ensemble, joined, missing, row_of, rows_of

#: Is told how many runs are made.
Show = Optional[Callable[[int], None]]
#: Start and end of the span as pairs of doubles.
Times = tuple[tuple[float, float], tuple[float, float]]
#: Numbers of runs, their rows, and whether their worker died.
Made = tuple[NDArray[np.int64], Ensemble, bool]


class Executor(Protocol):
    """Of concurrent.futures, mpi4py.futures, Dask (`client.get_executor()`) and others."""

    def submit(self, fn: Callable[..., Any], /, *args: Any) -> Any:
        """A future of fn(*args), with `result()` and `cancel()`."""


def check_executor(executor: Any) -> None:
    """Refuses what has no `submit`, such as a number of processes or a multiprocessing.Pool."""
    if executor is None or (callable(getattr(executor, "submit", None)) and not isinstance(executor, type)):
        return
    raise TypeError(
        f"executor is {executor!r}; it must have the method submit: give "
        "concurrent.futures.ProcessPoolExecutor(), mpi4py.futures.MPIPoolExecutor() or client.get_executor()"
    )


def _cannot_be_sent(error: Exception) -> bool:
    """Whether an error is one of pickling."""
    import pickle

    kinds = (TypeError, AttributeError)
    return isinstance(error, pickle.PicklingError) or (isinstance(error, kinds) and "pickle" in str(error))


@dataclass(frozen=True)
class Task:
    """What all chunks have in common, ready to be pickled."""

    h: Hamiltonian
    #: Start and end, each with its low word, which only double-double uses.
    times: Times
    given: dict[str, Any]
    precision: str
    threads: int
    output: Optional[Callable[[Solution], Any]]


def chunk_of(task: Task, q: Floats, p: Floats, show: Show = None) -> Ensemble:
    """The rows of these starts: a function of its arguments alone, but for whom it tells of its progress."""
    keep = [(name, quantity._recorded) for name, quantity in task.given["preserve"].items()]
    events = [(name, event._recorded, *rest) for name, event, *rest in task.given["events"]]
    given = {**task.given, "preserve": keep, "events": events}
    flat = (q.ravel().tolist(), p.ravel().tolist())
    h = task.h
    if task.output is None:
        (start, _), (end, _) = task.times
        return rows_of(_native.ensemble(h._recorded, *flat, (start, end), given, task.threads, show), h.shape)
    return _with_outputs(task, task.output, given, (q, p), show)


def _with_outputs(
    task: Task,
    output: Callable[[Solution], Any],
    given: dict[str, Any],
    starts: tuple[Floats, Floats],
    show: Show,
) -> Ensemble:
    """The rows of these starts, and what a function makes of each run."""
    h, times, (q, p) = task.h, task.times, starts
    changes, at_times = changes_of(given["events"]), bool(given["t_eval"][0])
    whole = {**given, "record": 0 if at_times else 1}

    def words(x: Floats) -> tuple[list[float], list[float]]:
        high, low = x if task.precision == "dd" else (x, np.zeros_like(x))
        return high.ravel().tolist(), low.ravel().tolist()

    def one(i: int) -> tuple[Ensemble, Any]:
        interval = (words(q[i]), words(p[i]), *times)
        try:
            found = _native.solve(h._recorded, interval, whole, task.precision, None)
        except (ValueError, _native.IntegrationError) as error:
            return missing(1, h.shape, str(error)), None
        if found["fault"] is not None:
            return missing(1, h.shape, found["fault"]), None
        raise_of(changes)
        sol = solution(h, found, whole, False)
        return row_of(sol), output(solution(h, found, whole, True) if at_times else sol)

    from concurrent.futures import ThreadPoolExecutor

    pool = ThreadPoolExecutor(task.threads)
    try:
        made = []
        for row in pool.map(one, range(len(q))):
            made.append(row)
            if show is not None:
                show(len(made))
    finally:
        pool.shutdown(cancel_futures=True)
    rows = joined([row for row, _ in made], h.shape)
    return replace(rows, outputs=tuple(result for _, result in made))


def _chunk_or_fault(task: Task, q: Floats, p: Floats) -> Union[Ensemble, tuple[Exception, str]]:
    """The rows of these starts; or what `output` raised, and where. What a worker has not enough of is a
    fault of the worker."""
    try:
        return chunk_of(task, q, p)
    except (MemoryError, OSError):
        raise
    except Exception as error:
        return error, traceback.format_exc()


def made_here(
    task: Task, which: NDArray[np.int64], starts: tuple[Floats, Floats], chunk: int, show: Show
) -> Generator[Made, None, None]:
    """The runs `which` of these starts, one chunk after the other."""
    q, p = starts
    for at in range(0, len(which), chunk):
        numbers = which[at : at + chunk]
        yield numbers, chunk_of(task, q[numbers], p[numbers], _after(at, show)), False


def _after(made: int, show: Show) -> Show:
    """Counts runs in addition to those that were made before."""
    return None if show is None else lambda more: show(made + more)


def made_elsewhere(
    executor: Executor,
    task: Task,
    which: NDArray[np.int64],
    starts: tuple[Floats, Floats],
    chunk: int,
    show: Show,
) -> Generator[Made, None, None]:
    """The runs `which` of these starts, each chunk as soon as it is made; by executors whose futures are not
    those of `concurrent.futures` in the order of the starts."""
    q, p = starts
    futures: list[tuple[NDArray[np.int64], Any]] = []
    done = 0
    try:
        for at in range(0, len(which), chunk):
            numbers = which[at : at + chunk]
            try:
                futures.append((numbers, executor.submit(_chunk_or_fault, task, q[numbers], p[numbers])))
            except Exception as error:  # A pool that is broken already refuses more.
                futures.append((numbers, error))
        for numbers, future in _as_completed(futures):
            try:
                if isinstance(future, Exception):
                    raise future
                made, is_lost = future.result(), False
                raised = None if isinstance(made, Ensemble) else made
            except Exception as error:
                if _cannot_be_sent(error):
                    raise TypeError(
                        f"output, or what it returns, cannot be sent to the workers of the executor "
                        f"({error}): use a function of a module that returns numbers and arrays"
                    ) from error
                raised = None
                message = (
                    f"the worker of this run died ({type(error).__name__}: {error}); call ensemble "
                    "again with resume= to repeat the run"
                )
                nothing = () if task.output is None else (None,) * len(numbers)
                made = replace(missing(len(numbers), task.h.shape, message), outputs=nothing)
                is_lost = True
            if raised is not None:
                raise raised[0] from RuntimeError(f"in a worker:\n{raised[1]}")
            done += len(numbers)
            if show is not None:
                show(done)
            yield numbers, made, is_lost
    except BaseException:
        for _, future in futures:
            if not isinstance(future, Exception):
                future.cancel()
        raise


def _as_completed(futures: list[tuple[NDArray[np.int64], Any]]) -> Iterator[tuple[NDArray[np.int64], Any]]:
    from concurrent.futures import Future, as_completed

    if not all(isinstance(future, Future) for _, future in futures):
        yield from futures
        return
    numbers = {future: numbers for numbers, future in futures}
    for future in as_completed(numbers):
        yield numbers[future], future
