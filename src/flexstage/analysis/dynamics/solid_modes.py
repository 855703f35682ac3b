"""Modes by finite elements, as a comparison takes them: whoever computes them."""

from __future__ import annotations

from dataclasses import dataclass

from flexstage.analysis.dynamics.modes import Modes
from flexstage.models.linear.model import LinearModel


@dataclass(frozen=True, eq=False)
class FeaModes:
    """Modes of a stage as a solid, its reduced model, and the relative errors estimated of its platform's frequencies, in their order.

    `errors` is empty where nothing coarser was at hand to estimate them from, and `None` for a mode that the coarser result has not.
    """

    modes: Modes
    model: LinearModel
    order: int
    errors: tuple[float | None, ...] = ()
