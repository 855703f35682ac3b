"""Kinematics: the result of an ideal model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding, join_findings, refuse
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, first_design
from flexstage.base.record import INNER, VIEW, Called, Heading, Layout
from flexstage.base.units.quantity import LENGTH
from flexstage.models.linear.blockage import Blockage
from flexstage.parts.freedom import Freedom
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS


@dataclass(frozen=True)
class FreeInternalMode:
    """Free internal mode, independent of strokes and platform (for example a spinning strut): `bodies` move and `links` deform."""

    TABLE: ClassVar[Layout] = Layout("Free internal modes (zero stiffness)", "bodies links")

    bodies: Annotated[tuple[str, ...], Heading("bodies that move")]
    links: Annotated[tuple[str, ...], Heading("links that deform")]


@dataclass(frozen=True)
class RedundantConstraint:
    """Redundant constraint: a set of locked DOFs (`B1/left.y`) with one superfluous member."""

    TABLE: ClassVar[Layout] = Layout("Redundant constraints", "constraints")

    constraints: Annotated[tuple[str, ...], Heading("locked DOFs, one of them superfluous")]


class Kinematics(Result):
    """Ideal kinematics of a stage with n strokes, g gauges and f ideal motions of its platform.

    The platform twist at its reference point is x = V xi; xi are the platform coordinates named in `coordinates` (all six for f = 6).
    `actuation` (..., n, f) is da/dxi for the strokes a, `sensing` (..., g, 6) is ds/dx for the readings s, and `motion` (..., 6, f) is V.

    `bodies` (..., N, f) is the motion of all body coordinates per unit xi. `strains` (..., 6, f) is the deformation of each link in the
    link frame per unit xi; only free DOFs and strokes contribute. `free` contains the free DOFs of each link. `length` (...) is the scale
    that makes rotations comparable with translations. `blocked` contains the blockage of each immobile actuator. `gauge_units` are the
    units of the readings (if absent, m); `sums` contains the weights of the gauges in each sum of gauges.

    `actuators` are the stroke actuators, `thrusts` the force actuators, which do not determine motion. `thrust` (..., f, t) is V^T W, the
    generalised force on xi per unit of a force actuator's input (`thrust_inputs`: N or A).
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("a model", "fs.ideal(stage)")
    actuators: tuple[str, ...]
    coordinates: tuple[str, ...]
    gauges: tuple[str, ...]
    actuation: Array
    sensing: Array
    motion: Array
    body_coordinates: Annotated[tuple[str, ...], INNER]
    bodies: Array
    strains: Mapping[str, Array]
    free: Mapping[str, tuple[Freedom, ...]]
    idle: tuple[FreeInternalMode, ...]
    redundant: tuple[RedundantConstraint, ...]
    length: Annotated[Number, LENGTH]
    provenance: str
    blocked: Annotated[Mapping[str, Blockage], INNER] = field(default_factory=dict)
    thrusts: tuple[str, ...] = ()
    thrust_inputs: Annotated[tuple[str, ...], INNER] = ()
    thrust: Array = field(default_factory=lambda: np.zeros((6, 0)))
    gauge_units: Annotated[tuple[str, ...], INNER] = ()
    sums: Annotated[Mapping[str, Mapping[str, Number]], INNER] = field(default_factory=dict)

    @property
    def mobility(self) -> Annotated[int, VIEW]:
        """Number of ideal motions of the platform with free strokes."""
        return len(self.coordinates)

    @property
    def actuated(self) -> Annotated[bool, VIEW]:
        """Whether the strokes determine the platform's motion: R_a has full column rank, in all designs of a batch."""
        scaled = np.real(self.actuation) * self._rotations_as_lengths
        return self.mobility > 0 and bool(np.all(np.linalg.matrix_rank(scaled, tol=1e-9) == self.mobility))

    @property
    def immobile(self) -> tuple[str, ...]:
        """Actuators whose stroke is zero in every ideal motion, because rigid links block the stroke (first design of a batch)."""
        scaled = first_design(np.real(self.actuation) * self._rotations_as_lengths, 2)
        size = np.max(np.abs(scaled), axis=-1, initial=0.0)
        return tuple(name for name, largest in zip(self.actuators, size, strict=True) if largest < 1e-9)

    @property
    def mapping(self) -> Annotated[Matrix, Called("R_a")]:
        """R_a = da/dxi: strokes per platform motion (equation 13 of Shin & Moon; da/dx for six DOFs).

        Raises `DesignError` if the stage is under-actuated.
        """
        self._require_actuated()
        return Matrix(self.actuation, self.actuators, self.coordinates, ratio_units(("m",) * len(self.actuators), self._units))

    @property
    def force_map(self) -> Annotated[Matrix, Called("W")]:
        """V^T W: generalised force on the platform's ideal motions per unit input of each force actuator, by virtual work.

        With six DOFs, V is the identity, and the result is the whole wrench at the platform's reference point. W is R_f^T times the force
        per unit input, where R_f = d(elongation)/dx for the force actuators.

        With fewer DOFs, only the work of W in the ideal motions is known; locked DOFs carry the other components of W. Each row is the
        force conjugate to one platform coordinate. Positive inputs push the faces of the actuator apart.
        """
        rows = [COMPONENTS.index(name) for name in self.coordinates]
        units = ratio_units(tuple(WRENCH_UNITS[row] for row in rows), self.thrust_inputs)
        return Matrix(self.thrust, tuple(FORCES[row] for row in rows), self.thrusts, units)

    @property
    def commanded(self) -> Annotated[tuple[str, ...], VIEW]:
        """Platform coordinates that strokes and forces can command independently of all other coordinates, in the first design.

        If R_a and V^T W together have rank f, all platform coordinates are included. Without force actuators, only coordinates that the
        strokes determine are included.
        """
        first = np.real(self.actuation[(0,) * (self.actuation.ndim - 2)]), np.real(self.thrust[(0,) * (self.thrust.ndim - 2)])
        scale = first_design(self._rotations_as_lengths, 2)[0]
        columns = np.concatenate([first[0].T, first[1]], axis=1) * scale[:, None]
        basis = np.linalg.svd(columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300), full_matrices=False)
        spanned = basis[0][:, basis[1] > 1e-9]
        missed = np.linalg.norm(np.eye(len(scale)) - spanned @ spanned.T, axis=0)
        return tuple(name for name, miss in zip(self.coordinates, missed, strict=True) if miss < 1e-7)

    @property
    def motions(self) -> Annotated[Matrix, VIEW]:
        """V, the platform twist in each ideal motion."""
        return Matrix(self.motion, COMPONENTS, self.coordinates, ratio_units(TWIST_UNITS, self._units))

    @property
    def first_length(self) -> float:
        """The real part of `length` in the first design."""
        return float(np.real(first_design(np.asarray(self.length), 0)))

    @property
    def _rotations_as_lengths(self) -> Array:
        """Factors (..., 1, f) of columns per coordinate that make these comparable, by real parts."""
        return _scales(self.coordinates, 1.0 / np.real(self.length))[..., None, :]

    @property
    def _units(self) -> tuple[str, ...]:
        return tuple(TWIST_UNITS[COMPONENTS.index(name)] for name in self.coordinates)

    @property
    def gauge_mapping(self) -> Annotated[Matrix, Called("R_s")]:
        """R_s = ds/dx: gauge readings per platform motion (equation 14 of Shin & Moon)."""
        return Matrix(self.sensing, self.gauges, COMPONENTS, ratio_units(self.reading_units, TWIST_UNITS))

    @property
    def reading_units(self) -> tuple[str, ...]:
        """Unit of each gauge's reading."""
        return self.gauge_units or ("m",) * len(self.gauges)

    @property
    def single_gauges(self) -> tuple[str, ...]:
        """Gauges that are not sums of other gauges."""
        return tuple(name for name in self.gauges if name not in self.sums)

    @property
    def telling(self) -> tuple[str, ...]:
        """Gauges and sums of gauges that determine the pose: all except gauges that are members of sums."""
        taken = {member for members in self.sums.values() for member in members}
        return tuple(name for name in self.gauges if name not in taken)

    @property
    def selection(self) -> Array:
        """Matrix (..., t, s) from readings of the `single_gauges` to readings of the `telling` gauges: ones, and the weights of sums."""
        rows = [[np.asarray(self.sums.get(name, {name: 1.0}).get(single, 0.0)) for single in self.single_gauges] for name in self.telling]
        batch = np.broadcast_shapes(*(item.shape for row in rows for item in row))
        flat = [np.broadcast_to(item, batch) for row in rows for item in row]
        return np.stack(flat, axis=-1).reshape(*batch, len(rows), -1) if flat else np.zeros((0, 0))

    @property
    def seen(self) -> Array:
        """Readings (..., t, f) of the t gauges in `telling` per unit of each ideal motion."""
        if not self.sums:
            return self.sensing @ self.motion
        return self.sensing[..., [self.gauges.index(name) for name in self.telling], :] @ self.motion

    @property
    def inverse(self) -> Array:
        """Inverse of R_a, d xi/da (..., f, n); the least-squares inverse for redundant strokes."""
        self._require_actuated()
        transposed = self.actuation.mT
        if self.actuation.shape[-1] == self.actuation.shape[-2]:
            return np.linalg.inv(self.actuation)
        return np.linalg.solve(transposed @ self.actuation, transposed)

    @property
    def jacobian(self) -> Annotated[Matrix, VIEW]:
        """J = dx/da (..., 6, n): the ideal platform twist per stroke (Jacobian), V R_a^-1."""
        return Matrix(self.motion @ self.inverse, COMPONENTS, self.actuators, ratio_units(TWIST_UNITS, ("m",) * len(self.actuators)))

    @property
    def projection(self) -> Array:
        """Projection V^+ (..., f, 6) of a platform twist on the ideal motions, with rotations weighted by `length`."""
        weight = _scales(COMPONENTS, self.length)[..., None, :] ** 2
        weighted = self.motion.mT * weight
        return np.linalg.solve(weighted @ self.motion, weighted)

    def _require_actuated(self) -> None:
        if not self.actuated:
            strokes = "1 stroke does" if len(self.actuators) == 1 else f"{len(self.actuators)} strokes do"
            motions = f"{self.mobility} ideal motion{'' if self.mobility == 1 else 's'}"
            immobile_note = f"; the links block {', '.join(self.immobile)}" if self.immobile else ""
            mend = [finding.advice for finding in self.blockages] or [self._advice]
            raise refuse(
                "mapping",
                f"{strokes} not determine the platform's {motions} ({', '.join(self.coordinates) or 'none'}){immobile_note}",
                f"{'; '.join(mend)}; stiffness, modes and response are available nevertheless",
            )

    @property
    def _advice(self) -> str:
        """Hint for strokes that do not determine the platform."""
        if not self.thrusts:
            return "Add actuators, or lock more degrees of freedom of the links"
        return f"Forces ({', '.join(self.thrusts)}) determine no motion: compute the displacement with the elastic model"

    @property
    def blockages(self) -> tuple[Finding, ...]:
        """Warnings of immobile strokes: blocking links, sorted by decreasing force, and DOFs to free. Equal warnings are merged."""
        return join_findings(
            Finding(
                name, f"the stroke cannot move: it is blocked by the locked degrees of freedom of {_by_link(each.against)}", _freeing(each)
            )
            for name, each in self.blocked.items()
        )


def _by_link(freedoms: tuple[str, ...]) -> str:
    links: dict[str, list[str]] = {}
    for freedom in freedoms:
        link, _, name = freedom.rpartition(".")
        links.setdefault(link, []).append(name)
    return ", ".join(f"{link} ({', '.join(names)})" for link, names in links.items())


def _freeing(blockage: Blockage) -> str:
    *others, last = blockage.free or ("one of them",)
    word = "and" if blockage.together else "or"
    hint = f"ree {', '.join(others)} {word} {last}" if others else f"ree {last}"
    if not blockage.ends:
        return f"F{hint}"
    hinge = "a hinge at each end" if len(blockage.ends) > 1 else "a hinge at this end"
    return f"The actuator, elastic only along its axis, has no hinge at {' and '.join(blockage.ends)}: add {hinge}; or f{hint}"


def _scales(names: tuple[str, ...], rotation: Number) -> Array:
    """1 for translations, `rotation` (...) for rotations (..., n)."""
    return np.where([name.startswith("r") for name in names], np.asarray(rotation)[..., None], 1.0)
