"""Superelements: check of the matrices, and Craig-Bampton reduction to ports and fixed-interface modes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Array, first_design, stack
from flexstage.base.session import SESSION
from flexstage.parts.mass import tensor
from flexstage.parts.matrix_file import LARGEST_DENSE, MatrixLike, digest_of, read_matrices
from flexstage.parts.profile import single
from flexstage.parts.superelement import FileUnits, Superelement
from flexstage.spatial.frame import Frame, axes, mirror, twist_transform

SYMMETRIC = 1e-6
"""Largest accepted asymmetry of an entry relative to the largest entry of the matrix."""
RIGID = 1e-3
"""Largest accepted stiffness of a rigid motion due to rounding in the file, divided by the stiffness of the softest elastic motion."""
STATED = 1e-3
"""Largest accepted relative deviation of specified mass properties from the matrices (centre: divided by the distance of the ports)."""
_NEGATIVE = 1e-8
_NOTHING = 1e-10
_MASSLESS = 1e-13
MOST_MODES = 1000
"""Largest number of internal coordinates of one superelement."""


@dataclass(frozen=True, eq=False)
class Condensed:
    """Superelement reduced to p ports and m fixed-interface modes [SI].

    A port's twist is about the port's origin, in its axes; the ports are in the order of their rows in the file. `stiffness` (6 (p - 1), 6
    (p - 1)) is the stiffness matrix of all ports except the first, which is fixed. `squares` (m,) are the squared angular frequencies of
    the mass-normalised modes. `inertia` (6 p + m, 6 p + m) is the mass matrix of all ports and the modes. `damping` (6 (p - 1) + m, 6 (p -
    1) + m) is the damping matrix of the modes and all ports except the first (`None`: undamped). `mass`, the `centre` of mass (3,) and the
    `moments` of inertia (3, 3) about the centre are in the part's axes and are computed from rigid motions. `error` is the ratio of the
    removed stiffness of rigid motions to the stiffness of the softest elastic motion.
    """

    stiffness: Array
    squares: Array
    inertia: Array
    damping: Array | None
    mass: float
    centre: Array
    moments: Array
    error: float


def condense(part: Superelement, where: str = "superelement") -> Condensed:
    """Read, check and reduce the part's matrices; the result is cached.

    Raises `DesignError` with all errors; their addresses begin with `where`.
    """
    try:
        return _condensed(part)
    except DesignError as error:
        raise DesignError(_at(where, finding) for finding in error.findings) from None


def superelement_findings(part: Superelement, where: str) -> Iterator[Finding]:
    """Return the errors of a superelement. The addresses of the errors begin with `where` (`parts.frame.ports.left.row`)."""
    try:
        condense(part, where)
    except DesignError as error:
        yield from error.findings


def _at(where: str, finding: Finding) -> Finding:
    """An error at a key of the part, or for one of its files at the part."""
    if finding.where.split(".")[0] in Superelement.__dataclass_fields__:
        return replace(finding, where=f"{where}.{finding.where}")
    return replace(finding, where=where, what=f"{finding.where}: {finding.what}")


@SESSION.keep(16)
def _condensed(part: Superelement) -> Condensed:
    matrices = read_matrices(part)
    named: dict[str, MatrixLike] = dict(zip(("stiffness matrix", "mass matrix", "damping matrix"), matrices, strict=False))
    require(_shape_findings(part, named))
    require(finding for name, matrix in named.items() for finding in _entry_findings(name, matrix))
    stiffness, inertia, *lost = _ports_first(part, matrices)
    count = 6 * len(part.ports)
    inner = stiffness[count:, count:]
    basis = np.vstack([np.eye(count), -_solve_within(inner, _dense(stiffness[count:, :count]))])  # static constraint modes
    in_file, carried = (_projected(each, basis) for each in (stiffness, inertia))
    scale, energy = _in_si(part)
    at_ports, carried = (energy * scale * each * scale[:, None] for each in (in_file, carried))
    frames = _frames(part)
    error, findings = _rigid_findings(part, at_ports, in_file, frames)
    require(findings)
    motion = np.vstack([twist_transform(frame, np.zeros(3)) for frame in frames])  # of the ports, by the part's twist at its origin
    mass, centre, moments, told = _mass_findings(part, motion.T @ carried @ motion, _span(frames))
    require([*told, *_negative_findings(inertia)])
    squares, shapes = _modes(part, inner, inertia[count:, count:])
    whole = np.hstack([basis, np.vstack([np.zeros((count, len(squares))), shapes])])
    size = np.concatenate([scale, np.full(len(squares), 1.0 / np.sqrt(energy))])
    reduced, *lost = (energy * size * _projected(each, whole) * size[:, None] for each in (inertia, *lost))
    require(finding for each in lost for finding in _loss_findings(each, motion))
    return Condensed(at_ports[6:, 6:], squares, reduced, lost[0][6:, 6:] if lost else None, mass, centre, moments, error)


def _loss_findings(damping: Array, motion: Array) -> Iterator[Finding]:
    """Errors of damping: resistance to rigid motions (mass-proportional damping), or negative damping."""
    largest = float(np.max(np.abs(damping), initial=0.0))
    left = float(np.max(np.abs(damping[:, : len(motion)] @ motion)))
    if left > RIGID * largest * float(np.max(np.abs(motion))):
        what = f"resists rigid motions, like mass-proportional damping (got {left:.3g} for a rigid motion, largest entry {largest:.3g})"
        yield Finding("damping matrix", what, "Export only the damping of material and joints; specify other damping for the whole stage")
    elif float(np.linalg.eigvalsh(damping)[0]) < -_NEGATIVE * len(damping) * largest:
        yield Finding("damping matrix", "has a negative eigenvalue", "Export the damping of the unloaded part")


def _shape_findings(part: Superelement, matrices: Mapping[str, MatrixLike]) -> Iterator[Finding]:
    if len(part.ports) < 2:
        yield Finding("ports", f"too few ports (got {len(part.ports)}, expected 2 or more)", "Specify every interface frame as a port")
    moved = [name for name, port in part.ports.items() if any(np.ndim(each) for each in (*port.at, *port.along, *port.up))]
    if moved and any(np.ptp(np.real(each)) for name in moved for port in (part.ports[name],) for each in (*port.at, *port.along, *port.up)):
        yield Finding(f"ports.{moved[0]}", "its pose varies between designs, but the file is for one pose", "Keep the ports fixed")
    sizes = {name: matrix.shape for name, matrix in matrices.items()}
    for name, shape in sizes.items():
        if len(shape) != 2 or shape[0] != shape[-1]:
            yield Finding(name, f"not square (got {_by(shape)})", "Export the whole matrix over ports and internal coordinates")
    if len(set(sizes.values())) > 1:
        what = f"matrices of different sizes ({', '.join(_by(shape) for shape in sizes.values())})"
        yield Finding("stiffness matrix", what, "Export all matrices over the same coordinates")
    rows = np.zeros(min(map(min, sizes.values())), dtype=int)
    for name in part.order:
        port = part.ports[name]
        if port.row + 5 > len(rows):
            what = f"its six rows end at row {port.row + 5}, but the matrices have {len(rows)} rows"
            yield Finding(f"ports.{name}.row", what, "Use the number of the port's first row, counted from 1")
            continue
        if np.any(rows[port.row - 1 : port.row + 5]):
            yield Finding(
                f"ports.{name}.row", f"rows {port.row} to {port.row + 5} overlap with another port", "Use six separate rows per port"
            )
        rows[port.row - 1 : port.row + 5] = 1


def _by(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))


def _entry_findings(name: str, matrix: MatrixLike) -> Iterator[Finding]:
    """Errors of entries: not finite, or not symmetric."""
    sparse = scipy.sparse.issparse(matrix)
    entries = matrix.data if sparse else matrix
    if not np.all(np.isfinite(entries)):
        yield Finding(name, f"{int(np.sum(~np.isfinite(entries)))} of its entries are not finite", "Export the matrix again")
        return
    largest = np.max(np.abs(entries), initial=0.0)
    off = abs(matrix - matrix.T)
    row, column = np.unravel_index(int(off.argmax()), matrix.shape)
    if off[row, column] > SYMMETRIC * largest:
        what = (
            f"not symmetric: entry ({row + 1}, {column + 1}) is {matrix[row, column]:.6g} and its transpose "
            f"{matrix[column, row]:.6g}; they differ by {off[row, column] / largest:.2g} of the largest entry (limit {SYMMETRIC:g})"
        )
        yield Finding(name, what, "Export the whole matrix, not only a triangle, of a model without rotors or contact")


def _ports_first(part: Superelement, matrices: tuple[MatrixLike, ...]) -> list[MatrixLike]:
    """Symmetric matrices with the ports' coordinates first, in the file's units."""
    ports = np.concatenate([np.arange(part.ports[name].row - 1, part.ports[name].row + 5) for name in part.order])
    order = np.concatenate([ports, np.setdiff1d(np.arange(matrices[0].shape[0]), ports)])
    return [_symmetrise(each)[order][:, order] for each in matrices]


def _projected(matrix: MatrixLike, basis: Array) -> Array:
    return _symmetrise(_dense(basis.T @ (matrix @ basis)))


def _solve_within(inner: MatrixLike, force: Array) -> Array:
    """K_ii^-1 times forces on the internal coordinates; refuses a singular K_ii."""
    if not inner.shape[0]:
        return force
    advice = "Remove free nodes and rigid-body modes: every internal degree of freedom requires stiffness against the ports"
    if scipy.sparse.issparse(inner):
        try:
            factors = scipy.sparse.linalg.splu(inner.tocsc(), diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError:
            raise refuse("stiffness matrix", "internal coordinates can move freely while the ports are fixed", advice) from None
        if np.min(factors.U.diagonal()) <= 0.0:
            raise refuse("stiffness matrix", "zero or negative stiffness of an internal motion with fixed ports", advice)
        return factors.solve(force)
    diagonal = np.diag(inner)
    root = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = inner * root * root[:, None]
    least = min(float(np.linalg.eigvalsh(scaled)[0]), float(np.min(diagonal)))
    if least <= _MASSLESS:
        what = f"zero or negative stiffness of an internal motion with fixed ports (least scaled eigenvalue {least:.2g})"
        raise refuse("stiffness matrix", what, advice)
    return root[:, None] * np.linalg.solve(scaled, root[:, None] * force)


def _in_si(part: Superelement, units: FileUnits | None = None) -> tuple[Array, float]:
    """Scale S (6 p,) of the file's port coordinates relative to SI, and its unit of energy [J]: K = energy S K_file S."""
    length, energy = (1.0, 1.0) if (units or part.units) is FileUnits.SI else (1e3, 1e-3)
    sides = mirror(1).diagonal() if part.reflected else np.ones(6)
    return np.tile(np.repeat([length, 1.0], 3) * sides, len(part.ports)), energy


