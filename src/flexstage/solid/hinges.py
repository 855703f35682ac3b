"""The 6x6 of every distinct hinge of a stage, as a solid by itself, with the roots it has in the stage.

The roots are part of a hinge: what a block yields where a hinge grows out of it no model with rigid bodies has anywhere else. A part that
is used with different roots is as many hinges.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from flexstage.base.digest import digest
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.number import Array
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.expand import PlacedLink, expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.piezo import Piezo
from flexstage.parts.rod import Rod
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.estimate import Accuracy
from flexstage.solid.fea.hinge_cache import HingeForm, HingePart, kept_hinges
from flexstage.solid.fea.parts import Ways
from flexstage.solid.fea.roots import Roots, roots_of
from flexstage.solid.read import STANDARD_WAYS, Notice
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS, mirror

if TYPE_CHECKING:
    from flexstage.solid.fea.hinge import HingeSolid

_MOST_STUB = 0.9

Hinges: TypeAlias = "Callable[[Mapping[str, HingeForm]], Mapping[str, HingeSolid]]"
"""Computes hinges by name: plainly, or from a cache and telling its progress."""


@dataclass(frozen=True, eq=False)
class DrawnHinge:
    """A distinct hinge: the `shared` part that it is, its form, and the drawn `links` that are like it."""

    shared: str
    form: HingeForm
    links: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class SolidHinge:
    """A distinct hinge by its name, as `drawn`, and its 6x6 about its centre in the link frame."""

    name: str
    drawn: DrawnHinge
    found: HingeSolid

    @property
    def links(self) -> tuple[str, ...]:
        """The drawn links that are like it."""
        return self.drawn.links

    @property
    def form(self) -> HingePart:
        """The part."""
        return self.drawn.form.part

    @property
    def material(self) -> Material:
        """Its material."""
        return self.drawn.form.material

    @property
    def roots(self) -> Roots:
        """Which of its ends grow on blocks."""
        return self.drawn.form.roots

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
    """Hinges computed to an accuracy with elements of at most an `order` (never less than three), each once, side by side, by `ways`."""
    asked = Accuracy(error=accuracy) if order is None else Accuracy(error=accuracy, orders=(2, max(3, order)))

    def compute(forms: Mapping[str, HingeForm]) -> Mapping[str, HingeSolid]:
        return kept_hinges(forms, asked, ways, notice)

    return compute


STANDARD_HINGES = hinges()
"""To 1 %, by the cache of the user."""


def distinct_hinges(mechanism: Mechanism) -> dict[str, DrawnHinge]:
    """Every distinct hinge of a stage.

    It is called as its part is; where that has different roots at different links, `part-link`; a copy that departs, by its link's name.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = distinct_hinges(double_triangle())
    >>> list(found), found["lever_notch"].links
    (['neck-back', 'neck-front', 'foot_notch-back', 'foot_notch-front', 'lever_notch', 'pole_neck'], ('vertical/pivot',))
    """
    shape = with_drawn_parts(mechanism)
    assembly = expand(shape)
    found: dict[str, list[PlacedLink]] = {}
    for link in assembly.links.values():
        if isinstance(link.part, (Notch, Neck, Leaf, Rod)) and link.material is not None:
            key = f"{digest(link.part, physics=True)} {digest(link.material, physics=True)} {roots_of(assembly, link)}"
            found.setdefault(key, []).append(link)
    alike = list(found.values())
    return {_called(shape, links, alike): _hinge(links, roots_of(assembly, links[0])) for links in alike}


def unknown_hinges(mechanism: Mechanism) -> dict[str, str]:
    """Why parts that are drawn have no 6x6 as a solid by themselves, by part: how their kind is held between blocks is not known."""
    parts = {link.link.part: link.part for link in expand(with_drawn_parts(mechanism)).links.values()}
    odd = {name: part for name, part in parts.items() if isinstance(part, Shaped) and not isinstance(part, (Notch, Neck, Leaf, Rod, Piezo))}
    return {name: f"the 6x6 of a part of kind {part.kind} as a solid by itself is not known" for name, part in odd.items()}


def _called(shape: Mechanism, links: list[PlacedLink], everything: list[list[PlacedLink]]) -> str:
    first = links[0]
    if first.part != shape.parts[first.link.part]:
        return first.name
    others = [each[0] for each in everything if each is not links and each[0].link.part == first.link.part]
    same = [other for other in others if other.part == first.part]
    if not same:
        return first.link.part
    unit, _, link = first.drawn.rpartition("/")
    clear = all(other.drawn.rpartition("/")[2] != link for other in same)
    return f"{first.link.part}-{link if clear else f'{unit}-{link}'}"


def _hinge(links: list[PlacedLink], roots: Roots) -> DrawnHinge:
    first = links[0]
    assert isinstance(first.part, (Notch, Neck, Leaf, Rod))  # noqa: S101  distinct_hinges has asked
    assert first.material is not None  # noqa: S101
    return DrawnHinge(first.link.part, HingeForm(first.part, first.material, roots), tuple(dict.fromkeys(link.drawn for link in links)))


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
    solved = compute({name: _turned(hinge.form)[0] for name, hinge in found.items()})
    return {name: SolidHinge(name, hinge, _back(solved[name], turned=_turned(hinge.form)[1])) for name, hinge in found.items()}


def _turned(form: HingeForm) -> tuple[HingeForm, bool]:
    """A hinge that grows on a block at its first end only is the one that does so at its second, turned end for end."""
    turned = form.roots.first and not form.roots.second
    return (form._replace(roots=form.roots.mirrored), True) if turned else (form, False)


def _back(found: HingeSolid, *, turned: bool) -> HingeSolid:
    if not turned:
        return found
    across = mirror(0)  # hinges are symmetric but for their roots
    compliance, stiffness, whole = (across @ each @ across for each in (found.compliance, found.stiffness, found.whole))
    return replace(found, compliance=compliance, stiffness=stiffness, whole=whole)
