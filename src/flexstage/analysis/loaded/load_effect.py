"""Effect of permanent load (weight, payloads, preloads, forces, bent flexures) on a stage, and the model linearised under this load."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.loaded.stability import Stability, is_large, prestress
from flexstage.analysis.loaded.standing import standing, under_load
from flexstage.base.finding import DesignError, refuse
from flexstage.base.lazy import LazyModule
from flexstage.base.number import Array
from flexstage.base.record import INNER
from flexstage.base.session import SESSION
from flexstage.base.units.quantity import RATIO
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.model import LinearModel
from flexstage.parts.part import Part
from flexstage.spatial.frame import COMPONENTS

if TYPE_CHECKING:
    from flexstage.analysis.loaded import operating_point
    from flexstage.models.nonlinear import equilibrium, linearise
    from flexstage.models.nonlinear import stage as nonlinear
    from flexstage.models.nonlinear.paths import critical_load
else:
    critical_load = LazyModule("flexstage.models.nonlinear.paths.critical_load")
    equilibrium = LazyModule("flexstage.models.nonlinear.equilibrium")
    operating_point = LazyModule("flexstage.analysis.loaded.operating_point")
    linearise = LazyModule("flexstage.models.nonlinear.linearise")
    nonlinear = LazyModule("flexstage.models.nonlinear.stage")

_BENT = "initially curved flexures"
_WARM = "thermal expansion"
SIGNIFICANT = 0.01
"""Relative change of a stiffness or frequency due to permanent load, above which results are computed for the loaded stage."""
_MODES = 6


@dataclass(frozen=True, eq=False)
class LoadEffect:
    """Effect of the permanent load (weight, payloads, preloads, specified forces, bent or warm flexures) on a stage.

    `change` is the largest relative change of the platform stiffness along an axis or of one of the first frequencies; `figure` names the
    changed quantity. If `figure` is empty, `change` is an upper bound for the change of any stiffness, from linearised buckling. `point` is
    the loaded stage if the change is significant (1 % or more), else None. If the change is unknown, `why` is the reason.
    """

    change: Annotated[float, RATIO]
    figure: str
    why: str
    point: Annotated[operating_point.OperatingPoint | None, INNER] = None
    cause: str = "weight, payloads and forces"

    @property
    def model(self) -> LinearModel | None:
        """Model linearised about the loaded state; `None` if the change is not significant."""
        return None if self.point is None else self.point.linear

    def deflection(self, point: str) -> Array | None:
        """Return the motion (6,) [m, rad] of a point from the unloaded to the loaded state; `None` if the change is not significant."""
        if self.point is None:
            return None
        unloaded = equilibrium.equilibrium(self.point.model, weight=0.0, stated=0.0)
        equilibrium.require_equilibrium(unloaded)
        return self.point.rest.twist(point) - unloaded.twist(point)

    @property
    def text(self) -> str:
        """Sentence on the effect; empty for stages without permanent load.

        >>> LoadEffect(0.004, "frequency 1", "").text
        'Weight, payloads and forces change stiffness and frequencies by up to 0.4 % (frequency 1): results are for the unloaded stage.'
        """
        cause, size = f"{self.cause[0].upper()}{self.cause[1:]}", f"{100.0 * abs(self.change):.2g} %"
        if self.model is not None:
            what = f"{cause} change {self.figure} by {100.0 * self.change:+.3g} %"
            return (
                f"{what}: stiffness, deflection, modes, responses, lost motion, drift, error budget, loops and their requirements "
                "are for the loaded stage, at large displacements; other results are nominal."
            )
        if self.why and not self.change:
            return f"The effect of {self.cause} on the stage is unknown, as {self.why}; results are for the unloaded stage."
        if self.why:
            return f"{cause} may change a stiffness by up to {size}; results are for the unloaded stage, as {self.why}."
        if self.figure:
            what = f"{cause} change stiffness and frequencies by up to {size} ({self.figure})"
            return f"{what}: results are for the unloaded stage."
        if not self.change:
            return ""
        return (
            f"{cause} change no stiffness by more than {size}, and no frequency by more than "
            f"{50.0 * abs(self.change):.2g} %: results are for the unloaded stage."
        )


@SESSION.keep(2)
def load_effect(mechanism: Mechanism) -> LoadEffect | None:
    """Compute the effect of the permanent load on a stage; `None` for a batch of designs or an unknown load factor.

    Linearised buckling gives upper bounds for the relative change of any stiffness: the reciprocal of the load factor for a decrease, and
    `Stability.stiffens` for an increase. If a bound is 1 % or more, the change is computed in the nominal position. If this change is 1 %
    or more, it is computed again with large displacements. Stages with flexures that are not straight when free are always computed with
    large displacements. Raises `DesignError` if the stage has no elastic model.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> load_effect(parallelogram()).model is None
    True
    """
    result = under_load(mechanism)
    if result is None or np.ndim(result.dead) or np.iscomplexobj(result.dead) or result.refusals:
        return None
    causes = [*([_BENT] if any(map(_is_bent, mechanism.parts.values())) else []), *([_WARM] if _is_warm(mechanism) else [])]
    bound, bent = _bound(result), bool(causes)
    *others, last = "weight", "payloads", "forces", *causes
    cause = f"{', '.join(others)} and {last}"
    if bound < SIGNIFICANT and not bent:
        return LoadEffect(bound, "", "")
    still = standing(mechanism)
    if is_large(mechanism, still):
        why = f"the model has too many degrees of freedom for a loaded state ({len(still.coordinates):,})"
        return LoadEffect(bound, "", why, cause=cause)
    near = _compare(still, prestress(mechanism, still))
    if abs(near.change) < SIGNIFICANT and not bent:
        return near
    try:
        return replace(_nonlinear_effect(mechanism), cause=cause)
    except DesignError as error:
        return LoadEffect(bound, "", "; ".join(str(each).rstrip(".") for each in error.findings), cause=cause)


def loaded_lumped_model(mechanism: Mechanism) -> LinearModel:
    """Return the lumped model or, if the permanent load is significant, `OperatingPoint.links` of the loaded stage.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> "geometric" in loaded_lumped_model(parallelogram()).stiffness
    False
    """
    drawn = standing(mechanism)
    result = None if drawn.designs else load_effect(mechanism)
    return drawn if result is None or result.point is None else result.point.links


def _bound(result: Stability) -> float:
    return max(1.0 / float(result.dead), float(result.stiffens))


def _is_bent(part: Part) -> bool:
    """Whether a part is curved when free."""
    return bool(getattr(part, "is_bent", False))


def _is_warm(mechanism: Mechanism) -> bool:
    return any(np.any(np.real(each) != 0.0) for each in mechanism.temperatures.values())


def _straight(mechanism: Mechanism) -> Mechanism:
    """The stage with all flexures straight when free."""
    parts = {name: getattr(part, "straight", part) for name, part in mechanism.parts.items()}
    changed = any(map(_is_bent, mechanism.parts.values())) or _is_warm(mechanism)
    return replace(mechanism, parts=parts, temperatures={}) if changed else mechanism


def _nonlinear_effect(mechanism: Mechanism) -> LoadEffect:
    point = operating_point.OperatingPoint(nonlinear.nonlinear(mechanism))
    if int(critical_load.unstable_motions(point.rest)):
        raise refuse("stage", "no stable equilibrium found under weight and loads", "Run flexstage buckle to find the critical load")
    unloaded = equilibrium.equilibrium(nonlinear.nonlinear(_straight(mechanism)), weight=0.0, stated=0.0)
    result = _compare(linearise.linearise(unloaded), point.linear)
    return replace(result, point=point) if abs(result.change) >= SIGNIFICANT else result


def _compare(still: LinearModel, about: LinearModel) -> LoadEffect:
    """Largest relative change from the unloaded to the loaded model."""
    before, after = dict(_figures(still)), dict(_figures(about))
    changes = {name: after[name] / before[name] - 1.0 for name in before if name in after and before[name] > 0.0}
    largest = max(changes, key=lambda name: round(abs(changes[name]), 9))
    return LoadEffect(changes[largest], largest, "")


def _figures(model: LinearModel) -> Iterator[tuple[str, float]]:
    """Platform stiffness along each axis, all other motions free, and the first frequencies."""
    compliance: Array = np.diagonal(statics(model).compliance.values)
    yield from ((f"the stiffness along {name}", 1.0 / float(each)) for name, each in zip(COMPONENTS, compliance, strict=True) if each > 0.0)
    frequencies = np.sqrt(eigen(model).values[:_MODES]) / (2.0 * np.pi)
    yield from ((f"frequency {place}", float(each)) for place, each in enumerate(frequencies, start=1))
