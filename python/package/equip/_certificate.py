"""`Certificate`: what a run kept, measured."""

from __future__ import annotations

import html
from dataclasses import asdict, dataclass, is_dataclass
from typing import Any, Optional, Union, get_args, get_origin, get_type_hints


@dataclass(frozen=True)
class Conserved:
    """How far a quantity has strayed from its value at the start, in its own unit."""

    name: str
    start: float
    #: Largest absolute difference over all steps.
    max: float
    #: Difference at the last step.
    end: float


@dataclass(frozen=True)
class EnergyRoundOff:
    """The largest round-off level of H over the steps that conserved it, and the energies."""

    round_off: float
    #: Time of the step at whose end it was largest.
    time: float
    #: abs(H), or the kinetic energy where that is larger and the round-off level is beyond 1e-6 of abs(H).
    scale: float


@dataclass(frozen=True)
class EnergyJumps:
    """Crossings at which H itself jumps: no force comes of it, and H differs by the jump."""

    count: int
    #: The largest, in the unit of H.
    largest: float


@dataclass(frozen=True)
class PhasePerStep:
    """The angle in radians by which the fastest motion turns in a step of that size, where it was largest."""

    angle: float
    step: float


@dataclass(frozen=True)
class VariableSteps:
    """What step control did."""

    #: Of a step, relative to the motion within it.
    tolerance: float
    #: Sizes of the steps, in the unit of time.
    smallest: float
    largest: float
    #: Steps refused because their error estimate was too large, and because they could not be solved.
    rejected: int
    failed: int


@dataclass(frozen=True)
class Counts:
    """Counts of work. Equal runs have equal counts on every machine."""

    steps: int
    #: Steps whose defect of the energy was left to a later one.
    uncorrected: int
    #: Fixed-point iterations over all stages without a preconditioner.
    fixed_point_iterations: int
    #: Iterations with a preconditioner.
    newton_iterations: int
    #: Times the stages of a step were begun anew with another preconditioner.
    taken_over: int
    #: Preconditioners made of ∇²H at all stages, and of one ∇²H.
    factorisations: int
    simplified_factorisations: int
    #: Evaluations of ∇H, of ∇²H, and of H alone, at one point each.
    gradients: int
    hessians: int
    energies: int
    #: Search directions of α, and updates of α.
    directions: int
    alpha_updates: int
    #: Local errors estimated to judge a displacement.
    local_errors: int
    #: Times a step was split into two.
    halvings: int
    #: Steps made for outputs between two steps, which are counted in no other number.
    output_steps: int
    #: Steps whose outputs are of order s only: the stages of a finer polynomial were not found.
    coarse_outputs: int
    #: Crossings of kinks and jumps of H at which a step, or a part of a fixed one, ended.
    switches_crossed: int


@dataclass(frozen=True)
class Certificate:
    """The measured record of a run: errors of energy and invariants, outcomes of the steps, counts of work.

    Times are in the unit of time of H, errors in that of their quantity, `seconds` are those of the wall
    clock. `str` is the text that the command line program prints; notebooks show a table.
    """

    #: What the first line says: "yes, on every step", "NO: " with the reasons, or "not requested" with the
    #: largest error, as of Gauss's method. `energy_conserved_on_every_step` is the same as a boolean.
    energy_conserved_to_round_off: str
    method: str
    #: "f64" or "dd".
    precision: str
    #: The fixed step; of variable steps the mean.
    step: float
    variable_steps: Optional[VariableSteps]
    start: float
    end: float
    #: H at the start, H - H(start) over the run; None if it was not measured.
    energy: Optional[Conserved]
    #: Largest error in units of its round-off level, over all steps, if they solve for the energy.
    energy_in_round_off_levels: Optional[float]
    #: None if the energy was not measured.
    energy_round_off: Optional[EnergyRoundOff]
    #: None if H jumps nowhere on the way.
    energy_jumps: Optional[EnergyJumps]
    #: None where the iteration of the steps contracts without the Hessian, as it does for small angles only.
    phase_per_step: Optional[PhasePerStep]
    #: Whether the steps resolve the fastest motion: at most as many radians as there are stages.
    motion_is_resolved: bool
    invariants: tuple[Conserved, ...]
    #: Smallest and largest α_1 ... α_{s-1} used; empty if none was solved for.
    alpha_range: tuple[tuple[float, float], ...]
    #: Largest Lyapunov exponent, per unit of time, and MEGNO, if a deviation was followed.
    lyapunov: Optional[float]
    megno: Optional[float]
    counts: Counts
    #: Steps by outcome.
    outcomes: dict[str, int]
    #: Whether every step conserved the energy to round-off, and neither the round-off level nor the error at
    #: the end is large compared with the energies.
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
        """Of what the native part hands over."""
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
        """What `to_dict` has written.

        Raises
        ------
        ValueError
            If it is not a certificate.
        """
        certificate = _checked(cls, stored, "the certificate")
        assert isinstance(certificate, Certificate)
        return certificate


def _checked(kind: Any, stored: Any, name: str) -> Any:
    """What was stored as numbers, texts, lists and dicts, as a value of this type; or a ValueError."""
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
