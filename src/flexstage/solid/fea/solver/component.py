"""Components: a stage cut at interfaces of units with other bodies, at the ends of stacks and at rigid bodies.

A body with outlines is elastic; a body without outlines is rigid. A component is a set of touching pieces of one instance (or of the
stage): links and elastic bodies. Every joint of a link with a body outside its component is an interface: a flat end face, which remains
plane at rigid bodies and stacks. Stacks are separate components between rigid end caps. Components are drawn in their unit's frame (a
single link in its own frame), so that equal components are reduced once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from itertools import chain

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, copies, expand
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.parts.material import Material
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.geometry.piece import Form, Piece, body_pieces, end_area, link_forms, link_pieces, relative_frame, span
from flexstage.solid.fea.solver.ties import End, ends
from flexstage.spatial.frame import Frame, identity


@dataclass(frozen=True, eq=False)
class Joint:
    """End face of a link at a body: its name (`B1/front:platform`), its frame with x out of the end face, and its area [m^2]."""

    name: str
    link: str
    body: str
    frame: Frame
    area: float


@dataclass(frozen=True, eq=False)
class Interface:
    """A joint at the boundary of a component: the end face of one of its links, or of another component's link (`footprint`).

    A joint `yields` if the solids on both sides are elastic: the face of the joint then deforms equally on both sides. A face on a rigid
    body or on an end cap of a stack stays plane.
    """

    joint: Joint
    footprint: Piece | None = None
    yields: bool = False


@dataclass(frozen=True, eq=False)
class Component:
    """One solid in its own axes: its `pieces`, its `interfaces` with neighbouring components, and its joints `fixed` to the ground.

    `bodies` maps each elastic body to the reference point (3,) of its mean twist. `place` is the component's frame in the stage. `seats`
    are the ends of parts without a shape that attach to the component.
    """

    name: str
    pieces: tuple[Piece, ...]
    interfaces: tuple[Interface, ...]
    fixed: tuple[Joint, ...]
    bodies: Mapping[str, Array]
    place: Frame
    seats: tuple[End, ...] = ()

    @property
    def floats(self) -> bool:
        """Whether the component has no joints, so that it can move as a whole; only parts without a shape can support it."""
        return not self.interfaces and not self.fixed


@dataclass(frozen=True, eq=False)
class _Graph:
    assembly: Assembly
    materials: Mapping[str, Material]
    links: Mapping[str, Piece]
    joints: Mapping[str, tuple[Joint, Joint]]
    owner: Mapping[str, str]


class Cut(Enum):
    """Places where a stage is cut into components: at units and stacks, or nowhere. Stacks always have rigid end caps."""

    UNITS = "units"
    NONE = "none"


def components(mechanism: Mechanism, cut: Cut = Cut.UNITS) -> tuple[Component, ...]:
    """Cut a stage into components, each in its own axes.

    Raises `DesignError` with the names of links without a shape or a specified stiffness.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [part.name for part in components(double_triangle())][:4]
    ['platform', 'B1/base', 'B1/tip', 'B1/pzt']
    """
    assembly = expand(mechanism)
    links = {piece.name: piece for piece in link_pieces(assembly, link_forms(assembly))}
    joints = {name: link_joints(assembly.links[name], piece.form) for name, piece in links.items()}
    graph = _Graph(assembly, mechanism.materials, links, joints, _owners(assembly, links, cut))
    frames = {name: frame.right_handed for name, _, frame in copies(mechanism)}
    members: dict[str, list[str]] = {}
    for node, owner in graph.owner.items():
        members.setdefault(owner, []).append(node)
    return tuple(_component(graph, nodes, frames) for nodes in members.values())


def groups(component: Component) -> dict[str, tuple[int, ...]]:
    """Collect the pieces (by index) of each link and each body.

    Links and bodies have the same sequence in every instance of a unit, so that one superelement serves all instances.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> groups(bar())
    {'bar': (0,)}
    """
    result: dict[str, tuple[int, ...]] = {}
    for number, piece in enumerate(component.pieces):
        result[piece.owner] = (*result.get(piece.owner, ()), number)
    return result


def with_yielding_ends(component: Component) -> Component:
    """Return the same component, but with link ends that may deform even on rigid bodies.

    An isolated unit with a rigid output then has the same components as the unit in its stage with an elastic platform at the output. With
    zero warps, the returned component behaves like the original component.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> bar().interfaces[0].yields, with_yielding_ends(bar()).interfaces[0].yields
    (False, True)
    """
    stacks = {piece.name for piece in component.pieces if isinstance(piece.form, Piezo)}
    if not component.bodies:
        return component
    return replace(
        component,
        interfaces=tuple(
            replace(item, yields=item.yields or (item.footprint is None and item.joint.link not in stacks)) for item in component.interfaces
        ),
    )


def link_joints(link: PlacedLink, form: Form) -> tuple[Joint, Joint]:
    """Return the two joints of a link: its end face towards -x of the link frame joins the first body, the other the second body.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.solid.fea.geometry.piece import form_of
    >>> link = next(iter(expand(parallelogram()).links.values()))
    >>> [joint.body for joint in link_joints(link, form_of(link))] == list(link.joins)
    True
    """
    half = 0.5 * span(form)
    first, second = link.joins
    about = Frame(link.frame.rotation @ np.diag([-1.0, -1.0, 1.0]), link.frame.point(np.array([-half, 0.0, 0.0])))
    along = Frame(link.frame.rotation, link.frame.point(np.array([half, 0.0, 0.0])))
    area = end_area(form)
    return Joint(f"{link.name}:{first}", link.name, first, about, area), Joint(f"{link.name}:{second}", link.name, second, along, area)


def is_elastic(assembly: Assembly, body: str) -> bool:
    """Return whether a body has outlines. Bodies with outlines are elastic solids; other bodies and the ground are rigid.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> is_elastic(expand(double_triangle()), "platform"), is_elastic(expand(double_triangle()), "ground")
    (True, False)
    """
    return body != GROUND and bool(assembly.bodies[body].solids)


def _group(name: str) -> str:
    return name.rpartition("/")[0]


def _owners(assembly: Assembly, links: Mapping[str, Piece], cut: Cut) -> dict[str, str]:
    """The component of each elastic body and link, named after its first body (a single link: itself)."""
    order = list(dict.fromkeys(_group(name) for name in (*assembly.bodies, *assembly.links)))
    bodies = [body for body in assembly.bodies if is_elastic(assembly, body)]
    nodes = sorted([*bodies, *(name for name in assembly.links if name in links)], key=lambda name: order.index(_group(name)))
    joined = np.zeros((len(nodes), len(nodes)))
    for name, piece in links.items():
        for body in assembly.links[name].joins:
            if body in bodies and (cut is Cut.NONE or (_group(body) == _group(name) and not isinstance(piece.form, Piezo))):
                joined[nodes.index(name), nodes.index(body)] = 1.0
    labels = scipy.sparse.csgraph.connected_components(joined, directed=False)[1].tolist()
    return {node: nodes[labels.index(label)] for node, label in zip(nodes, labels, strict=True)}


def _component(graph: _Graph, nodes: list[str], frames: Mapping[str, Frame]) -> Component:
    links = [node for node in nodes if node in graph.links]
    bodies = [node for node in nodes if node not in graph.links]
    place = graph.assembly.links[links[0]].frame if not bodies and len(links) == 1 else frames.get(_group(nodes[0]), identity())
    drawn = (body_pieces(body, graph.assembly.bodies[body].solids, graph.materials, place.rotation) for body in bodies)
    pieces = [*chain(*drawn), *link_pieces(graph.assembly, {name: graph.links[name].form for name in links}, place.rotation)]
    name = bodies[0] if bodies else links[0]
    own, fixed = _own_joints(graph, links, graph.owner[nodes[0]])
    foreign = _footprints(graph, bodies, graph.owner[nodes[0]])
    return Component(
        name=name,
        pieces=tuple(piece.within(place) for piece in pieces),
        interfaces=tuple(
            replace(item, joint=_place(item.joint, place), footprint=item.footprint and item.footprint.within(place))
            for item in (*own, *foreign)
        ),
        fixed=tuple(_place(joint, place) for joint in fixed),
        bodies={body: _point(graph.assembly.bodies[body].reference, place) for body in bodies},
        place=place,
        seats=tuple(replace(end, point=_point(end.point, place)) for end in ends(graph.assembly) if end.body in bodies),
    )


def _own_joints(graph: _Graph, links: list[str], owner: str) -> tuple[list[Interface], list[Joint]]:
    ends = [joint for name in links for joint in graph.joints[name]]
    joints = [joint for joint in ends if graph.owner.get(joint.body) != owner or isinstance(graph.links[joint.link].form, Piezo)]
    free = [Interface(joint, yields=_yields(graph, joint)) for joint in joints if joint.body != GROUND]
    return free, [joint for joint in joints if joint.body == GROUND]


def _yields(graph: _Graph, joint: Joint) -> bool:
    return is_elastic(graph.assembly, joint.body) and not isinstance(graph.links[joint.link].form, Piezo)


def _footprints(graph: _Graph, bodies: list[str], owner: str) -> list[Interface]:
    return [
        Interface(joint, graph.links[joint.link], _yields(graph, joint))
        for pair in graph.joints.values()
        for joint in pair
        if joint.body in bodies and graph.owner[joint.link] != owner
    ]


def _place(joint: Joint, place: Frame) -> Joint:
    return replace(joint, frame=relative_frame(joint.frame, place))


def _point(point: Array, place: Frame) -> Array:
    return relative_frame(Frame(np.eye(3), point), place).position
