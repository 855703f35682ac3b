"""Law of a flexure at large displacements: mode tables, quadratic energy and the few non-quadratic terms.

All quantities are dimensionless: lengths are divided by the flexure's length L, forces by E I / L^2, moments by E I / L, with a reference
rigidity E I.

The centre line is along x of the link frame, y is across the thin side, z along the width. Curvatures are (twist, about y, about z).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.beams.beam import Beam
from flexstage.beams.flexure.modes import FINE, gauss, polynomials, project
from flexstage.beams.flexure.strip import LOADS, STRETCH_FOUR, STRETCH_TWO, fields
from flexstage.beams.flexure.twist import curling_energy, orthonormal, restrained_twist_modes
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.section import Rectangle, Section, cowper_rectangle


@dataclass(frozen=True)
class Resolution(CheckedFields):
    """Discretisation of a flexure: numbers of modes and points.

    `twist`, `across` and `bending` are the numbers of modes in twist, in bending about y, and in bending about z. `fields` are the numbers
    of modes of the plate fields a2 and a4; each mode is the response to a line load. `points` is the number of points along the flexure.
    """

    twist: int = 6
    across: int = 6
    bending: int = 8
    fields: tuple[int, int] = LOADS
    points: int = 10


DEFAULT = Resolution()
STRESSES = Resolution(twist=3, across=4, bending=4)
"""Default resolution for hinges of varying compliance. Moments of degree 0 and 1 are exact at zero load; higher degrees are for loads.
"""


@dataclass(frozen=True, eq=False)
class FlexureLaw:
    """Tables of a flexure (docs/nonlinear.md, 3). The leading axes (...) index flexures with equal numbers of modes.

    - `form` (..., q, q): second derivative of the quadratic energy with respect to the q amplitudes, which are those of k curvature modes,
      then of e plate modes.
    - `modes` (..., n, 3, k): three curvatures due to unit amplitudes, at the n points of the integration rule; `inner` (..., 3 (n + 1), 3,
      k): the same curvatures at the integration points of the rotation steps.
    - `plate` (..., n, 2, e): the plate fields a2 and a4 (bending across the width) due to unit amplitudes, at the n points.
    - `compliance` (..., n, 3): flexibilities in tension and in shear along y and z, times the bending rigidity, divided by L^2.
    - `trapeze` (...): I_p / (A L^2), with the polar second moment I_p and area A of the section, and the length L.
    - `stretch` (..., 2): the stiffnesses against Gaussian curvature, the constants c_2 and c_4 of docs/nonlinear.md, 13.
    - `length` L [m], and bending `rigidity` about z [N m^2]; they make the tables dimensionless.
    - `inertia` (..., n, 4): mass per length and its second moments about x, y and z [kg/m, kg m].
    - `half` (..., 2): half thickness and half width [m].
    - `shearing` (...): largest shear stress, divided by the shear modulus, the twist rate and the half thickness; 2 in a strip, 1 in a
      round section.
    - `natural` (..., 2): natural curvatures about z and across the width, times the length.
    - `rest` (..., q): the negative first derivative of the energy with respect to the amplitudes, due to the natural curvatures.
    """

    length: Array
    rigidity: Array
    form: Array
    modes: Array
    inner: Array
    plate: Array
    compliance: Array
    trapeze: Array
    stretch: Array
    inertia: Array
    half: Array
    shearing: Array
    natural: Array
    rest: Array

    @property
    def line_mass(self) -> Array:
        """Mean mass per length [kg/m]."""
        return self.inertia[..., 0] @ gauss(self.inertia.shape[-2]).weights

    @property
    def signature(self) -> tuple[int, ...]:
        """Numbers of points, curvature modes and plate modes; equal for all flexures of one batch."""
        return (*self.modes.shape[-3:], self.plate.shape[-1])


def leaf_law(part: Leaf, material: Material, resolution: Resolution = DEFAULT, *, warps: bool = False) -> FlexureLaw:
    """Build the law of a leaf with plate action and clamped ends (docs/nonlinear.md, 9 to 13); if `warps`, the ends may warp.

    The law is exact for small strains of a thin leaf, except for two approximations:

    - two shapes across the width: error 0.04 % in bending up to b^2 k / t = 20 (width b, thickness t, curvature k);
    - one warping shape for twist at clamped ends.
    """
    length, thickness, width = (np.asarray(each, dtype=float) for each in (part.length, part.thickness, part.width))
    young, poisson = float(material.modulus), float(material.contraction)
    section = Rectangle(thickness, width, cowper_rectangle(poisson))
    rigidity = np.asarray(young * section.inertia_z)
    rule = gauss(resolution.points)
    twist, twist_form = _leaf_twist(resolution, section, material, length, rigidity, warps=warps)
    size = resolution.twist + resolution.across + resolution.bending
    shapes = fields(float(width / length), float(thickness / length), poisson, rule.size, resolution.fields)
    factor = 1.0 / (1.0 - poisson * poisson)
    form = scipy.linalg.block_diag(
        twist_form,
        _squares(resolution.across) * (section.inertia_y / section.inertia_z),
        _squares(resolution.bending) * factor,
        shapes.form * factor,
    )
    pull = poisson * factor * (shapes.coupling[0] + 10.0 / 3.0 * shapes.coupling[1])[:, : resolution.bending]
    bend = slice(size - resolution.bending, size)
    form[size:, bend], form[bend, size:] = pull, pull.T
    blank, heated = _natural(part, material)
    thermal_gradient = blank * form[:, size - resolution.bending]
    thermal_gradient[size - resolution.bending] += factor * (1.0 + poisson) * heated
    thermal_gradient[size:] += factor * (1.0 + poisson) * heated * (shapes.coupling[0] + 10.0 / 3.0 * shapes.coupling[1])[:, 0]
    modes, inner = _tables([twist, np.eye(resolution.across, rule.size), np.eye(resolution.bending, rule.size)], rule.size)
    ratio = width * width / (thickness * length)
    return FlexureLaw(
        length=length,
        rigidity=rigidity,
        form=form,
        modes=modes,
        inner=inner,
        plate=np.moveaxis(shapes.values, (0, 1, 2), (1, 2, 0)),
        compliance=_spread(_force_compliance(section, material, rigidity / length**2), rule.size),
        trapeze=np.asarray(section.polar / section.area / length**2),
        stretch=12.0 * ratio * ratio * np.array([STRETCH_TWO, STRETCH_FOUR]),
        inertia=_spread(_inertia(section, float(material.density)), rule.size),
        half=0.5 * np.stack([thickness, width]),
        shearing=np.asarray(2.0),
        natural=np.array([blank + heated, heated]),
        rest=thermal_gradient,
    )


def _natural(part: Leaf, material: Material) -> tuple[float, float]:
    """Natural curvatures times the length: of the blank, and of a warmer face at +y, which bends both ways (docs/nonlinear.md, 30)."""
    blank = 0.0 if part.curvature is None else float(part.curvature)
    if part.face_temperature_difference is None:
        return blank * float(part.length), 0.0
    if material.expansion is None:
        what = "thermal expansion missing (a leaf has a face temperature difference)"
        raise refuse(part.material, what, "Specify the expansion, or remove face_temperature_difference")
    return blank * float(part.length), -float(material.expansion * part.face_temperature_difference / part.thickness * part.length)


def natural_curvature(part: Leaf, material: Material) -> float:
    """Compute the curvature about z of a free leaf [1/m], due to its initial curvature and its face temperature difference.

    >>> natural_curvature(Leaf("steel", 0.1, 0.001, 0.01, curvature=2.0), Material(young=200e9, poisson=0.3, density=7750.0))
    2.0
    """
    return sum(_natural(part, material)) / float(part.length)


def beam_law(part: Beam, resolution: Resolution = STRESSES, *, flat: bool = False, curvature: float = 0.0) -> FlexureLaw:
    """Build the law of a part with a `Beam`; its modes are polynomial moments (docs/nonlinear.md, 14).

    Each curvature is a moment times the flexibility of the section. At zero load, the law gives the 6x6 stiffness matrix of the beam. With
    `flat`, the section is assumed to be thin: twist stretches its fibres far from the axis (Wagner effect). `curvature` is the natural
    curvature about z [1/m].
    """
    places, weights, flexibility, inertia = _whole(part)
    length = np.sum(weights)
    weights, places = weights / length, places / length + 0.5
    rigidity = 1.0 / (weights @ flexibility[:, 5])
    counts = (resolution.twist, resolution.across, resolution.bending)
    size = resolution.points
    relative = flexibility * rigidity / np.array([length**2] * 3 + [1.0] * 3)
    shapes = [relative[:, 3 + axis] * polynomials(count, places) for axis, count in enumerate(counts)]
    forms = [shape * weights @ polynomials(count, places).T for shape, count in zip(shapes, counts, strict=True)]
    modes, inner = _tables([project(shape, places, weights, size) for shape in shapes], size)
    points = polynomials(size, gauss(size).points)
    compliance = (project(relative[:, :3].T, places, weights, size) @ points).T
    section = part.section
    thickness, width, polar, area = (float(np.min(each)) for each in (section.height, section.width, section.polar, section.area))
    wagner = 12.0 * (width * width / (thickness * length)) ** 2 * STRETCH_TWO if flat else 0.0
    return FlexureLaw(
        length=length,
        rigidity=rigidity,
        form=scipy.linalg.block_diag(*forms),
        modes=modes,
        inner=inner,
        plate=np.zeros((size, 2, 0)),
        compliance=compliance,
        trapeze=np.asarray(polar / area / length**2),
        stretch=np.array([wagner, 0.0]),
        inertia=(project(inertia[:, [0, 3, 4, 5]].T, places, weights, size) @ points).T,
        half=0.5 * np.array([thickness, width]),
        shearing=np.asarray(2.0 - section.is_axisymmetric),
        natural=np.array([curvature * length, 0.0]),
        rest=curvature * length * np.eye(sum(counts))[sum(counts[:2])],
    )


def _whole(part: Beam) -> tuple[Array, Array, Array, Array]:
    """Positions about the centre, weights, flexibility and inertia of both halves of a beam, of one design."""
    position, weight = np.ravel(part.points.position), np.ravel(part.points.rate * part.points.rule.weights)
    flexibility, inertia = (np.broadcast_to(each, (len(position), 6)) for each in (part.flexibility, part.inertia))
    weights, flexibility, inertia = (np.concatenate([each[::-1], each]) for each in (weight, flexibility, inertia))
    return np.concatenate([-position[::-1], position]), weights, flexibility, inertia


def _leaf_twist(
    resolution: Resolution, section: Section, material: Material, length: Array, rigidity: Array, *, warps: bool
) -> tuple[Array, Array]:
    """Coefficients (k, n) of the twist modes, and their quadratic form (docs/nonlinear.md, 9)."""
    torsion = float(material.shear) * section.torsion / rigidity
    count, fine = resolution.twist, gauss(FINE)
    if warps:
        return np.eye(count, resolution.points), torsion * _squares(count)
    warping = float(material.modulus) * (0.0 if section.warping is None else section.warping) / (rigidity * length * length)
    modes = orthonormal(restrained_twist_modes(count, fine.points, 0.5 * np.sqrt(torsion / warping)), fine.weights)
    plate = 1.0 / (1.0 - float(material.contraction) ** 2)
    curled = curling_energy(float(section.width / length), float(material.contraction), modes)
    form = torsion * _product(modes.values, fine.weights) + plate * (warping * _product(modes.slopes, fine.weights) - curled)
    return project(modes.values, fine.points, fine.weights, resolution.points), form


def _product(values: Array, weights: Array) -> Array:
    return values * weights @ values.T


def _squares(count: int) -> Array:
    """Integrals of the squared polynomials."""
    return np.diag(1.0 / (2.0 * np.arange(count) + 1.0))


def _tables(coefficients: list[Array], size: int) -> tuple[Array, Array]:
    """Curvatures (n, 3, k) at the points and (3 (n + 1), 3, k) at the rotation steps, of modes about x, y and z."""
    rule = gauss(size)
    total, done = sum(len(each) for each in coefficients), 0
    curvatures = np.zeros((size + len(rule.inner), 3, total))
    at = polynomials(size, np.concatenate([rule.points, rule.inner]))
    for axis, each in enumerate(coefficients):
        curvatures[:, axis, done : done + len(each)] = (each @ at).T
        done += len(each)
    return curvatures[:size], curvatures[size:]


def _force_compliance(section: Section, material: Material, scale: Array) -> Array:
    along = 1.0 / (float(material.modulus) * section.area)
    lateral = section.shear / (float(material.shear) * section.area)
    across = lateral if material.shear_across is None else lateral * float(material.shear) / float(material.shear_across)
    return scale * np.array([along, across, lateral])


def _inertia(section: Section, density: float) -> Array:
    return density * np.array([section.area, section.polar, section.inertia_y, section.inertia_z])


def _spread(row: Array, size: int) -> Array:
    return np.broadcast_to(row, (size, len(row)))
