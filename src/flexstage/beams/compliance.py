"""Compliance, stiffness and part law by beam theory, about the part's centre and in its link frame.

Both ends are rigidly extended to the centre. The compliance times the wrench on the second end is the twist of the second end minus the
twist of the first end. Wrench and twists are about the centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Array, first_design
from flexstage.base.session import SESSION
from flexstage.base.storage.digest import keep
from flexstage.beams import LAWS
from flexstage.beams.beam import Beam
from flexstage.beams.fixed_end_modes import FixedEndModes, join
from flexstage.beams.law import PartLaw
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import ALL, Freedom, others
from flexstage.parts.material import Material
from flexstage.parts.part import Elastic, Part, Restricted, inner, material_of

_SINGULAR = 1e-12
"""Relative stiffness below which a specified stiffness is singular (rounding)."""
_NAMED = 1e-6
_EVERY: Array = np.arange(6)


@dataclass(frozen=True, eq=False)
class Law:
    """Stiffness and constraints of a link: `stiffness` (..., 6, 6), with zeros for free and locked DOFs, and the `locked` DOFs.

    `inner` (..., m) [1/s^2] are the squared angular frequencies of m mass-normalised fixed-end modes (default: no modes). These modes are
    additional coordinates of the lumped model. The mass matrix of the link has the shape (..., 12 + m, 12 + m): first the motions of both
    ends, then the modes.
    """

    stiffness: Array
    locked: tuple[Freedom, ...] = ()
    inner: Array | None = None


def compliance(part: Elastic, material: Material | None) -> Array:
    """Compute the compliance (..., 6, 6) of a part about its centre in SI units, with rows and columns (x, y, z, rx, ry, rz).

    The matrix is diagonal, except for parts with a specified matrix. Notches, necks, leaves and rods need a `material`.

    Raises `DesignError` if the material is missing, or if the part has a specified stiffness that is singular (no compliance exists).

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> from flexstage.parts.rod import Rod
    >>> compliance(Rod("steel", length=0.1, diameter=0.002), steel).shape
    (6, 6)
    """
    part_law, specified = _law_of(part), _stated(part, material)
    if specified is not None:
        return np.linalg.inv(_regular(part, specified))
    return _diagonal_matrix(_diagonal(part, material)) if part_law.compliance is None else part_law.compliance(part)


def stiffness(part: Elastic, material: Material | None) -> Array:
    """Compute the stiffness (..., 6, 6) of a part about its centre: as specified, or the inverse of its compliance.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> from flexstage.parts.rod import Rod
    >>> rod = Rod("steel", length=0.1, diameter=0.002)
    >>> bool(np.allclose(stiffness(rod, steel) @ compliance(rod, steel), np.eye(6)))
    True
    """
    part_law, specified = _law_of(part), _stated(part, material)
    if specified is not None:
        return specified
    if part_law.compliance is not None:
        return np.linalg.inv(part_law.compliance(part))
    return _diagonal_matrix(1.0 / _diagonal(part, material))


def law(part: Part, material: Material | None) -> Law:
    """Compute the stiffness and the locked DOFs of any part.

    A `Joint` has no stiffness and locks all DOFs that are not free. Ordinary parts lock nothing.

    For a `Restricted` part, the stiffness matrix K, the inverse of the compliance, is reduced: rows and columns of locked DOFs become zero.
    Free DOFs f are condensed: the stiffness of the elastic DOFs e is K_ee - K_ef K_ff^-1 K_fe, with the blocks of K. Free DOFs that have no
    stiffness need no condensation.

    >>> law(Joint((Freedom.RZ,)), None).locked == others((Freedom.RZ,))
    True
    """
    if isinstance(part, Joint):
        return Law(np.zeros((6, 6)), locked_freedoms(part))
    if not isinstance(part, Restricted):
        modes = fixed_end_modes(part, material)
        return Law(stiffness(part, material), inner=join(mode.squares for mode in modes) if modes else None)
    full = stiffness(part.part, material)
    kept, freed = _indices(part.elastic), _stiff_among(_indices(part.free), full)
    block = full[..., kept[:, None], kept]
    if len(freed) and len(kept):
        mixed = full[..., kept[:, None], freed]
        block = block - mixed @ np.linalg.solve(_regular(part.part, full[..., freed[:, None], freed], freed), mixed.mT)
    result = np.zeros_like(full)
    result[..., kept[:, None], kept] = block
    return Law(result, locked_freedoms(part))


def viscous_damping(part: Part) -> Array | None:
    """Return the viscous damping (..., 6, 6) [N s/m] of a part about its centre, or `None` if the part has none.

    The result for a restricted part contains only the damping of its elastic DOFs.

    >>> from flexstage.parts.voice_coil import VoiceCoil
    >>> viscous_damping(VoiceCoil(force_constant=10.0, damping=2.0)).diagonal().tolist()
    [2.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """
    part_law = law_of(part)
    damping = None if part_law is None or part_law.damping is None else part_law.damping(inner(part))
    if damping is None:
        return None
    kept: Array = np.array([freedom in part.elastic for freedom in ALL]) if isinstance(part, Restricted) else np.ones(6, dtype=bool)
    own = np.where(kept[:, None] & kept, damping, 0.0)
    return own if np.any(own) else None


@SESSION.keep(32)
def fixed_end_modes(part: Elastic, material: Material | None) -> tuple[FixedEndModes, ...]:
    """Compute the lowest fixed-end modes of a part at the stations of its beam; their number is the part's `inner_modes`.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> from flexstage.parts.leaf import Leaf
    >>> [mode.axis for mode in fixed_end_modes(Leaf("steel", length=0.1, thickness=0.001, width=0.01, inner_modes=2), steel)]  # y, about x
    [1, 3]
    """
    part_law = law_of(part)
    if part.inner_modes == 0 or part_law is None or part_law.fixed_end_modes is None:
        return ()
    half = first_design(np.real(beam_of(part, material).points.position), 1)
    return part_law.fixed_end_modes(part, _required_material(part, material), np.concatenate([-half, half]) / half[-1])


def locked_freedoms(part: Part) -> tuple[Freedom, ...]:
    """Return the DOFs that a part locks."""
    if isinstance(part, Joint):
        return others(part.free)
    return others(part.elastic + part.free) if isinstance(part, Restricted) else ()


def law_of(part: Part) -> PartLaw | None:
    """Return the law for the kind of a part, or `None` if there is none. For a restricted part, return the law of the part inside."""
    return LAWS.get(inner(part).kind)


@keep
def beam_of(part: Part, material: Material | None) -> Beam:
    """Build the straight beam of a part; raises `DesignError` if the material is missing or the kind has no beam.

    >>> from flexstage.parts.piezo import Piezo
    >>> beam_of(Piezo(stroke=1e-4, stiffness=1e7, length=0.1, diameter=0.01), None).section.is_axisymmetric
    True
    """
    part_law = _law_of(part)
    if part_law.beam is None:
        raise _unknown(part)
    return part_law.beam(part, _required_material(part, material) if part_law.needs_material else material)


def _law_of(part: Part) -> PartLaw:
    part_law = law_of(part)
    if part_law is None:
        raise _unknown(part)
    return part_law


def _stated(part: Elastic, material: Material | None) -> Array | None:
    """The stiffness of a part whose law specifies a stiffness instead of a compliance."""
    part_law = _law_of(part)
    if part_law.material_stiffness is not None:
        return part_law.material_stiffness(part, _required_material(part, material))
    return None if part_law.stiffness is None else part_law.stiffness(part)


def _unknown(part: Part) -> DesignError:
    what = "no beam theory for this kind"
    advice = f'Install a package with a law for this kind ({LAWS.group}), or specify a 6x6 compliance matrix (kind = "compliance_matrix")'
    return refuse(f"a part of kind {inner(part).kind}", what, advice)


@SESSION.keep(32)
def _diagonal(part: Elastic, material: Material | None) -> Array:
    own = _law_of(part).diagonal
    return beam_of(part, material).diagonal() if own is None else own(part, _required_material(part, material))


def _required_material(part: Part, material: Material | None) -> Material:
    if material is None:
        where = f"{inner(part).kind} of {material_of(part)}"
        raise refuse(where, "material missing for the stiffness", f"Pass the material {material_of(part)}")
    return material


def _regular(part: Elastic, specified: Array, freedoms: Array = _EVERY) -> Array:
    """A non-singular stiffness (..., k, k) in some DOFs: NaN for singular designs; raises if the first design is singular."""
    size = np.sqrt(np.max(np.abs(np.real(specified)), axis=-1))
    size = np.where(size > 0.0, size, 1.0)
    _, values, motions = np.linalg.svd(np.real(specified) / size[..., :, None] / size[..., None, :])
    none = np.asarray(values <= _SINGULAR * values[..., :1])
    if np.any(first_design(none, 1)):
        moved = np.max(np.abs(first_design(motions, 2)[first_design(none, 1)]), axis=0) > _NAMED
        names = ", ".join(ALL[index].value for index in freedoms[moved])
        what = f"singular stiffness in {names}, so that the compliance does not exist"
        raise refuse(f"a part of kind {part.kind}", what, "Specify this stiffness, or use the lumped model, which needs no compliance")
    return np.where(np.any(none, axis=-1, keepdims=True)[..., None], np.nan, specified)


def _stiff_among(freedoms: Array, stiffness: Array) -> Array:
    """The given DOFs in which any design has stiffness."""
    rows = np.any(np.real(stiffness[..., freedoms, :]) != 0.0, axis=-1)
    return freedoms[np.any(rows, axis=tuple(range(rows.ndim - 1)))]


def _diagonal_matrix(diagonal: Array) -> Array:
    return diagonal[..., None] * np.eye(6)


def _indices(freedoms: Sequence[Freedom]) -> Array:
    return np.array([freedom.index for freedom in freedoms], dtype=int)
