"""Effective mass of the platform at a point: of the rigid body, and of the whole stage (static condensation)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

import numpy as np

from flexstage.analysis.linear_statics.statics import statics
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.moving_mass import moving_inertia
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.channels import twist_places
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import displacement
from flexstage.spatial.frame import COMPONENTS, FORCES, transport

_UNITS = (("kg",) * 3 + ("kg m",) * 3,) * 3 + (("kg m",) * 3 + ("kg m^2",) * 3,) * 3
_MASSLESS = "the body of this point has no specified mass"


class MassMatrix(Result):
    """Mass matrix M at a point in the stage's axes: the kinetic energy is v^T M v / 2 for the point's velocity and angular velocity v.

    `rigid` (..., 6, 6) is the mass matrix of the point's `body` alone, with its payloads. `reduced` (..., 6, 6) includes the whole stage:
    all other masses follow quasi-statically with strokes fixed (static condensation, Guyan, AIAA Journal 3, 380, 1965). `reduced` and the
    stiffness at the same point give natural frequencies that are never below the frequencies of the whole model. The frequencies from
    `reduced` are close to those of the whole model if there are no local modes nearby. `reasons` explain unknown masses.
    """

    point: str
    body: str
    rigid: Matrix | None
    reduced: Matrix | None
    provenance: str
    reasons: Mapping[str, str] = field(default_factory=dict)


@check_arguments
def mass_matrix(mechanism: Mechanism, model: LinearModel, *, point: str = PLATFORM) -> MassMatrix:
    """Compute the mass matrix (..., 6, 6) [kg, kg m, kg m^2] at a `point` of a body: of this body alone, and of the whole stage.

    `point` is a named point, or the name of a body (its reference point). `rigid` is X^T M X: M is the body's mass matrix at its reference
    point, and X maps a twist of `point` to the twist of the reference point. `reduced` is S^T M S, with the mass matrix M of the model. The
    columns of S are the static shapes of the model for unit twists of `point`, with strokes fixed: S = K^-1 C^T (C K^-1 C^T)^-1. K is the
    stiffness matrix of the model, and C maps the model's coordinates to the twist of `point`. The theory assumes small displacements and no
    free internal modes. `reduced` is None if `point` has fewer than six degrees of freedom, or if the body has a free internal mode.
    `rigid` is None for a body without mass.

    >>> import flexstage as fs
    >>> stage = fs.case("double-triangle")
    >>> result = fs.mass_matrix(stage, fs.lumped(stage))
    >>> [round(float(matrix.at("platform.fx", "platform.x")), 3) for matrix in (result.rigid, result.reduced)]
    [13.997, 14.441]
    """
    assembly = expand(mechanism)
    places = twist_places(assembly)
    if point not in places:
        raise refuse(point, "unknown point", suggest_nearest(point, places))
    place = places[point]
    placed = assembly.bodies.get(place.body)
    own = None if placed is None else moving_inertia(mechanism, placed)
    rigid = None if own is None or placed is None else _congruent(own, transport(placed.reference - place.point))
    reasons = {} if rigid is not None else {"rigid": _MASSLESS}
    try:
        shapes = _static_shapes(model, point)
        followed = shapes.mT
        reduced = _symmetric(followed @ model.momenta(shapes) if model.is_sparse else followed @ model.inertia_matrix @ shapes)
    except DesignError as error:
        reduced, reasons = None, {**reasons, "reduced": str(error)}
    return MassMatrix(point, place.body, _label(rigid, point), _label(reduced, point), model.provenance, reasons)


def _static_shapes(model: LinearModel, point: str) -> Array:
    """Static coordinates (..., n, 6) per unit twist of a point. Refuses locked points and free internal modes."""
    result = statics(model, load_point=point, read_point=point)
    require(Finding(point, reason, "Use the lumped model") for name, reason in result.reasons.items() if name == "stiffness")
    rows = model.output[..., model.output_index(result.compliance.rows), :]
    shapes = displacement(model, rows.mT) @ result.stiffness.values
    if model.floating is None:
        return shapes
    axes = np.isinf(np.diag(result.compliance.values))  # without stiffness: the floating motions that make up the twist
    missing = (np.eye(len(rows)) - rows @ shapes)[axes]
    return shapes + model.floating @ np.linalg.solve(rows[axes] @ model.floating, missing)


def _congruent(matrix: Array, motions: Array) -> Array:
    return _symmetric(motions.mT @ matrix @ motions)


def _symmetric(result: Array) -> Array:
    return 0.5 * (result + result.mT)


def _label(values: Array | None, point: str) -> Matrix | None:
    if values is None:
        return None
    rows, columns = (tuple(f"{point}.{name}" for name in names) for names in (FORCES, COMPONENTS))
    return Matrix(values, rows, columns, _UNITS)
