"""SIGTERM, the signal of job schedulers, during a run with a checkpoint."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class _Terminated(BaseException):
    """Raised by SIGTERM, as KeyboardInterrupt by Ctrl-C."""


def _default() -> None:
    """Ends this process as SIGTERM does where nobody handles it."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    os.kill(os.getpid(), signal.SIGTERM)


@contextmanager
def terminating() -> Iterator[None]:
    """Lets SIGTERM end the block by an exception, and then the process, as it would have without the block.
    Handlers that the user has set stay, and other threads than the main one cannot set any."""
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return
    process = os.getpid()

    def handle(number: int, frame: Any) -> None:
        if os.getpid() != process:
            # A process that was forked off meanwhile, such as the worker of an executor.
            _default()
        raise _Terminated

    signal.signal(signal.SIGTERM, handle)
    try:
        yield
    except _Terminated:
        _default()
        raise
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
