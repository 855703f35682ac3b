"""Effect of the flexibility of bodies on stiffness along the ideal motions and on the first frequencies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding, name_first
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.flexible_bodies import body_flexibilities, with_flexible_bodies
from flexstage.models.linear.eigen import lowest_modes
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.spatial.frame import COMPONENTS

SIGNIFICANT = 0.05
"""Relative change of a stiffness or frequency above which the assumption of rigid bodies is doubtful."""
_FREQUENCIES = 6
_EQUAL = 1e-6
"""Relative difference of equal effects."""


@dataclass(frozen=True)
class BodyEffect:
    """Value of a `quantity` [SI] with `rigid` and with `flexible` bodies; `body` names the body or bodies with the largest effect."""

    quantity: str
    rigid: float
    flexible: float
    body: str

    @property
    def change(self) -> float:
        """Relative change of the quantity due to flexible bodies."""
        return self.flexible / self.rigid - 1.0


def body_effects(mechanism: Mechanism, model: LinearModel, kinematics: Kinematics | None = None) -> tuple[BodyEffect, ...]:
    """Compare stiffness and frequencies of a lumped `model` with rigid bodies and of the same model with flexible bodies.

    The quantities are the stiffness of the platform along each ideal motion of `kinematics`, with strokes fixed, and the first six natural
    frequencies. The result is empty if no body has an estimated flexibility, for batches, and for large (sparse) stages.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> stage = parallelogram()
    >>> all(each.change < 0.0 for each in body_effects(stage, lumped(stage)))
    True
    """
    if model.is_sparse or model.stiffness_matrix.ndim > 2:
        return ()
    found = body_flexibilities(mechanism).found
    if not found:
        return ()
    rigid, flexible = (_quantities(each, kinematics) for each in (model, with_flexible_bodies(model, mechanism, found)))
    groups = [[each for each in found if each.group == number] for number in {each.group: None for each in found}]
    alone = {
        name_first([each.body for each in group]): _quantities(with_flexible_bodies(model, mechanism, group), kinematics)
        for group in groups
    }
    return tuple(
        BodyEffect(name, value, flexible[name], _softest({body: each[name] for body, each in alone.items()}, value))
        for name, value in rigid.items()
    )


def _softest(values: Mapping[str, float], rigid: float) -> str:
    """Bodies whose flexibility alone gives the least value; several where symmetry makes their effects equal."""
    least = min(values.values())
    return ", ".join(body for body, value in values.items() if value - least <= _EQUAL * (rigid - least))


def _quantities(model: LinearModel, kinematics: Kinematics | None) -> dict[str, float]:
    """Stiffness along the ideal motions and the first frequencies, by name."""
    result: dict[str, float] = {}
    rows = [place for place, each in enumerate(model.outputs) if each.name in {f"{PLATFORM}.{name}" for name in COMPONENTS}]
    if kinematics is not None and len(rows) == len(COMPONENTS):
        compliance = model.output[rows] @ np.linalg.solve(model.stiffness_matrix, model.output[rows].T)
        for name, motion in zip(kinematics.coordinates, kinematics.motion.T, strict=True):
            direction = motion / motion[COMPONENTS.index(name)]
            result[f"the stiffness along {name}"] = float(1.0 / (direction @ compliance @ direction))
    frequencies = np.sqrt(lowest_modes(model).values[:_FREQUENCIES]) / (2.0 * np.pi)
    return result | {f"frequency {number}": float(value) for number, value in enumerate(frequencies, 1)}


def body_findings(effects: Sequence[BodyEffect]) -> Iterator[Finding]:
    """Yield one warning for each body that has the largest effect on any quantity with a change above `SIGNIFICANT`.

    The warning names the two quantities that change most. Each change is due to the flexibility of all bodies together.
    """
    large = sorted((each for each in effects if abs(each.change) > SIGNIFICANT), key=lambda each: -round(abs(each.change), 6))
    for body in dict.fromkeys(each.body for each in large):
        worst = [each for each in large if each.body == body][:2]
        values = " and ".join(f"{each.quantity} by {100.0 * each.change:.0f} %" for each in worst)
        yield Finding(
            body,
            f"modelled as rigid, but flexible bodies change {values}; the effect of this body is the largest",
            "Make the body stiffer, or include its flexibility: --elastic-bodies",
        )
