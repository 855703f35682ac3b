"""`[requirements]` lines of a design file, and verdicts on values."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from enum import Enum

import numpy as np

from flexstage.analysis.assessment.measures import (
    MEASURES,
    Measure,
    MeasureKind,
    buckling,
    buckling_factor,
    direction_of,
    measure_kind,
    named_number,
    over,
    path_buckling,
    safety,
    safety_at_strokes,
)
from flexstage.analysis.loaded.course import drive_quantity
from flexstage.base.finding import DesignError, Finding, refuse, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.units.quantity import ANGLE, Quantity
from flexstage.base.units.unit import parse, quantity_of_unit
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.spatial.frame import COMPONENTS

_LINE = re.compile(r"\s*(?P<sense>at least|at most)\s+(?P<value>.+?)(?:\s+at\s+(?P<point>[^\s].*?))?\s*")
_MEASURE = re.compile(r"\s*(?P<key>[^\s]+)(?:\s+over\s+(?P<path>[^\s]+))?(?:\s+at\s+(?P<point>[^\s].*?))?\s*")
_COUNT = re.compile(r"[1-9]\d{0,2}")
_SLACK = 1e-9


class Sense(Enum):
    """Sense of a limit: at least or at most."""

    AT_LEAST = "at least"
    AT_MOST = "at most"


@dataclass(frozen=True, kw_only=True)
class Requirement(Measure):
    """Requirement line: a measure, its `limit` [SI] with a `sense`, and the `text` of the line."""

    text: str
    sense: Sense
    limit: float


@dataclass(frozen=True, eq=False)
class Verdict:
    """Verdict on a requirement, from the design's `value` (...) in SI units; an unknown value is `None`, and `reason` explains it."""

    requirement: Requirement
    value: Array | None
    reason: str = ""

    @property
    def margin(self) -> Array:
        """Relative margin (...) to the limit (0.1: 10 % reserve); negative if the requirement is not met, NaN if the value is unknown.

        For a limit of zero, the margin is absolute, in SI units.
        """
        if self.value is None:
            return np.asarray(np.nan)
        spare = self.value - self.requirement.limit
        scale = abs(self.requirement.limit) or 1.0
        return (spare if self.requirement.sense is Sense.AT_LEAST else -spare) / scale

    @property
    def passed(self) -> Array:
        """Whether the requirement is met (...), within a relative rounding error of 1e-9; false for a missing value."""
        return np.nan_to_num(self.margin, nan=-np.inf) >= -_SLACK


def asked_factor(mechanism: Mechanism) -> float:
    """Return the required load factor: the largest lower limit of all requirements on buckling.

    If no requirement is on buckling, the result is the largest lower limit of a safety factor, or 1 if no safety factor is required.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> asked_factor(parallelogram())
    2.0
    """
    lines = [line for line in requirements(mechanism) if line.sense is Sense.AT_LEAST]
    own = [line.limit for line in lines if line.kind in (buckling_factor, buckling, path_buckling)]
    return max(own or [line.limit for line in lines if line.kind in (safety, safety_at_strokes)], default=1.0)


