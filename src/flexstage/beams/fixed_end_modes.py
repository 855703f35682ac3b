"""Fixed-end modes of prismatic parts (Ritz's method): transverse bending, and twist.

The trial functions are polynomials that are zero at both ends. Their number exceeds the number of requested modes, so that the lowest modes
are correct to 1e-4 or better. Bending is by Timoshenko's theory: deflection w, section rotation psi.

A plate (Kirchhoff) also bends across its width. In bending, its deflection is w plus Legendre polynomials of even degree in z; in twist,
its deflection is phi z plus polynomials of odd degree, with the twist angle phi. All these terms are zero at the clamped ends. The strain
energy U of a plate is

    2 U = integral of D (w_xx^2 + 2 nu w_xx w_zz + w_zz^2 + 2 (1 - nu) w_xz^2) + S (w' - psi)^2 dx,   D = E t^3 / (12 (1 - nu^2)),

where psi' replaces the mean of w_xx over the width, and S is the shear stiffness. A narrow plate bends with E I, a short wide plate with E
I / (1 - nu^2). Shear at the edges reduces the twist stiffness: G J of the section replaces 2 (1 - nu) D b.

The energy of a twisted beam is 2 U = integral of G J phi'^2 + E C_w phi''^2 dx, with phi' = 0 at ends with restrained warping.

The eigenvalues are distinct. Complex-step derivatives of the modes are therefore correct for any parameter.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from flexstage.base.number import Array, Number

_MORE = 14
"""Polynomials per field in addition to the number of requested modes."""
_EVEN, _ODD = (2, 4, 6), (1, 3, 5)
"""Degrees of the polynomials across a plate."""
_FIRST_LOBE = -0.9
"""Position in the first lobe of a mode that fixes its sign, over half the length."""


@dataclass(frozen=True, eq=False)
class Plate:
    """Plate data of a leaf: `width` and Poisson's ratio nu. Plate rigidity times width is the beam's rigidity divided by 1 - nu^2."""

    width: Number
    poisson: Number


@dataclass(frozen=True, eq=False)
class Bending:
    """Part that bends in a plane: `length`, `rigidity` E I, `shear` stiffness, and `mass` and `rotary` inertia per length."""

    length: Number
    rigidity: Number
    shear: Number
    mass: Number
    rotary: Number
    plate: Plate | None = None


@dataclass(frozen=True, eq=False)
class Torsion:
    """Part that twists: `length`, torsional `rigidity` G J, and `inertia` about its axis per length.

    `warping` is E C_w (absent: free warping), and `warping_inertia` rho C_w, with Young's modulus E, density rho and the warping constant
    C_w. For a `plate` of width b and plate rigidity D, `warping` is D b^3 / 12, and the deflection includes polynomials of higher degree
    across the width.
    """

    length: Number
    rigidity: Number
    inertia: Number
    warping: Number | None = None
    warping_inertia: Number = 0.0
    plate: Plate | None = None


@dataclass(frozen=True, eq=False)
class FixedEndModes:
    """Modes of unit modal mass: squared angular frequencies `squares` (..., n) [1/s^2], and the motion of sections.

    `moved` (..., n, s) are the displacements of s sections in n modes, and `turned` (..., n, s) their rotations. `axis` is 1 for
    deflections along y, 2 along z, 3 for twist about x. For deflections, `turned` has the sign of the slope; for twist, it is `None`.
    """

    axis: int
    squares: Array
    moved: Array
    turned: Array | None = None


def fixed_end_bending(axis: int, part: Bending, count: int, stations: Array) -> FixedEndModes:
    """Compute the first `count` fixed-end bending modes along y (`axis` 1) or z (2) at `stations` (s,), x divided by the half length.

    The example compares the frequencies with those of Euler's clamped-clamped beam: 22.3733, 61.6728 and 120.903 times (E I / (rho A
    L^4))^(1/2).

    >>> slender = Bending(length=1.0, rigidity=1.0, shear=1e9, mass=1.0, rotary=0.0)
    >>> (fixed_end_bending(1, slender, 3, np.zeros(1)).squares ** 0.5).round(3).tolist()
    [22.373, 61.673, 120.903]
    """
    size = count + _MORE
    plain, clamped = _basis(size, 1), _basis(size, 2)
    half = 0.5 * part.length
    one, slope, mixed = plain.product(0, 0), plain.product(1, 1), plain.product(1, 0)
    stiff = {(0, 0): (part.shear / half, slope), (0, 1): (-part.shear, mixed)}
    heavy = {(0, 0): (part.mass * half, one), (1, 1): (part.rotary * half, one)}
    bending, fields = part.rigidity, 2
    blocks = [stiff, {(1, 1): (part.shear * half, one)}]
    if part.plate is not None:
        width, poisson, across = part.plate.width, part.plate.poisson, _across(_EVEN)
        bending, fields = part.rigidity / (1.0 - poisson * poisson), 2 + len(_EVEN)
        scale = width * width / 6.0
        blocks += _plate_blocks(clamped, _EVEN, bending / width * scale * scale, part.plate, half, first=2)
        curling = [2.0 * poisson * bending * scale / (width * width) * bend for bend in across.curling]
        blocks += [{(1, 2 + number): (each, plain.product(1, 0, clamped))} for number, each in enumerate(curling)]
        shares = 0.5 * scale * scale * part.mass * half
        heavy |= {(2 + number, 2 + number): (shares * each, clamped.product(0, 0)) for number, each in enumerate(across.square)}
    blocks.append({(1, 1): (bending / half, slope)})
    squares, vectors = _modes(_matrix(blocks, fields, size), _matrix([heavy], fields, size), count)
    deflection, rotation = (vectors[..., field * size : (field + 1) * size, :].mT @ plain.at(stations) for field in (0, 1))
    return _signed(axis, squares, deflection, rotation, vectors[..., :size, :].mT @ plain.at(np.array([_FIRST_LOBE])))


def fixed_end_twist(part: Torsion, count: int, stations: Array) -> FixedEndModes:
    """Compute the first `count` fixed-end twist modes at `stations` (s,): positions x divided by the half length, from -1 to 1.

    >>> rod = Torsion(length=1.0, rigidity=1.0, inertia=1.0)
    >>> (fixed_end_twist(rod, 3, np.zeros(1)).squares ** 0.5 / np.pi).round(9).tolist()
    [1.0, 2.0, 3.0]
    """
    size = count + _MORE
    basis = _basis(size, 1 if part.warping is None else 2)
    half = 0.5 * part.length
    slope = basis.product(1, 1)
    stiff, heavy = [{(0, 0): (part.rigidity / half, slope)}], [{(0, 0): (part.inertia * half, basis.product(0, 0))}]
    if part.warping is not None:
        stiff.append({(0, 0): (part.warping / half**3, basis.product(2, 2))})
        heavy.append({(0, 0): (part.warping_inertia / half, slope)})
    fields = 1
    if part.plate is not None and part.warping is not None:
        fields, plate = len(_ODD), part.plate
        edges = part.rigidity * plate.width * plate.width / (24.0 * (1.0 - plate.poisson) * part.warping)  # G J over 2 (1 - nu) D b
        stiff = _plate_blocks(basis, _ODD, 3.0 * part.warping / plate.width, plate, half, first=0, shear=edges)
        shares = 1.5 * _across(_ODD).square
        heavy += [{(number, number): (part.inertia * share * half, basis.product(0, 0))} for number, share in enumerate(shares) if number]
    squares, vectors = _modes(_matrix(stiff, fields, size), _matrix(heavy, fields, size), count)
    first, moved = (vectors[..., :size, :].mT @ basis.at(places) for places in (np.array([_FIRST_LOBE]), stations))
    return _signed(3, squares, moved, None, first)


@dataclass(frozen=True, eq=False)
class _Across:
    """Integrals over [-1, 1] of Legendre polynomials across a plate: squares (n,), products (n, n) of first and second derivatives.

    `mixed` (n, n) are products of values and second derivatives, `curling` (n,) integrals of the second derivatives.
    """

    square: Array
    slope: Array
    bend: Array
    mixed: Array
    curling: Array


@functools.cache
def _across(degrees: tuple[int, ...]) -> _Across:
    places, weights = _gauss(max(degrees) + 1)
    series = np.eye(max(degrees) + 1)[:, list(degrees)]
    plain, slope, bend = (legendre.legval(places, legendre.legder(series, order, axis=0)) for order in range(3))
    return _Across((plain**2) @ weights, (slope * weights) @ slope.T, (bend * weights) @ bend.T, (plain * weights) @ bend.T, bend @ weights)


def _plate_blocks(
    basis: _Basis, degrees: tuple[int, ...], rigidity: Number, plate: Plate, half: Number, *, first: int, shear: Number = 1.0
) -> list[dict[tuple[int, int], tuple[Number, Array]]]:
    """Kirchhoff energy of fields across a plate, the first at index `first`: `rigidity` is D times the squared scale of the fields.

    `shear` is a factor on the twist energy.
    """
    across, poisson, side = _across(degrees), plate.poisson, 0.5 * plate.width
    blocks: list[dict[tuple[int, int], tuple[Number, Array]]] = []
    for one, other in itertools.combinations_with_replacement(range(len(degrees)), 2):
        place = (first + one, first + other)
        mixed = across.mixed[one, other] * basis.product(2, 0) + across.mixed[other, one] * basis.product(0, 2)
        blocks += [
            {place: (rigidity / side**3 * half, across.bend[one, other] * basis.product(0, 0))},
            {place: (2.0 * (1.0 - poisson) * shear * rigidity / side / half, across.slope[one, other] * basis.product(1, 1))},
            {place: (poisson * rigidity / side / half, mixed)},
        ]
        if one == other:
            blocks.append({place: (rigidity * side / half**3, across.square[one] * basis.product(2, 2))})
    return blocks


def join(arrays: Iterable[Array]) -> Array:
    """Concatenate arrays along their last axis; the other axes are broadcast.

    >>> join([np.ones((2, 1)), np.zeros(2)]).tolist()
    [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    """
    parts = tuple(arrays)
    batch = np.broadcast_shapes(*(each.shape[:-1] for each in parts))
    return np.concatenate([np.broadcast_to(each, (*batch, each.shape[-1])) for each in parts], axis=-1)


def _signed(axis: int, squares: Array, moved: Array, turned: Array | None, first: Array) -> FixedEndModes:
    sign = np.where(np.real(first) < 0.0, -1.0, 1.0)
    return FixedEndModes(axis, squares, sign * moved, None if turned is None else sign * turned)


@dataclass(frozen=True, eq=False)
class _Basis:
    """Polynomials (series, number) in Legendre form on [-1, 1], and their derivatives."""

    series: tuple[Array, ...]

    def at(self, places: Array, order: int = 0) -> Array:
        """Values (n, s) of a derivative."""
        return legendre.legval(places, self.series[order], tensor=True)

    def product(self, order: int, other_order: int, other: _Basis | None = None) -> Array:
        """Integrals (n, n) of the product of derivatives."""
        places, weights = _gauss(len(self.series[0]) + 4)
        return (self.at(places, order) * weights) @ (other or self).at(places, other_order).T


@functools.cache
def _basis(size: int, folds: int) -> _Basis:
    """Legendre polynomials integrated `folds` times: they vanish at both ends with all derivatives of lower order."""
    series = legendre.legint(np.vstack([np.zeros((folds, size)), np.eye(size)]), folds, lbnd=-1.0, axis=0)
    return _Basis(tuple(legendre.legder(series, order, axis=0) for order in range(3)))


@functools.cache
def _gauss(count: int) -> tuple[Array, Array]:
    return legendre.leggauss(count)


def _matrix(blocks: list[dict[tuple[int, int], tuple[Number, Array]]], fields: int, size: int) -> Array:
    """Assemble the symmetric matrix of blocks (field, field), each a number (...) times a matrix; equal positions add up."""
    entries = [(place, np.asarray(number)[..., None, None] * matrix) for block in blocks for place, (number, matrix) in block.items()]
    batch = np.broadcast_shapes(*(matrix.shape[:-2] for _, matrix in entries))
    result = np.zeros((*batch, fields * size, fields * size), dtype=np.result_type(*(matrix for _, matrix in entries)))
    for (row, column), matrix in entries:
        rows, columns = slice(row * size, (row + 1) * size), slice(column * size, (column + 1) * size)
        result[..., rows, columns] += matrix
        if row != column:
            result[..., columns, rows] += matrix.mT
    return result


def _modes(stiffness: Array, inertia: Array, count: int) -> tuple[Array, Array]:
    """The lowest eigenvalues (..., n) and vectors (..., N, n) of unit modal mass; imaginary parts to first order."""
    scale = 1.0 / np.sqrt(np.real(np.diagonal(stiffness, axis1=-2, axis2=-1)))
    stiff, heavy = (matrix * scale[..., None] * scale[..., None, :] for matrix in np.broadcast_arrays(stiffness, inertia))
    lower = np.linalg.cholesky(np.real(stiff))
    inner = np.linalg.solve(lower, np.linalg.solve(lower, np.real(heavy)).mT)
    values, vectors = np.linalg.eigh(0.5 * (inner + inner.mT))
    values = values[..., : -count - 1 : -1]
    vectors = np.linalg.solve(lower.mT, vectors[..., ::-1][..., :count])
    if np.iscomplexobj(stiff) or np.iscomplexobj(heavy):
        values, vectors = _stepped(stiff, heavy, values, vectors)
    return 1.0 / values, scale[..., None] * vectors / np.sqrt(values)[..., None, :]


def _stepped(stiff: Array, heavy: Array, values: Array, vectors: Array) -> tuple[Array, Array]:
    """Eigenpairs M v = mu K v to first order in the imaginary parts of K and M, by a bordered system per mode."""
    steps, turns = [], []
    for number in range(values.shape[-1]):
        value, vector = values[..., number, None, None], vectors[..., number : number + 1]
        row = vector.mT
        lag = np.imag(heavy) - value * np.imag(stiff)
        step = row @ lag @ vector
        border = np.real(stiff) @ vector
        system = np.block([[np.real(heavy) / value - np.real(stiff), border], [border.mT, np.zeros_like(value)]])
        right = np.concatenate([-(lag @ vector) / value + step / value * border, -0.5 * row @ np.imag(stiff) @ vector], axis=-2)
        turns.append(np.linalg.solve(system, right)[..., :-1, 0])
        steps.append(step[..., 0, 0])
    return values + 1j * np.stack(steps, axis=-1), vectors + 1j * np.stack(turns, axis=-1)
