"""The 6x6 of every distinct hinge of a stage, as a solid by itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from flexstage.base.digest import digest
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.number import Array
from flexstage.mechanism.drawn import drawn
from flexstage.mechanism.expand import PlacedLink, expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.rod import Rod
from flexstage.readings.solid.estimate import Accuracy
from flexstage.readings.solid.hinge_cache import HingeForm, HingePart, kept_hinges
from flexstage.readings.solid.parts import Ways
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS
from flexstage.studies.solid_read import STANDARD_WAYS, Notice

if TYPE_CHECKING:
    from flexstage.readings.solid.hinge import HingeSolid

_MOST_STUB = 0.9

Hinges: TypeAlias = "Callable[[Mapping[str, HingeForm]], Mapping[str, HingeSolid]]"
"""Computes hinges by name: plainly, or from a cache and telling its progress."""


@dataclass(frozen=True, eq=False)
class SolidHinge:
    """A distinct hinge: its `part` by name, the drawn `links` that are like it, and its 6x6 about its centre in the link frame."""

    part: str
    links: tuple[str, ...]
    form: HingePart
    material: Material
    found: HingeSolid

    @property
    def compliance(self) -> Matrix:
        """C (6, 6) with names and units."""
        return Matrix(self.found.compliance, COMPONENTS, FORCES, ratio_units(TWIST_UNITS, WRENCH_UNITS))

    @property
    def errors(self) -> Array:
        """Relative errors estimated of the direct compliances (6,) about the centre."""
        return np.maximum(self.found.error, np.where(np.isfinite(self.found.changes), self.found.changes, 0.0))

    @property
    def separable(self) -> tuple[bool, ...]:
        """Whether each direct compliance can be told from that of the stubs beside the hinge: they have at most 90 % of the whole.

        In torsion a wide notch is stiffer than its stubs, which are taken off as beams held from warping (Vlasov): a small difference of
        two larger numbers, and beams are too rough for it.
        """
        whole, own = (np.diag(each) for each in (self.found.whole, self.found.compliance))
        return tuple(bool(value) for value in own >= (1.0 - _MOST_STUB) * whole)

    @property
    def stiffness(self) -> Matrix:
        """K (6, 6) with names and units."""
        return Matrix(self.found.stiffness, FORCES, COMPONENTS, ratio_units(WRENCH_UNITS, TWIST_UNITS))


def hinges(accuracy: float = 0.01, order: int | None = None, ways: Ways = STANDARD_WAYS, notice: Notice | None = None) -> Hinges:
    """Hinges computed to an accuracy with elements of at most an `order` (never less than three), each once, side by side, by `ways`.

    >>> hinges().__name__
    'compute'
    """
    asked = Accuracy(error=accuracy) if order is None else Accuracy(error=accuracy, orders=(2, max(3, order)))

    def compute(forms: Mapping[str, HingeForm]) -> Mapping[str, HingeSolid]:
        return kept_hinges(forms, asked, ways, notice)

    return compute


STANDARD_HINGES = hinges()
"""To 1 %, by the cache of the user."""


def distinct_hinges(mechanism: Mechanism) -> dict[str, tuple[HingePart, Material, tuple[str, ...]]]:
    """Form, material and drawn links of every distinct hinge, by the name of its part (or of the copy that departs from it).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> {name: links for name, (_, _, links) in distinct_hinges(double_triangle()).items()}["lever_notch"]
    ('vertical/pivot',)
    """
    shape = drawn(mechanism)
    found: dict[str, tuple[str, list[PlacedLink]]] = {}
    for link in expand(shape).links.values():
        if isinstance(link.part, (Notch, Neck, Leaf, Rod)) and link.material is not None:
            key = f"{digest(link.part, physics=True)} {digest(link.material, physics=True)}"
            name = link.link.part if link.part == shape.parts[link.link.part] else link.name
            found.setdefault(key, (name, []))[1].append(link)
    return {name: _hinge(links) for name, links in found.values()}


def _hinge(links: list[PlacedLink]) -> tuple[HingePart, Material, tuple[str, ...]]:
    first = links[0]
    assert isinstance(first.part, (Notch, Neck, Leaf, Rod))  # noqa: S101  distinct_hinges has asked
    assert first.material is not None  # noqa: S101
    return first.part, first.material, tuple(dict.fromkeys(link.drawn for link in links))


def solid_hinges(mechanism: Mechanism, compute: Hinges = STANDARD_HINGES) -> dict[str, SolidHinge]:
    """Compute the 6x6 of every distinct notch, neck, leaf and rod.

    Raises `DesignError` where a stage has none.

    >>> solid_hinges(Mechanism("bare"))
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: links: none of them is a notch, neck, leaf or rod. Only these have a 6x6 that can be computed.
    """
    found = distinct_hinges(mechanism)
    if not found:
        raise refuse("links", "none of them is a notch, neck, leaf or rod", "Only these have a 6x6 that can be computed")
    solved = compute({name: (form, material) for name, (form, material, _) in found.items()})
    return {name: SolidHinge(name, links, form, material, solved[name]) for name, (form, material, links) in found.items()}
