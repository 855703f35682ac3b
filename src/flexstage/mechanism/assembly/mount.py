"""Mounting of one stage on another: a single description, with names of the mounted stage prefixed (`fine/B1`)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array, Number, Table, Vector, stack
from flexstage.base.storage.digest import Description, digest
from flexstage.mechanism.addresses.locate import canonical
from flexstage.mechanism.assembly.expand import copy_frames, patterned, placed_bodies
from flexstage.mechanism.assembly.likeness import drawn_units
from flexstage.mechanism.assembly.pattern import Normal, Pose, copy_names
from flexstage.mechanism.assembly.sight import link_names
from flexstage.mechanism.mechanism import (
    EVERYWHERE,
    GROUND,
    NAMED,
    NOT_GROWING,
    PLATFORM,
    GaugePlace,
    LinkProbe,
    Mechanism,
    Probe,
)
from flexstage.mechanism.references import BODIES, SECTIONS, renamed
from flexstage.parts.body import Body, Inertia, owner_of
from flexstage.parts.mass import tensor
from flexstage.parts.material import Material
from flexstage.spatial.frame import Frame, reflection

STAGES = "stages"
"""Table of a design file that lists the stages mounted on this stage."""


@dataclass(frozen=True, eq=False)
class Mount(Description):
    """Stage of another design `file` (relative path), with its ground fixed to the body `on` at a `pose`."""

    file: str
    on: str = GROUND
    pose: Pose = field(default_factory=Pose)


@check_arguments
def mount(
    stage: Mechanism, name: str, carried: Mechanism, *, on: str = GROUND, pose: Pose | None = None, platform: bool | None = None
) -> Mechanism:
    """Return the stage with another stage, `carried`, mounted on its body `on`. The body `on` replaces the ground of `carried`.

    Bodies, links, units, instances, parts, gauges and loads of the carried stage get the names `name/...`; positions and directions are
    converted to the frame of `stage`. Overrides, tags and temperatures of the carried stage are kept; if `on` is the ground, the material
    of the carried ground is kept too. Other properties of the carried stage as a whole (gravity, damping, requirements, envelope, formulas)
    are dropped. If `platform` is true, the carried stage's platform becomes the platform of the result. The default is true if `stage` has
    no body `platform`.

    Raises `DesignError` for name clashes, an unknown body, a mirrored pose, or if the two stages specify different materials or
    temperatures for a ground that they share.

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
    temperatures = {key: each for key, each in _temperatures(carried).items() if key != GROUND or _is_on_ground(stage, on)}
    moved: dict[str, Mapping[str, Any]] = {
        "materials": {key: item.turned(frame.rotation) for key, item in carried.materials.items()},
        "parts": carried.parts,
        "bodies": {key: _moved_body(body, frame) for key, body in carried.bodies.items()},
        "links": {key: _moved(link, frame) for key, link in carried.links.items()},
        "units": carried.units,
        "placements": dict(_placed(carried.placements, frame)),
        "sensors": carried.sensors,
        "gauges": dict(_gauges(carried, name, frame)),
        "stops": dict(_placed(carried.stops, frame)),
        "payloads": {key: replace(_moved(item, frame), inertia=_turned(item.inertia, frame)) for key, item in carried.payloads.items()},
        "forces": {key: _moved(item, frame) for key, item in carried.forces.items()},
    }
    own = {section: {rename.key(section, key): rename.inside(section, item) for key, item in moved[section].items()} for section in moved}
    own["temperatures"] = {**{rename.body(key): each for key, each in temperatures.items()}, **stage.temperatures}
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
    taken = {*stage.bodies, *stage.units, *stage.links, *(copy for key in placed for copy in copy_names(key))}
    if name in taken:
        yield Finding(where, "the name is in use", "Use another name: it becomes the prefix of all names of the mounted stage")
    if pose.mirror is not None:
        yield Finding(f"{where}.pose.mirror", "a whole stage cannot be mirrored", "Mirror the units in the file of the mounted stage")
    known = {GROUND, *placed_bodies(stage)}
    if on not in known:
        yield Finding(f"{where}.on", f'unknown body "{on}"', suggest_nearest(on, known))
    if _is_on_ground(stage, on):
        yield from _ground_findings(stage, name, carried)
    if on in {body for unit in drawn_units(carried).values() for body in unit.bodies}:
        yield Finding(f"{where}.on", f'a unit of the mounted stage also has a body "{on}"', "Rename one of the two bodies")