def _frames(part: Superelement) -> list[Frame]:
    ports = (part.ports[name] for name in part.order)
    return [Frame(np.real(first_design(axes(port.along, port.up), 2)), np.real(first_design(stack(port.at), 1))) for port in ports]


def _span(frames: list[Frame]) -> float:
    """Largest distance between ports [m]; 0.1 m if they coincide."""
    places = np.array([frame.position for frame in frames])
    return float(np.max(np.linalg.norm(places[:, None] - places, axis=-1))) or 0.1


def _rigid_error(at_ports: Array, frames: list[Frame]) -> tuple[float, float, float]:
    """Largest stiffness of rigid motions, softest and stiffest elastic one [N/m], rotations scaled by the distance of the ports."""
    span = _span(frames)
    weights = np.tile(np.repeat([1.0, 1.0 / span], 3), len(frames))
    middle = np.mean([frame.position for frame in frames], axis=0)
    motion = np.vstack([twist_transform(frame, middle) for frame in frames]) * weights[:6] / weights[:, None]
    scaled = weights * at_ports * weights[:, None]
    values = np.linalg.eigvalsh(scaled[6:, 6:])
    elastic = values[values > _NOTHING * values[-1]] if values[-1] > 0.0 else values[-1:]
    return float(np.linalg.norm(scaled @ motion, 2)), float(elastic[0]), float(elastic[-1])