def known_keys(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the requirement keys of this stage, with frequencies up to the sixth (higher numbers are also valid keys).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [key for key in known_keys(double_triangle()) if key.startswith("loss")][:3]
    ['loss', 'loss.B1', 'loss.B2']
    """
    names = _names(mechanism)
    return tuple(key for form in MEASURES for key in _keys_of_form(form, names))


def requirements(mechanism: Mechanism) -> tuple[Requirement, ...]:
    """Read all `[requirements]` lines of a description.

    A line contains `at least` or `at most` and a value with its unit; for some keys, `at` and a named point may follow. Raises
    `DesignError` with all unknown keys (and the nearest known keys), unreadable lines, wrong units and unknown points.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> read = requirements(double_triangle())[0]
    >>> read.kind.form, read.name, read.sense.value, read.limit
    ('stroke.<axis>', 'x', 'at least', 5e-05)
    """
    results: list[Requirement] = []
    findings: list[Finding] = []
    for key, text in mechanism.requirements.items():
        try:
            results.append(_read(mechanism, f"requirements.{key}", key, text))
        except DesignError as error:
            findings += error.findings
    if findings:
        raise DesignError(findings)
    return tuple(results)


def _names(mechanism: Mechanism) -> dict[str, tuple[str, ...]]:
    """Valid names for each placeholder."""
    assembly = expand(mechanism)
    return {
        "path": tuple(mechanism.paths),
        "axis": COMPONENTS,
        "dimension": COMPONENTS[:3],
        "direction": ("(1,1,0)",),
        "n": tuple(str(number) for number in range(1, 7)),
        "actuator": tuple(assembly.actuators),
        "gauge": tuple(assembly.gauges),
        "number": tuple(mechanism.numbers),
    }


def _keys_of_form(form: str, names: Mapping[str, tuple[str, ...]]) -> Iterator[str]:
    match = re.search(r"<(\w+)>", form)
    if match is None:
        yield form
        return
    for name in names[match[1]]:
        yield form.replace(match[0], name)


def requirement(mechanism: Mechanism, key: str, text: str, where: str) -> Requirement:
    """Read one requirement: `key` names a measure, `text` is its limit as in `[requirements]`. Errors name the location `where`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> requirement(double_triangle(), "mass", "at most 12 kg", "limits.mass").limit
    12.0
    """
    return _read(mechanism, where, key, text)


def _read(mechanism: Mechanism, where: str, key: str, text: str) -> Requirement:
    match = _LINE.fullmatch(text)
    if match is None:
        raise refuse(
            where, f'invalid requirement (got "{text}")', 'Use "at least" or "at most" and a value, e.g. "at least 50 um" for a stroke'
        )
    requested = _measure(mechanism, f"{key} at {match['point']}" if match["point"] else key, where)
    limit = parse(match["value"], requested.quantity, where=where)
    stated = {each.name: getattr(requested, each.name) for each in fields(requested) if each.name != "key"}
    return Requirement(key, **stated, text=text, sense=Sense(match["sense"]), limit=limit)


def measure(mechanism: Mechanism, text: str, where: str) -> Measure:
    """Read the name of a measure: a key as in `[requirements]`, for some keys followed by `at` and a named point.

    Errors name the location `where`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> read = measure(double_triangle(), "stroke.x at platform", "responses.reach")
    >>> read.kind.form, read.name, read.quantity.shown
    ('stroke.<axis>', 'x', 'um')
    """
    return _measure(mechanism, text, where)


def _measure(mechanism: Mechanism, text: str, where: str) -> Measure:
    match = _MEASURE.fullmatch(text)
    if match is None:
        raise refuse(where, f'invalid measure (got "{text}")', 'Use the name of a measure, e.g. "stroke.x at chuck"')
    kind, name = _kind(match["key"], _names(mechanism), where)
    if kind.along:
        return _along(mechanism, (match["key"], kind, name), match["point"], where)
    point, quantity = _point_and_quantity(where, kind, name, match["point"], (PLATFORM, *expand(mechanism).points))
    if kind is named_number:
        quantity = quantity_of_unit(mechanism.numbers[name].unit)
    if match["path"] is None:
        return Measure(match["key"], kind, name, quantity, point)
    if match["path"] not in mechanism.paths:
        raise refuse(where, f'unknown path "{match["path"]}"', suggest_nearest(match["path"], mechanism.paths))
    return Measure(f"{match['key']} over {match['path']}", over(kind), name, quantity, point, path=match["path"])


def _along(mechanism: Mechanism, requested: tuple[str, MeasureKind, str], at: str | None, where: str) -> Measure:
    """Measure along a path, or at a value of its drive."""
    key, kind, name = requested
    drive = drive_quantity(expand(mechanism), mechanism.paths[name].drive, f"paths.{name}.drive")
    place = None if at is None else parse(at, drive, where=where)
    quantity = kind.about if kind.about is not None and drive is ANGLE else kind.quantity
    return Measure(key if at is None else f"{key} at {at}", kind, name, quantity, place=place)


def _accepts_name(placeholder: str, name: str, where: str) -> bool:
    """Whether an unlisted name is valid: a number or a direction."""
    if placeholder == "direction" and name.removeprefix("r").startswith("("):
        direction_of(name, where)
        return True
    return placeholder == "n" and _COUNT.fullmatch(name) is not None


def _point_and_quantity(where: str, kind: MeasureKind, name: str, point: str | None, points: tuple[str, ...]) -> tuple[str, Quantity]:
    """Point of a measure, and its quantity: the rotational one about an axis."""
    if point and not kind.pointed:
        raise refuse(where, f"the measure does not support a point (got at {point})", f'Remove "at {point}"')
    point = point or PLATFORM
    if point not in points:
        raise refuse(where, f"unknown point (got at {point})", suggest_nearest(point, points))
    return point, kind.about if kind.about is not None and name.startswith("r") else kind.quantity


def _kind(key: str, names: Mapping[str, tuple[str, ...]], where: str) -> tuple[MeasureKind, str]:
    """Kind of measure of a key, and the name in it."""
    for form in MEASURES:
        stem, _, rest = form.partition("<")
        placeholder, _, tail = rest.partition(">")
        name = key.removeprefix(stem).removesuffix(tail)
        if key == stem and not placeholder:
            return measure_kind(form), ""
        fits = placeholder and key.startswith(stem) and key.endswith(tail)
        if fits and (name in names[placeholder] or _accepts_name(placeholder, name, where)):
            return measure_kind(form), name
    known = [spelt for form in MEASURES for spelt in _keys_of_form(form, names)]
    advice = f"{suggest_nearest(key, known)}. For a measure of another package, install that package"
    raise refuse(where, f'unknown measure "{key}"', advice)
