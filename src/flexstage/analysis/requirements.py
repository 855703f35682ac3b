"""Measures, the numbers by which a stage is judged; the `[require]` lines of a design file about them, and the verdict on a value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np

from flexstage.analysis.offered import MEASURES, OfferedMeasure
from flexstage.base.finding import DesignError, Finding, nearest, refuse
from flexstage.base.number import Array
from flexstage.base.quantity import (
    ANGLE,
    DISPLACEMENT,
    FORCE,
    FREQUENCY,
    LENGTH,
    MASS,
    MOMENT,
    RATIO,
    STIFFNESS,
    Quantity,
)
from flexstage.base.unit import parse
from flexstage.mechanism.expand import Assembly, expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.spatial.frame import COMPONENTS

_LINE = re.compile(r"\s*(?P<sense>at least|at most)\s+(?P<value>.+?)(?:\s+at\s+(?P<point>[^\s].*?))?\s*")
_MEASURE = re.compile(r"\s*(?P<key>[^\s]+)(?:\s+at\s+(?P<point>[^\s].*?))?\s*")
_COUNT = re.compile(r"[1-9]\d{0,2}")
_SLACK = 1e-9

ROTATION = Quantity("rotation", ANGLE.si, "urad", "244 urad")
TWISTING = Quantity("rotational stiffness", "N m/rad", "N m/rad", "8e4 N m/rad")
DRIFT = Quantity("drift", "m/K", "nm/K", "5 nm/K")
TILT_DRIFT = Quantity("rotational drift", "rad/K", "nrad/K", "50 nrad/K")
FINE = Quantity("displacement", DISPLACEMENT.si, "nm", "10 nm")
FINE_ROTATION = Quantity("rotation", ANGLE.si, "nrad", "50 nrad")


class Sense(Enum):
    """Which side of the limit is good."""

    AT_LEAST = "at least"
    AT_MOST = "at most"


class Subject(Enum):
    """What a requirement is about; the value is the form of its key."""

    STROKE = "stroke.<axis>"
    CORNER = "corner"
    FREQUENCY = "frequency.<n>"
    PLATFORM_FREQUENCY = "frequency.platform.<n>"
    SAFETY = "safety"
    BUCKLING = "buckling"
    STIFFNESS = "stiffness.<axis>"
    DIRECTED_STIFFNESS = "stiffness.<direction>"
    LEAST_STIFFNESS = "stiffness.least"
    DEFLECTION = "deflection.<axis>"
    FORCE = "force.<axis>"
    LOSS = "loss"
    OWN_LOSS = "loss.<actuator>"
    CROSSTALK = "crosstalk"
    MAP_ERROR = "map_error.<axis>"
    DRIFT = "drift.<axis>"
    MASS = "mass"
    TOTAL_MASS = "mass.total"
    SIZE = "envelope.<dimension>"
    HEIGHT = "height"
    OPENING = "opening"
    RESOLUTION = "resolution.<axis>"
    GAUGE_RANGE = "gauge.range"
    OWN_GAUGE_RANGE = "gauge.range.<gauge>"
    LOAD = "load"
    OWN_LOAD = "load.<actuator>"
    OFFERED = "<offered>"


@dataclass(frozen=True)
class Kind:
    """What a subject means, its quantities along and about an axis, and whether a point may be named."""

    meaning: str
    quantity: Quantity
    about: Quantity | None = None
    pointed: bool = False


KINDS: Mapping[Subject, Kind] = {
    Subject.STROKE: Kind("stroke both ways along one axis, lost motion made up by command", DISPLACEMENT, ROTATION, pointed=True),
    Subject.CORNER: Kind("share of the actuators' strokes that all required strokes at once ask for", RATIO),
    Subject.FREQUENCY: Kind("n-th natural frequency, any body", FREQUENCY),
    Subject.PLATFORM_FREQUENCY: Kind("n-th natural frequency of the platform", FREQUENCY),
    Subject.SAFETY: Kind("yield over peak stress in the worst hinge at the worst corner of the strokes, from no voltage", RATIO),
    Subject.BUCKLING: Kind("critical load over compression in the worst part at the worst corner of the strokes", RATIO),
    Subject.STIFFNESS: Kind(
        "stiffness of the platform against a load along one axis, the others giving way", STIFFNESS, TWISTING, pointed=True
    ),
    Subject.DIRECTED_STIFFNESS: Kind(
        "stiffness of the platform against a force along a direction, or with r a moment about it, all else giving way",
        STIFFNESS,
        TWISTING,
        pointed=True,
    ),
    Subject.LEAST_STIFFNESS: Kind("stiffness against a force in the direction that gives way most", STIFFNESS, pointed=True),
    Subject.DEFLECTION: Kind("motion under gravity and stated forces, strokes held", DISPLACEMENT, ROTATION, pointed=True),
    Subject.FORCE: Kind("blocking force of the platform along one axis", FORCE, MOMENT),
    Subject.LOSS: Kind("largest share of its stroke an actuator loses", RATIO),
    Subject.OWN_LOSS: Kind("share of its stroke the actuator loses", RATIO),
    Subject.CROSSTALK: Kind("largest stroke one actuator appears to make when another does", RATIO),
    Subject.MAP_ERROR: Kind("largest error of the linear map over the workspace", FINE, FINE_ROTATION),
    Subject.DRIFT: Kind(
        "motion per kelvin of uniform temperature, strokes held, the ground of the material of its links", DRIFT, TILT_DRIFT, pointed=True
    ),
    Subject.MASS: Kind("mass of the platform without payload", MASS),
    Subject.TOTAL_MASS: Kind("mass of all bodies, links and stacks without payload", MASS),
    Subject.SIZE: Kind("edge of the bounding box", LENGTH),
    Subject.HEIGHT: Kind("edge of the bounding box along z", LENGTH),
    Subject.OPENING: Kind("how far anything stands into the clear opening", LENGTH),
    Subject.RESOLUTION: Kind("pose error of one resolution step of every gauge, worst signs", FINE, FINE_ROTATION, pointed=True),
    Subject.GAUGE_RANGE: Kind("share of half the gauges' range that all required strokes at once ask for, worst gauge", RATIO),
    Subject.OWN_GAUGE_RANGE: Kind("share of half the gauge's range that all required strokes at once ask for", RATIO),
    Subject.LOAD: Kind("share of its maximum load, or of what may pull it, that the most loaded stack bears at the worst corner", RATIO),
    Subject.OWN_LOAD: Kind("largest compression of the stack at the worst corner of the strokes, dead load included", FORCE),
}
"""Of all subjects but `OFFERED`, whose measures say it themselves."""


@dataclass(frozen=True)
class Measure:
    """A number that a stage has: its `key`, the `subject` with its `name` (an axis, actuator, gauge, number), the point it is taken at."""

    key: str
    subject: Subject
    name: str
    quantity: Quantity
    point: str = PLATFORM


@dataclass(frozen=True, kw_only=True)
class Requirement(Measure):
    """One line: a measure, on which side of the limit [SI] it is to be, and the line's own words."""

    text: str
    sense: Sense
    limit: float