def _rigid_findings(part: Superelement, at_ports: Array, in_file: Array, frames: list[Frame]) -> tuple[float, list[Finding]]:
    """Relative error in rigid motions, and errors of the stiffness at the ports."""
    left, softest, stiffest = _rigid_error(at_ports, frames)
    if stiffest <= 0.0:
        return 0.0, [Finding("stiffness matrix", "no relative motion of the ports has stiffness", "Check the file")]
    if left > RIGID * softest:
        what = (
            f"a rigid motion of all ports has a stiffness of {left:.3g} N/m (rotations multiplied by {_span(frames) * 1e3:.4g} mm), "
            f"{left / stiffest:.2g} times that of the stiffest elastic motion and "
            f"{left / softest:.2g} times that of the softest (expected at most {RIGID:g})"
        )
        return left / softest, [Finding("ports", what, _hint(part, at_ports, in_file, frames))]
    least = float(np.linalg.eigvalsh(at_ports[6:, 6:])[0])
    if least < -_NEGATIVE * stiffest:
        what = f"negative stiffness of a motion with port {part.order[0]} fixed ({least:.3g})"
        return left / softest, [Finding("stiffness matrix", what, "Export the elastic stiffness of the unloaded part")]
    return left / softest, []


def _hint(part: Superelement, at_ports: Array, in_file: Array, frames: list[Frame]) -> str:
    """Hint for free rigid motions: the common mistake that explains the error, if any."""
    for units in FileUnits:
        scale, energy = _in_si(part, units)
        if units is not part.units and _is_free(energy * scale * in_file * scale[:, None], frames):
            far = "farther apart" if part.units is FileUnits.SI else "closer"
            return f'Use units = "{units.value}", or move the ports a thousand times {far}: rigid motions are then free'
    if _is_free(at_ports, [Frame(np.eye(3), frame.position) for frame in frames]):
        return "Remove the keys along and up: rigid motions are free if all ports have the axes of the part"
    for first, second in itertools.combinations(range(len(frames)), 2):
        swapped = list(frames)
        swapped[first], swapped[second] = frames[second], frames[first]
        if _is_free(at_ports, swapped):
            return f"Exchange the rows of {part.order[first]} and {part.order[second]}: rigid motions are then free"
    return "Check positions and axes of the ports and the order of the rows (x, y, z, rx, ry, rz); export a model without supports"


