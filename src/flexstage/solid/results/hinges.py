"""6x6 compliance matrix of every distinct hinge of a stage, by finite elements of the isolated hinge with the roots it has in the stage.

A root is the elastic block to which an end of the hinge is attached. The compliance of the roots belongs to the hinge, because models with
rigid bodies contain no other compliance of the blocks. A part used with different roots counts as several hinges.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, TypeAlias

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW
from flexstage.base.storage.digest import digest
from flexstage.base.units.quantity import RATIO
from flexstage.mechanism.assembly.expand import PlacedLink, expand
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.hinges.hinge_form import NO_ESTIMATE, HingeForm, HingeSolid
from flexstage.solid.fea.hinges.roots import Roots, roots_of
from flexstage.solid.fea.jobs.hinge_cache import hinges_from_cache
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.solid.results.read import STANDARD_WAYS
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS, mirror

_MOST_STUB = 0.9

Hinges: TypeAlias = Callable[[Mapping[str, HingeForm]], Mapping[str, HingeSolid]]
"""Function that returns the 6x6 compliance matrices of hinges by name: computed, or from a cache with progress reports."""


@dataclass(frozen=True, eq=False)
class DistinctHinge:
    """A distinct hinge: `shared` is the name of its part, `form` is its input for FEA, `links` are the drawn links with this hinge."""

    shared: Annotated[str, INNER]
    form: Annotated[HingeForm, INNER]
    links: tuple[str, ...]

    @property
    def roots(self) -> Annotated[Roots, VIEW]:
        """Roots: the ends that are attached to blocks."""
        return self.form.roots


@dataclass(frozen=True, eq=False)
class SolidHinge(DistinctHinge, InNotebook):
    """A distinct hinge with its computed compliance between the ends of its arcs; the compliance is about its centre, in the link frame."""

    found: Annotated[HingeSolid, INNER]

    @property
    def compliance(self) -> Annotated[Matrix, VIEW]:
        """Compliance matrix C (6, 6) with names and units."""
        return Matrix(self.found.compliance, COMPONENTS, FORCES, ratio_units(TWIST_UNITS, WRENCH_UNITS))

    @property
    def stiffness(self) -> Annotated[Matrix, VIEW]:
        """Stiffness matrix K (6, 6) with names and units."""
        return Matrix(self.found.stiffness, FORCES, COMPONENTS, ratio_units(WRENCH_UNITS, TWIST_UNITS))

    @property
    def separable(self) -> Annotated[tuple[bool, ...], VIEW]:
        """Whether each direct compliance is separable: at least 10 % of the direct compliance of hinge and stubs together.

        The solid contains stubs (pieces of the blocks) next to the hinge. The compliance of the stubs by beam theory with restrained
        warping (Vlasov) is subtracted. In torsion, a wide notch is stiffer than its stubs. The result is then a small difference of two
        large numbers, for which beam theory of the stubs is too inaccurate.
        """
        whole, own = (np.diag(each) for each in (self.found.whole, self.found.compliance))
        return tuple((own >= (1.0 - _MOST_STUB) * whole).tolist())

    @property
    def error(self) -> Annotated[float | None, RATIO]:
        """Largest estimated relative error of any entry of the compliance at the hinge's end; null if unknown."""
        return self.found.error if np.isfinite(self.found.error) else None

    @property
    def errors(self) -> Annotated[Array | None, RATIO]:
        """Estimated relative errors (6,) of the direct compliances about the centre; null if unknown."""
        if self.error is None:
            return None
        return np.maximum(self.error, np.where(np.isfinite(self.found.changes), self.found.changes, 0.0))

    @property
    def reasons(self) -> Mapping[str, str]:
        """Reasons for unknown errors."""
        return {} if self.error is not None else dict.fromkeys(("error", "errors"), NO_ESTIMATE)

    @property
    def order(self) -> Annotated[int, VIEW]:
        """Polynomial order of the elements in the last solution."""
        return self.found.order

    @property
    def elements(self) -> Annotated[int, VIEW]:
        """Number of finite elements."""
        return self.found.elements

    @property
    def freedoms(self) -> Annotated[int, VIEW]:
        """Number of unknowns."""
        return self.found.freedoms


def hinges(accuracy: float = 0.01, order: int | None = None, ways: Ways = STANDARD_WAYS) -> Hinges:
    """Return a function that computes compliance matrices of hinges to a relative accuracy, with elements up to this `order` (at least 3).

    `ways` specifies cache, progress and processes. Every hinge is computed once, in parallel with the other hinges.
    """
    required = accuracy_of(accuracy, order)
    return lambda forms: hinges_from_cache(forms, required, ways)


