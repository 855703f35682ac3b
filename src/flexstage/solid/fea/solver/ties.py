"""Ties: effects of parts without a shape in a stage of solids, from their specified values.

A spring, a force actuator, a compliance matrix, a contact or a superelement has no outline to mesh. The stiffness and mass of these parts
are specified, and are equal in every model. The end of a part on an elastic body moves with the surface around the end (see
`field.seat_motion`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, PlacedSuperelement
from flexstage.mechanism.mechanism import GROUND
from flexstage.models.linear.model import Contribution
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.condensation import Condensed, condense
from flexstage.parts.part import Restricted, strut_of
from flexstage.parts.shape import Shaped
from flexstage.parts.stated import Stated
from flexstage.spatial.frame import Frame, spatial_rotation, twist_transform


@dataclass(frozen=True, eq=False)
class End:
    """End of a part without a shape: the `name` of the end (`motor:platform`, `frame.left:platform`), its body, and its point (3,)."""

    name: str
    body: str
    point: Array


@dataclass(frozen=True, eq=False)
class ShapelessContribution:
    """Contribution of a part without a shape: stiffness for its `strain`, and `inertia` for the motions of its ends and inner coordinates.

    `carried` (r, 6) is the motion of the part's ends and inner coordinates if the whole stage moves rigidly about its origin. `passed` (w,
    s) maps the forces (s,) due to the part's strain to the output wrenches (w,). `damping` is the part's viscous damping for this strain.
    """

    strain: Contribution
    inertia: Contribution
    carried: Array
    passed: Array
    damping: Array | None = None


def stated_of(link: PlacedLink) -> Stated | None:
    """Return the specified behaviour of a link without a shape; `None` if it has a shape, is ideal or restricted, or specifies nothing.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> links = expand(case("voice-coil-stage")).links
    >>> stated_of(links["motor"]).stiffness.any(), stated_of(links["G1/inner_left"])
    (np.False_, None)
    """
    return None if isinstance(link.part, (Shaped, Joint, Restricted)) else link.part.stated(link.material)


def ends(assembly: Assembly) -> Iterator[End]:
    """List the ends of all parts without a shape, except ends on the ground.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> [end.name for end in ends(expand(case("voice-coil-stage")))]
    ['motor:platform']
    """
    for name, link in assembly.links.items():
        if stated_of(link) is not None:
            half = 0.5 * float(np.real(strut_of(link.part) or 0.0))
            for body, away in zip(link.joins, (-half, half), strict=True):
                if body != GROUND:
                    yield End(f"{name}:{body}", body, link.frame.point(np.array([away, 0.0, 0.0])))
    for name, element in assembly.superelements.items():
        for place, port in element.ports.items():
            if port.body != GROUND:
                yield End(f"{name}.{place}:{port.body}", port.body, port.frame.position)


def inner_coordinates(element: PlacedSuperelement) -> tuple[str, ...]:
    """Return names for the modes of a superelement with fixed ports."""
    return tuple(f"{element.name}.mode{number + 1}" for number in range(len(_condensed(element).squares)))


Twist = Callable[[str, str, Frame], Array]
"""Function of an end's name, its body and a frame, which returns the end's twist (6, N) at the origin and in the axes of the frame."""


def link_tie(link: PlacedLink, stated: Stated, twist: Twist, loss_factor: float) -> ShapelessContribution:
    """Build the contribution of a link without a shape between two bodies.

    >>> spring = Stated(np.eye(6), np.zeros((12, 12)))
    >>> from flexstage.cases.registry import case
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> link = expand(case("voice-coil-stage")).links["motor"]
    >>> link_tie(link, spring, lambda end, body, frame: np.eye(6) * (body != "ground"), 0.0).strain.operator.trace().item()
    6.0
    """
    first, second = (twist(f"{link.name}:{body}", body, link.frame) for body in link.joins)
    carry = twist_transform(link.frame, np.zeros(3))
    return ShapelessContribution(
        strain=Contribution(second - first, np.real(stated.stiffness), loss_factor),
        inertia=Contribution(np.vstack([first, second]), np.real(stated.mass)),
        carried=np.vstack([carry, carry]),
        passed=np.eye(6),
        damping=None if stated.damping is None or not np.any(stated.damping) else np.real(stated.damping),
    )


def superelement_tie(element: PlacedSuperelement, twist: Twist, inner: Array) -> ShapelessContribution:
    """Build a superelement's contribution.

    Its strains are the port twists relative to the first port, then m mode amplitudes `inner` (m, N).
    """
    found = _condensed(element)
    ports = list(element.ports.values())
    moved = [twist(f"{element.name}.{name}:{port.body}", port.body, port.frame) for name, port in element.ports.items()]
    size, modes = 6 * len(ports) - 6, len(found.squares)
    law = np.zeros((size + modes, size + modes))
    law[:size, :size], law[size:, size:] = found.stiffness, np.diag(found.squares)
    relative = [own - _carry(ports[0].frame, port.frame) @ moved[0] for own, port in zip(moved[1:], ports[1:], strict=True)]
    loss = element.part.loss_factor
    carried = [twist_transform(port.frame, np.zeros(3)) for port in ports]
    return ShapelessContribution(
        strain=Contribution(np.vstack([*relative, inner]), law, 0.0 if loss is None else float(np.real(loss))),
        inertia=Contribution(np.vstack([*moved, inner]), found.inertia),
        carried=np.vstack([*carried, np.zeros((modes, 6))]),
        passed=np.hstack([_all_ports([port.frame for port in ports]), np.zeros((6 * len(ports), modes))]),
        damping=found.damping,
    )


def _condensed(element: PlacedSuperelement) -> Condensed:
    return condense(element.part, f"parts.{element.link.part}")


def _carry(start: Frame, end: Frame) -> Array:
    """Transformation of a rigid body's twist from one frame to another, each in its axes."""
    return twist_transform(end, start.position) @ spatial_rotation(start.rotation)


def _all_ports(frames: Sequence[Frame]) -> Array:
    """Operator from the wrenches at all ports but the first to those at all ports (6 p, 6 (p - 1)); the first balances the others."""
    balance = -np.hstack([_carry(frames[0], frame).T for frame in frames[1:]])
    return np.vstack([balance, np.eye(balance.shape[1])])


def stated_links(assembly: Assembly) -> dict[str, str]:
    """Return the links without a shape that have specified behaviour, and the kind of part of each link.

    >>> from flexstage.cases.registry import case
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> stated_links(expand(case("voice-coil-stage")))
    {'motor': 'voice_coil'}
    """
    links = {name: link.part.kind for name, link in assembly.links.items() if stated_of(link) is not None}
    return links | {name: element.part.kind for name, element in assembly.superelements.items()}


def in_words(stated: Mapping[str, str]) -> str:
    """Return in words the numbers of links with specified behaviour, by kind of part; empty if there are no such links.

    >>> in_words({"a": "spring", "b": "spring", "motor": "voice_coil"})
    '2 springs, 1 voice coil as specified'
    """
    counts = Counter(_NOUNS.get(kind, kind.replace("_", " ")) for kind in stated.values())
    text = ", ".join(f"{count} {noun}{'s' if count > 1 else ''}" for noun, count in counts.items())
    return f"{text} as specified" if text else ""


_NOUNS = {
    "compliance_matrix": "matrix part",
    "force": "force actuator",
    "amplified": "amplified actuator",
    "stepper": "stepping drive",
}
