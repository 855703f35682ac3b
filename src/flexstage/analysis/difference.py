"""What a change does: the key figures of a stage before and after."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.analysis.complete import Analysis
from flexstage.base.quantity import SHARE
from flexstage.mechanism.address import get, quantity_of
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS, WRENCH_UNITS


@dataclass(frozen=True)
class KeyFigure:
    """A key figure: its name, SI unit and value."""

    name: str
    unit: str
    value: float


@dataclass(frozen=True)
class Change:
    """A key figure before and after; `None` where it exists on one side only."""

    name: str
    unit: str
    old: float | None
    new: float | None

    @property
    def relative(self) -> Annotated[float | None, SHARE]:
        """New over old less one; None where that has no meaning."""
        return None if self.old is None or self.new is None or self.old == 0.0 else self.new / self.old - 1.0


@dataclass(frozen=True, eq=False)
class Comparison:
    """What setting values did: the description as `stated`, the `addresses` that were set, the key `figures` before and after."""

    stated: Mechanism
    addresses: tuple[str, ...]
    figures: tuple[Change, ...]


def set_values(before: Mechanism, after: Mechanism, addresses: Iterable[str]) -> tuple[Change, ...]:
    """The values that were set, before and after; values that are no single numbers are left out.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.address import set_value
    >>> stage = double_triangle()
    >>> set_values(stage, set_value(stage, "parts.neck.thickness", 0.0014), ["parts.neck.thickness"])[0].new
    0.0014
    """
    found = ((name, get(before, name), get(after, name)) for name in dict.fromkeys(addresses))
    return tuple(
        Change(name, quantity_of(after, name).si, old if isinstance(old, float) else None, new)
        for name, old, new in found
        if isinstance(new, float)
    )


def difference(before: Analysis, after: Analysis) -> tuple[Change, ...]:
    """Every key figure of two analyses, old against new.

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
    """What a designer looks at first: required values, frequencies of the platform, stiffness, losses, strokes, strength.

    Names are those of requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> [figure.name for figure in key_figures(analyse(double_triangle(), Model.MAPPED))][8:10]
    ['frequency.platform.2', 'frequency.platform.3']
    """
    found = (*_requirement_figures(analysis), *_frequencies(analysis), *_stiffness(analysis), *_losses(analysis), *_reach(analysis))
    named = {figure.name: figure for figure in reversed(found)}
    return tuple(named[name] for name in dict.fromkeys(figure.name for figure in found))


def _requirement_figures(analysis: Analysis) -> Iterator[KeyFigure]:
    for verdict in analysis.verdicts:
        if verdict.value is not None:
            asked = verdict.requirement
            name = asked.key if asked.point == PLATFORM else f"{asked.key} at {asked.point}"
            yield KeyFigure(name, asked.quantity.si, float(verdict.value))


def _frequencies(analysis: Analysis) -> Iterator[KeyFigure]:
    if analysis.modes is None:
        return
    for number, index in enumerate(analysis.modes.platform, start=1):
        yield KeyFigure(f"frequency.platform.{number}", "Hz", float(analysis.modes.frequencies[index]))


def _stiffness(analysis: Analysis) -> Iterator[KeyFigure]:
    if analysis.statics is None:
        return
    compliance = np.diag(analysis.statics.compliance.values)
    for name, value, top, bottom in zip(COMPONENTS, compliance, WRENCH_UNITS, TWIST_UNITS, strict=True):
        if value > 0.0:
            yield KeyFigure(f"stiffness.{name}", f"{top}/{bottom}", float(1.0 / value))


def _losses(analysis: Analysis) -> Iterator[KeyFigure]:
    if analysis.lost_motion is None:
        return
    for name in analysis.lost_motion.loss.rows:
        yield KeyFigure(f"loss.{name}", "1", float(analysis.lost_motion.loss.at(name, name)))


def _reach(analysis: Analysis) -> Iterator[KeyFigure]:
    reach = analysis.workspace
    if reach is None:
        return
    strokes = reach.single if reach.corrected is None else reach.corrected
    for name, value in zip(strokes.coordinates, strokes.symmetric, strict=True):
        yield KeyFigure(f"stroke.{name}", TWIST_UNITS[COMPONENTS.index(name)], float(value))
    if reach.stress is not None and reach.stress.links:
        yield KeyFigure("safety", "1", float(reach.stress.least))
    if reach.buckling is not None and reach.buckling.links:
        yield KeyFigure("buckling", "1", float(reach.buckling.least))