def _is_free(at_ports: Array, frames: list[Frame]) -> bool:
    left, softest, _ = _rigid_error(at_ports, frames)
    return softest > 0.0 and left <= RIGID * softest


def _mass_findings(part: Superelement, seen: Array, span: float) -> tuple[float, Array, Array, list[Finding]]:
    """Mass, centre and moments from rigid motions (6, 6) about the part's origin, and their errors."""
    along = np.diag(seen)[:3]
    mass = float(np.mean(along))
    lever = -seen[:3, 3:] / mass if mass > 0.0 else np.zeros((3, 3))
    centre = 0.5 * np.array([lever[2, 1] - lever[1, 2], lever[0, 2] - lever[2, 0], lever[1, 0] - lever[0, 1]])
    cross = 0.5 * (lever - lever.T)
    moments = seen[3:, 3:] - mass * cross.T @ cross if mass > 0.0 else np.zeros((3, 3))
    findings: list[Finding] = []
    if mass < 0.0:
        findings.append(Finding("mass matrix", f"rigid motions have the mass {mass:.4g} kg", "Export the mass matrix"))
    elif np.max(np.abs(seen[:3, :3] - mass * np.eye(3))) > STATED * mass > 0.0:
        what = f"rigid motions along x, y and z have the masses {along[0]:.6g}, {along[1]:.6g} and {along[2]:.6g} kg, which should be equal"
        findings.append(Finding("mass matrix", what, "Export the whole mass matrix: mass at the ports or in some directions is missing"))
    elif np.max(np.abs(lever + lever.T)) > STATED * span:
        what = "translations and rotations are not coupled as in a rigid body"
        findings.append(Finding("mass matrix", what, "Check positions and axes of the ports, and export the consistent mass matrix"))
    return mass, centre, moments, [*findings, *_stated_findings(part, mass, centre, moments, span)]


def _stated_findings(part: Superelement, mass: float, centre: Array, moments: Array, span: float) -> Iterator[Finding]:
    advice = "Check both values, and the units of the file"
    if part.mass is not None:
        stated = single(part.mass)
        if abs(stated - mass) > STATED * max(abs(stated), abs(mass)):
            yield Finding("mass", f"wrong mass (got {stated:.6g} kg, expected {mass:.6g} kg from rigid motions of the matrices)", advice)
    if part.centre is not None:
        stated = np.real(first_design(stack(part.centre), 1))
        off = float(np.linalg.norm(stated - centre))
        if off > STATED * span:
            expected = ", ".join(f"{each * 1e3:.5g}" for each in centre)
            what = f"wrong centre of mass ({off * 1e3:.4g} mm from that of the matrices, which is ({expected}) mm)"
            yield Finding("centre", what, advice)
    if part.inertia is not None:
        stated = np.real(first_design(tensor(part.inertia), 2))
        off = float(np.max(np.abs(stated - moments)))
        if off > STATED * max(float(np.trace(stated)), float(np.trace(moments))):
            result = ", ".join(f"{each:.4g}" for each in np.diag(moments))
            yield Finding("inertia", f"differs by {off:.4g} kg m^2 from the inertia of the matrices (xx, yy, zz = {result})", advice)


