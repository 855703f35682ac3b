"""Seat: a body between the ground and some links of a stage. Imposed displacements of the seat represent assembly errors."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import TypeVar

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.models.nonlinear.elements.hinge import Hinges
from flexstage.models.nonlinear.stage import Flexures, Nonlinear

SEAT = "seat"
_Links = TypeVar("_Links", Flexures, Hinges)


def seat(model: Nonlinear, links: Collection[str], place: Array) -> Nonlinear:
    """Build a model in which `links` are connected to a body `seat` instead of the ground. The seat's reference point is `place` (3,).

    The seat is free: the caller must fix its six coordinates. Raises `DesignError` if none of the links is connected to the ground.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> seat(nonlinear(parallelogram()), ["left"], np.zeros(3)).bodies[-1]
    'seat'
    """
    ground = len(model.bodies)
    flexures, hinges = tuple(_moved(group, ground, links, place) for group in model.flexures), _moved(model.hinges, ground, links, place)
    if not any(np.any(np.concatenate([group.first, group.second]) == ground) for group in (*flexures, hinges)):
        raise refuse(", ".join(links) or SEAT, "not connected to the ground", "Use an instance or a link on the ground")
    return replace(
        model,
        bodies=(*model.bodies, SEAT),
        reference=np.concatenate([model.reference[:-1], place[None], model.reference[-1:]]),
        flexures=flexures,
        hinges=hinges,
        places=replace(model.places, body=np.where(model.places.body == ground, ground + 1, model.places.body)),
        growth=np.append(model.growth, model.growth[-1]),
    )


def _moved(group: _Links, ground: int, links: Collection[str], place: Array) -> _Links:
    """Links whose ground ends are on the seat if they are named, else on the ground behind it."""
    mine = np.array([name in links for name in group.names], dtype=bool)
    links_on_seat: dict[str, Array] = {}
    for end, arm in (("first", "arm_first"), ("second", "arm_second")):
        bodies = getattr(group, end)
        seated = mine & (bodies == ground)
        links_on_seat[end] = np.where((bodies == ground) & ~seated, ground + 1, bodies)
        links_on_seat[arm] = getattr(group, arm) - seated[:, None] * place
    return replace(group, **links_on_seat)
