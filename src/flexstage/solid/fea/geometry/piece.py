"""Pieces: the parts and bodies of a stage as single solids, each with its medium, before drawing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array, Number
from flexstage.base.register import Register
from flexstage.base.storage.digest import digest
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink
from flexstage.parts.body import Cylinder, PlacedSolid, Solid
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.material import Material, Oriented
from flexstage.parts.part import Part, Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.shape import Shaped
from flexstage.spatial.frame import Frame

_DIGITS = 10
"""Digits to which a crystal's tensor is rounded, relative to its largest entry, so that instances of a unit have equal tensors."""

_CROSSED = 1e-9
"""Largest coupling of normal and shear strains that is attributed to rounding, divided by the largest entry."""

MILLIMETRES = 1e3
"""CAD units per metre."""

OFFERED_SHAPES: Register[object] = Register("flexstage.shapes", {})
"""Shapes from other packages, without the shapes of `draw`; the versions of these packages are available without the CAD kernel."""

Form: TypeAlias = Shaped | Solid
"""Description of a shape; compliance matrices and ideal joints have no form."""


@dataclass(frozen=True)
class Medium:
    """An elastic medium: Young's modulus [Pa], Poisson's ratio, density [kg/m^3].

    For a crystal, `tensor` contains the rows of its stiffness [Pa] in the axes of the drawing (xx, yy, zz, yz, xz, xy, engineering shear
    strains). `young` is then the modulus along x, and `poisson` is such that `shear` is the geometric mean of the shear moduli of the
    planes xy and xz. Only hinge stubs use these two values.
    """

    young: float
    poisson: float
    density: float
    tensor: tuple[tuple[float, ...], ...] | None = None

    @property
    def shear(self) -> float:
        """Shear modulus G = E / (2 (1 + nu)) [Pa].

        >>> Medium(260.0, 0.3, 1.0).shear
        100.0
        """
        return self.young / (2.0 * (1.0 + self.poisson))

    @property
    def lame(self) -> float:
        """First Lame constant E nu / ((1 + nu) (1 - 2 nu)) [Pa].

        >>> Medium(1.0, 0.25, 1.0).lame
        0.4
        """
        return self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson))


@dataclass(frozen=True, eq=False)
class Piece:
    """One solid to draw: its address (`B1/front`, `platform.plate`), form, medium and frame.

    The form of a link is drawn along x, with its centre at the origin of `frame`; the solid of a body is drawn about the origin of `frame`.
    `body` is the name of the body, or None for a link.
    """

    name: str
    form: Form
    medium: Medium
    frame: Frame
    body: str | None = None

    @property
    def owner(self) -> str:
        """Name of the body to which the piece belongs, or of the link."""
        return self.name if self.body is None else self.body

    def within(self, base: Frame) -> Piece:
        """Return the piece in the axes of `base`, rounded so that all instances of a unit have equal pieces."""
        return replace(self, frame=relative_frame(self.frame, base))


def relative_frame(frame: Frame, base: Frame) -> Frame:
    """Return a frame relative to a `base` frame, rounded so that all instances of a unit have equal frames.

    >>> relative_frame(Frame(np.eye(3), np.ones(3)), Frame(np.eye(3), np.array([1.0, 0.0, 0.0]))).position.tolist()
    [0.0, 1.0, 1.0]
    """
    back = np.real(base.rotation).T
    rotation, position = back @ np.real(frame.rotation), back @ (np.real(frame.position) - np.real(base.position))
    return Frame(np.round(rotation, 12) + 0.0, np.round(position, 12) + 0.0)


def medium(material: Material, rotation: Array | None = None) -> Medium:
    """Return the medium of a material; for a crystal, the axes of the drawing are the columns of `rotation` (3, 3) in the stage.

    Without `rotation`, the drawing has the axes of the part for which the crystal is oriented, or the stage's axes for a crystal that is
    not oriented.

    >>> medium(Material(young=200e9, poisson=0.3, density=7750.0)).density
    7750.0
    >>> from flexstage.spatial.frame import axes
    >>> silicon = Material(None, None, 2329.0, c11=165.64e9, c12=63.94e9, c44=79.51e9)
    >>> round(medium(silicon).young / 1e9), round(medium(silicon, axes((1.0, 1.0, 0.0))).young / 1e9)
    (130, 169)
    """
    density = _single(material.density)
    if not material.is_cubic:
        return Medium(_single(material.modulus), _single(material.contraction), density)
    in_stage = np.eye(3) if rotation is None else rotation
    seen = material.tensor if rotation is None and isinstance(material, Oriented) else material.stiffness_tensor(in_stage)
    unit = 10 ** (int(np.log10(np.max(np.real(seen)))) - _DIGITS)
    tensor = np.round(np.real(seen) / unit) * unit + 0.0
    soft = np.linalg.inv(tensor)
    young, shear = float(1.0 / soft[0, 0]), float(1.0 / np.sqrt(soft[4, 4] * soft[5, 5]))
    return Medium(young, 0.5 * young / shear - 1.0, density, tuple(tuple(row) for row in tensor.tolist()))


def is_mirrored(own: Medium, axis: int) -> bool:
    """Return whether a medium is symmetric about the plane normal to an axis (0, 1, 2) of the drawing; true if it is isotropic.

    >>> is_mirrored(Medium(1.0, 0.3, 1.0), 0)
    True
    """
    if own.tensor is None:
        return True
    odd = np.array([(pair.count(axis) % 2) for pair in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))], dtype=bool)
    crossed = np.array(own.tensor)[np.ix_(odd, ~odd)]
    return bool(np.max(np.abs(crossed)) < _CROSSED * own.tensor[0][0])


