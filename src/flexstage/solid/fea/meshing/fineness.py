"""Options of a solid model: fineness and order of the mesh, element sizes, and number of modes in each component.

This module does not load the solver.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding
from flexstage.parts.section import Rectangle
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.geometry.piece import MILLIMETRES, Piece, span, thinnest

ATTEMPTS = ((1.0, 1.0, 1.0), (1.0, 0.7, 1.0), (0.8, 1.0, 1.0), (1.0, 1.0, 1.4), (0.85, 0.6, 1.0), (0.7, 0.7, 1.4), (0.5, 0.8, 1.0))
"""Variations of the mesh that are tried if the mesher fails: factors on all sizes, on grading and on segments per radius of curvature."""


_NOTCH = 5.0 / 3.0
"""Size of elements in notches, which have one order more, divided by the size of elements on the faces of other hinges."""
_STRUT = 0.4
"""Factor on the element size for straight necks: elements as wide as thick, at low cost."""
THIN = 35.0
"""A leaf or notch whose width and length exceed this multiple of its thickness is thin: its elements are flat and have one order more."""
_FLAT = 2.0 / 9.0
"""Size of elements in thin parts, divided by the smaller of width and length: strains vary slowly along the faces."""
_MIDDLE, _SMOOTH = 0.7, 0.25
"""Size of elements in the middle plane of a notch, where the strain gradient is largest, over that on the faces of other hinges; in thin
notches over the geometric mean of radius and thickness."""
_MOST = 3e5
"""Largest number of elements in one link."""
WARPS = 12
"""Number of linear and quadratic motions of an interface face, without the rigid motions."""


@dataclass(frozen=True)
class Fineness(CheckedFields):
    """Element sizes, and polynomial `order` of the elements' displacements and curved shapes.

    In notches and thin leaves, the order is higher by one. On the faces of a link, the element size is `neck` times the smallest thickness;
    on the faces of a body, it is `block` times the smallest dimension. `grading` is the growth of the element size away from small elements
    (from 0.1, slow, to 0.9, fast).
    """

    neck: float = 1.5
    block: float = 1.5
    grading: float = 0.8
    order: int = 3


class Hold(Enum):
    """Motion of faces between elastic bodies: a twist plus linear and quadratic warps, or free motion with a prescribed mean twist."""

    RIGID = "rigid"
    AVERAGED = "averaged"


@dataclass(frozen=True)
class Reduction(CheckedFields):
    """Options of a component's reduction: mesh, element order, number of fixed-interface modes, and constraint of the interface faces.

    With `residual`, the basis also includes static displacements. They are computed with fixed interface faces, under the inertia forces
    that the motions of these faces cause. The static displacements replace the omitted modes to first order in frequency squared.
    Components with a content digest in `raised` have elements one order higher than the other components. With `static`, the `raised`
    components have no modes, because static results do not need them.
    """

    fineness: Fineness = Fineness()
    modes: int = 12
    hold: Hold = Hold.RIGID
    residual: bool = False
    raised: frozenset[str] = frozenset()
    static: bool = False

    def of(self, content: str) -> Reduction:
        """Return the options of the component with the digest `content`.

        >>> own = Reduction(raised=frozenset({"lever"}), static=True).of("lever")
        >>> own.fineness.order, own.modes
        (4, 0)
        """
        more = content in self.raised
        modes, finer = 0 if more and self.static else self.modes, replace(self.fineness, order=self.fineness.order + more)
        return replace(self, fineness=finer, modes=modes, raised=frozenset(), static=False)


def is_leaf(form: object) -> bool:
    """Return whether a form is a leaf: its section is rectangular, and it is thin along its whole length.

    >>> from flexstage.parts.leaf import Leaf
    >>> is_leaf(Leaf("steel", 0.01, 1e-3, 5e-3))
    True
    """
    return isinstance(form, Shaped) and form.slender and not form.bends_both_ways and isinstance(form.throat, Rectangle)


def is_notch(form: object) -> bool:
    """Return whether a form is a hinge with arcs that is neither axisymmetric nor slender; strain varies smoothly in this hinge.

    >>> from flexstage.parts.leaf import Leaf
    >>> is_notch(Leaf("steel", 0.01, 1e-3, 5e-3))
    False
    """
    return isinstance(form, Shaped) and form.has_arc and not (form.is_axisymmetric or form.slender)


def is_thin(form: object) -> bool:
    """Return whether a form is a leaf or notch wider and longer than 35 times its thickness; only thin forms have flat elements.

    >>> from flexstage.parts.leaf import Leaf
    >>> [is_thin(Leaf("steel", 0.04, 1e-3, width)) for width in (0.03, 0.04)]
    [False, True]
    """
    return (is_leaf(form) or is_notch(form)) and isinstance(form, Shaped) and _short(form) > THIN * thinnest(form)


def _short(form: Shaped) -> float:
    """The smaller of width and length [m]."""
    return min(float(np.real(form.throat.width)), span(form))


def is_strut(form: object) -> bool:
    """Return whether a form is a neck of constant section, whose end blocks are wider than the neck.

    >>> from flexstage.parts.leaf import Leaf
    >>> is_strut(Leaf("steel", 0.01, 1e-3, 5e-3))
    False
    """
    return isinstance(form, Shaped) and form.is_prismatic and not form.slender and form.bends_both_ways


def element_size(piece: Piece, fineness: Fineness) -> float:
    """Return the size of elements [m] on the faces of a piece.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> round(element_size(bar().pieces[0], Fineness(block=1.5)), 9)
    0.015
    """
    form = piece.form
    if piece.body is not None:
        return fineness.block * thinnest(form)
    if isinstance(form, Shaped) and is_thin(form):
        return fineness.neck * _FLAT * _short(form)
    return (_STRUT if is_strut(form) else _NOTCH if is_notch(form) else 1.0) * fineness.neck * thinnest(form)


def middle_size(form: Shaped, neck: float) -> float:
    """Return the size of elements [m] around the thinnest line of a notch.

    >>> from flexstage.parts.notch import Notch
    >>> from flexstage.parts.profile import Circular
    >>> middle_size(Notch("steel", 1e-3, 1e-2, Circular(1e-3)), 1.0)
    0.0007
    """
    return _SMOOTH * neck * float(np.sqrt(0.5 * span(form) * thinnest(form))) if is_thin(form) else _MIDDLE * neck * thinnest(form)


def thin_findings(pieces: Iterable[Piece], fineness: Fineness) -> Iterator[Finding]:
    """Yield an error for each link that is too thin to be meshed over its length and width.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> list(thin_findings(bar().pieces, Fineness()))
    []
    """
    for piece in pieces:
        form = piece.form
        if piece.body is not None or not isinstance(form, Shaped):
            continue
        size = middle_size(form, fineness.neck) if is_notch(form) and is_thin(form) else element_size(piece, fineness)
        sides = sorted((span(form), *(float(np.real(side)) for side in (form.end.height, form.end.width))))
        count = sides[1] * sides[2] / size**2
        if count > _MOST:
            over = " x ".join(f"{side * MILLIMETRES:.4g}" for side in (sides[2], sides[1]))
            what = f"its thickness of {thinnest(form) * MILLIMETRES:.3g} mm is too small to mesh over {over} mm"
            more = f"it needs about {count:.1g} elements of {size * MILLIMETRES:.3g} mm (at most {_MOST:.1g} allowed)"
            yield Finding(piece.name, f"{what}: {more}", "Check the thickness, or use larger elements (Fineness.neck)")
