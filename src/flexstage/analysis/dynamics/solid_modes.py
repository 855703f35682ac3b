"""Finite-element modes for comparisons, in a form that does not depend on the finite-element solver."""

from __future__ import annotations

from dataclasses import dataclass

from flexstage.analysis.dynamics.modes import Modes
from flexstage.models.linear.model import LinearModel


@dataclass(frozen=True, eq=False)
class FeaModes:
    """Finite-element modes of a stage, its reduced model, and estimated relative errors of the platform frequencies.

    `errors` is empty if there is no coarser mesh. An error is `None` if the mode is missing from the result of the coarser mesh.
    """

    modes: Modes
    model: LinearModel
    order: int
    errors: tuple[float | None, ...] = ()