def _is_on_ground(stage: Mechanism, on: str) -> bool:
    return owner_of(placed_bodies(stage), on) == GROUND


def _ground(name: str, carried: Mechanism) -> str | None:
    """Specified ground material of the mounted stage, by its new name."""
    return carried.ground if carried.ground in (None, NOT_GROWING) else f"{name}/{carried.ground}"


def _temperatures(stage: Mechanism) -> dict[str, Number]:
    """Specified temperatures of bodies and of the ground."""
    moving = [name for name, body in placed_bodies(stage).items() if body.of is None]
    everywhere = dict.fromkeys((GROUND, *moving), stage.temperatures[EVERYWHERE]) if EVERYWHERE in stage.temperatures else {}
    return everywhere | {name: value for name, value in stage.temperatures.items() if name != EVERYWHERE}


def _ground_findings(stage: Mechanism, name: str, carried: Mechanism) -> Iterator[Finding]:
    """Errors for different specifications of a common ground."""
    mine, other = stage.ground, _ground(name, carried)
    if mine and other and not _agree(stage.materials.get(mine, mine), carried.materials.get(carried.ground or "", other)):
        what = f'different ground materials (got "{other}" in the mounted stage, "{mine}" in this stage)'
        yield Finding(f"stages.{name}", what, f'Specify the material in this design: ground = "{mine}"; "{NOT_GROWING}" means no expansion')
    warm, warmer = (_temperatures(each).get(GROUND) for each in (stage, carried))
    if warm is not None and warmer is not None and not np.array_equal(warm, warmer):
        what = f"different ground temperatures (got {warmer:g} K in the mounted stage, {warm:g} K in this stage)"
        yield Finding(f"stages.{name}", what, f'Specify the temperature in this design: temperatures.ground = "{warm:g} K"')


def _agree(one: Material | str, other: Material | str) -> bool:
    return digest(one, physics=True) == digest(other, physics=True)


@dataclass(frozen=True)
class _Names:
    """New names of the mounted stage.

    `on` is its ground; `drawn` are bodies of its units, which keep their names; `brings_platform`: its platform is that of both stages.
    """

    name: str
    on: str
    drawn: frozenset[str]
    brings_platform: bool

    def body(self, body: str) -> str:
        """Name of a body of the stage or of an instance."""
        if body == GROUND:
            return self.on
        return body if body == PLATFORM and self.brings_platform else f"{self.name}/{body}"

    def key(self, section: str, key: str) -> str:
        """Name of an entry of a section."""
        return self.body(key) if section == "bodies" else f"{self.name}/{key}"

    def inside(self, section: str, item: Any) -> Any:
        """An entry of a section with renamed references."""
        own = self.drawn if section == "units" else ()

        def change(field_name: str, text: str) -> str:
            if field_name in BODIES:
                return text if field_name == "joins" and text in own else self.body(text)
            return f"{self.name}/{text}"

        return renamed(item, (*SECTIONS, *BODIES), change)


def _placed(entries: Mapping[str, Any], outer: Frame) -> Iterator[tuple[str, Any]]:
    """Single instances, each with its pose in the carrying stage."""
    for name, item, frame in patterned(entries):
        yield name, replace(item, pattern=_pose(frame.within(outer)))


def _gauges(carried: Mechanism, name: str, frame: Frame) -> Iterator[tuple[str, GaugePlace]]:
    """Single gauges: with a new pose, or with new names of links and gauges."""
    for key, item in carried.gauges.items():
        if isinstance(item, Probe):
            yield from _placed({key: item}, frame)
        elif isinstance(item, LinkProbe):
            links = zip(copy_names(key), link_names(item.link), strict=True)
            yield from ((copy, replace(item, link=f"{name}/{link}")) for copy, link in links)
        else:
            yield key, replace(item, sum=Table({f"{name}/{member}": weight for member, weight in item.sum.items()}))


