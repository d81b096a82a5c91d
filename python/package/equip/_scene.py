"""`Scene`: a named Hamiltonian with an initial state."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from . import _native
from ._hamiltonian import Hamiltonian, of_recording
from ._methods import chosen
from ._numbers import DoubleDouble, Floats


class Scene(Hamiltonian):
    """A named Hamiltonian with an initial state. Positions and momenta have the shape (m,).

    Attributes
    ----------
    name, title, formula, source, solution, hard, units
        Texts: description, formula, source, known solutions, difficulties, and units (empty without units).
    parameters
        The values of the parameters, as text.
    q0, p0
        The initial state, (m,) each.
    period
        The natural unit of time.
    step, end
        A fixed step size that resolves the motion with order 8, and a suitable end time.
    invariants
        Invariants besides H, by name: Hamiltonians, for `invariants` of `equip.solve`.
    """

    def __init__(self, name: str, parameters: dict[str, Any]) -> None:
        found = _native.scene(
            name, [(key.replace("_", "-"), str(value)) for key, value in parameters.items()]
        )
        self._name, self._given, self._found = name, parameters, found
        self._recorded = found["hamiltonian"]
        self._shape = (self._recorded.degrees_of_freedom,)
        self.name = name
        self.title: str = found["title"]
        self.formula: str = found["formula"]
        self.source: str = found["source"]
        self.solution: str = found["solution"]
        self.hard: str = found["hard"]
        self.units: str = found["units"]
        self.parameters: dict[str, str] = dict(found["parameters"])
        self.q0: Floats = np.array(found["start"][0])
        self.p0: Floats = np.array(found["start"][1])
        self.period: float = found["period"]
        self.step: float = found["step"]
        self.end: float = found["end"]
        self.invariants: dict[str, Hamiltonian] = {
            name: of_recording(recorded, self._shape) for name, recorded in found["invariants"]
        }

    def start(self, precision: Literal["f64", "dd"] = "f64") -> tuple[Any, Any]:
        """(q0, p0): arrays of floats, or with "dd" `equip.DoubleDouble`s, computed with 31 digits."""
        if chosen("precision", precision, ("f64", "dd")) == "f64":
            return self.q0, self.p0
        q, p = ((np.array(high), np.array(low)) for high, low in (self._found["q"], self._found["p"]))
        return DoubleDouble(*q), DoubleDouble(*p)

    def __repr__(self) -> str:
        given = ", ".join(f"{name}={value}" for name, value in self.parameters.items())
        return f"<scene {self.name.replace('-', '_')}({given}): {self.formula}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Scene, (self._name, self._given)