def _negative_findings(inertia: MatrixLike) -> Iterator[Finding]:
    """Errors for negative mass: on the diagonal, or of a motion."""
    diagonal = inertia.diagonal()
    largest = np.max(np.abs(diagonal), initial=0.0)
    below = np.flatnonzero(diagonal < -_NEGATIVE * largest)
    if len(below):
        what = f"{len(below)} of its diagonal entries are negative, the smallest is {diagonal[below].min():.4g} in the file's units"
        yield Finding("mass matrix", what, "Export the mass matrix of the model, not a dynamic stiffness")
        return
    if scipy.sparse.issparse(inertia):
        return
    root = 1.0 / np.sqrt(np.where(diagonal > _MASSLESS * largest, diagonal, largest or 1.0))
    least = float(np.linalg.eigvalsh(inertia * root * root[:, None])[0])
    if least < -_NEGATIVE * len(root):
        what = f"negative mass of a motion (least eigenvalue {least:.3g}, with the diagonal scaled to 1)"
        yield Finding("mass matrix", what, "Export the consistent or the lumped mass matrix, with all its digits")


def _modes(part: Superelement, inner: MatrixLike, mass: MatrixLike) -> tuple[Array, Array]:
    """Squares (m,) of the angular frequencies of the retained fixed-interface modes, and their mass-normalised shapes (n, m)."""
    size = inner.shape[0]
    if not size or part.modes == 0 or not np.any(mass.diagonal()):
        return np.zeros(0), np.zeros((size, 0))
    most = np.inf if part.below is None else (2.0 * np.pi * single(part.below)) ** 2
    if scipy.sparse.issparse(inner):
        squares, shapes = _lowest(part, inner, mass)
    else:
        inverses, shapes = scipy.linalg.eigh(mass, inner)
        kept = inverses > _MASSLESS * inverses[-1]
        squares, shapes = 1.0 / inverses[kept][::-1], (shapes[:, kept] / np.sqrt(inverses[kept]))[:, ::-1]
    few = (squares < most)[: part.modes]
    squares, shapes = squares[: part.modes][few], shapes[:, : part.modes][:, few]
    if len(squares) > MOST_MODES:
        what = f"too many internal coordinates (got {len(squares)}, expected {MOST_MODES} at most)"
        raise refuse("modes", what, 'Limit the number of modes (e.g. modes = 20) or their frequency (e.g. below = "2 kHz")')
    return squares, shapes


def _lowest(part: Superelement, inner: MatrixLike, mass: MatrixLike) -> tuple[Array, Array]:
    """Lowest modes of sparse matrices, by shift and invert at zero."""
    if part.modes is None:
        what = f"too many internal coordinates for all modes (got {inner.shape[0]}, expected {LARGEST_DENSE} at most)"
        raise refuse("modes", what, "Limit the number of modes, e.g. modes = 20")
    count = min(part.modes, inner.shape[0] - 2)
    start = np.random.default_rng(0).standard_normal(inner.shape[0])
    squares, shapes = scipy.sparse.linalg.eigsh(inner.tocsc(), k=count, M=mass.tocsc(), sigma=0.0, v0=start)
    order = np.argsort(squares)
    return squares[order], shapes[:, order]


def _symmetrise(matrix: MatrixLike) -> MatrixLike:
    return 0.5 * (matrix + matrix.T)


def _dense(matrix: MatrixLike) -> Array:
    return matrix.toarray() if scipy.sparse.issparse(matrix) else np.asarray(matrix)


@check_arguments
def superelement(part: Superelement) -> Superelement:
    """Return the part with absolute paths and the current digest of its files. Raises `DesignError` in the same cases as `condense`.

    Use this function for parts created in Python from new files. A part in a design file contains its digest already.
    """
    paths = {key: getattr(part, key) for key in ("file", "stiffness_file", "mass_file", "damping_file")}
    whole = replace(part, **{key: str(Path(path).resolve()) for key, path in paths.items() if path})
    versioned = replace(whole, sha256=digest_of(whole.files))
    condense(versioned)
    return versioned
