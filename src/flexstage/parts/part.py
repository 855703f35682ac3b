"""Parts of links, and parts restricted to some degrees of freedom."""

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
    """Restricted part: `elastic` degrees of freedom keep their compliance, `free` ones have no stiffness, all others are locked.

    A restricted part is massless. It reproduces the hinge assumptions of published equations, for comparison of models.
    """

    kind: ClassVar[str] = "restricted"
    part: Elastic
    elastic: tuple[Freedom, ...]
    free: tuple[Freedom, ...] = ()

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom of the part that are not locked."""
        left = self.elastic + self.free
        return tuple(freedom for freedom in self.part.intended if freedom in left)

    @property
    def mirrored(self) -> Restricted | None:
        """Mirror image of the part, with the same elastic and free DOFs."""
        inside = self.part.mirrored
        return None if inside is None else self if inside is self.part else replace(self, part=inside)


Part: TypeAlias = Elastic | Joint | Restricted


def inner(part: Part) -> Elastic | Joint:
    """Return the part itself, or the part inside a restricted part."""
    return part.part if isinstance(part, Restricted) else part


def is_actuator(part: Part) -> bool:
    """Return whether the part has an input.

    >>> is_actuator(Joint())
    False
    """
    return isinstance(inner(part), Actuator)


def imposes_stroke(part: Part) -> bool:
    """Return whether the part is a stroke actuator.

    >>> from flexstage.parts.force_actuator import ForceActuator
    >>> imposes_stroke(ForceActuator())
    False
    """
    return is_actuator(part) and actuator_of(part).takes_stroke


def actuator_of(part: Part) -> Actuator:
    """Return the actuator of a part or a restricted part; raises `DesignError` for a part without an input.

    >>> from flexstage.parts.force_actuator import ForceActuator
    >>> actuator_of(Restricted(ForceActuator(), ())).input.si
    'N'
    """
    own = inner(part)
    if not isinstance(own, Actuator):
        raise refuse(f"a part of kind {own.kind}", "it has no input", "Use an actuator")
    return own


def material_of(part: Part) -> str | None:
    """Return the name of the part's material, if any.

    >>> material_of(Joint()) is None
    True
    """
    return getattr(inner(part), "material", None)


def counter_of(part: Part) -> str | None:
    """Return the name of the contact partner's material, if any.

    >>> counter_of(Joint()) is None
    True
    """
    return getattr(inner(part), "counter", None)


def ports_of(part: Part) -> Mapping[str, Port]:
    """Return the ports (interface frames) of a part by name; empty for a part between two bodies.

    >>> ports_of(Joint())
    {}
    """
    return getattr(inner(part), "ports", {})


def push_of(part: Part) -> Number | None:
    """Return the preload [N] with which a part pushes its ends apart; `None` without a preload.

    >>> push_of(Joint()) is None
    True
    """
    return getattr(inner(part), "push", None)


def strut_of(part: Part) -> Number | None:
    """Return the length [m] between the pivots of a part without a shape; `None` if the part acts at one point.

    >>> strut_of(Joint()) is None
    True
    """
    return getattr(inner(part), "strut", None)


def span(part: Part) -> Number:
    """Return the length of a part along its x axis [m]; zero for compliance matrices and joints.

    >>> from flexstage.parts.leaf import Leaf
    >>> span(Leaf("steel", length=0.05, thickness=0.001, width=0.01))
    0.05
    """
    own = inner(part)
    return own.span if isinstance(own, Shaped) else 0.0
