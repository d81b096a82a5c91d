"""`Certificate`: what a run conserved, measured."""

from __future__ import annotations

import html
from dataclasses import asdict, dataclass, is_dataclass
from typing import Any, Optional, Union, get_args, get_origin, get_type_hints


@dataclass(frozen=True)
class Conserved:
    """The error of a conserved quantity: its difference from the initial value, in its own unit."""

    name: str
    start: float
    #: Largest absolute difference over all steps.
    max: float
    #: Difference at the last step.
    end: float


@dataclass(frozen=True)
class EnergyRoundOff:
    """The largest round-off level of H over the steps that conserve H, and the scale of the energies."""

    round_off: float
    #: Time at the end of the step with this level.
    time: float
    #: abs(H_ref), or the largest kinetic energy since then if that is larger and the round-off level exceeds
    #: √ε·abs(H_ref) (1.5e-8 in f64).
    scale: float


@dataclass(frozen=True)
class EnergyJumps:
    """Discontinuities at which H itself jumps. A jump exerts no force, so H changes by the jump."""

    count: int
    #: The largest jump, in the unit of H.
    largest: float


@dataclass(frozen=True)
class PhasePerStep:
    """The largest phase hω of the fastest motion in a step, in radians, and the size of that step."""

    angle: float
    step: float


@dataclass(frozen=True)
class VariableSteps:
    """The work of the step size control."""

    #: Error of a step, relative to the change of the state over the step.
    tolerance: float
    #: Step sizes, in the unit of time.
    smallest: float
    largest: float
    #: Attempts rejected for their error estimate, and attempts for which no stages or no admissible α were
    #: found.
    rejected: int
    failed: int


@dataclass(frozen=True)
class Counts:
    """Counts of work. Equal runs have equal counts on every machine."""

    steps: int
    #: Uncorrected steps: their energy error was not removed.
    uncorrected: int
    #: Fixed-point iterations over all stages without a preconditioner.
    fixed_point_iterations: int
    #: Iterations with a preconditioner.
    newton_iterations: int
    #: Restarts of the iteration of a step with another preconditioner.
    preconditioner_changes: int
    #: Factorisations of full Newton (∇²H at all stages) and of simplified Newton (one ∇²H).
    factorisations: int
    simplified_factorisations: int
    #: Evaluations of ∇H, of ∇²H, and of H alone, each at one point.
    gradients: int
    hessians: int
    energies: int
    #: Search directions of α, and updates of α.
    directions: int
    alpha_updates: int
    #: Estimates of the local error, for the test whether α is admissible.
    local_errors: int
    #: Halvings of steps.
    halvings: int
    #: Steps made for outputs between two steps. No other count contains these.
    output_steps: int
    #: Steps whose outputs have only order s, because the iteration for the 2s stages failed.
    coarse_outputs: int
    #: Changes of the state by events and by `set_state`. Errors are relative to the values after each change.
    state_changes: int
    #: Discontinuities at which a step, or a part of a fixed step, ended.
    discontinuities_crossed: int


