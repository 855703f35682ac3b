"""The description of a stage: frozen, without state and without results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, TypeAlias

from flexstage.base.notebook import InNotebook, RenderHook
from flexstage.base.number import Number, Table, Vector
from flexstage.base.storage.digest import DOCUMENT_ONLY, KEY, WHERE_STATED, Description
from flexstage.base.units.quantity import (
    ACCELERATION,
    ANY,
    DIRECTION,
    FORCE,
    FREQUENCY,
    LENGTH,
    NOT_NEGATIVE,
    POSITIVE,
    RATE,
    RATIO,
    STIFFNESS,
    TEMPERATURE,
    TIME,
)
from flexstage.mechanism.assembly.pattern import ORIGIN, Pattern, between, middle
from flexstage.parts.body import Body, Payload
from flexstage.parts.freedom import Freedom
from flexstage.parts.gauge import Instrument, SensorSense
from flexstage.parts.material import Material
from flexstage.parts.part import Part

GROUND = "ground"
PLATFORM = "platform"
NOT_GROWING = "none"
"""Said of the ground in place of a material: it does not grow with temperature."""
EVERYWHERE = "all"
"""Said in place of a body: the temperature of all that has none of its own."""

NAMED = ("materials", "parts", "bodies", "links", "units", "placements", "sensors", "gauges", "payloads", "forces", "stops")
"""Sections of entries by name."""
BESIDE = {"beside": True}
"""Metadata of a field that has no key of its own in a file: formulas stand where the values do."""


Joins: TypeAlias = tuple[str, str] | Mapping[str, str]
"""Bodies that a link joins: first and second, or by the port of its part."""


def _empty(metadata: Mapping[str, Any] | None = None) -> Any:
    """A table without entries where none is given."""
    return field(default_factory=lambda: Table({}), metadata=metadata)


@dataclass(frozen=True, eq=False)
class NamedNumber(Description):
    """A number that formulas refer to by name: its value [SI] and the unit that files show it in (`1`: a ratio)."""

    value: Annotated[Number, ANY]
    unit: str


@dataclass(frozen=True, eq=False)
class Link(Description):
    """A part between two bodies, or between as many as it has ports.

    `joins` names them, first to second: the relative twist is that of the second against the first. `part` names an entry of the
    mechanism's parts. The link frame has its origin at the part's centre `at`, x along `along`, from the first body to the second, z along
    `bends` (the axis of the compliant rotation; needed for parts that are not round). `free` overrides the part's intended freedoms.
    Instead of `at` and `along` the part's two ends may be given: `start` at the first body, `end` at the second.

    A part with ports (a superelement) joins a body at each, by name: several ports may be joined to one body. The link frame is then that
    of the part's axes, and `free` the freedoms of the second port's body against the first's, about its origin, where it has two.

    `circuit` names the input of a force actuator. Those of one circuit are in series on one amplifier and share the input; a `-` before
    the name reverses the polarity (push-pull).
    """

    joins: Joins
    part: str
    at: Annotated[Vector, LENGTH] | None = None
    along: Annotated[Vector, DIRECTION] | None = None
    bends: Annotated[Vector, DIRECTION] | None = None
    free: tuple[Freedom, ...] | None = None
    start: Annotated[Vector, LENGTH] | None = field(default=None, metadata={KEY: "from"})
    end: Annotated[Vector, LENGTH] | None = field(default=None, metadata={KEY: "to"})
    circuit: str | None = None

    @property
    def centre(self) -> Vector:
        """The part's centre: `at`, or the middle between both ends."""
        return middle(self.start, self.end) if self.at is None and self.start and self.end else self.at or ORIGIN

    @property
    def direction(self) -> Vector:
        """The direction of the part's x axis: `along`, or from end to end."""
        return between(self.start, self.end) if self.along is None and self.start and self.end else self.along or ORIGIN

    @property
    def bodies(self) -> tuple[str, ...]:
        """The names of the bodies it joins."""
        return tuple(self.joins.values()) if isinstance(self.joins, Mapping) else self.joins


