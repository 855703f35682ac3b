"""Springs without a drawn shape, specified by stiffness (also negative): coil springs, magnets, cables, membranes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar, TypeAlias

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number, stack
from flexstage.base.storage.digest import DOCUMENT_ONLY
from flexstage.base.units.quantity import (
    FORCE,
    LENGTH,
    MASS,
    NOT_NEGATIVE,
    POSITIVE,
    RATIO,
    ROTATIONAL_STIFFNESS,
    STIFFNESS,
    STIFFNESS_MATRIX,
)
from flexstage.parts.freedom import ALL, Freedom
from flexstage.parts.material import Material
from flexstage.parts.shape import Elastic
from flexstage.parts.stated import Stated, is_even, line_mass, mirror_rows, symmetry_findings, turns_into_itself

_Along: TypeAlias = Annotated[Number, STIFFNESS]
_About: TypeAlias = Annotated[Number, ROTATIONAL_STIFFNESS]


@dataclass(frozen=True, eq=False)
class Spring(Elastic):
    """Spring along x without a drawn shape, with a specified stiffness.

    Specify exactly one of `stiffness` along x, `diagonal` (x, y, z, rx, ry, rz), and `matrix`, a symmetric 6x6 stiffness about the centre.
    With `stiffness`, the other degrees of freedom have zero stiffness. The stiffness may be negative (as for magnets), but the whole stage
    must be stable. `free` lists the free degrees of freedom of the ideal model (default: all).

    A spring with a `length` L has pivots at both ends: a tension F adds the transverse stiffness F / L. Without a length, the spring acts
    at one point. `preload` is the initial force that pushes the ends apart (negative: pulls them together). With `free_length`, the preload
    is k (free_length - length), with the stiffness k along x. `mass` is uniform over the length.
    """

    kind: ClassVar[str] = "spring"
    stiffness: _Along | None = None
    diagonal: tuple[_Along, _Along, _Along, _About, _About, _About] | None = None
    matrix: Annotated[tuple[tuple[Number, ...], ...], STIFFNESS_MATRIX] | None = None
    free: tuple[Freedom, ...] = ALL
    length: Annotated[Number, LENGTH, POSITIVE] | None = None
    free_length: Annotated[Number, LENGTH, POSITIVE] | None = None
    preload: Annotated[Number, FORCE] | None = None
    mass: Annotated[Number, MASS, NOT_NEGATIVE] = 0.0
    loss_factor: Annotated[Number, RATIO, NOT_NEGATIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom, as specified in `free`."""
        return self.free

    @property
    def whole(self) -> Array:
        """Stiffness (..., 6, 6) about the spring's centre.

        >>> Spring(stiffness=-2e3).whole.diagonal().tolist()
        [-2000.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        """
        if self.matrix is not None:
            return stack(self.matrix)
        diagonal = (self.stiffness, 0.0, 0.0, 0.0, 0.0, 0.0) if self.diagonal is None else self.diagonal
        return stack(diagonal)[..., None] * np.eye(6)

    @property
    def is_axisymmetric(self) -> bool:
        """Whether y and z have the same degrees of freedom and stiffness, in translation and rotation."""
        return is_even(self.free) and turns_into_itself(self.whole)

    @property
    def mirrored(self) -> Spring:
        """Mirror image in the x-z plane: the spring with mirrored stiffness."""
        return self if self.matrix is None else replace(self, matrix=mirror_rows(self.matrix))

    def stated(self, material: Material | None = None) -> Stated:  # noqa: ARG002
        """Return the stiffness matrix, and the mass matrix of a uniform mass along the length."""
        return Stated(self.whole, line_mass(self.mass, 0.0 if self.length is None else self.length))

    @property
    def push(self) -> Number | None:
        """Preload [N], as specified or computed from the free length."""
        if self.free_length is None or self.length is None:
            return self.preload
        return self.whole[..., 0, 0] * (self.free_length - self.length)

    @property
    def strut(self) -> Number | None:
        """Length between the pivots [m]."""
        return self.length

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors: no stiffness or several stiffnesses, an asymmetric matrix, two preloads, or a preload without a length."""
        stated = [name for name in ("stiffness", "diagonal", "matrix") if getattr(self, name) is not None]
        if len(stated) != 1:
            what = f"both {' and '.join(stated)} specified" if stated else "stiffness missing"
            yield Finding("", what, "Specify one of stiffness (along its axis), diagonal (six stiffnesses) and matrix (6x6 stiffness)")
        if self.matrix is not None:
            yield from symmetry_findings("matrix", self.whole)
        if self.free_length is not None and self.preload is not None:
            yield Finding("free_length", "preload specified too", "Remove one of the two: free_length determines the preload")
        if self.length is None and (self.free_length is not None or self.preload is not None):
            what = "length missing: with a preload, the stiffness across the axis is preload / length"
            yield Finding("length", what, 'Add the length between the ends, e.g. length = "20 mm"')
