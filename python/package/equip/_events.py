"""Events: functions whose roots are located, and their changes of the state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Optional, Union

import numpy as np

from ._hamiltonian import record_with_time
from ._numbers import Floats, Shape, refuse_units

Event = Callable[[Any, Any, Any], Any]


def _is_terminal(event: Any, name: str) -> bool:
    terminal = getattr(event, "terminal", None)
    if terminal is None or terminal in (True, False):
        return bool(terminal)
    raise ValueError(
        f"{name} has terminal = {terminal!r}; it must be True, which ends the run at the first root, or "
        "False. Solution.t_events has all roots"
    )


def _direction(event: Any, name: str) -> int:
    direction = getattr(event, "direction", None)
    try:
        return int(np.sign(float(direction or 0)))
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} has direction = {direction!r}; it must be 1, -1 or 0") from None


class Change:
    """The change of the state by an event. The native part calls it in the thread of the steps."""

    def __init__(self, function: Callable[..., Any], shape: Shape, name: str) -> None:
        self._function, self._shape, self.name = function, shape, name
        #: What the function raised, which ends the run.
        self.raised: Optional[BaseException] = None

    def __call__(self, t: float, q: Floats, p: Floats) -> Optional[tuple[Floats, Floats]]:
        try:
            found = self._function(t, q.reshape(self._shape), p.reshape(self._shape))
            if not isinstance(found, tuple) or len(found) != 2:
                raise TypeError(f"then of {self.name} must return (q, p); it returned {found!r:.60}")
            return self._flat(found[0], "q"), self._flat(found[1], "p")
        except BaseException as error:
            self.raised = error
            return None

    def _flat(self, x: Any, name: str) -> Floats:
        refuse_units(x, name)
        if np.iscomplexobj(x):
            raise ValueError(f"then of {self.name} returned complex {name}; it must be real")
        array = np.asarray(x, dtype=float)
        if array.shape != self._shape:
            raise ValueError(
                f"then of {self.name} returned {name} of shape {array.shape}; it must have {self._shape}"
            )
        return np.ascontiguousarray(array.ravel())


def _change(event: Any, shape: Shape, name: str) -> Optional[Change]:
    then = getattr(event, "then", None)
    if then is None:
        return None
    if not callable(then):
        raise TypeError(
            f"{name} has then = {then!r}; it must be a function of t, q and p that returns (q, p)"
        )
    return Change(then, shape, name)


def events_of(events: Union[None, Event, Sequence[Event]], shape: Shape) -> list[tuple[Any, ...]]:
    """Events as the native part reads them: name, recording, direction, whether they end the run, and what
    they do to the state."""
    if events is None:
        return []
    given = [events] if callable(events) else events
    if not isinstance(given, Sequence) or not all(callable(event) for event in given):
        raise TypeError("events must be a function g(t, q, p), or a list of such")
    found = []
    for i, event in enumerate(given):
        name = getattr(event, "__name__", "event")
        called = f"event {i} ({name})"
        terminal, direction = _is_terminal(event, called), _direction(event, called)
        change = _change(event, shape, called)
        if terminal and change is not None:
            raise ValueError(
                f"{called} has terminal and then: it ends the run, or changes its state, not both"
            )
        found.append((name, record_with_time(event, shape, called), direction, terminal, change))
    return found


def changes_of(events: list[tuple[Any, ...]]) -> list[Change]:
    """Those of the events that change the state."""
    return [event[4] for event in events if event[4] is not None]


def raise_of(changes: Sequence[Change]) -> None:
    """Raises what one of these functions has raised, once."""
    for change in changes:
        raised, change.raised = change.raised, None
        if raised is not None:
            raise raised