@dataclass(frozen=True, eq=False)
class Unit(Description):
    """A sub-assembly drawn once in its own frame and placed by pattern: its `bodies` and `links`.

    Links may also join bodies of the stage (`ground`, `platform`, ...) and of other copies (`W/carriage`). `stiffness` states the unit's
    own stiffness in actuator coordinates for the mapped model (absent: computed where the unit is a direct or a lever unit).

    `like` names another unit, whose bodies and links this one has too, but for those that it draws under the same names; overrides of
    that unit (`inner/front.thickness`) are its own, its own (`outer/front.at.x`) go before. A stated stiffness is not taken over.
    """

    bodies: Mapping[str, Body] = _empty()
    links: Mapping[str, Link] = _empty()
    stiffness: Annotated[Number, STIFFNESS, POSITIVE] | None = None
    like: str | None = None


@dataclass(frozen=True, eq=False)
class Placement(Description):
    """Copies of a unit: its name and the pattern they stand in. The key `B1-B3` names three copies."""

    unit: str
    pattern: Pattern


@dataclass(frozen=True, eq=False)
class Probe(Description):
    """Gauges that read the motion of `body` against `base` along, or about, the x axis of the pattern's frame, at its origin.

    x points from a gauge of gaps to its target: the gap opens when the target moves along +x, and `positive` says whether its reading then
    grows. The others state none: their reading grows along +x, or with a turn about +x by the right-hand rule.
    """

    gauge: str
    body: str
    pattern: Pattern
    positive: SensorSense | None = None
    base: str = GROUND


@dataclass(frozen=True, eq=False)
class LinkProbe(Description):
    """A gauge on a link of the expanded stage (`B1/pzt`): it reads the link's deformation along, or about, the link's x axis.

    The second body against the first: positive where the link becomes longer. `B1-B3/pzt` are the links of as many gauges.
    """

    gauge: str
    link: str


@dataclass(frozen=True, eq=False)
class GaugeSum(Description):
    """A weighted sum of other gauges that read one quantity, by name: `{S1 = 0.5, S2 = -0.5}`.

    Its members are read through it: the pose follows from the gauges that no sum takes up, sums among them. Its noise, steps and range
    are those of its members.
    """

    sum: Mapping[str, Annotated[Number, RATIO]]


GaugePlace: TypeAlias = Probe | LinkProbe | GaugeSum


@dataclass(frozen=True, eq=False)
class Stop(Description):
    """A gap at which a stroke ends: `body` may move by `gap` along x of the pattern's frame, at its origin, against `base`.

    With `gap_negative` it ends the way back too; without, nothing stops that. A key such as `E1-E3` names as many stops.
    """

    body: str
    pattern: Pattern
    gap: Annotated[Number, LENGTH, POSITIVE]
    gap_negative: Annotated[Number, LENGTH, POSITIVE] | None = None
    base: str = GROUND


@dataclass(frozen=True, eq=False)
class Force(Description):
    """A constant force on a body at a point (a bonding force), in the stage's frame."""

    body: str
    at: Annotated[Vector, LENGTH]
    force: Annotated[Vector, FORCE]


@dataclass(frozen=True, eq=False)
class StrokePath(Description):
    """A path to judge the stage along: `drive` (a coordinate such as `platform.y`, a stack, a load) goes between the two values of `to`.

    Values are texts with units, counted from where the stage sags to; at `points` of them equilibrium is looked for. `hold` says what
    stays: a dead load in newtons along a coordinate (`{"platform.x": "-20 N"}`), a coordinate that stays where it rests
    (`{"platform.rz": "0"}`), or `{"gravity": "off"}`.
    """

    drive: str
    to: tuple[str, str]
    points: int = 11
    hold: Mapping[str, str] = _empty()


@dataclass(frozen=True, eq=False)
class ModalDamping(Description):
    """One damping ratio for all modes."""

    ratio: Annotated[Number, RATIO, NOT_NEGATIVE]


@dataclass(frozen=True, eq=False)
class StructuralDamping(Description):
    """The loss factor of each part's material: K_p (1 + j eta_p); frequency domain only."""


@dataclass(frozen=True, eq=False)
class RayleighDamping(Description):
    """C = mass_factor M + stiffness_factor K."""

    mass_factor: Annotated[Number, RATE, NOT_NEGATIVE]
    stiffness_factor: Annotated[Number, TIME, NOT_NEGATIVE]


Damping: TypeAlias = ModalDamping | StructuralDamping | RayleighDamping


@dataclass(frozen=True, eq=False)
class Aperture(Description):
    """Clear aperture through the stage along z that nothing may enter: a rectangle (size x, size y) about the z axis."""

    size: tuple[Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE]]


