"""Front door: compliance, stiffness and law of any part by beam theory, about its centre and in its link frame.

Both ends are rigidly extended to the centre. Compliance takes the wrench at the centre on the second end to the relative twist, second
minus first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.beams.beam import Beam
from flexstage.beams.given import given_compliance
from flexstage.beams.leaf import leaf_beam, leaf_diagonal
from flexstage.beams.neck import neck_beam
from flexstage.beams.notch import notch_beam
from flexstage.beams.piezo import piezo_beam
from flexstage.beams.rod import rod_beam
from flexstage.parts.freedom import Freedom, others
from flexstage.parts.given import Given, Joint
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Elastic, Part, Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.rod import Rod


@dataclass(frozen=True, eq=False)
class Law:
    """What a link does between its bodies: `stiffness` (..., 6, 6), zero in free and locked rows, and the `locked` freedoms."""

    stiffness: Array
    locked: tuple[Freedom, ...] = ()


def compliance(part: Elastic, material: Material | None) -> Array:
    """Compliance (..., 6, 6) of a part about its centre, rows (x, y, z, rx, ry, rz), SI; diagonal but for a `Given` part.

    `material` is needed by notches, necks, leaves and rods. Raises `DesignError` if it is missing.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> compliance(Rod("steel", length=0.1, diameter=0.002), steel).shape
    (6, 6)
    """
    return given_compliance(part) if isinstance(part, Given) else _diagonal_matrix(_diagonal(part, material))


def stiffness(part: Elastic, material: Material | None) -> Array:
    """Stiffness (..., 6, 6) of a part about its centre, the inverse of its compliance.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> rod = Rod("steel", length=0.1, diameter=0.002)
    >>> bool(np.allclose(stiffness(rod, steel) @ compliance(rod, steel), np.eye(6)))
    True
    """
    if isinstance(part, Given):
        return np.linalg.inv(given_compliance(part))
    return _diagonal_matrix(1.0 / _diagonal(part, material))


def law(part: Part, material: Material | None) -> Law:
    """The law of any part.

    A `Joint` has no stiffness and locks what is not free. A `Restricted` part starts from K = C^-1: locked rows and columns are deleted,
    freed ones condensed out, K_ee - K_ef K_ff^-1 K_fe. Ordinary parts lock nothing.

    >>> law(Joint((Freedom.RZ,)), None).locked == others((Freedom.RZ,))
    True
    """
    if isinstance(part, Joint):
        return Law(np.zeros((6, 6)), locked(part))
    if not isinstance(part, Restricted):
        return Law(stiffness(part, material))
    full = stiffness(part.part, material)
    kept, freed = _indices(part.elastic), _indices(part.free)
    block = full[..., kept[:, None], kept]
    if len(freed) and len(kept):
        mixed = full[..., kept[:, None], freed]
        block = block - mixed @ np.linalg.solve(full[..., freed[:, None], freed], np.swapaxes(mixed, -1, -2))
    result = np.zeros_like(full)
    result[..., kept[:, None], kept] = block
    return Law(result, locked(part))


def locked(part: Part) -> tuple[Freedom, ...]:
    """The freedoms that a part locks."""
    if isinstance(part, Joint):
        return others(part.free)
    return others(part.elastic + part.free) if isinstance(part, Restricted) else ()


def beam_of(part: Notch | Neck | Leaf | Rod | Piezo, material: Material | None) -> Beam:
    """The part as a straight beam; raises `DesignError` where it needs a material and has none.

    >>> beam_of(Piezo(stroke=1e-4, stiffness=1e7, length=0.1, diameter=0.01), None).section.is_round
    True
    """
    if isinstance(part, Piezo):
        return piezo_beam(part)
    material = _required(part, material)
    if isinstance(part, Notch):
        return notch_beam(part, material)
    if isinstance(part, Neck):
        return neck_beam(part, material)
    return leaf_beam(part, material) if isinstance(part, Leaf) else rod_beam(part, material)


@lru_cache(maxsize=32)
def _diagonal(part: Notch | Neck | Leaf | Rod | Piezo, material: Material | None) -> Array:
    if isinstance(part, Leaf):
        return leaf_diagonal(part, _required(part, material))
    return beam_of(part, material).diagonal()


def _required(part: Notch | Neck | Leaf | Rod, material: Material | None) -> Material:
    if material is None:
        kind = type(part).__name__.lower()
        raise refuse(f"{kind} of {part.material}", "its stiffness was asked for without a material", f"pass the material {part.material}")
    return material


def _diagonal_matrix(diagonal: Array) -> Array:
    return diagonal[..., None] * np.eye(6)


def _indices(freedoms: Sequence[Freedom]) -> Array:
    return np.array([freedom.index for freedom in freedoms], dtype=int)
