"""Energy-conserving integration of Hamiltonian systems. The user writes only the energy H(q, p)."""

from importlib.util import find_spec as _find_spec

if _find_spec(f"{__name__}._native") is None:
    raise ImportError(
        "the native part of equip is not in this folder, which has the sources: start Python in another "
        "folder, where it finds the installed package, or build in place by `maturin develop`"
    )

from . import scenes
from ._certificate import (
    Certificate,
    Conserved,
    Counts,
    EnergyJumps,
    EnergyRoundOff,
    PhasePerStep,
    VariableSteps,
)
from ._functions import Table, erf, erfc, table, table2
from ._hamiltonian import Hamiltonian
from ._many import Ensemble, draw_starts, ensemble
from ._methods import AveragedVectorField, Equip, FixedAlpha, Gauss, Hbvm, Trapezoidal
from ._native import FileFormatError, FileInUseError, IntegrationError, __version__
from ._numbers import DoubleDouble
from ._solution import Solution, load
from ._solve import solve
from ._steps import Occurrence, Step, Steps, steps, suggest_step

__all__ = [
    "AveragedVectorField",
    "Certificate",
    "Counts",
    "Conserved",
    "DoubleDouble",
    "EnergyRoundOff",
    "EnergyJumps",
    "Ensemble",
    "Equip",
    "FileFormatError",
    "FileInUseError",
    "FixedAlpha",
    "Gauss",
    "Hamiltonian",
    "Hbvm",
    "IntegrationError",
    "Occurrence",
    "PhasePerStep",
    "Solution",
    "Step",
    "Steps",
    "Table",
    "Trapezoidal",
    "VariableSteps",
    "__version__",
    "draw_starts",
    "ensemble",
    "erf",
    "erfc",
    "load",
    "scenes",
    "solve",
    "steps",
    "suggest_step",
    "table",
    "table2",
]