@dataclass(frozen=True, eq=False)
class Mechanism(InNotebook, Description):
    """A stage: one description for all models.

    A graph of rigid `bodies` and elastic `links`, drawn directly or in `units` placed by pattern (`placements`), with `gauges`. Body
    `ground` is implied, body `platform` is the moving part. `overrides` are values of single links that differ from the shared part, by
    address (`horizontal/front.thickness`, `B2/front.thickness`). `max_mode_frequency` is the frequency below which modes are listed.
    `stops` end strokes, `paths` are what requirements over a stroke are judged along. `ground` names the material that the ground grows
    with (`none`: it does not grow). `temperatures` are changes since it was made, by body (`ground` too), and of `all` that has none of its
    own; a part has the mean of the bodies that it joins. `packages` are those that its kinds of parts, gauges and measures come from, each
    perhaps with versions: `tapered-leaf >= 1`. `formulas` say, by address, what values are worked out of `numbers`; values are kept as they
    come out.
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("a description", "stage")
    name: str = field(metadata=DOCUMENT_ONLY)
    materials: Mapping[str, Material] = _empty()
    parts: Mapping[str, Part] = _empty()
    bodies: Mapping[str, Body] = _empty()
    links: Mapping[str, Link] = _empty()
    units: Mapping[str, Unit] = _empty()
    placements: Mapping[str, Placement] = _empty()
    sensors: Mapping[str, Instrument] = _empty()
    gauges: Mapping[str, GaugePlace] = _empty()
    payloads: Mapping[str, Payload] = _empty()
    forces: Mapping[str, Force] = _empty()
    gravity: Annotated[Vector, ACCELERATION] = (0.0, 0.0, -9.80665)
    damping: Damping | None = None
    envelope: (
        tuple[Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE]] | None
    ) = None
    opening: Aperture | None = None
    max_mode_frequency: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    ground: str | None = None
    overrides: Mapping[str, Any] = _empty()
    requirements: Mapping[str, str] = _empty(DOCUMENT_ONLY)
    packages: tuple[str, ...] = field(default=(), metadata=DOCUMENT_ONLY)
    tags: Mapping[str, str] = _empty(DOCUMENT_ONLY)
    sources: Mapping[str, str] = _empty(DOCUMENT_ONLY)
    numbers: Mapping[str, NamedNumber] = _empty(DOCUMENT_ONLY)
    formulas: Mapping[str, str] = _empty(DOCUMENT_ONLY | BESIDE)
    stops: Mapping[str, Stop] = _empty(WHERE_STATED)
    paths: Mapping[str, StrokePath] = _empty(DOCUMENT_ONLY | WHERE_STATED)
    temperatures: Mapping[str, Annotated[Number, TEMPERATURE]] = _empty(WHERE_STATED)

    def view(self, *, motion: str = "mode 1") -> Any:
        """Return the interactive 3-D view of the stage, for a notebook or a page: `flexstage.view`."""
        return RenderHook.views.view(self, motion=motion)


def every_link(mechanism: Mechanism) -> Iterator[tuple[str, Link]]:
    """Every link that is drawn, of the stage and of its units, by its address.

    >>> [address for address, _ in every_link(Mechanism("", units={"leg": Unit(links={"foot": Link(("ground", "knee"), "wire")})}))]
    ['units.leg.links.foot']
    """
    yield from ((f"links.{name}", link) for name, link in mechanism.links.items())
    yield from ((f"units.{unit}.links.{name}", link) for unit, item in mechanism.units.items() for name, link in item.links.items())


def every_body(mechanism: Mechanism) -> Iterator[tuple[str, Body]]:
    """Every body that is drawn, of the stage and of its units, by its address.

    >>> [address for address, _ in every_body(Mechanism("", bodies={"platform": Body()}))]
    ['bodies.platform']
    """
    yield from ((f"bodies.{name}", body) for name, body in mechanism.bodies.items())
    yield from ((f"units.{unit}.bodies.{name}", body) for unit, item in mechanism.units.items() for name, body in item.bodies.items())


def posed(gauges: Mapping[str, GaugePlace]) -> dict[str, Probe]:
    """The gauges that stand at poses of their own, not on links and not as sums of others.

    >>> list(posed({"D": GaugeSum({"S1": 1.0, "S2": -1.0}), "SG": LinkProbe("strain", "B1/pzt")}))
    []
    """
    return {name: item for name, item in gauges.items() if isinstance(item, Probe)}
