"""Linear-elastic materials: isotropic, or crystals of cubic symmetry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from functools import reduce
from typing import Annotated

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number, Vector
from flexstage.base.storage.digest import DOCUMENT_ONLY, Description
from flexstage.base.units.quantity import (
    DENSITY,
    DIRECTION,
    EXPANSION,
    MODULUS,
    NOT_NEGATIVE,
    POISSON_RANGE,
    POSITIVE,
    PRESSURE,
    RATIO,
)
from flexstage.spatial.frame import axes

_AGREES = 0.01
"""Tolerance between Poisson's ratio as specified and from both moduli, relative to 1 + nu: moduli have two or three digits."""
_CUBIC = ("c11", "c12", "c44")


@dataclass(frozen=True, eq=False)
class Material(Description):
    """Linear-elastic material.

    An isotropic material has `young` [Pa], and `poisson` [-] or `shear_modulus` [Pa] (or both, if consistent). A crystal of cubic symmetry
    has `c11`, `c12`, `c44` [Pa] instead. `crystal` gives the crystal directions along the stage's x and z axes (default: 100 and 001).

    `density` [kg/m^3] is required. Optional values are `expansion` [1/K], `loss_factor` [-], and the stress limits `yield_stress`,
    `fatigue_limit`, `allowable_stress` [Pa]. The least of these stress limits governs.

    >>> Material(young=200e9, poisson=0.25, density=7750.0).shear
    80000000000.0
    """

    young: Annotated[Number, MODULUS, POSITIVE] | None
    poisson: Annotated[Number, RATIO, POISSON_RANGE] | None
    density: Annotated[Number, DENSITY, NOT_NEGATIVE]
    yield_stress: Annotated[Number, PRESSURE, POSITIVE] | None = None
    expansion: Annotated[Number, EXPANSION] | None = None
    loss_factor: Annotated[Number, RATIO, NOT_NEGATIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)
    shear_modulus: Annotated[Number, MODULUS, POSITIVE] | None = None
    fatigue_limit: Annotated[Number, PRESSURE, POSITIVE] | None = None
    allowable_stress: Annotated[Number, PRESSURE, POSITIVE] | None = None
    c11: Annotated[Number, MODULUS, POSITIVE] | None = None
    c12: Annotated[Number, MODULUS] | None = None
    c44: Annotated[Number, MODULUS, POSITIVE] | None = None
    crystal: tuple[Annotated[Vector, DIRECTION], Annotated[Vector, DIRECTION]] | None = None

    @property
    def modulus(self) -> Number:
        """Young's modulus [Pa]; NaN for a crystal, because its modulus depends on the direction (see `oriented`)."""
        return np.nan if self.young is None else self.young

    @property
    def shear(self) -> Number:
        """Shear modulus [Pa]: as specified, or G = E / (2 (1 + nu))."""
        return self.modulus / (2.0 * (1.0 + self.contraction)) if self.shear_modulus is None else self.shear_modulus

    @property
    def contraction(self) -> Number:
        """Poisson's ratio: as specified, or nu = E / (2 G) - 1."""
        if self.poisson is not None:
            return self.poisson
        return np.nan if self.shear_modulus is None else self.modulus / (2.0 * self.shear_modulus) - 1.0

    @property
    def twist_ratio(self) -> Number:
        """Young's modulus divided by twice the shear modulus, for warping torsion; 1 + Poisson's ratio for an isotropic material."""
        return 1.0 + self.contraction

    @property
    def shear_across(self) -> Number | None:
        """Shear modulus [Pa] in the x-y plane, which may differ from the modulus in the x-z plane; `None` for an isotropic material."""
        return None

    @property
    def is_cubic(self) -> bool:
        """Whether the material is a cubic crystal."""
        return any(getattr(self, name) is not None for name in _CUBIC)

    @property
    def limits(self) -> dict[str, Number]:
        """Specified stress limits [Pa], by name."""
        stated = {"yield stress": self.yield_stress, "fatigue limit": self.fatigue_limit, "allowable stress": self.allowable_stress}
        return {name: limit for name, limit in stated.items() if limit is not None}

    @property
    def limit(self) -> Number | None:
        """Least specified stress limit [Pa]; `None` if none is specified.

        >>> Material(young=200e9, poisson=0.3, density=7750.0, yield_stress=1e9, fatigue_limit=4e8).limit.item()
        400000000.0
        """
        stated = list(self.limits.values())
        return reduce(lambda one, other: np.where(np.real(one) <= np.real(other), one, other)[()], stated) if stated else None

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors in the combination of elastic constants, by field."""
        yield from self._cubic_faults() if self.is_cubic else self._isotropic_faults()

    def _isotropic_faults(self) -> Iterator[Finding]:
        if self.young is None or (self.poisson is None and self.shear_modulus is None):
            missing, example = ("poisson", "poisson = 0.3") if self.young is not None else ("young", 'young = "200 GPa"')
            what = "elastic constants incomplete (expected young and one of poisson and shear_modulus, or c11, c12 and c44)"
            yield Finding(missing, what, f"Use e.g. {example}")
        elif self.shear_modulus is not None:
            result = np.real(self.young) / (2.0 * np.real(self.shear_modulus)) - 1.0
            apart = 0.0 if self.poisson is None else np.abs(result - np.real(self.poisson)) / (1.0 + np.real(self.poisson))
            first = float(np.ravel(result)[0])
            if np.any(result <= -1.0) or np.any(result >= 0.5):
                yield Finding(
                    "shear_modulus",
                    f"young and shear_modulus give an invalid Poisson's ratio (got {first:.4g}, expected -1 to 0.5)",
                    "Correct young or shear_modulus",
                )
            elif np.any(apart > _AGREES):
                stated = float(np.ravel(np.real(self.contraction))[0])
                what = f"young and shear_modulus give the Poisson's ratio {first:.4g}, but poisson is {stated:.4g}"
                yield Finding("shear_modulus", what, "Specify two of young, poisson and shear_modulus, or three consistent values")

    def _cubic_faults(self) -> Iterator[Finding]:
        missing = [name for name in _CUBIC if getattr(self, name) is None]
        if missing:
            yield Finding(missing[0], f"a crystal of cubic symmetry requires {', '.join(_CUBIC)}", "Specify all three")
            return
        double = [name for name in ("young", "poisson", "shear_modulus") if getattr(self, name) is not None]
        if double:
            yield Finding(
                double[0], "redundant: c11, c12 and c44 determine it for each direction", f"Remove {double[0]}, or remove c11, c12 and c44"
            )
        c11, c12, _ = (np.real(each) for each in self._constants)
        if np.any(c11 <= np.abs(c12)) or np.any(c11 + 2.0 * c12 <= 0.0):
            yield Finding("c11", "unstable crystal (expected c11 > |c12| and c11 + 2 c12 > 0)", "Check c11, c12 and c44")

    @property
    def _constants(self) -> tuple[Array, Array, Array]:
        c11, c12, c44 = (np.asarray(np.nan if each is None else each) for each in (self.c11, self.c12, self.c44))
        return c11, c12, c44

    def oriented(self, rotation: Array) -> Material:
        """Return the material in the axes of a part: x along the part, z along its width.

        The columns of `rotation` (..., 3, 3) are the part's axes in the stage's frame. Isotropic materials are returned unchanged.

        A cubic crystal has the compliance S = C^-1 and the anisotropy J = S11 - S12 - S44/2. For an axis with components n1, n2, n3 in the
        crystal, Young's modulus E is given by 1/E = S11 - 2 J (n1^2 n2^2 + n2^2 n3^2 + n3^2 n1^2). With the components m1, m2, m3 of a
        second axis and q = n1^2 m1^2 + n2^2 m2^2 + n3^2 m3^2, Poisson's ratio is -E (S12 + J q), and the shear modulus G is given by 1/G =
        S44 + 4 J q (Nye 1957; Hopcroft, Nix & Kenny, J. MEMS 19 (2010) 229-238).

        Beams along x use Young's modulus along x and the shear moduli of the planes xy and xz. For wide leaves, Poisson's ratio in the
        plate modulus E / (1 - nu^2) is -S13 / (S11 S33)^(1/2), with the compliance S in the axes of the part. In directions other than 100,
        110 and 111, tension and bending are coupled with shear and twist; the returned material omits this coupling.
        """
        if not self.is_cubic:
            return self
        c11, c12, c44 = self._constants
        s11 = (c11 + c12) / ((c11 - c12) * (c11 + 2.0 * c12))
        s12 = -c12 / ((c11 - c12) * (c11 + 2.0 * c12))
        s44 = 1.0 / c44
        excess = s11 - s12 - 0.5 * s44
        square = self._lattice(rotation) ** 2
        own = s11[..., None] - excess[..., None] * (1.0 - np.sum(square * square, axis=-2))
        mixed = [np.sum(square[..., :, 0] * square[..., :, axis], axis=-1) for axis in (1, 2)]
        across, plane = (1.0 / (s44 + 4.0 * excess * each) for each in mixed)
        return Oriented(
            young=1.0 / own[..., 0],
            poisson=-(s12 + excess * mixed[1]) / np.sqrt(own[..., 0] * own[..., 2]),
            shear_modulus=plane,
            other_shear=across,
            tensor=self.stiffness_tensor(_right_handed(rotation)),
            **{name: getattr(self, name) for name in _KEPT},
        )

    def stiffness_tensor(self, rotation: Array) -> Array:
        """Compute the stiffness (..., 6, 6) [Pa] of a crystal in other axes: the columns of `rotation` (..., 3, 3), in the stage's frame.

        The order is xx, yy, zz, yz, xz, xy, with engineering shear strains. The stiffness tensor C_ijkl follows from component i of crystal
        axis a, q_ai, and from the Kronecker delta d_ij (Nye 1957):

        C_ijkl = C12 d_ij d_kl + C44 (d_ik d_jl + d_il d_jk) + (C11 - C12 - 2 C44) sum_a q_ai q_aj q_ak q_al.

        >>> silicon = Material(None, None, 2329.0, c11=165.64e9, c12=63.94e9, c44=79.51e9)
        >>> (silicon.stiffness_tensor(axes((1.0, 1.0, 0.0))).diagonal()[[0, 2, 5]] / 1e9).round(2).tolist()
        [194.3, 165.64, 50.85]
        """
        c11, c12, c44 = (each[..., None, None] for each in self._constants)
        lattice = self._lattice(rotation)
        pairs = lattice[..., :, _FIRST] * lattice[..., :, _SECOND]
        isotropic = c12 * _VOLUME + c44 * np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])
        return isotropic + (c11 - c12 - 2.0 * c44) * (pairs.mT @ pairs)

    def turned(self, rotation: Array) -> Material:
        """Return the material for another stage, with its crystal directions rotated.

        The columns of `rotation` (..., 3, 3) are the axes of the present stage, in the axes of the other stage.

        >>> silicon = Material(None, None, 2329.0, c11=166e9, c12=64e9, c44=80e9)
        >>> silicon.turned(np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])).crystal
        ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
        """
        if not self.is_cubic or np.array_equal(rotation, np.eye(3)):
            return self
        lattice = self._lattice(rotation.mT)
        along, up = (tuple(np.moveaxis(lattice[..., :, axis], -1, 0).tolist()) for axis in (0, 2))
        return replace(self, crystal=(along, up))

    def _lattice(self, rotation: Array) -> Array:
        """Axes (..., 3, 3), from columns in the stage to columns in the crystal."""
        along, up = ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)) if self.crystal is None else self.crystal
        return axes(along, up) @ rotation


_FIRST, _SECOND = (0, 1, 2, 1, 0, 0), (0, 1, 2, 2, 2, 1)
_VOLUME: Array = np.pad(np.ones((3, 3)), (0, 3))


def _right_handed(rotation: Array) -> Array:
    """Right-handed axes, y from z and x, for links in mirrored instances."""
    x, y, z = np.moveaxis(rotation, -1, 0)
    hand = np.sign(np.real(np.linalg.det(rotation)))[..., None]
    return np.stack([x, hand * y, z], axis=-1)


_KEPT = ("density", "yield_stress", "expansion", "loss_factor", "source", "fatigue_limit", "allowable_stress", *_CUBIC, "crystal")


@dataclass(frozen=True, eq=False)
class Oriented(Material):
    """Cubic crystal in the axes of a part: `young` along x, `poisson` for a plate, `shear_modulus` in plane xz and `other_shear` in xy."""

    other_shear: Annotated[Number, MODULUS, POSITIVE] = np.nan
    tensor: Array = field(default_factory=lambda: np.full((6, 6), np.nan))

    @property
    def twist_ratio(self) -> Number:
        """Young's modulus divided by twice the shear modulus of the x-z plane, for warping torsion of a leaf."""
        return self.modulus / (2.0 * self.shear)

    @property
    def shear_across(self) -> Number:
        """Shear modulus in the x-y plane [Pa]."""
        return self.other_shear


@dataclass(frozen=True, eq=False)
class Paired(Material):
    """Material of a part together with `counter`, the material of its contact partner."""

    counter: Material = field(default_factory=lambda: _NOTHING)

    @classmethod
    def of(cls, material: Material, counter: Material) -> Paired:
        """Return a part's material paired with the material of its contact partner."""
        return cls(**{each.name: getattr(material, each.name) for each in fields(Material)}, counter=counter)


_NOTHING = Material(None, None, 0.0)