def accuracy_of(accuracy: float, order: int | None) -> Accuracy:
    """Return the accuracy requirements of hinges: the relative error, and the element orders up to `order` (at least three).

    >>> accuracy_of(0.01, 2).orders
    (2, 3)
    """
    return Accuracy(error=accuracy) if order is None else Accuracy(error=accuracy, orders=(2, max(3, order)))


STANDARD_HINGES = hinges()
"""Function that computes the compliance matrices of hinges to 1 %, with the user's cache."""


def distinct_hinges(mechanism: Mechanism) -> dict[str, DistinctHinge]:
    """Return every distinct hinge of a stage, by name.

    A hinge has the name of its part, or `part-link` if hinges of the part have different ends (elastic or rigid). A hinge of a link that
    overrides values of its part has the name of the link.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = distinct_hinges(double_triangle())
    >>> list(found), found["lever_notch"].links
    (['neck-back', 'neck-front', 'foot_notch-back', 'foot_notch-front', 'lever_notch', 'pole_neck'], ('vertical/pivot',))
    """
    shape = with_drawn_parts(mechanism)
    assembly = expand(shape)
    alike: dict[str, tuple[HingeForm, list[PlacedLink]]] = {}
    for link in assembly.links.values():
        if isinstance(link.part, Shaped) and link.material is not None:
            form = HingeForm(link.part, link.material, roots_of(assembly, link))
            whole = "" if link.of is None else link.link.part
            key = f"{digest(form.part, physics=True)} {digest(form.material, physics=True)} {form.roots} {whole}"
            alike.setdefault(key, (form, []))[1].append(link)
    everything = [links for _, links in alike.values()]
    return {
        _name(shape, links, everything): DistinctHinge(links[0].link.part, form, tuple(dict.fromkeys(link.drawn for link in links)))
        for form, links in alike.values()
    }


def _name(shape: Mechanism, links: list[PlacedLink], everything: list[list[PlacedLink]]) -> str:
    first = links[0]
    if first.described.part != shape.parts[first.link.part]:
        return first.name
    others = [each[0] for each in everything if each is not links and each[0].link.part == first.link.part]
    same = [other for other in others if other.described.part == first.described.part]
    if not same:
        return first.link.part
    unit, _, link = first.drawn.rpartition("/")
    clear = all(other.drawn.rpartition("/")[2] != link for other in same)
    return f"{first.link.part}-{link if clear else f'{unit}-{link}'}"


@check_arguments
def solid_hinges(mechanism: Mechanism, compute: Hinges = STANDARD_HINGES) -> dict[str, SolidHinge]:
    """Compute the 6x6 compliance matrix of every distinct drawn hinge.

    Raises `DesignError` if the stage has no hinge with a shape.

    >>> solid_hinges(Mechanism("bare"))
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: links: no hinge has a shape. Use notches, necks, leaves or rods.
    """
    found = distinct_hinges(mechanism)
    require_hinges(found)
    solved = compute(turned_forms(found))
    return {name: as_drawn(each, solved[name]) for name, each in found.items()}


def require_hinges(found: Mapping[str, DistinctHinge]) -> None:
    """Raise a `DesignError` if a stage has no drawn hinge.

    >>> require_hinges({})
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: links: no hinge has a shape. Use notches, necks, leaves or rods.
    """
    if not found:
        raise refuse("links", "no hinge has a shape", "Use notches, necks, leaves or rods")


def as_drawn(hinge: DistinctHinge, solved: HingeSolid) -> SolidHinge:
    """Transform the result `solved` of FEA with an input from `turned_forms` to the orientation of the drawn hinge."""
    return SolidHinge(hinge.shared, hinge.form, hinge.links, _turn_back(solved, hinge.form))


def turned_forms(found: Mapping[str, DistinctHinge]) -> dict[str, HingeForm]:
    """Return the inputs of FEA for hinges, by name. A hinge with a block only at its first end gets exchanged ends, unless it is a crystal.

    >>> turned_forms({})
    {}
    """
    return {name: _turn(hinge.form) for name, hinge in found.items()}


def _is_turned(form: HingeForm) -> bool:
    """Whether a hinge has a root at its first end only: it is computed with exchanged ends; not for a crystal."""
    return form.roots.first and not form.roots.second and not form.material.is_cubic


def _turn(form: HingeForm) -> HingeForm:
    return form._replace(roots=form.roots.mirrored) if _is_turned(form) else form


def _turn_back(found: HingeSolid, form: HingeForm) -> HingeSolid:
    if not _is_turned(form):
        return found
    across = mirror(0)  # hinges are symmetric except for their roots
    compliance, stiffness, whole = (across @ each @ across for each in (found.compliance, found.stiffness, found.whole))
    return replace(found, compliance=compliance, stiffness=stiffness, whole=whole)
