"""`Hamiltonian`: an energy, recorded from a function of q and p."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any, Union

import numpy as np

from . import _arrays, _external, _native, _recording
from ._numbers import Floats, Shape, refuse_masked, refuse_units, shape_of

Function = Callable[..., Any]

#: Numbers that are made between two looks at signals: some milliseconds.
_NUMBERS = 1 << 18


class Hamiltonian:
    """The energy H(q, p) of a system, and its derivatives.

    The constructor calls `function(q, p)` once, with arrays of variables, and records its formula. Captured
    arrays are read at this time; later changes of them have no effect. Derivatives are exact to rounding.
    Steps run in compiled Rust, without calling Python.

    Parameters
    ----------
    function
        H as a function of positions q and momenta p, two arrays of the given shape. It may use operators,
        NumPy functions, `@`, `np.einsum`, `np.linalg.norm`, loops, and captured numbers and arrays.
        Give constants with more than 16 digits as `Fraction`, `Decimal` or text. The function must not branch
        on q and p.
    shape
        The shape of q and of p: `2` for a plane, `(6, 3)` for six bodies in space.

    Raises
    ------
    TypeError
        If the function compares variables, or converts them to numbers. The traceback ends at that line.
    ValueError
        If a constant is infinite or not a number.

    Examples
    --------
    >>> import numpy as np
    >>> kepler = Hamiltonian(lambda q, p: 0.5 * p @ p - 1 / np.sqrt(q @ q), shape=2)
    >>> kepler([2.0, 0.0], [0.0, 0.5])
    -0.375
    """

    #: The constructor of an external energy, and its arguments.
    _external: Any = None

    def __init__(self, function: Function, shape: Union[int, Shape]) -> None:
        if not callable(function):
            raise TypeError("the first argument is the energy: a function of q and p")
        self._shape = shape_of(shape)
        self._recorded = _record(function, self._shape, "H(q, p)")

    @classmethod
    def with_time(cls, function: Callable[[Any, Any, Any], Any], shape: Union[int, Shape]) -> Hamiltonian:
        """An energy H(t, q, p) that depends on time.

        Runs conserve the energy balance: H minus the energy that has entered through the explicit dependence
        on time. `Solution.energy_error` and the certificate have the error of this balance; at times of
        `t_eval` it is not known. Quantities to monitor or to conserve are functions of (t, q, p) too.

        Parameters
        ----------
        function
            H as a function of the time t, a number, and of q and p. The constructor calls it twice.
        shape
            The shape of q and of p.

        Examples
        --------
        >>> import numpy as np
        >>> pushed = Hamiltonian.with_time(lambda t, q, p: p @ p / 2 - q[0] * np.cos(t), shape=1)
        >>> pushed([2.0], [1.0], 0.0)
        -1.5
        """
        axes = shape_of(shape)
        if not callable(function):
            raise TypeError("the first argument is the energy: a function of t, q and p")
        return of_recording(record_with_time(function, axes, "H(t, q, p)"), axes)

    @classmethod
    def external(
        cls,
        value: Callable[[Floats, Floats], float],
        gradient: Callable[[Floats, Floats], tuple[Any, Any]],
        shape: Union[int, Shape],
        accuracy: float = 2.0**-50,
    ) -> Hamiltonian:
        """An energy that other code computes: a C library, an interpolator, a learned energy.

        Every iteration calls the functions with numbers and holds the GIL. An evaluation costs some
        microseconds of Python in addition to its own time; a recorded energy costs a tenth of a microsecond.
        A run compares the gradient with differences of the values at the start and at some later steps. The
        Hessian is computed from differences of gradients. Discontinuities are not detected. A run in
        double-double has only 16 digits of H.

        Parameters
        ----------
        value
            H as a function of q and p, two arrays of doubles of the given shape: one number.
        gradient
            ∂H/∂q and ∂H/∂p as a function of q and p: two arrays of the given shape.
        shape
            The shape of q and of p.
        accuracy
            The relative rounding error of the values, and of the gradient relative to its largest component:
            2.2e-16 (one operation in doubles) to 1. If variable steps become very short, the gradient
            is less accurate than declared.

        Raises
        ------
        ValueError
            If `accuracy` is out of range. Runs raise it if the gradient disagrees with the values, or is in
            single precision and `accuracy` is not, and raise the exceptions of the functions.

        Examples
        --------
        >>> import math
        >>> pendulum = Hamiltonian.external(
        ...     lambda q, p: p[0] ** 2 / 2 - math.cos(q[0]), lambda q, p: (np.sin(q), p), shape=1
        ... )
        >>> pendulum([0.0], [1.0])
        -0.5
        """
        axes = shape_of(shape)
        h = of_recording(_external.external(value, gradient, axes, float(accuracy)), axes)
        h._external = "external", (value, gradient, axes, float(accuracy))
        return h

    @classmethod
    def external_potential(
        cls,
        value: Callable[[Floats], float],
        gradient: Callable[[Floats], Any],
        shape: Union[int, Shape],
        masses: Any = 1.0,
        accuracy: float = 2.0**-50,
    ) -> Hamiltonian:
        """The energy sum(p² / (2 masses)) + U(q) with a potential U that other code computes: a force field,
        a learned potential.

        The same as `external` with H = T + U, in half as many evaluations: the kinetic energy is known.

        Parameters
        ----------
        value
            U as a function of q, an array of doubles of the given shape: one number.
        gradient
            ∂U/∂q (minus the force) as a function of q: an array of the given shape.
        shape
            The shape of q and of p.
        masses
            One number, or an array that broadcasts to the given shape: for particles in space (n, 1).
        accuracy
            As in `external`, of U and ∂U/∂q.

        Raises
        ------
        ValueError
            The errors of `external`; masses of another shape, or 0, infinite or NaN.

        Examples
        --------
        >>> import math
        >>> pendulum = Hamiltonian.external_potential(lambda q: -math.cos(q[0]), np.sin, shape=1, masses=2.0)
        >>> pendulum([0.0], [1.0])
        -0.75
        """
        axes = shape_of(shape)
        of_all = tuple(_external.masses_of(masses, axes).tolist())
        native = _external.potential(value, gradient, axes, of_all, float(accuracy))
        h = of_recording(native, axes)
        h._external = "external_potential", (value, gradient, axes, of_all, float(accuracy))
        return h

    def with_bracket(self, bracket: Callable[[Any, Any], dict[tuple[int, int], Any]]) -> Hamiltonian:
        """The system y' = B(y) ∇H(y) with this energy: a rigid body, spins, a charge in (x, v). The state
        y is q.ravel() followed by p.ravel(); q and p are its halves. If y has an odd number of components,
        add one on which H and B do not depend.

        Parameters
        ----------
        bracket
            The entries of the skew-symmetric matrix B as a function of q and p: a dict {(i, j): B_ij} with
            one entry for each pair, counted from 0. B_ji = -B_ij is set automatically; other entries are 0.

        Raises
        ------
        ValueError
            If an entry is outside B, on its diagonal or given twice, or if H depends on time.
        TypeError
            If the energy is external, and in the cases of the constructor.

        Examples
        --------
        >>> body = Hamiltonian(lambda q, p: (q[0]**2 + q[1]**2 / 2 + p[0]**2 / 3) / 2, shape=2)
        >>> body = body.with_bracket(lambda q, p: {(0, 1): -p[0], (0, 2): q[1], (1, 2): -q[0]})
        """
        if self.is_external:
            raise TypeError("an external energy cannot have a bracket; record it from a function of q and p")
        n = 2 * self.degrees_of_freedom

        def call(q: list[_native.Variable], p: list[_native.Variable]) -> Any:
            given = (_arrays.variables(part, self._shape) for part in (q, p))
            return _recording.entries(bracket, n, *given)

        return of_recording(self._recorded.with_bracket(call), self._shape)

    @property
    def is_canonical(self) -> bool:
        """Whether q' = ∂H/∂p and p' = -∂H/∂q, that is, without a bracket."""
        return self._recorded.is_canonical

    @property
    def is_external(self) -> bool:
        """Whether this is an energy by `external` or `external_potential`."""
        return self._external is not None

    @property
    def has_time(self) -> bool:
        """Whether H depends on time, by `with_time`."""
        return self._recorded.has_time

    @property
    def shape(self) -> Shape:
        """The shape of q and of p."""
        return self._shape

    @property
    def degrees_of_freedom(self) -> int:
        """The number m of positions."""
        return self._recorded.degrees_of_freedom

    @property
    def separable(self) -> bool:
        """Whether H = T(p) + U(q)."""
        return self._recorded.separable

    @property
    def quadratic(self) -> bool:
        """Whether H has degree at most two; every method conserves such an H."""
        degree = self._recorded.degree
        return degree is not None and degree <= 2

    @property
    def operations(self) -> int:
        """Operations of one evaluation of H; equal operations count once."""
        return self._recorded.operations

    @property
    def gradient_operations(self) -> int:
        """Operations of one evaluation of the gradient."""
        return self._recorded.gradient_operations

    def _each(
        self, values: Callable[[Floats], Floats], width: int, q: Any, p: Any, t: Any
    ) -> tuple[Floats, Shape]:
        """`width` values for each state, and the axes before those of one state. States, which are (q, p), or
        (q, t, p, 0), are evaluated some thousand at a time, so that signals are answered in between."""
        if any(_arrays.has_recorded(x) for x in (q, p, t)):
            raise TypeError("a Hamiltonian cannot be called within another: call its function")
        if self.has_time == (t is None):
            raise TypeError(
                "H depends on time: give t after q and p"
                if self.has_time
                else "H does not depend on time: leave out t"
            )
        q, p = _real(q, "q"), _real(p, "p")
        axes = len(self._shape)
        for name, x in (("q", q), ("p", p)):
            if x.shape[x.ndim - axes :] != self._shape or x.ndim < axes:
                raise ValueError(
                    f"{name} has shape {x.shape}, but this Hamiltonian needs {self._shape}, "
                    "after any further axes"
                )
        time = [] if t is None else [_real(t, "t")]
        batch = np.broadcast_shapes(
            q.shape[: q.ndim - axes], p.shape[: p.ndim - axes], *(x.shape for x in time)
        )
        m = self.degrees_of_freedom
        q, p = (np.broadcast_to(x, batch + self._shape) for x in (q, p))
        time = [np.broadcast_to(x, batch) for x in time]

        def at(part: tuple[Any, ...]) -> Floats:
            times = [x[part].reshape(-1, 1) for x in time]
            parts = [q[part].reshape(-1, m), *times, p[part].reshape(-1, m), *map(np.zeros_like, times)]
            return values(np.concatenate(parts, axis=-1).ravel())

        parts = _parts(batch, max(_NUMBERS // max(width, 2 * m), 1))
        first = next(parts, None)
        second = next(parts, None)
        if first is not None and second is None:
            return at(first).reshape(*batch, width), batch
        results: Floats = np.empty(math.prod(batch) * width)
        done = 0
        begun: Any = () if first is None else (first, second)
        for part in chain(begun, parts):
            made = at(part)
            results[done : done + len(made)] = made
            done += len(made)
        return results.reshape(*batch, width), batch

    def _kept(self) -> Any:
        """Which numbers of a flat state are those of q and p."""
        m = self.degrees_of_freedom
        return np.r_[0:m, m + 1 : 2 * m + 1] if self.has_time else slice(None)

    def __call__(self, q: Any, p: Any, t: Any = None) -> Any:
        """H, in its own unit: a number, or an array if q and p have axes before those of `shape`, or if t
        has axes. Give the time t if H depends on it."""
        values, batch = self._each(self._recorded.values, 1, q, p, t)
        return values[..., 0] if batch else float(values[0])

    def gradient(self, q: Any, p: Any, t: Any = None) -> tuple[Floats, Floats]:
        """(∂H/∂q, ∂H/∂p), each of the shape of q, after any further axes."""
        n = 2 * (self.degrees_of_freedom + self.has_time)
        gradients, batch = self._each(self._recorded.gradients, n, q, p, t)
        gradients = gradients[..., self._kept()].reshape(*batch, 2, *self._shape)
        rest: Any = (slice(None),) * len(self._shape)
        of_q, of_p = ((..., part, *rest) for part in (0, 1))
        return gradients[of_q], gradients[of_p]

    def hessian(self, q: Any, p: Any, t: Any = None) -> Floats:
        """∇²H, 2m × 2m, by the components of q.ravel() and then those of p.ravel(), after any further
        axes."""
        n = 2 * (self.degrees_of_freedom + self.has_time)
        hessians, batch = self._each(self._recorded.hessians, n * n, q, p, t)
        kept = self._kept()
        return hessians.reshape(*batch, n, n)[..., kept, :][..., kept]

    def __repr__(self) -> str:
        if self.is_external:
            return f"<Hamiltonian of shape {self._shape}, external>"
        kind = "quadratic" if self.quadratic else "separable" if self.separable else "not separable"
        time = ", of time" if self.has_time else ""
        return f"<Hamiltonian of shape {self._shape}{time}, {kind}, {self.operations} operations>"

    def to_bytes(self) -> bytes:
        """The recorded formula, with all digits of its constants and with its tables, as in a pickle. The
        function itself is not stored and may be a lambda.

        Raises
        ------
        ValueError
            If the energy is external. A pickle of an external energy contains its functions.
        """
        return self._recorded.to_bytes()

    @classmethod
    def from_bytes(cls, recording: bytes, shape: Union[int, Shape]) -> Hamiltonian:
        """The Hamiltonian from the bytes of `to_bytes`. Its runs have the same bits.

        Raises
        ------
        ValueError
            If the bytes are damaged, or have another format or number of variables.
        """
        return of_recording(_native.Recorded.from_bytes(recording), shape)

    def __eq__(self, other: object) -> bool:
        """Whether both have the same recorded formula and shape."""
        if not isinstance(other, Hamiltonian):
            return NotImplemented
        if self.is_external or other.is_external:
            return bool(self._external == other._external)
        return self._shape == other._shape and self.to_bytes() == other.to_bytes()

    def __hash__(self) -> int:
        if self.is_external:
            return hash(self._external)
        return hash((self._shape, self.to_bytes()))

    def __reduce__(self) -> tuple[Any, ...]:
        if self.is_external:
            constructor, arguments = self._external
            return getattr(Hamiltonian, constructor), arguments
        return Hamiltonian.from_bytes, (self.to_bytes(), self._shape)


def _parts(batch: Shape, most: int) -> Iterator[tuple[Any, ...]]:
    """Indices of parts of at most so many states each, in the order of the states."""
    rest = math.prod(batch[1:])
    if not batch:
        yield ()
    elif rest > most:
        for i in range(batch[0]):
            for part in _parts(batch[1:], most):
                yield (i, *part)
    else:
        rows = most // max(rest, 1)
        for i in range(0, batch[0], rows):
            yield (slice(i, i + rows),)


def _real(x: Any, name: str) -> Floats:
    """Doubles of real numbers; NumPy would take real parts of complex ones, and ticks of times."""
    refuse_masked(x, name)
    refuse_units(x, name)
    array = np.asarray(x)
    if array.dtype.kind in "cmM":
        raise ValueError(f"{name} is of dtype {array.dtype}; it must be real numbers")
    try:
        return np.asarray(array, dtype=float)
    except OverflowError:
        raise ValueError(f"{name} is beyond the largest double, 1.8e308") from None


def of_recording(recorded: _native.Recorded, shape: Union[int, Shape]) -> Hamiltonian:
    """What has been recorded, for arrays of the given shape."""
    h = Hamiltonian.__new__(Hamiltonian)
    h._recorded, h._shape = recorded, shape_of(shape)
    if int(np.prod(h._shape)) != recorded.degrees_of_freedom:
        raise ValueError(
            f"shape is {shape}, but what was recorded has {recorded.degrees_of_freedom} positions"
        )
    return h


def _record(function: Function, shape: Shape, name: str) -> _native.Recorded:
    """f(q, p), called once."""
    _recording.check_arguments(function, name, "q, p")

    def call(q: list[_native.Variable], p: list[_native.Variable]) -> Any:
        given = (_arrays.variables(q, shape), _arrays.variables(p, shape))
        return _recording.call(function, name, "q, p", *given)

    return _native.Recorded(call, int(np.prod(shape)))


def record_with_time(function: Function, shape: Shape, name: str) -> _native.Recorded:
    """f(t, q, p), called once."""
    _recording.check_arguments(function, name, "t, q, p")

    def call(t: _native.Variable, q: list[_native.Variable], p: list[_native.Variable]) -> Any:
        given = (t, _arrays.variables(q, shape), _arrays.variables(p, shape))
        return _recording.call(function, name, "q, p", *given)

    return _native.Recorded.with_time(call, int(np.prod(shape)))


def recorded_quantity(function: Any, h: Hamiltonian, name: str) -> _native.Recorded:
    """A quantity of the states of h: a function with the arguments of h, or a Hamiltonian."""
    if not isinstance(function, Hamiltonian):
        if not callable(function):
            raise TypeError(f"{name} is {function!r}; it must be a function of q and p")
        return (record_with_time if h.has_time else _record)(function, h.shape, name)
    if function.is_external:
        raise TypeError(
            f"{name} is an external energy; it must be a function of q and p that can be recorded"
        )
    if function.degrees_of_freedom != h.degrees_of_freedom:
        raise ValueError(f"{name} is made for shape {function.shape}, but this Hamiltonian has {h.shape}")
    return function._recorded