@dataclass(frozen=True, eq=False)
class Verdict:
    """A requirement against the design's `value` (...) in SI; `None` with the `reason` where it could not be found out."""

    requirement: Requirement
    value: Array | None
    reason: str = ""

    @property
    def margin(self) -> Array:
        """Distance to the limit on the good side over the limit (...): 0.1 is 10 % to spare, negative fails; NaN without a value.

        For a limit of zero the distance itself, in SI.
        """
        if self.value is None:
            return np.asarray(np.nan)
        spare = self.value - self.requirement.limit
        scale = abs(self.requirement.limit) or 1.0
        return (spare if self.requirement.sense is Sense.AT_LEAST else -spare) / scale

    @property
    def passed(self) -> Array:
        """Whether the requirement is met (...); rounding to a billionth counts as met, a missing value as not."""
        return np.nan_to_num(self.margin, nan=-np.inf) >= -_SLACK


def known_keys(mechanism: Mechanism) -> tuple[str, ...]:
    """Every key that may be required of this stage (frequencies up to the sixth; higher numbers are read too).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [key for key in known_keys(double_triangle()) if key.startswith("loss")][:3]
    ['loss', 'loss.B1', 'loss.B2']
    """
    names = _names(expand(mechanism))
    return tuple(key for subject in Subject for key in _spelt(subject.value, names))


def requirements(mechanism: Mechanism) -> tuple[Requirement, ...]:
    """Read all `[require]` lines of a description.

    A line is `at least` or `at most`, a value with its unit, and for some keys `at` a named point. Raises `DesignError` with every unknown
    key (and the nearest ones), unreadable line, wrong unit and unknown point.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> read = requirements(double_triangle())[0]
    >>> read.subject, read.name, read.sense.value, read.limit
    (<Subject.STROKE: 'stroke.<axis>'>, 'x', 'at least', 5e-05)
    """
    assembly = expand(mechanism)
    names, points = _names(assembly), (PLATFORM, *assembly.points)
    found: list[Requirement] = []
    findings: list[Finding] = []
    for key, text in mechanism.requirements.items():
        try:
            found.append(_read(f"require.{key}", (key, text), names, points))
        except DesignError as error:
            findings += error.findings
    if findings:
        raise DesignError(findings)
    return tuple(found)


def _names(assembly: Assembly) -> dict[str, tuple[str, ...]]:
    """What may stand in the place of each placeholder."""
    return {
        "axis": COMPONENTS,
        "dimension": COMPONENTS[:3],
        "direction": ("(1,1,0)",),
        "n": tuple(str(number) for number in range(1, 7)),
        "actuator": tuple(assembly.actuators),
        "gauge": tuple(assembly.gauges),
        "offered": tuple(MEASURES),
    }


