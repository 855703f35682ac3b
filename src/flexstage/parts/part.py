"""The parts a link may be made of, and their restriction to some freedoms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, TypeAlias

from flexstage.base.finding import refuse
from flexstage.base.number import Number
from flexstage.base.storage.digest import Description
from flexstage.parts.actuator import Actuator
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.shape import Elastic, Shaped
from flexstage.parts.superelement import Port


@dataclass(frozen=True, eq=False)
class Restricted(Description):
    """A part of which only the `elastic` freedoms keep their compliance; the `free` ones lose all stiffness, the rest is locked.

    Its mass is left out. Used to connect models: what the paper's equations know of a hinge.
    """

    kind: ClassVar[str] = "restricted"
    part: Elastic
    elastic: tuple[Freedom, ...]
    free: tuple[Freedom, ...] = ()

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The intended freedoms of the part, as far as they are not locked."""
        left = self.elastic + self.free
        return tuple(freedom for freedom in self.part.intended if freedom in left)

    @property
    def mirrored(self) -> Restricted | None:
        """The part in a mirror, restricted alike."""
        inside = self.part.mirrored
        return None if inside is None else self if inside is self.part else replace(self, part=inside)


Part: TypeAlias = Elastic | Joint | Restricted


def inner(part: Part) -> Elastic | Joint:
    """The part itself, or what a restricted one restricts."""
    return part.part if isinstance(part, Restricted) else part


def is_actuator(part: Part) -> bool:
    """Whether the part has an input.

    >>> is_actuator(Joint())
    False
    """
    return isinstance(inner(part), Actuator)


def imposes_stroke(part: Part) -> bool:
    """Whether the part is an actuator whose input is a stroke.

    >>> from flexstage.parts.force_actuator import ForceActuator
    >>> imposes_stroke(ForceActuator())
    False
    """
    return is_actuator(part) and actuator_of(part).takes_stroke


def actuator_of(part: Part) -> Actuator:
    """The actuator that a part is, or that a restricted one restricts; refused for what has no input.

    >>> from flexstage.parts.force_actuator import ForceActuator
    >>> actuator_of(Restricted(ForceActuator(), ())).input.si
    'N'
    """
    own = inner(part)
    if not isinstance(own, Actuator):
        raise refuse(f"a part of kind {own.kind}", "it has no input", "Ask an actuator")
    return own


def material_of(part: Part) -> str | None:
    """Name of the part's material, if it has one.

    >>> material_of(Joint()) is None
    True
    """
    return getattr(inner(part), "material", None)


def counter_of(part: Part) -> str | None:
    """Name of the material that the part is pressed on, if it is.

    >>> counter_of(Joint()) is None
    True
    """
    return getattr(inner(part), "counter", None)


def ports_of(part: Part) -> Mapping[str, Port]:
    """The interface frames that a part is joined by, by name; empty for a part between two bodies.

    >>> ports_of(Joint())
    {}
    """
    return getattr(inner(part), "ports", {})


def push_of(part: Part) -> Number | None:
    """The constant force with which a part pushes its ends apart as drawn [N]; `None` where it has none.

    >>> push_of(Joint()) is None
    True
    """
    own = inner(part)
    return None if isinstance(own, Joint) else own.push


def strut_of(part: Part) -> Number | None:
    """Length [m] over which a part without a shape turns about both of its ends; `None` where it acts in one point.

    >>> strut_of(Joint()) is None
    True
    """
    own = inner(part)
    return None if isinstance(own, Joint) else own.strut


def span(part: Part) -> Number:
    """Length of a part along its x axis [m], zero for given matrices and joints.

    >>> from flexstage.parts.leaf import Leaf
    >>> span(Leaf("steel", length=0.05, thickness=0.001, width=0.01))
    0.05
    """
    own = inner(part)
    return own.span if isinstance(own, Shaped) else 0.0
