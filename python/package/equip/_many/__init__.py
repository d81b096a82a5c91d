"""Ensembles: many runs of one system."""

from .rows import Ensemble
from .run import ensemble
from .starts import draw_starts

__all__ = ["Ensemble", "draw_starts", "ensemble"]