def kind_of(subject: Subject, name: str = "") -> Kind:
    """What a subject means; of a measure that another package offers, what it says itself."""
    if subject is not Subject.OFFERED:
        return KINDS[subject]
    found = offered(name)
    return Kind(found.meaning, found.quantity)


def offered(name: str) -> OfferedMeasure:
    """A measure that an installed package offers; raises `DesignError` where none does."""
    found = MEASURES.get(name)
    if found is None:
        raise refuse(name, "no installed package offers this measure", "Install the one that does")
    return found


def _spelt(form: str, names: Mapping[str, tuple[str, ...]]) -> Iterator[str]:
    match = re.search(r"<(\w+)>", form)
    if match is None:
        yield form
        return
    for name in names[match[1]]:
        yield form.replace(match[0], name)


def requirement(mechanism: Mechanism, key: str, text: str, where: str) -> Requirement:
    """Read one line: `key` is a measure, `text` its limit as in `[require]`. Raises `DesignError` at `where`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> requirement(double_triangle(), "mass", "at most 12 kg", "limits.mass").limit
    12.0
    """
    assembly = expand(mechanism)
    return _read(where, (key, text), _names(assembly), (PLATFORM, *assembly.points))


def _read(where: str, line: tuple[str, str], names: Mapping[str, tuple[str, ...]], points: tuple[str, ...]) -> Requirement:
    key, text = line
    subject, name = _subject(key, names, where)
    match = _LINE.fullmatch(text)
    if match is None:
        raise refuse(where, f'found "{text}"', 'Write "at least" or "at most" and a value, for example "at least 50 um at chuck"')
    point, quantity = _placed(where, (subject, name), match["point"], points)
    limit = parse(match["value"], quantity, where=where)
    return Requirement(key, subject, name, quantity, point, text=text, sense=Sense(match["sense"]), limit=limit)


def measure(mechanism: Mechanism, text: str, where: str) -> Measure:
    """Read the name of a measure: a key as in `[require]`, for some `at` a named point. Raises `DesignError` at `where`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> read = measure(double_triangle(), "stroke.x at platform", "responses.reach")
    >>> read.subject, read.name, read.quantity.shown
    (<Subject.STROKE: 'stroke.<axis>'>, 'x', 'um')
    """
    assembly = expand(mechanism)
    match = _MEASURE.fullmatch(text)
    if match is None:
        raise refuse(where, f'found "{text}"', 'Write the name of a measure, for example "stroke.x at chuck"')
    subject, name = _subject(match["key"], _names(assembly), where)
    point, quantity = _placed(where, (subject, name), match["point"], (PLATFORM, *assembly.points))
    return Measure(match["key"], subject, name, quantity, point)


def _free(placeholder: str, name: str, where: str) -> bool:
    """Whether a name that is in no list may stand in the place: a number, or a direction."""
    if placeholder == "direction" and name.removeprefix("r").startswith("("):
        direction_of(name, where)
        return True
    return placeholder == "n" and _COUNT.fullmatch(name) is not None


def direction_of(name: str, where: str = "direction") -> Array:
    """The unit vector (3,) of a direction such as `(1,1,0)`, with `r` before it for a moment about it. Raises `DesignError` at `where`.

    >>> direction_of("r(0,3,4)").tolist()
    [0.0, 0.6, 0.8]
    """
    try:
        vector = np.array([float(each) for each in name.removeprefix("r").removeprefix("(").removesuffix(")").split(",")])
    except ValueError:
        vector = np.zeros(0)
    if vector.shape != (3,) or not np.all(np.isfinite(vector)) or not np.any(vector) or not name.endswith(")"):
        raise refuse(where, f'"{name}" is no direction', "Write three numbers, not all 0, without spaces, for example (1,1,0)")
    return vector / np.linalg.norm(vector)


def _placed(where: str, asked: tuple[Subject, str], point: str | None, points: tuple[str, ...]) -> tuple[str, Quantity]:
    """The point a measure is taken at, and its quantity: that about an axis for rotations."""
    subject, name = asked
    kind = kind_of(subject, name)
    if point and not kind.pointed:
        raise refuse(where, f"is not asked at a point, found at {point}", f'Leave out "at {point}"')
    point = point or PLATFORM
    if point not in points:
        raise refuse(where, f"found at {point}, and no point has this name", nearest(point, points))
    return point, kind.about if kind.about is not None and name.startswith("r") else kind.quantity


def _subject(key: str, names: Mapping[str, tuple[str, ...]], where: str) -> tuple[Subject, str]:
    """The subject of a key and the name in it."""
    for subject in Subject:
        stem, _, placeholder = subject.value.rstrip(">").partition("<")
        name = key.removeprefix(stem)
        if key == stem and not placeholder:
            return subject, ""
        if placeholder and key.startswith(stem) and (name in names[placeholder] or _free(placeholder, name, where)):
            return subject, name
    known = [spelt for subject in Subject for spelt in _spelt(subject.value, names)]
    advice = f"{nearest(key, known)}. A measure that another package offers is known where that package is installed"
    raise refuse(where, f'there is no measure called "{key}"', advice)
