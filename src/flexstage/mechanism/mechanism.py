"""Description of a stage: immutable data, without state and results."""

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
from flexstage.parts import GAUGES
from flexstage.parts.body import Body, Payload
from flexstage.parts.freedom import Freedom
from flexstage.parts.gauge import Instrument, SensorSense
from flexstage.parts.material import Material
from flexstage.parts.part import Part

GROUND = "ground"
PLATFORM = "platform"
NOT_GROWING = "none"
"""Value for the ground's material that means no thermal expansion."""
EVERYWHERE = "all"
"""Name in `temperatures` for all bodies without an entry."""

NAMED = ("materials", "parts", "bodies", "links", "units", "placements", "sensors", "gauges", "payloads", "forces", "stops")
"""Sections of a description with entries by name."""
BESIDE = {"beside": True}
"""Field metadata: the field has no key in files. Formulas, for example, are written in place of values."""


Joins: TypeAlias = tuple[str, str] | Mapping[str, str]
"""Bodies joined by a link: the first and second body, or the bodies by port of its part."""


def _empty(metadata: Mapping[str, Any] | None = None) -> Any:
    """Default: an empty table."""
    return field(default_factory=lambda: Table({}), metadata=metadata)


@dataclass(frozen=True, eq=False)
class NamedNumber(Description):
    """Number with a name for use in formulas: its value in SI units, and its unit in design files (`1` for a ratio)."""

    value: Annotated[Number, ANY]
    unit: str


@dataclass(frozen=True, eq=False)
class Link(Description):
    """Elastic connection (a part) between two bodies, or between as many bodies as the part has ports.

    `joins` names the bodies; the relative twist of the link is the motion of the second body relative to the first body. `part` names an
    entry of the mechanism's parts. The link frame has its origin at the part's centre `at`. Its x axis points along `along`, from the first
    to the second body; its z axis points along `bends`, the axis of compliant rotation. `bends` is required for parts that are not
    axisymmetric. `free` overrides the ideal degrees of freedom of the part. Instead of `at` and `along`, two ends can be specified: `start`
    at the first body, and `end` at the second body.

    A part with ports (a superelement) joins a body at each named port; several ports may join the same body. The link frame of a part with
    ports has the part's axes. With two ports, `free` lists the degrees of freedom of the second port's body relative to the first port's
    body, in the link frame. `circuit` names the input of a force actuator. Force actuators of one circuit are in series on one amplifier
    and share the input. A `-` before the name reverses the polarity (push-pull).
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
        """Centre of the part: `at`, or the midpoint between both ends."""
        return middle(self.start, self.end) if self.at is None and self.start and self.end else self.at or ORIGIN

    @property
    def direction(self) -> Vector:
        """Direction of the part's x axis: `along`, or from `start` to `end`."""
        return between(self.start, self.end) if self.along is None and self.start and self.end else self.along or ORIGIN

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the joined bodies."""
        return tuple(self.joins.values()) if isinstance(self.joins, Mapping) else self.joins


@dataclass(frozen=True, eq=False)
class Unit(Description):
    """Sub-assembly of `bodies` and `links`, drawn once in a local frame and placed by a pattern.

    Links may also join bodies of the stage (`ground`, `platform`, ...) and of other instances (`W/carriage`). `stiffness` is the unit's
    stiffness in actuator coordinates for the mapped model (default: computed for a direct or a lever unit).

    The unit inherits the bodies and links of another unit, named by `like`, except for names that it defines itself. Overrides of the other
    unit (`inner/front.thickness`) are inherited too; the unit's own overrides (`outer/front.at.x`) take precedence. `stiffness` is not
    inherited.
    """

    bodies: Mapping[str, Body] = _empty()
    links: Mapping[str, Link] = _empty()
    stiffness: Annotated[Number, STIFFNESS, POSITIVE] | None = None
    like: str | None = None


@dataclass(frozen=True, eq=False)
class Placement(Description):
    """Instances of a unit: the unit's name, and the pattern of its instances. A key such as `B1-B3` names three instances."""

    unit: str
    pattern: Pattern


@dataclass(frozen=True, eq=False)
class Probe(Description):
    """Gauges (displacement sensors) for the motion of `body` relative to `base`, along or about the x axis of the pattern's frame.

    The measuring point is the frame's origin. For a gap gauge, x points to the target: the gap opens if the target moves along +x.
    `positive` specifies whether the reading increases when the gap opens or when it closes. Other gauges have no `positive`: their reading
    increases with motion along +x, or with right-handed rotation about +x.
    """

    gauge: str
    body: str
    pattern: Pattern
    positive: SensorSense | None = None
    base: str = GROUND


@dataclass(frozen=True, eq=False)
class LinkProbe(Description):
    """Gauge on a link (`B1/pzt`: the link `pzt` of the instance `B1`) that measures the deformation along or about the link's x axis.

    The gauge measures the motion of the second body relative to the first; elongation is positive. With the link names `B1-B3/pzt`, three
    gauges are defined: on the links `B1/pzt`, `B2/pzt` and `B3/pzt`.
    """

    gauge: str
    link: str


@dataclass(frozen=True, eq=False)
class GaugeSum(Description):
    """Weighted sum of gauges that measure the same quantity: `sum` has the weight of each gauge, e.g. `{S1 = 0.5, S2 = -0.5}`.

    The sum replaces its members: the platform's pose is computed from sums and from gauges that are not in a sum. Noise, resolution and
    range are specified for the members.
    """

    sum: Mapping[str, Annotated[Number, RATIO]]


GaugePlace: TypeAlias = Probe | LinkProbe | GaugeSum


