"""Convex decomposition: polytopes inside the solids of bodies and the parts of links.

Flat faces are exact. Polygons inside the round faces deviate by at most `SAGITTA`: pieces touch only if the solids touch.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from flexstage.base.number import Array
from flexstage.base.session import SESSION
from flexstage.parts.body import Solid
from flexstage.parts.part import Part, inner
from flexstage.parts.pieces import MOST, SAGITTA, corner_count, solid_pieces
from flexstage.parts.profile import Contour, Elliptic, Filleted, Profile, Straight, length, single
from flexstage.parts.section import Section
from flexstage.parts.shape import Profiled, Shaped
from flexstage.spatial.convex import Convex, frustum

Form: TypeAlias = Shaped | Solid
_Slab: TypeAlias = tuple[tuple[float, float], tuple[float, float]]


def form_of(part: Part) -> Form | None:
    """Return the part of a link, or the part inside a restricted part, if it has a form; `None` for a compliance matrix or an ideal joint.

    >>> from flexstage.parts.leaf import Leaf
    >>> form_of(Leaf("steel", 0.02, 0.001, 0.01)).span
    0.02
    """
    own = inner(part)
    return own if isinstance(own, Shaped) else None


def is_flat(form: Form) -> bool:
    """Return whether a form has no arcs, so that its pieces are exact.

    >>> from flexstage.parts.body import Block
    >>> is_flat(Block("steel", (0.1, 0.1, 0.1)))
    True
    """
    return form.is_flat if isinstance(form, Solid) else form.is_prismatic and not form.is_axisymmetric


@SESSION.keep(256)
def pieces(form: Form, trim: float = 0.0) -> tuple[Convex, ...]:
    """Return the convex pieces of a form in its own frame; none for an imported shape.

    A link's part is shortened by `trim` [m] at each end. Holes cut by other solids are ignored.

    >>> from flexstage.parts.leaf import Leaf
    >>> len(pieces(Leaf("steel", 0.02, 0.001, 0.01)))
    1
    """
    if isinstance(form, Solid):
        return solid_pieces(form)
    return tuple(_hinge(form, trim) if isinstance(form, Profiled) else _loft(form, trim))


def _loft(form: Shaped, trim: float) -> Iterator[Convex]:
    """A part without cuts, linear between the stations of its silhouette."""
    places, angles = np.array([x for x, _ in form.silhouette]), _angles(form)
    inside = np.clip(places, places[0] + trim, places[-1] - trim)
    for here, there in pairwise(inside):
        if there > here:
            yield from _slab((here, there), (form.section_at(here), form.section_at(there)), angles)


def _slab(stations: tuple[float, float], sections: tuple[Section, Section], angles: Array) -> Iterator[Convex]:
    """Pieces between two stations, one for each piece of the sections."""
    for one, other in zip(*(section.pieces(angles) for section in sections), strict=True):
        yield frustum(*stations, one, other)


def _angles(form: Shaped) -> Array:
    """Angles of the corners of a round outline."""
    count = corner_count(0.5 * max(single(np.maximum(section.height, section.width)) for _, section in form.silhouette))
    return 2.0 * np.pi * np.arange(count) / count


def _hinge(form: Profiled, trim: float) -> Iterator[Convex]:
    """Slabs between stations along the hinge; heights are from tangents of its cuts, or the lower end."""
    angles = _angles(form)
    for stations, (low, high) in _slabs(form.profile, trim):
        yield from _slab(stations, (form.grown(low), form.grown(high)), angles)


def _slabs(profile: Profile, trim: float) -> Iterator[_Slab]:
    """Stations and heights of the cuts' inner approximation, each slab of the right half followed by its mirror image."""
    for (here, there), (low, high) in _right(profile, 0.5 * single(length(profile)) - trim):
        yield (here, there), (low, high)
        if there > -here:
            yield (-there, -here), (high, low)


def _right(profile: Profile, half: float) -> Iterator[_Slab]:
    """Slabs of the middle and of the right half, by tangents at arc midpoints."""
    if isinstance(profile, Straight):
        yield (-half, half), (0.0, 0.0)
        return
    if isinstance(profile, Contour):
        yield from _chords(profile, half)
        return
    along = single(profile.along if isinstance(profile, Elliptic) else profile.radius)
    across = single(profile.across if isinstance(profile, Elliptic) else profile.radius)
    straight = 0.5 * single(profile.length) - along if isinstance(profile, Filleted) else 0.0
    if straight > 0.0:
        yield (-straight, straight), (0.0, 0.0)
    step = 2.0 * np.arccos(max(0.0, 1.0 - SAGITTA / max(along, across)))
    angles = np.linspace(0.0, 0.5 * np.pi, int(np.clip(np.ceil(0.5 * np.pi / step), 4, MOST // 2)) + 1)
    for begin, end in pairwise(angles):
        here, there = straight + along * np.sin(begin), min(half, straight + along * np.sin(end))
        if there <= here:
            continue
        middle = 0.5 * (begin + end)
        slope = across * np.sin(middle) / (along * np.cos(middle))
        at, height = straight + along * np.sin(middle), across * (1.0 - np.cos(middle))
        yield (here, there), (max(0.0, height + slope * (here - at)), max(0.0, height + slope * (there - at)))


def _chords(contour: Contour, half: float) -> Iterator[_Slab]:
    """Chords between stations up to `half`, each lowered to the contour."""
    for start, end in pairwise(contour.knots):
        samples = np.linspace(start, end, 4 * MOST + 1)
        bend = float(np.max(np.abs(np.diff(contour.height(samples), 2)))) * (4.0 * MOST) ** 2
        count = int(np.clip(np.ceil(np.sqrt(bend / (8.0 * SAGITTA))), 2, MOST // 2))
        for here, there in pairwise(np.linspace(start, end, count + 1)):
            far = min(half, there)
            if far > here:
                yield (here, far), _below(contour.height(np.linspace(here, far, 9)))


def _below(heights: Array) -> tuple[float, float]:
    """Ends of a straight line below equidistant heights: their chord, lowered, with ends of at least zero."""
    share = np.linspace(0.0, 1.0, len(heights))
    above = float(np.max(heights[0] + (heights[-1] - heights[0]) * share - heights))
    low, high = float(heights[0]) - above, float(heights[-1]) - above
    if low < 0.0:
        return 0.0, float(np.min(heights[1:] / share[1:]))
    return (float(np.min(heights[:-1] / (1.0 - share[:-1]))), 0.0) if high < 0.0 else (low, high)
