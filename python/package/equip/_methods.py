"""Methods: Gauss, EQUIP, and related Runge-Kutta methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, Union

from ._numbers import number, pair, whole

_PRECONDITIONERS = ("automatic", "identity", "diagonal", "frozen", "full")


MOST_STAGES = 32


def chosen(name: str, value: str, words: tuple[str, ...]) -> str:
    """`value`, which must be one of the words."""
    if not isinstance(value, str) or value not in words:
        raise ValueError(f"{name} is {value!r}; it must be {' or '.join(map(repr, words))}")
    return value


def _options(family: str, stages: int, preconditioner: str) -> dict[str, Any]:
    return {
        "family": family,
        "stages": whole(stages, "stages", 1 if family == "gauss" else 2, MOST_STAGES),
        "alpha": (0.0, 0.0),
        "alpha_policy": "within error",
        "alpha_bound": 0.05,
        "preconditioner": chosen("preconditioner", preconditioner, _PRECONDITIONERS),
    }


@dataclass(frozen=True)
class Equip:
    """EQUIP methods of order 2s, which conserve H.

    Each step first computes the Gauss step (α = 0). If its energy error exceeds the round-off level, the
    solver determines the parameters α_k so that H(y₁) = H_ref, the value of H at the start.

    Parameters
    ----------
    stages
        s, from 2 to 32.
    alphas
        Which α_k are free: "several", the first three or as many as there are conserved quantities; or the
        "last" one only, as in the paper.
    alpha_policy
        Limit on the change of the end point caused by α. "within error": if the change would be much larger
        than the local error, the step is left uncorrected. "always": no limit. "refuse": the run ends with an
        error where "within error" would leave a step uncorrected.
    alpha_bound
        Largest |α|, dimensionless.
    preconditioner
        How the stages are iterated: "identity" (fixed-point iteration), "diagonal", "frozen" (simplified
        Newton), "full" (Newton), or "automatic". The solution is the same.
    """

    stages: int = 8
    alphas: Literal["several", "last"] = "several"
    alpha_policy: Literal["within error", "always", "refuse"] = "within error"
    alpha_bound: float = 0.05
    preconditioner: Literal["automatic", "identity", "diagonal", "frozen", "full"] = "automatic"

    def _options(self) -> dict[str, Any]:
        family = "equip" if chosen("alphas", self.alphas, ("several", "last")) == "several" else "equip-last"
        options = _options(family, self.stages, self.preconditioner)
        alpha_policy = chosen("alpha_policy", self.alpha_policy, ("within error", "always", "refuse"))
        return {
            **options,
            "alpha_policy": alpha_policy,
            "alpha_bound": number(self.alpha_bound, "alpha_bound"),
        }


@dataclass(frozen=True)
class Gauss:
    """Gauss-Legendre collocation of order 2s. Quadratic invariants are conserved, the energy is not.

    Parameters
    ----------
    stages
        s, from 1 to 32; with variable steps, from 2.
    preconditioner
        How the stages are iterated: "identity" (fixed-point iteration), "diagonal", "frozen" (simplified
        Newton), "full" (Newton), or "automatic". The solution is the same.
    """

    stages: int = 8
    preconditioner: Literal["automatic", "identity", "diagonal", "frozen", "full"] = "automatic"

    def _options(self) -> dict[str, Any]:
        return _options("gauss", self.stages, self.preconditioner)


@dataclass(frozen=True)
class FixedAlpha:
    """The symplectic method of order 2s - 2 whose last α is `alpha` (dimensionless) in every step.

    Parameters
    ----------
    stages
        s, from 2 to 32.
    alpha
        The last α, dimensionless.
    preconditioner
        How the stages are iterated: "identity" (fixed-point iteration), "diagonal", "frozen" (simplified
        Newton), "full" (Newton), or "automatic". The solution is the same.
    """

    stages: int
    alpha: Any
    preconditioner: Literal["automatic", "identity", "diagonal", "frozen", "full"] = "automatic"

    def _options(self) -> dict[str, Any]:
        options = _options("fixed-alpha", self.stages, self.preconditioner)
        return {**options, "alpha": pair(self.alpha, "alpha")}


@dataclass(frozen=True)
class Hbvm:
    """HBVM(k, s) of order 2s. H is conserved as accurately as k Gauss nodes integrate ∇H along a step.

    A polynomial H of degree up to 2k/s is conserved to round-off. Quadratic invariants are not conserved.

    Parameters
    ----------
    nodes
        k, from s to 32.
    degree
        s, from 1.
    preconditioner
        How the stages are iterated: "identity" (fixed-point iteration), "diagonal", "frozen" (simplified
        Newton), "full" (Newton), or "automatic". The solution is the same.
    """

    nodes: int
    degree: int
    preconditioner: Literal["automatic", "identity", "diagonal", "frozen", "full"] = "automatic"

    def _options(self) -> dict[str, Any]:
        degree = whole(self.degree, "degree", 1, MOST_STAGES)
        nodes = whole(self.nodes, "nodes", degree, MOST_STAGES)
        return {**_options("hbvm", max(2, degree), self.preconditioner), "family": f"hbvm={nodes},{degree}"}


@dataclass(frozen=True)
class AveragedVectorField:
    """The averaged vector field method of order 2: HBVM(k, 1), exact for a polynomial H, else k = 16.

    Parameters
    ----------
    preconditioner
        How the stages are iterated: "identity" (fixed-point iteration), "diagonal", "frozen" (simplified
        Newton), "full" (Newton), or "automatic". The solution is the same.
    """

    preconditioner: Literal["automatic", "identity", "diagonal", "frozen", "full"] = "automatic"

    def _options(self) -> dict[str, Any]:
        return {**_options("avf", 2, self.preconditioner), "family": "avf"}


@dataclass(frozen=True)
class Trapezoidal:
    """The trapezoidal method of order 2, with equidistant nodes that include both ends of a step.

    Parameters
    ----------
    nodes
        k, from 2 to 8.
    preconditioner
        How the stages are iterated: "identity" (fixed-point iteration), "diagonal", "frozen" (simplified
        Newton), "full" (Newton), or "automatic". The solution is the same.
    """

    nodes: int = 5
    preconditioner: Literal["automatic", "identity", "diagonal", "frozen", "full"] = "automatic"

    def _options(self) -> dict[str, Any]:
        nodes = whole(self.nodes, "nodes", 2, 8)
        return {**_options("trapezoidal", 2, self.preconditioner), "family": f"trapezoidal={nodes}"}


Method = Union[Equip, Gauss, FixedAlpha, Hbvm, AveragedVectorField, Trapezoidal]


def method_options(method: Any, by_tolerance: bool) -> dict[str, Any]:
    """Options of a method as the native part reads them."""
    if not isinstance(method, (Equip, Gauss, FixedAlpha, Hbvm, AveragedVectorField, Trapezoidal)):
        raise TypeError(
            f"method is {method!r}; it must be equip.Equip(stages=8), equip.Gauss(stages=8), "
            "equip.FixedAlpha(8, alpha), equip.Hbvm(nodes, degree), equip.AveragedVectorField() or "
            "equip.Trapezoidal(nodes)"
        )
    found = method._options()
    is_of_degree_one = (
        isinstance(method, (AveragedVectorField, Trapezoidal)) or getattr(method, "degree", 2) == 1
    )
    if by_tolerance and is_of_degree_one:
        raise ValueError("a method of order 2 has no error estimate: give a step")
    if by_tolerance and found["stages"] == 1:
        raise ValueError("one stage has no error estimate: give a step, or stages=2 or more")
    return found
