"""The loaded stage: by how much weight, payloads, preloads and forces change it, and small motions about it where that is felt."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

import numpy as np

from flexstage.analysis.stability import Stability, is_large, prestress
from flexstage.analysis.standing import standing, under_load
from flexstage.analysis.statics import statics
from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Array
from flexstage.base.quantity import RATIO
from flexstage.base.record import INNER
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.model import LinearModel
from flexstage.models.nonlinear.critical import unstable_motions
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.stage import nonlinear
from flexstage.spatial.frame import COMPONENTS

FELT = 0.01
"""Change of a stiffness or a frequency from which results are those of the loaded stage."""
_MODES = 6


@dataclass(frozen=True, eq=False)
class LoadEffect:
    """By how much its dead load (weight, payloads, preloads, stated forces) changes a stage.

    `change` is the largest relative change of the platform's stiffness along an axis or of one of the first frequencies, and `figure` which
    it is; where `figure` is empty it is a bound of any stiffness, from linearised buckling. `model` is small motions about the loaded state
    where the change is felt (1 % or more), else None. `why` says why it could not be worked out.
    """

    change: Annotated[float, RATIO]
    figure: str
    why: str
    model: Annotated[LinearModel | None, INNER]

    @property
    def text(self) -> str:
        """What is said of it, empty of stages without dead load.

        >>> LoadEffect(0.004, "frequency 1", "", None).text
        'Weight, payloads and forces change stiffness and frequencies by up to 0.4 % (frequency 1): results are of the unloaded stage.'
        """
        size = f"{100.0 * abs(self.change):.2g} %"
        if self.model is not None:
            return (
                f"Weight, payloads and forces change {self.figure} by {100.0 * self.change:+.3g} %: stiffness, modes, responses and their "
                "requirements are those of the loaded stage, at large displacements; all else is of the drawn one."
            )
        if self.why:
            return f"Weight, payloads and forces may change a stiffness by up to {size}; results are of the unloaded stage, as {self.why}."
        if self.figure:
            what = f"Weight, payloads and forces change stiffness and frequencies by up to {size} ({self.figure})"
            return f"{what}: results are of the unloaded stage."
        if not self.change:
            return ""
        return (
            f"Weight, payloads and forces change no stiffness by more than {size}, no frequency by more than "
            f"{50.0 * abs(self.change):.2g} %: results are of the unloaded stage."
        )


@lru_cache(maxsize=2)
def load_effect(mechanism: Mechanism) -> LoadEffect | None:
    """How a stage changes under its dead load; `None` of a batch of designs and of stages whose load factor is not known.

    Linearised buckling bounds the change of every stiffness by 1 / load factor. Only where that is 1 % or more the change is worked out, in
    the drawn position first, and where it is felt at large displacements. Raises `DesignError` where the stage has no elastic model.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> load_effect(parallelogram()).model is None
    True
    """
    found = under_load(mechanism)
    if found is None or np.ndim(found.dead) or np.iscomplexobj(found.dead) or found.refusals:
        return None
    bound = _bound(found)
    if bound < FELT:
        return LoadEffect(bound, "", "", None)
    still = standing(mechanism)
    if is_large(mechanism, still):
        return LoadEffect(bound, "", f"its {len(still.coordinates):,} freedoms are too many for that of the loaded one", None)
    near = _compare(still, prestress(mechanism, still))
    if abs(near.change) < FELT:
        return near
    try:
        return _felt(mechanism)
    except DesignError as error:
        return LoadEffect(bound, "", "; ".join(str(each).rstrip(".") for each in error.findings), None)


def _bound(found: Stability) -> float:
    return max(1.0 / float(found.dead), float(found.stiffens))


def _felt(mechanism: Mechanism) -> LoadEffect:
    model = nonlinear(mechanism)
    state = equilibrium(model)
    if int(unstable_motions(state)):
        raise refuse("stage", "under its weight and loads no stable equilibrium was found", "Ask flexstage buckle how much it bears")
    return _compare(linearise(equilibrium(model, weight=0.0, stated=0.0)), linearise(state))


def _compare(still: LinearModel, about: LinearModel) -> LoadEffect:
    """The largest change from the unloaded model to the loaded one."""
    before, after = dict(_figures(still)), dict(_figures(about))
    changes = {name: after[name] / before[name] - 1.0 for name in before if name in after and before[name] > 0.0}
    largest = max(changes, key=lambda name: round(abs(changes[name]), 9))
    change = changes[largest]
    return LoadEffect(change, largest, "", about if abs(change) >= FELT else None)


def _figures(model: LinearModel) -> Iterator[tuple[str, float]]:
    """Stiffness along the platform's axes, everything else giving way, and the first frequencies."""
    compliance: Array = np.diagonal(statics(model).compliance.values)
    yield from ((f"the stiffness along {name}", 1.0 / float(each)) for name, each in zip(COMPONENTS, compliance, strict=True) if each > 0.0)
    frequencies = np.sqrt(eigen(model).values[:_MODES]) / (2.0 * np.pi)
    yield from ((f"frequency {place}", float(each)) for place, each in enumerate(frequencies, start=1))
