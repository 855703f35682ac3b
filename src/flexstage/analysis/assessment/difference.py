"""Comparison of key figures of a stage before and after a change."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.assessment.requirements import Verdict
from flexstage.analysis.complete import Analysis
from flexstage.analysis.dynamics.modes import Modes
from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.analysis.linear_statics.statics import Statics
from flexstage.analysis.workspace.buckling import Buckling
from flexstage.analysis.workspace.strength import HingeStress
from flexstage.analysis.workspace.stroke import SingleAxis
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.record import INNER, Heading, Layout, UnitIn
from flexstage.base.units.quantity import SHARE
from flexstage.mechanism.addresses.address import get, quantity_of
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.spatial.frame import COMPONENTS, MOTION, TWIST_UNITS, WRENCH_UNITS


@dataclass(frozen=True)
class KeyFigure:
    """Key figure of a stage: name, SI unit and value."""

    name: str
    unit: str
    value: float


@dataclass(frozen=True)
class Change:
    """Key figure before and after a change; a missing value is `None`."""

    TABLE: ClassVar[Layout] = Layout("Changes of key figures", "name old new difference relative")

    name: Annotated[str, Heading("key figure")]
    unit: str
    old: Annotated[float | None, UnitIn("unit")]
    new: Annotated[float | None, UnitIn("unit")]

    @property
    def difference(self) -> Annotated[float | None, INNER, UnitIn("unit"), Heading(digits=4)]:
        """New minus old; None if either is missing."""
        return None if self.old is None or self.new is None else self.new - self.old

    @property
    def relative(self) -> Annotated[float | None, SHARE, Heading(digits=3)]:
        """Relative change, (new - old)/old; None if a value is missing or the old value is 0."""
        return None if self.old is None or self.new is None or self.old == 0.0 else self.new / self.old - 1.0


@dataclass(frozen=True, eq=False)
class Comparison:
    """Key `figures` before and after a change of the values at some `addresses`. `stated` is the original description."""

    stated: Mechanism
    addresses: tuple[str, ...]
    figures: tuple[Change, ...]


def set_values(before: Mechanism, after: Mechanism, addresses: Iterable[str]) -> tuple[Change, ...]:
    """Return each changed value that is a single number, before and after the change.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.addresses.address import set_value
    >>> stage = double_triangle()
    >>> set_values(stage, set_value(stage, "parts.neck.thickness", 0.0014), ["parts.neck.thickness"])[0].new
    0.0014
    """
    result = ((name, get(before, name), get(after, name)) for name in dict.fromkeys(addresses))
    return tuple(
        Change(name, quantity_of(after, name).si, old if isinstance(old, float) else None, new)
        for name, old, new in result
        if isinstance(new, float)
    )


def difference(before: Analysis, after: Analysis) -> tuple[Change, ...]:
    """Compare the key figures of two analyses, before and after a change.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> one = analyse(double_triangle(), Model.MAPPED)
    >>> {change.relative for change in difference(one, one) if change.old} == {0.0}
    True
    """
    old, new = ({figure.name: figure for figure in key_figures(analysis)} for analysis in (before, after))
    known = new | {name: figure for name, figure in old.items() if name not in new}
    return tuple(Change(name, figure.unit, _value(old, name), _value(new, name)) for name, figure in known.items())


def _value(figures: Mapping[str, KeyFigure], name: str) -> float | None:
    return figures[name].value if name in figures else None


def key_figures(analysis: Analysis) -> tuple[KeyFigure, ...]:
    """Return the key figures: values of requirements, platform frequencies, stiffness, lost motion, strokes, safety factors.

    Key figures have the names of measures in `[requirements]`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> [figure.name for figure in key_figures(analyse(double_triangle(), Model.MAPPED))][8:10]
    ['frequency.platform.2', 'frequency.platform.3']
    """
    result = (
        *requirement_figures(analysis.verdicts),
        *frequency_figures(analysis.modes),
        *stiffness_figures(analysis.statics),
        *loss_figures(analysis.lost_motion),
        *_workspace_figures(analysis.workspace),
    )
    named = {figure.name: figure for figure in reversed(result)}
    return tuple(named[name] for name in dict.fromkeys(figure.name for figure in result))


def requirement_figures(verdicts: Iterable[Verdict]) -> Iterator[KeyFigure]:
    """Yield the key figures of requirements with a known value."""
    for verdict in verdicts:
        if verdict.value is not None:
            requested = verdict.requirement
            name = requested.key if requested.point == PLATFORM else f"{requested.key} at {requested.point}"
            yield KeyFigure(name, requested.quantity.si, float(verdict.value))


def frequency_figures(found: Modes | None) -> Iterator[KeyFigure]:
    """Yield the platform frequencies as key figures."""
    if found is None:
        return
    for number, index in enumerate(found.platform, start=1):
        yield KeyFigure(f"frequency.platform.{number}", "Hz", float(found.frequencies[index]))


def stiffness_figures(found: Statics | None) -> Iterator[KeyFigure]:
    """Yield the platform's stiffness along and about each axis as key figures, with all other degrees of freedom free."""
    if found is None:
        return
    compliance = np.diag(found.compliance.values)
    for name, value, top, bottom in zip(COMPONENTS, compliance, WRENCH_UNITS, TWIST_UNITS, strict=True):
        if value > 0.0:
            yield KeyFigure(f"stiffness.{name}", f"{top}/{bottom}", float(1.0 / value))


def loss_figures(found: LostMotion | None) -> Iterator[KeyFigure]:
    """Yield the lost motion of each actuator as key figures."""
    if found is None:
        return
    for name in found.loss.rows:
        yield KeyFigure(f"loss.{name}", "1", float(found.loss.at(name, name)))


def _workspace_figures(reach: Workspace | None) -> Iterator[KeyFigure]:
    if reach is not None:
        yield from reach_figures(reach.single_axis if reach.corrected is None else reach.corrected, reach.stress, reach.buckling)


def reach_figures(strokes: SingleAxis | None, stress: HingeStress | None, buckling: Buckling | None) -> Iterator[KeyFigure]:
    """Yield platform strokes, and safety factors of hinges and columns, as key figures."""
    if strokes is not None:
        for name, value in zip(strokes.coordinates, strokes.symmetric, strict=True):
            yield KeyFigure(f"stroke.{name}", MOTION.unit(name), float(value))
    if stress is not None and stress.links:
        yield KeyFigure("safety", "1", float(stress.min_safety))
    if buckling is not None and buckling.links:
        yield KeyFigure("buckling", "1", float(buckling.min_factor))