def _pose(frame: Frame) -> Pose:
    """Pose of a frame; a left-handed one is a mirror image in the plane normal to x."""
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


def _turned(inertia: Inertia | None, frame: Frame) -> Inertia | None:
    """Moments of inertia in the axes of the carrying stage: R J R^T."""
    if inertia is None or np.array_equal(frame.rotation, np.eye(3)):
        return inertia
    matrix = frame.rotation @ tensor(inertia) @ frame.rotation.mT
    moments = [_number(matrix[..., axis, axis]) for axis in range(3)]
    return Inertia(*moments, *(_number(-matrix[..., one, other]) for one, other in ((0, 1), (0, 2), (1, 2))))


def _moved(item: Any, frame: Frame) -> Any:
    """An outline, a body, a link or a load in another frame."""
    own = {each.name: getattr(item, each.name) for each in fields(item)}
    points = {name: _point(frame, own[name]) for name in ("at", "start", "end", "reference") if own.get(name) is not None}
    ways = ("along", "bends", "up", "force")
    return replace(item, **points, **{name: _components(frame.direction(stack(own[name]))) for name in ways if own.get(name) is not None})


def _moved_body(body: Body, frame: Frame) -> Body:
    return replace(
        _moved(body, frame),
        solids=Table({key: _moved(solid, frame) for key, solid in body.solids.items()}),
        centre=_point(frame, body.centre or (0.0, 0.0, 0.0)) if body.mass is not None else None,
        inertia=_turned(body.inertia, frame),
        points=Table({key: _point(frame, at) for key, at in body.points.items()}),
    )


def _override(name: str, key: str) -> str:
    return f"links.{name}/{key.removeprefix('links.')}" if key.startswith("links.") else f"{name}/{key}"


def _provenance(stage: Mechanism, rename: _Names, carried: Mechanism) -> tuple[Table, Table]:
    """Tags by new addresses, and sources; a source of equal key but different text gets a new key."""
    name = rename.name
    keys = {key: key if stage.sources.get(key, text) == text else f"{name}/{key}" for key, text in carried.sources.items()}
    tags: dict[str, str] = {}
    for address, tag in carried.tags.items():
        section, dot, rest = canonical(carried, address).partition(".")
        words = tag.split(" ")
        told = " ".join([*words[:1], *(keys.get(word, word) for word in words[1:2]), *words[2:]])
        thing, _, inside = rest.partition(".")
        if section in NAMED:
            tags[f"{section}.{rename.key(section, thing)}.{inside}"] = told
        elif "/" in section and dot:
            tags[f"{name}/{section}.{rest}"] = told
    sources = {**{keys[key]: text for key, text in carried.sources.items()}, **stage.sources}
    return Table({**tags, **stage.tags}), Table(sources)


def mount_all(stage: Mechanism, carried: Mapping[str, tuple[Mount, Mechanism]]) -> Mechanism:
    """Return the stage with all stages in `carried` mounted, each after the stage that carries it.

    Ground properties that the stage specifies apply to all mounted stages. If the stage has no body `platform`, the topmost stage provides
    it. Raises `DesignError` for several topmost stages.

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
    """The mounted stage without ground properties that the stage specifies."""
    warm = _temperatures(carried)
    if GROUND in _temperatures(stage):
        warm.pop(GROUND, None)
    return replace(carried, ground=None if stage.ground else carried.ground, temperatures=Table(warm))


def _top(stage: Mechanism, carried: Mapping[str, Mount]) -> str | None:
    """Mounted stage with the platform; none if the stage has one."""
    if PLATFORM in stage.bodies or not carried:
        return None
    bearing = {item.on.partition("/")[0] for item in carried.values()}
    top = [name for name in carried if name not in bearing]
    if len(top) != 1:
        what = f'unknown body "{PLATFORM}", and no unique topmost stage (got {", ".join(top) or "none"})'
        raise refuse("stages", what, f"Declare the moving platform under bodies.{PLATFORM}")
    return top[0]
