"""A stage on a stage: one description of both, everything of the carried one under its name (`fine/B1`)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, cast

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array, Number, Table, Vector, stack
from flexstage.base.storage.digest import Description, digest
from flexstage.mechanism.addresses.locate import canonical
from flexstage.mechanism.assembly.expand import copy_frames, placed_bodies
from flexstage.mechanism.assembly.likeness import drawn_units
from flexstage.mechanism.assembly.pattern import Normal, Pose, copy_names
from flexstage.mechanism.assembly.sight import link_names
from flexstage.mechanism.mechanism import (
    EVERYWHERE,
    GROUND,
    NOT_GROWING,
    PLATFORM,
    GaugePlace,
    Link,
    LinkProbe,
    Mechanism,
    Placement,
    Probe,
    Stop,
    Unit,
)
from flexstage.parts.body import Body, Inertia, Solid, owner_of
from flexstage.parts.mass import tensor
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted
from flexstage.spatial.frame import Frame, identity, reflection

STAGES = "stages"
"""The table of a design file that says what stages stand on this one."""
_SECTIONS = ("materials", "parts", "bodies", "links", "units", "placements", "sensors", "gauges", "payloads", "forces", "stops")


@dataclass(frozen=True, eq=False)
class Mount(Description):
    """A stage from another design `file` (its path is from this one), its ground joined to the body `on`, where it is drawn by a `pose`."""

    file: str
    on: str = GROUND
    pose: Pose = field(default_factory=Pose)


@check_arguments
def mount(
    stage: Mechanism, name: str, carried: Mechanism, *, on: str = GROUND, pose: Pose | None = None, platform: bool | None = None
) -> Mechanism:
    """Return the stage with another one `carried` on its body `on`: what was that one's ground is this body.

    Bodies, links, units, copies, parts, gauges and loads of the carried stage are called `name/...`, their numbers are as they are there;
    its overrides and tags come along, its temperatures too, and, on the ground, what that grows with. Its gravity, damping, requirements,
    envelope, formulas and what else is said of a stage as a whole do not. `platform`: that of the carried stage is the platform of both
    (absent: where the stage itself has no body of this name). Raises `DesignError` where names clash, the body is not there, the pose is
    mirrored, or both stages state another growth or temperature of one ground.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> both = mount(parallelogram(), "fine", parallelogram(), on="platform")
    >>> list(both.bodies), list(both.placements)
    (['platform', 'fine/platform'], ['B', 'fine/B'])
    """
    pose = pose or Pose()
    require(_mount_findings(stage, name, carried, on, pose))
    brings = PLATFORM not in stage.bodies if platform is None else platform
    rename = _Names(name, on, frozenset(drawn for unit in drawn_units(carried).values() for drawn in unit.bodies), brings)
    frame = copy_frames(pose, 1)[0]
    own: dict[str, Mapping[str, Any]] = {
        "materials": {f"{name}/{key}": item.turned(frame.rotation) for key, item in carried.materials.items()},
        "parts": {f"{name}/{key}": rename.part(part) for key, part in carried.parts.items()},
        "bodies": {rename.body(key): _moved_body(rename.solids(body), frame) for key, body in carried.bodies.items()},
        "links": {f"{name}/{key}": _moved_link(rename.link(link), frame) for key, link in carried.links.items()},
        "units": {f"{name}/{key}": rename.unit(unit) for key, unit in carried.units.items()},
        "placements": dict(_copies(carried, name, frame)),
        "sensors": _under(name, carried.sensors),
        "gauges": dict(_gauges(carried, rename, frame)),
        "stops": dict(_stops(carried, rename, frame)),
        "payloads": {
            f"{name}/{key}": replace(item, body=rename.body(item.body), at=_point(frame, item.at), inertia=_turned(item.inertia, frame))
            for key, item in carried.payloads.items()
        },
        "forces": {
            f"{name}/{key}": replace(item, body=rename.body(item.body), at=_point(frame, item.at), force=_direction(frame, item.force))
            for key, item in carried.forces.items()
        },
        "temperatures": {
            rename.body(key): value for key, value in _temperatures(carried).items() if key != GROUND or _is_on_ground(stage, on)
        },
    }
    own["temperatures"] = {**own["temperatures"], **stage.temperatures}
    merged = {section: Table({**getattr(stage, section), **entries}) for section, entries in own.items()}
    overrides = {_override(name, key): value for key, value in carried.overrides.items()}
    tags, sources = _provenance(stage, rename, carried)
    packages = tuple(dict.fromkeys((*stage.packages, *carried.packages)))
    ground = stage.ground or (_ground(name, carried) if _is_on_ground(stage, on) else None)
    overrides = Table({**overrides, **stage.overrides})
    return replace(stage, **merged, ground=ground, overrides=overrides, tags=tags, sources=sources, packages=packages)


def _mount_findings(stage: Mechanism, name: str, carried: Mechanism, on: str, pose: Pose) -> Iterator[Finding]:
    where = f"stages.{name}"
    placed = (*stage.placements, *stage.gauges, *stage.stops)
    taken = {copy for key in placed for copy in copy_names(key)} | {
        *stage.bodies,
        *stage.units,
        *stage.links,
    }
    if name in taken:
        yield Finding(where, "something else has this name", "Give the stage a name of its own: all that is in it is called by it")
    if pose.mirror is not None:
        yield Finding(f"{where}.pose.mirror", "a whole stage is not mirrored", "Mirror its units, in its own file")
    known = {GROUND, *placed_bodies(stage)}
    if on not in known:
        yield Finding(f"{where}.on", f'there is no body "{on}"', suggest_nearest(on, known))
    if _is_on_ground(stage, on):
        yield from _ground_findings(stage, name, carried)
    if on in {body for unit in drawn_units(carried).values() for body in unit.bodies}:
        yield Finding(f"{where}.on", f'a unit of the carried stage has a body "{on}" itself', "Give one of them another name")


def _is_on_ground(stage: Mechanism, on: str) -> bool:
    return owner_of(placed_bodies(stage), on) == GROUND


def _ground(name: str, carried: Mechanism) -> str | None:
    """What the carried stage states that its ground grows with, by its new name."""
    return carried.ground if carried.ground in (None, NOT_GROWING) else f"{name}/{carried.ground}"


def _temperatures(stage: Mechanism) -> dict[str, Number]:
    """The temperature of every body, and of the ground, that the stage states."""
    moving = [name for name, body in placed_bodies(stage).items() if body.of is None]
    everywhere = dict.fromkeys((GROUND, *moving), stage.temperatures[EVERYWHERE]) if EVERYWHERE in stage.temperatures else {}
    return everywhere | {name: value for name, value in stage.temperatures.items() if name != EVERYWHERE}


def _ground_findings(stage: Mechanism, name: str, carried: Mechanism) -> Iterator[Finding]:
    """What both state of the ground must agree."""
    mine, other = stage.ground, _ground(name, carried)
    if mine and other and not _agree(stage.materials.get(mine, mine), carried.materials.get(carried.ground or "", other)):
        what = f'its ground grows as "{other}", that of what it is mounted beside as "{mine}"'
        yield Finding(f"stages.{name}", what, f'State it in this design: ground = "{mine}", or "{NOT_GROWING}" if it does not grow')
    warm, warmer = (_temperatures(each).get(GROUND) for each in (stage, carried))
    if warm is not None and warmer is not None and not np.array_equal(warm, warmer):
        what = f"its ground is warmer by {warmer:g} K, that of what it is mounted beside by {warm:g} K"
        yield Finding(f"stages.{name}", what, f'State it in this design: temperatures.ground = "{warm:g} K"')


def _agree(one: Material | str, other: Material | str) -> bool:
    return digest(one, physics=True) == digest(other, physics=True)


def _under(name: str, entries: Mapping[str, Any]) -> dict[str, Any]:
    return {f"{name}/{key}": value for key, value in entries.items()}


@dataclass(frozen=True)
class _Names:
    """What things of the carried stage are called.

    Its ground is `on`, `drawn` are the bodies that units call by their own names; with `brings_platform` its platform keeps its name.
    """

    name: str
    on: str
    drawn: frozenset[str]
    brings_platform: bool

    def body(self, body: str) -> str:
        """A body of the stage or of a copy."""
        if body == GROUND:
            return self.on
        return body if body == PLATFORM and self.brings_platform else f"{self.name}/{body}"

    def part(self, part: Part) -> Part:
        """A part, of the material under its new name."""
        if isinstance(part, Restricted):
            return replace(part, part=self.part(part.part))
        named = {key: f"{self.name}/{value}" for key in ("material", "replaces") if (value := getattr(part, key, None))}
        return replace(cast("Any", part), **named) if named else part

    def solids(self, body: Body) -> Body:
        """A body, its solids of the materials under their new names, and whose it is."""
        solids = {key: replace(cast("Any", solid), material=f"{self.name}/{solid.material}") for key, solid in body.solids.items()}
        return replace(body, solids=Table(solids), of=None if body.of is None else self.body(body.of))

    def link(self, link: Link, own: frozenset[str] = frozenset()) -> Link:
        """A link, of the part under its new name; `own` are the bodies of its unit."""
        joins = {key: body if body in own else self.body(body) for key, body in _pairs(link.joins)}
        return replace(
            link, part=f"{self.name}/{link.part}", joins=Table(joins) if isinstance(link.joins, Mapping) else tuple(joins.values())
        )

    def unit(self, unit: Unit) -> Unit:
        """A unit."""
        return replace(
            unit,
            bodies=Table({key: self.solids(body) for key, body in unit.bodies.items()}),
            links=Table({key: self.link(link, self.drawn) for key, link in unit.links.items()}),
            like=None if unit.like is None else f"{self.name}/{unit.like}",
        )


def _gauges(carried: Mechanism, rename: _Names, frame: Frame) -> Iterator[tuple[str, GaugePlace]]:
    """The gauges one by one: what looks at bodies in its new pose, what reads links or other gauges by their new names."""
    for key, item in carried.gauges.items():
        names = [f"{rename.name}/{copy}" for copy in copy_names(key)]
        if isinstance(item, Probe):
            gauge, body, base = f"{rename.name}/{item.gauge}", rename.body(item.body), rename.body(item.base or GROUND)
            poses = [_pose(each.within(frame)) for each in copy_frames(item.pattern, len(names))]
            yield from (
                (name, replace(item, gauge=gauge, body=body, base=base, pattern=pose)) for name, pose in zip(names, poses, strict=True)
            )
        elif isinstance(item, LinkProbe):
            links = [f"{rename.name}/{link}" for link in link_names(item.link)]
            own = replace(item, gauge=f"{rename.name}/{item.gauge}")
            yield from ((name, replace(own, link=link)) for name, link in zip(names, links, strict=True))
        else:
            yield names[0], replace(item, sum=Table(_under(rename.name, item.sum)))


def _stops(carried: Mechanism, rename: _Names, frame: Frame) -> Iterator[tuple[str, Stop]]:
    """The stops one by one, each in its new pose."""
    for key, item in carried.stops.items():
        names = copy_names(key)
        for name, each in zip(names, copy_frames(item.pattern, len(names)), strict=True):
            own = replace(item, body=rename.body(item.body), base=rename.body(item.base), pattern=_pose(each.within(frame)))
            yield f"{rename.name}/{name}", own


def _pairs(joins: Any) -> Iterator[tuple[Any, str]]:
    return iter(joins.items()) if isinstance(joins, Mapping) else iter(enumerate(joins))


def _copies(carried: Mechanism, name: str, outer: Frame) -> Iterator[tuple[str, Placement]]:
    """Copies one by one, each in its pose in the carrying stage."""
    for key, item in carried.placements.items():
        copies = copy_names(key)
        for copy, frame in zip(copies, copy_frames(item.pattern, len(copies)), strict=True):
            yield f"{name}/{copy}", Placement(f"{name}/{item.unit}", _pose(frame.within(outer)))


def _pose(frame: Frame) -> Pose:
    """The pose of a frame; a left-handed one is the image of another in the plane across x."""
    plain = frame.within(reflection(0)) if frame.mirrored else frame
    along, up = (_components(plain.rotation[..., :, axis]) for axis in (0, 2))
    return Pose(_components(plain.position), along, up, Normal.X if frame.mirrored else None)


def _components(vector: Array) -> Vector:
    x, y, z = (_number(vector[..., axis]) for axis in range(3))
    return (x, y, z)


def _number(value: Array) -> Number:
    return value if np.ndim(value) else value.item()


def _point(frame: Frame, at: Vector) -> Vector:
    return _components(frame.point(stack(at)))


def _direction(frame: Frame, along: Vector) -> Vector:
    return _components(frame.direction(stack(along)))


def _turned(inertia: Inertia | None, frame: Frame) -> Inertia | None:
    """Moments of inertia along the axes of the carrying stage: R J R^T."""
    if inertia is None or np.array_equal(frame.rotation, identity().rotation):
        return inertia
    matrix = frame.rotation @ tensor(inertia) @ np.swapaxes(frame.rotation, -1, -2)
    moments = [_number(matrix[..., axis, axis]) for axis in range(3)]
    return Inertia(*moments, *(_number(-matrix[..., one, other]) for one, other in ((0, 1), (0, 2), (1, 2))))


def _moved_body(body: Body, frame: Frame) -> Body:
    return replace(
        body,
        solids=Table({key: _moved_solid(solid, frame) for key, solid in body.solids.items()}),
        centre=_point(frame, body.centre or (0.0, 0.0, 0.0)) if body.mass is not None else None,
        inertia=_turned(body.inertia, frame),
        points=Table({key: _point(frame, at) for key, at in body.points.items()}),
        reference=None if body.reference is None else _point(frame, body.reference),
    )


def _moved_solid(solid: Solid, frame: Frame) -> Solid:
    directions = {key: _direction(frame, getattr(solid, key)) for key in ("along", "up") if hasattr(solid, key)}
    return replace(cast("Any", solid), at=_point(frame, solid.at), **directions)


def _moved_link(link: Link, frame: Frame) -> Link:
    points = {key: _point(frame, at) for key in ("at", "start", "end") if (at := getattr(link, key)) is not None}
    directions = {key: _direction(frame, along) for key in ("along", "bends") if (along := getattr(link, key)) is not None}
    return replace(link, **points, **directions)


def _override(name: str, key: str) -> str:
    return f"links.{name}/{key.removeprefix('links.')}" if key.startswith("links.") else f"{name}/{key}"


def _provenance(stage: Mechanism, rename: _Names, carried: Mechanism) -> tuple[Table, Table]:
    """Tags by their new addresses, and sources, those of other text but the same key under a new one."""
    name = rename.name
    keys = {key: key if stage.sources.get(key, text) == text else f"{name}/{key}" for key, text in carried.sources.items()}
    tags: dict[str, str] = {}
    for address, tag in carried.tags.items():
        section, dot, rest = canonical(carried, address).partition(".")
        words = tag.split(" ")
        told = " ".join([*words[:1], *(keys.get(word, word) for word in words[1:2]), *words[2:]])
        thing, _, inside = rest.partition(".")
        if section in _SECTIONS:
            called = rename.body(thing) if section == "bodies" else f"{name}/{thing}"
            tags[f"{section}.{called}.{inside}"] = told
        elif "/" in section and dot:
            tags[f"{name}/{section}.{rest}"] = told
    sources = {**{keys[key]: text for key, text in carried.sources.items()}, **stage.sources}
    return Table({**tags, **stage.tags}), Table(sources)


def mount_all(stage: Mechanism, carried: Mapping[str, tuple[Mount, Mechanism]]) -> Mechanism:
    """Return the stage with all that it carries, each after the one that it stands on. What it states of the ground itself holds for all.

    Where the stage has no body `platform`, the stage that carries no other brings it. Raises `DesignError` where several do.

    >>> mount_all(Mechanism("bare"), {}).name
    'bare'
    """
    top = _top(stage, {name: item for name, (item, _) in carried.items()})
    waiting = {name: (item, _under_ground_of(stage, inner)) for name, (item, inner) in carried.items()}
    while waiting:
        known = {GROUND, *placed_bodies(stage)}
        name = next((each for each, (item, _) in waiting.items() if item.on in known), next(iter(waiting)))
        item, inner = waiting.pop(name)
        stage = mount(stage, name, inner, on=item.on, pose=item.pose, platform=name == top)
    return stage


def _under_ground_of(stage: Mechanism, carried: Mechanism) -> Mechanism:
    """The carried stage without what the stage itself states of the ground."""
    warm = _temperatures(carried)
    if GROUND in _temperatures(stage):
        warm.pop(GROUND, None)
    return replace(carried, ground=None if stage.ground else carried.ground, temperatures=Table(warm))


def _top(stage: Mechanism, carried: Mapping[str, Mount]) -> str | None:
    """Which of the carried stages brings the platform; none if the stage has one."""
    if PLATFORM in stage.bodies or not carried:
        return None
    bearing = {item.on.partition("/")[0] for item in carried.values()}
    top = [name for name in carried if name not in bearing]
    if len(top) != 1:
        what = f'there is no body "{PLATFORM}", and not one of the stages is on top of all others, but {", ".join(top) or "none"}'
        raise refuse("stages", what, f"Declare the moving part under bodies.{PLATFORM}")
    return top[0]