def stack_medium(stack: Piezo) -> Medium:
    """Return the medium of a stack's ceramic: E = k L / A from axial stiffness k, length L and area A; density from the mass.

    >>> round(stack_medium(Piezo(stroke=1e-4, stiffness=17e6, length=0.162, diameter=0.01, mass=0.1)).young / 1e9, 2)
    35.07
    """
    area = 0.25 * np.pi * _single(stack.diameter) ** 2
    size = _single(stack.length)
    return Medium(_single(stack.stiffness) * size / area, _single(stack.poisson), _single(stack.mass) / (area * size))


def form_of(link: PlacedLink) -> Form | Finding | None:
    """Return the form of a link's part, `None` if the part has a specified stiffness instead of a shape, or an error if it has neither.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> type(form_of(expand(double_triangle()).links["B1/front"])).__name__
    'Neck'
    """
    part: Part = link.part
    if isinstance(part, Restricted):
        return Finding(
            link.name, "some of its DOFs are locked or freed by a restriction", "Use the unrestricted stage: a solid has all DOFs"
        )
    if isinstance(part, Shaped):
        return part
    if not isinstance(part, Joint) and part.stated(link.material) is not None:
        return None
    what = f"a part of kind {part.kind} has neither a shape nor a specified stiffness"
    return Finding(link.name, what, 'Use a part with a shape, or specify its 6x6 compliance matrix (kind = "compliance_matrix")')


def link_forms(assembly: Assembly) -> dict[str, Form]:
    """Return the forms of all links that have one.

    Raises `DesignError` with the names of links that have neither a shape nor a specified stiffness.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> list(link_forms(expand(parallelogram())))[:2]
    ['left', 'right']
    """
    found = {name: form_of(link) for name, link in assembly.links.items()}
    require(form for form in found.values() if isinstance(form, Finding))
    return {name: form for name, form in found.items() if form is not None and not isinstance(form, Finding)}


def link_pieces(assembly: Assembly, forms: Mapping[str, Form], rotation: Array | None = None) -> Iterator[Piece]:
    """Yield the pieces of links, in the stage; `rotation` is that of the drawing, for crystals (see `medium`)."""
    for name, form in forms.items():
        link = assembly.links[name]
        if isinstance(form, Piezo):
            yield Piece(name, form, stack_medium(form), link.frame)
        elif link.material is not None:
            yield Piece(name, form, medium(link.material, rotation), link.frame)


def body_pieces(
    body: str, solids: Mapping[str, PlacedSolid], materials: Mapping[str, Material], rotation: Array | None = None
) -> Iterator[Piece]:
    """Yield the pieces of a body, in the stage; `rotation` is that of the drawing, for crystals (see `medium`)."""
    for name, placed in solids.items():
        yield Piece(name, placed.solid, medium(materials[placed.solid.material], rotation), placed.frame, body)


def form_digest(form: Form) -> str:
    """Return the digest of a form. If another package draws the form, the digest includes the package's name and version.

    >>> from flexstage.parts.body import Block
    >>> form_digest(Block("steel", (1.0, 1.0, 1.0))) == form_digest(Block("steel", (1.0, 1.0, 2.0)))
    False
    """
    return digest(form, physics=True) + (OFFERED_SHAPES.offer(form.kind) if isinstance(form, Shaped) else "")


def span(form: Form) -> float:
    """Return the length of a link's form between its end faces [m].

    >>> from flexstage.parts.profile import Circular
    >>> from flexstage.parts.notch import Notch
    >>> span(Notch("steel", 1e-3, 1e-2, Circular(5e-3)))
    0.01
    """
    return _single(form.span if isinstance(form, Shaped) else form.sides[..., 0])


def end_area(form: Form) -> float:
    """Return the area of a link form's end faces [m^2].

    >>> from flexstage.parts.profile import Straight
    >>> from flexstage.parts.neck import Neck
    >>> round(end_area(Neck("steel", 2e-3, Straight(1e-2), width=3e-3)) * 1e6, 9)
    6.0
    """
    if isinstance(form, Cylinder):
        return 0.25 * np.pi * (_single(form.diameter) ** 2 - (0.0 if form.bore is None else _single(form.bore) ** 2))
    if isinstance(form, Solid):
        return _single(form.sides[..., 1]) * _single(form.sides[..., 2])
    return _single(form.end.area)


def thinnest(form: Form) -> float:
    """Return the smallest dimension of a form [m], which sets the local mesh size.

    >>> from flexstage.parts.body import Block
    >>> thinnest(Block("steel", (0.1, 0.02, 0.03)))
    0.02
    """
    return _single(form.thinnest if isinstance(form, Solid) else form.throat.thinnest)


def _single(value: Number) -> float:
    """One design's number; batches have no single solid."""
    return float(np.real(value))


def millimetres(value: object) -> float:
    """Convert a length of one design to CAD units."""
    return _single(value) * MILLIMETRES  # type: ignore[arg-type]


def coordinates(point: Any) -> Array:
    """Return the coordinates (3,) of a point of the CAD kernel or of a mesh [mm]."""
    return np.array([point.x, point.y, point.z])
