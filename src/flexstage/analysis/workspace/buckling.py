"""Buckling of the whole stage, and Euler load of every slender part, at the worst corner of the stroke range."""

from __future__ import annotations

from enum import Enum
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.loaded.stability import Stability, stability
from flexstage.analysis.workspace.load import SAFETY
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.analysis.workspace.wrench import corner_wrenches
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, index_of_largest, stack
from flexstage.base.record import INNER, VIEW, Along, Heading, Layout
from flexstage.base.units.quantity import RATIO
from flexstage.beams.compliance import law_of
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, PlacedSuperelement, expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.parts.piezo import Piezo
from flexstage.parts.shape import Shaped

_ROUNDING = 1e-9


class Ends(Enum):
    """End conditions of a column, which determine its effective length: P = pi^2 E I / (effective length)^2."""

    GUIDED = "guided"
    """Both ends clamped, one end free to move sideways (a flexure between blocks): effective length L."""
    PINNED = "pinned"
    """Both ends pinned (a stack between two hinges): effective length L, from hinge to hinge."""
    FREE = "free"
    """One end clamped, the other end free (a body on a single flexure): effective length 2 L."""


class Buckling(Result):
    """Euler load `critical` [N], largest `compression` [N] over the strokes (negative: tension) and `length` [m] of each link (..., L).

    `ends` lists the assumed end conditions of each column. `stage` is the buckling of the whole stage: its end conditions are exact, and
    columns and bodies can buckle together.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Buckling of single parts",
        "table ends",
        head="part",
        notes=("Euler load of each part with the listed end conditions, or its torsional buckling load if lower.",),
    )

    links: tuple[str, ...]
    critical: Annotated[Array, Heading("critical load", digits=4)]
    compression: Annotated[Array, Heading(digits=4)]
    length: Array
    ends: Annotated[tuple[Ends, ...], Along("links")]
    provenance: str
    stage: Stability

    @property
    def factor(self) -> Annotated[Array, INNER, Heading("load factor", digits=4, infinite="in tension", mark=SAFETY)]:
        """Critical load divided by compression (..., L); infinite for parts in tension."""
        pressed = self.compression > 0.0
        return np.where(pressed, self.critical / np.where(pressed, self.compression, 1.0), np.inf)

    @property
    def min_factor(self) -> Annotated[Array, RATIO]:
        """Load factor of the whole stage for the worst strokes; for a batch, one factor per design."""
        return self.stage.worst

    @property
    def weakest(self) -> Annotated[str | None, VIEW]:
        """Link with the least Euler load factor in the first design; None if no column is in compression."""
        if not self.links:
            return None
        first = 1.0 / self.factor.reshape(-1, len(self.links))[0]
        return self.links[int(index_of_largest(first))] if np.any(first > 0.0) else None

    @property
    def table(self) -> Annotated[Matrix, VIEW]:
        """Table of the links (rows) with compression, critical load and load factor."""
        values = np.stack([self.compression, self.critical, self.factor], axis=-1)
        return Matrix(values, self.links, ("compression", "critical", "factor"), (("N", "N", "1"),) * len(self.links))


def buckling(mechanism: Mechanism, model: LinearModel, limits: StrokeLimits) -> Buckling:
    """Compute Euler loads of slender parts, and their largest compression over the corners of the strokes under permanent load.

    Slender parts are leaves, rods, notches, necks and stacks. The Euler load is P = pi^2 E I / L_e^2, with the least second moment of the
    thinnest section assumed over the whole length. The load of notched hinges is thus underestimated. If the torsional buckling load is
    lower, it replaces the Euler load. The load factor of the whole stage is computed with the actual end conditions. Compressions below
    1e-9 of the largest force in any part are rounding errors and count as zero.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> from flexstage.analysis.workspace.stroke import stroke_limits
    >>> stage = double_triangle()
    >>> bool(buckling(stage, lumped(stage), stroke_limits(stage)).min_factor > 10.0)
    True
    """
    assembly = expand(mechanism)
    whole = stability(mechanism, model, limits)
    columns = {name: _column(assembly, link) for name, link in assembly.links.items() if _is_column(link)}
    wrenches = corner_wrenches(mechanism, model, limits, tuple(columns))
    rigidity = stack([column[0] for column in columns.values()])
    length_ = stack([column[1] for column in columns.values()])
    ends = tuple(column[2] for column in columns.values())
    twisting = stack([_twisting_load(assembly.links[name]) for name in columns])
    effective = length_ * np.array([2.0 if end is Ends.FREE else 1.0 for end in ends])
    compression = np.max(-wrenches[..., 0], axis=0)
    largest = np.max(np.abs(wrenches[..., :3]), axis=(0, -2, -1), initial=0.0)
    compression = np.where(np.abs(compression) > _ROUNDING * largest[..., None], compression, 0.0)
    critical = np.broadcast_to(np.minimum(np.pi**2 * rigidity / effective**2, twisting), compression.shape)
    return Buckling(tuple(columns), critical, compression, np.broadcast_to(length_, compression.shape), ends, model.provenance, whole)


def _is_column(link: PlacedLink) -> bool:
    return isinstance(link.part, Shaped)


def _column(assembly: Assembly, link: PlacedLink) -> tuple[Number, Number, Ends]:
    """Least bending rigidity [N m^2], length [m] and ends of a part as a column."""
    part = link.part
    if isinstance(part, Piezo):
        return stack_rigidity(part), _strut_length(assembly, link, part), Ends.PINNED
    alone = any(body != GROUND and len(_links_at(assembly, body)) == 1 for body in link.joins)
    young = np.nan if link.material is None else link.material.modulus
    assert isinstance(part, Shaped)  # noqa: S101  _is_column has asked
    return young * part.throat.least_inertia, part.span, Ends.FREE if alone else Ends.GUIDED


def _twisting_load(link: PlacedLink) -> Number:
    """Torsional buckling load of the section, if its law specifies one."""
    known = law_of(link.part)
    if known is None or known.twisting_load is None or link.material is None:
        return np.inf
    return known.twisting_load(link.part, link.material)


def stack_rigidity(piezo: Piezo) -> Number:
    """Return the bending rigidity E I of a stack [N m^2]: the specified value or, by default, k L d^2 / 16.

    The stack has the stiffness k, the length L, the diameter d and the section A; its modulus is E = k L / A.

    >>> round(stack_rigidity(Piezo(stroke=1e-4, stiffness=16e6, length=0.1, diameter=0.01)), 9)
    10.0
    """
    if piezo.bending_rigidity is not None:
        return piezo.bending_rigidity
    return piezo.stiffness * piezo.length * piezo.diameter**2 / 16.0


def _strut_length(assembly: Assembly, link: PlacedLink, piezo: Piezo) -> Array:
    """Length between the hinges at both ends of a stack; the stack's own end at a neighbour with several links."""
    axis = link.frame.rotation[..., :, 0] * 0.5 * np.asarray(piezo.length)[..., None]
    ends: list[Array] = []
    for body, own in zip(link.joins, (link.frame.position - axis, link.frame.position + axis), strict=True):
        others = [other for other in _links_at(assembly, body) if other.name != link.name]
        inner = body not in {GROUND, PLATFORM} and len(others) == 1
        ends.append(others[0].joints(body)[0] if inner else own)
    return np.sqrt(np.sum((ends[1] - ends[0]) ** 2, axis=-1))


def _links_at(assembly: Assembly, body: str) -> list[PlacedLink | PlacedSuperelement]:
    return [link for link in (*assembly.links.values(), *assembly.superelements.values()) if body in link.joins]