@dataclass(frozen=True)
class Certificate:
    """The report of a run: errors of energy and invariants, outcomes of the steps, counts of work.

    Times are in the unit of time of H, errors in the unit of their quantity. `seconds` is wall-clock time.
    `str` gives the text that the program `equip` prints. Notebooks show a table.
    """

    #: The verdict, the first line: "yes, on every step", "NO: " with the reason, "not requested" (for example
    #: Gauss) with the largest error, or "no step was made". `energy_conserved_on_every_step` is the verdict
    #: as a boolean, true if there is no step.
    energy_conserved_to_round_off: str
    method: str
    #: "f64" or "dd".
    precision: str
    #: The fixed step size, or the mean of variable step sizes.
    step: float
    variable_steps: Optional[VariableSteps]
    start: float
    end: float
    #: H_ref, the value of H at the start or after the last change of the state, and H - H_ref; None if not
    #: measured.
    energy: Optional[Conserved]
    #: Largest energy error of all steps in round-off levels, if the method solves for α.
    energy_in_round_off_levels: Optional[float]
    #: None if the energy was not measured.
    energy_round_off: Optional[EnergyRoundOff]
    #: None if H does not jump during the run.
    energy_jumps: Optional[EnergyJumps]
    #: The largest hω of the fastest motion. hω is estimated only in steps 1, 2, 4, 8, …, and only if the
    #: iteration converged slowly or used ∇²H. None: no such step.
    phase_per_step: Optional[PhasePerStep]
    #: Whether the steps resolve the fastest motion: hω ≤ s.
    motion_is_resolved: bool
    invariants: tuple[Conserved, ...]
    #: Smallest and largest α_1 ... α_{s-1}; empty if the method does not solve for α.
    alpha_range: tuple[tuple[float, float], ...]
    #: Largest Lyapunov exponent, per unit of time, and MEGNO, if a tangent vector was propagated.
    lyapunov: Optional[float]
    megno: Optional[float]
    counts: Counts
    #: Number of steps with each outcome.
    outcomes: dict[str, int]
    #: Whether every step conserved the energy to round-off, and both the round-off level and the error at the
    #: end are small compared with the energies.
    energy_conserved_on_every_step: bool
    seconds: float
    text: str

    def to_dict(self) -> dict[str, Any]:
        """All fields as numbers, texts, lists and dicts, ready for JSON."""
        return {
            **asdict(self),
            "invariants": [asdict(i) for i in self.invariants],
            "alpha_range": [list(r) for r in self.alpha_range],
        }

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        def row(line: str) -> str:
            label, _, value = line.strip().partition("  ")
            cells = (f"<td>{html.escape(text.strip())}</td>" for text in (label, value))
            return f"<tr>{''.join(cells)}</tr>"

        verdict, *lines = self.text.splitlines()
        first = f'<tr><th colspan="2">{html.escape(verdict)}</th></tr>'
        return f"<table>{first}{''.join(row(line) for line in lines)}</table>"

    @classmethod
    def _of(cls, found: dict[str, Any]) -> Certificate:
        """From the data of the native part."""
        names = Counts.__dataclass_fields__
        round_off = found["energy_round_off"]
        return cls(
            counts=Counts(**{name: found[name] for name in names}),
            energy=Conserved(*found["energy"]) if found["energy"] else None,
            energy_round_off=round_off and EnergyRoundOff(*round_off),
            energy_jumps=EnergyJumps(*found["energy_jumps"]) if found["energy_jumps"] else None,
            phase_per_step=PhasePerStep(*found["phase_per_step"]) if found["phase_per_step"] else None,
            invariants=tuple(Conserved(*defect) for defect in found["invariants"]),
            variable_steps=VariableSteps(*found["variable_steps"]) if found["variable_steps"] else None,
            alpha_range=tuple(found["alpha_range"]),
            outcomes={name: count for name, count in found["outcomes"] if count},
            **{
                name: found[name]
                for name in (
                    "energy_conserved_to_round_off",
                    "method",
                    "precision",
                    "step",
                    "start",
                    "end",
                    "energy_in_round_off_levels",
                    "lyapunov",
                    "megno",
                    "energy_conserved_on_every_step",
                    "motion_is_resolved",
                    "seconds",
                    "text",
                )
            },
        )

    @classmethod
    def _from_dict(cls, stored: Any) -> Certificate:
        """From the dict of `to_dict`.

        Raises
        ------
        ValueError
            If it is not a certificate.
        """
        certificate = _checked(cls, stored, "the certificate")
        assert isinstance(certificate, Certificate)
        return certificate


def _checked(kind: Any, stored: Any, name: str) -> Any:
    """A value of this type from numbers, texts, lists and dicts; or a ValueError."""
    origin, parts = get_origin(kind), get_args(kind)
    if is_dataclass(kind):
        hints = get_type_hints(kind)
        if not isinstance(stored, dict) or stored.keys() != hints.keys():
            raise ValueError(f"{name} does not have the entries {', '.join(hints)}")
        made: Any = kind
        return made(**{key: _checked(hint, stored[key], key) for key, hint in hints.items()})
    if origin is Union:
        return None if stored is None else _checked(parts[0], stored, name)
    if origin is tuple and isinstance(stored, (list, tuple)):
        if parts[-1] is Ellipsis:
            return tuple(_checked(parts[0], x, name) for x in stored)
        if len(parts) == len(stored):
            return tuple(_checked(part, x, name) for part, x in zip(parts, stored))
    if origin is dict and isinstance(stored, dict):
        return {_checked(parts[0], key, name): _checked(parts[1], x, name) for key, x in stored.items()}
    if kind is float and type(stored) in (int, float):
        return float(stored)
    if kind in (int, bool, str) and type(stored) is kind:
        return stored
    raise ValueError(f"{name} is {stored!r:.40}")