@dataclass(frozen=True, eq=False)
class Stop(Description):
    """Stop of a stroke: at the origin of the pattern's frame, `body` can move by `gap` along x relative to `base`.

    `gap_negative` is the limit in the opposite direction (default: none). A key such as `E1-E3` names three stops.
    """

    body: str
    pattern: Pattern
    gap: Annotated[Number, LENGTH, POSITIVE]
    gap_negative: Annotated[Number, LENGTH, POSITIVE] | None = None
    base: str = GROUND


@dataclass(frozen=True, eq=False)
class Force(Description):
    """Constant force on a body at a point (e.g. a bonding force), in the stage's frame."""

    body: str
    at: Annotated[Vector, LENGTH]
    force: Annotated[Vector, FORCE]


@dataclass(frozen=True, eq=False)
class StrokePath(Description):
    """Load path of a stage: `drive` (a coordinate such as `platform.y`, a stack or a load) varies between the two values of `to`.

    The values of `to` are strings with units, relative to the static equilibrium. `points` is the number of equilibria. `hold`
    specifies the constant conditions, for example:

    - `{"platform.x": "-20 N"}`: a permanent load along a coordinate;
    - `{"platform.rz": "0"}`: a coordinate fixed at its static equilibrium;
    - `{"gravity": "off"}`: no weight.
    """

    drive: str
    to: tuple[str, str]
    points: int = 11
    hold: Mapping[str, str] = _empty()


@dataclass(frozen=True, eq=False)
class ModalDamping(Description):
    """Modal damping: one damping ratio for all modes."""

    ratio: Annotated[Number, RATIO, NOT_NEGATIVE]


@dataclass(frozen=True, eq=False)
class StructuralDamping(Description):
    """Structural damping, only in the frequency domain: stiffness is multiplied by 1 + j eta, with the loss factor eta of the material."""


@dataclass(frozen=True, eq=False)
class RayleighDamping(Description):
    """Rayleigh damping: the damping matrix is `mass_factor` times the mass matrix plus `stiffness_factor` times the stiffness matrix."""

    mass_factor: Annotated[Number, RATE, NOT_NEGATIVE]
    stiffness_factor: Annotated[Number, TIME, NOT_NEGATIVE]


Damping: TypeAlias = ModalDamping | StructuralDamping | RayleighDamping


@dataclass(frozen=True, eq=False)
class Aperture(Description):
    """Clear aperture (keep-out volume) through the stage along z: a rectangle (size x, size y) about the z axis."""

    size: tuple[Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE]]


@dataclass(frozen=True, eq=False)
class Mechanism(InNotebook, Description):
    """Description of a stage, for all models.

    The stage is a graph of rigid `bodies` and elastic `links`, with `gauges`. Bodies and links are defined directly, or in `units` that
    `placements` repeat in patterns. The body `ground` exists implicitly; the stage positions the body `platform`. Several links can share a
    part; `overrides` replace values of the part for single links, by address (`horizontal/front.thickness`, `B2/front.thickness`).
    `max_mode_frequency` is the frequency limit of listed modes.

    `stops` limit strokes; `paths` are load paths for requirements. `ground` names the ground's material, for its expansion (`none`: no
    expansion). `temperatures` are temperature changes since manufacture, by body (including `ground`); the entry `all` is for all other
    bodies. The temperature of a part is the mean temperature of the bodies that it joins. `packages` lists required packages that provide
    kinds of parts, gauges and measures, with optional versions: `tapered-leaf >= 1`. With `elastic_bodies`, the lumped model includes the
    flexibility of bodies, estimated from their outlines. `formulas` compute the values at their addresses from `numbers`; the description
    stores the computed values.
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("a description", "stage")
    name: str = field(metadata=DOCUMENT_ONLY)
    materials: Mapping[str, Material] = _empty()
    parts: Mapping[str, Part] = _empty()
    bodies: Mapping[str, Body] = _empty()
    links: Mapping[str, Link] = _empty()
    units: Mapping[str, Unit] = _empty()
    placements: Mapping[str, Placement] = _empty()
    sensors: Mapping[str, Annotated[Instrument, GAUGES]] = _empty()
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
    elastic_bodies: bool = field(default=False, metadata=WHERE_STATED)

    def view(self, *, motion: str = "mode 1") -> Any:
        """Return an interactive 3-D view of the stage for a notebook or a page (see `flexstage.view`)."""
        return RenderHook.views.view(self, motion=motion)


def every_link(mechanism: Mechanism) -> Iterator[tuple[str, Link]]:
    """Yield every drawn link of the stage and of its units, by address.

    >>> [address for address, _ in every_link(Mechanism("", units={"leg": Unit(links={"foot": Link(("ground", "knee"), "wire")})}))]
    ['units.leg.links.foot']
    """
    yield from ((f"links.{name}", link) for name, link in mechanism.links.items())
    yield from ((f"units.{unit}.links.{name}", link) for unit, item in mechanism.units.items() for name, link in item.links.items())


def every_body(mechanism: Mechanism) -> Iterator[tuple[str, Body]]:
    """Yield every drawn body of the stage and of its units, by address.

    >>> [address for address, _ in every_body(Mechanism("", bodies={"platform": Body()}))]
    ['bodies.platform']
    """
    yield from ((f"bodies.{name}", body) for name, body in mechanism.bodies.items())
    yield from ((f"units.{unit}.bodies.{name}", body) for unit, item in mechanism.units.items() for name, body in item.bodies.items())


def posed(gauges: Mapping[str, GaugePlace]) -> dict[str, Probe]:
    """Return the gauges that have a pose: all except gauges on links and sums of gauges.

    >>> list(posed({"D": GaugeSum({"S1": 1.0, "S2": -1.0}), "SG": LinkProbe("strain", "B1/pzt")}))
    []
    """
    return {name: item for name, item in gauges.items() if isinstance(item, Probe)}
