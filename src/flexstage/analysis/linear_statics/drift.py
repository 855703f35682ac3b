"""Thermal drift: motion due to uniform and linear temperature changes, per kelvin.

Every body and part expands freely with the temperature field. A linear field with gradient g causes no stress in a free body. T is the
temperature change at the body's reference point, and r is the position relative to this point. With the expansion coefficient alpha, the
displacement at r is u = alpha [T r + (g . r) r - g r^2 / 2], and the rotation is alpha g x r. The links deform where the expansions of
bodies and parts do not fit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from flexstage.analysis.linear_statics.lost_motion import LOADED
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Vector, join, matvec, stack
from flexstage.base.record import INNER
from flexstage.base.units.quantity import LENGTH
from flexstage.beams.compliance import law
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, expand
from flexstage.mechanism.assembly.expansion import Expansion, Ground, expansion
from flexstage.mechanism.assembly.incidence import deformation, layout
from flexstage.mechanism.assembly.sight import Sight
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.models.flexible_bodies import BODIES, flexible_links
from flexstage.models.linear.model import Contribution, LinearModel
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.part import Restricted
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS, cross_matrix, spatial_rotation, transport

FIELDS = ("uniform", "gradient.x", "gradient.y", "gradient.z")
_FIELD_UNITS = ("K", "K/m", "K/m", "K/m")
_FITS = 1e-7


class Drift(Result):
    """Motion and forces due to a temperature field of unit size: uniform (1 K), or linear along x, y or z (1 K/m).

    `motion` has six components for the platform and for each named point. `gauges` contains the gauge readings, and `forces` the six stress
    resultants of each elastic link. `ground` is the assumed material of the ground (`None`: no expansion) and its source. `datum` (..., 3)
    [m] is the fixed point of the ground; linear temperature fields are zero there. `taken` names the material used for each body. `bodies`
    are the twists (..., 6, 4) of all bodies at their reference points, in the four temperature fields.
    """

    motion: Matrix
    gauges: Matrix
    forces: Matrix
    ground: Ground
    datum: Annotated[Array, LENGTH]
    taken: Mapping[str, str]
    provenance: str
    bodies: Annotated[Mapping[str, Array], INNER] = field(default_factory=dict[str, Array])

    def of(self, point: str = PLATFORM) -> Matrix:
        """Return the six rows of `motion` for one point."""
        return self.motion.part(tuple(f"{point}.{name}" for name in COMPONENTS), FIELDS)


_ABOUT = cross_matrix(np.eye(3))
"""Cross-product matrices of the unit vectors, by axis."""


@dataclass(frozen=True, eq=False)
class _Thermal:
    """Expansion of bodies and parts in the four fields, relative to a datum."""

    assembly: Assembly
    expansion: Expansion
    datum: Array

    def growth(self, body: str, point: Array) -> Array:
        """Expansion twist (..., 6, 4) of a body at a point, from its reference, in stage axes."""
        reference = self.datum if body == GROUND else self.assembly.bodies[body].reference
        return np.asarray(self.expansion.bodies[body])[..., None, None] * _growth(point - reference, reference - self.datum)

    def misfit(self, link: PlacedLink) -> Array:
        """Deformation (..., 6, 4) of a link, in its frame, for bodies at rest."""
        first, second = (self.growth(body, link.frame.position) + self._half(link, end) for end, body in enumerate(link.joins))
        return spatial_rotation(link.frame.rotation).mT @ (second - first)

    def _half(self, link: PlacedLink, end: int) -> Array:
        """Expansion of the half of a part next to a body, minus that of the body, at the part's centre."""
        if link.name not in self.expansion.parts:
            return np.zeros((6, 4))
        own, length = self.expansion.parts[link.name]
        more = own - self.expansion.bodies[link.joins[end]]
        arm = (0.5 if end == 0 else -0.5) * np.asarray(length)[..., None] * link.frame.rotation[..., :, 0]
        return np.asarray(more)[..., None, None] * _growth(arm, link.frame.position - arm - self.datum)


@check_arguments
def drift(mechanism: Mechanism, model: LinearModel, *, ground: str | None = None, datum: Vector = (0.0, 0.0, 0.0)) -> Drift:
    """Compute the thermal drift of a stage with strokes fixed: bodies and parts expand, and the links deform elastically.

    `ground` names the ground's material (default: the material from `ground_of`); with `none`, the ground does not expand. Motions are
    relative to the ground's `datum`. A stage of one material, including the ground, expands without stress. Springs, shear piezos,
    amplified actuators and compliance matrices that replace no part do not expand: compute their expansion separately. If `model` is from
    `linearise(state, inner=False)`, its stiffness is that of the loaded stage, but the expansion is that of the nominal stage.

    Raises `DesignError` for missing expansion coefficients, an unknown ground material, or locked degrees of freedom that block expansion.
    `DesignError` is also raised for models with stiffness that does not belong to links: mapped models, and linearised models with `inner`
    coordinates.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> stage = double_triangle()
    >>> drifted = drift(stage, lumped(stage), ground="steel")
    >>> bool(abs(drifted.motion.at("platform.x", "uniform")) < 1e-15)
    True
    """
    thermal = _Thermal(expand(mechanism), expansion(mechanism, ground), stack(datum))
    misfits = {name: thermal.misfit(link) for name, link in thermal.assembly.links.items()}
    fitted = _fit_misfits(thermal.assembly, misfits)
    strains = {name: misfits[name] + fitted.strains.get(name, 0.0) for name in misfits}
    if LOADED in model.stiffness:
        strains[LOADED] = _stacked(fitted, model.stiffness[LOADED])
    if bent := flexible_links(mechanism) if BODIES in model.stiffness else ():
        strains[BODIES] = np.concatenate([strains[name] for name in bent])
    if other := _unlinked(model, strains):
        what = f"drift is not supported for models with stiffness outside links (got the stiffness of {other[0]})"
        raise refuse("drift", what, "Use the lumped model")
    whole = {name: _without_modes(strains[name], part.law.shape[-1] - strains[name].shape[-2]) for name, part in model.stiffness.items()}
    motion = model.follow(whole)
    twists = {body: moved + fitted.twists.get(body, 0.0) for body, moved in _twists(thermal.assembly, model, motion).items()}
    parts = {name: part for name, part in model.stiffness.items() if name in misfits}
    forces = {name: (part.law @ (part.operator @ motion + whole[name]))[..., :6, :] for name, part in parts.items()}
    if bent:
        bodies = model.stiffness[BODIES]
        relief = bodies.law @ (bodies.operator @ motion + strains[BODIES])
        forces |= {name: forces[name] + relief[6 * place : 6 * place + 6] for place, name in enumerate(bent)}
    return Drift(
        motion=_motions(thermal, twists),
        gauges=_gauges(thermal, twists),
        forces=_label(forces, FORCES, WRENCH_UNITS),
        ground=thermal.expansion.ground,
        datum=thermal.datum,
        taken=thermal.expansion.taken,
        provenance=f"{model.provenance}, ground {thermal.expansion.taken[GROUND]}",
        bodies=twists,
    )


def _unlinked(model: LinearModel, strains: Mapping[str, Array]) -> list[str]:
    """Stiffness terms other than links; about a state, links with internal deformation."""
    about = LOADED in model.stiffness
    return [
        name for name, part in model.stiffness.items() if name not in strains or (about and part.law.shape[-1] != strains[name].shape[-2])
    ]


def _stacked(fitted: _Fitted, part: Contribution) -> Array:
    """Motions (n, 4) of all bodies that follow the expansion and rotate the load."""
    twists = list(fitted.twists.values())
    return join(twists) if twists else np.zeros((part.law.shape[-1], 4))


def _without_modes(strain: Array, inner: int) -> Array:
    """Misfit (..., 6, k) of a link with internal modes, which do not expand."""
    return np.concatenate([strain, np.zeros((*strain.shape[:-2], inner, strain.shape[-1]))], axis=-2) if inner else strain


def _growth(arm: Array, origin: Array) -> Array:
    """Free expansion (..., 6, 4) over `arm` from a point at `origin` from the datum, for a unit coefficient and the four fields."""
    arm, origin = np.broadcast_arrays(arm, origin)
    square = np.sum(arm * arm, axis=-1)
    columns = [np.concatenate([arm, np.zeros_like(arm)], axis=-1)]
    for axis in range(3):
        slope = np.eye(3)[axis]
        shift = (origin[..., axis, None] + arm[..., axis, None]) * arm - 0.5 * square[..., None] * slope
        columns.append(np.concatenate([shift, matvec(_ABOUT[axis], arm)], axis=-1))
    return np.stack(columns, axis=-1)


@dataclass(frozen=True, eq=False)
class _Fitted:
    """Body motions for which locked degrees of freedom follow the expansion, and the resulting link deformations."""

    twists: Mapping[str, Array]
    strains: Mapping[str, Array]


def _fit_misfits(assembly: Assembly, misfits: Mapping[str, Array]) -> _Fitted:
    """Least-norm body motions that close the misfits of locked degrees of freedom."""
    bound = {
        name: law(link.part, link.material).locked for name, link in assembly.links.items() if isinstance(link.part, (Joint, Restricted))
    }
    if not any(bound.values()):
        return _Fitted({}, {})
    order = layout(assembly)
    operators = {name: deformation(assembly, order, link) for name, link in assembly.links.items()}
    picked = {name: [freedom.index for freedom in locked] for name, locked in bound.items() if locked}
    rows, gaps = (join(known[name][..., index, :] for name, index in picked.items()) for known in (operators, misfits))
    motion = -np.linalg.pinv(rows, rcond=1e-10) @ gaps
    left = np.max(np.abs(rows @ motion + gaps))
    if left > _FITS * np.max(np.abs(gaps)):
        raise refuse(
            "drift",
            f"locked degrees of freedom block thermal expansion (residual {float(left):.3g} m/K)",
            "Add elasticity to the restricted parts in the directions of expansion",
        )
    return _Fitted(
        {body: motion[..., order.columns(body), :] for body in order.bodies}, {name: item @ motion for name, item in operators.items()}
    )


def _twists(assembly: Assembly, model: LinearModel, motion: Array) -> dict[str, Array]:
    """Twist (..., 6, 4) of every body."""
    places = {body: model.output_index(tuple(f"{body}.{name}" for name in COMPONENTS)) for body in assembly.bodies}
    if model.is_sparse:
        outputs = model.output @ motion
        return {body: outputs[rows] for body, rows in places.items()}
    return {body: model.output[..., rows, :] @ motion for body, rows in places.items()}


def _motions(thermal: _Thermal, twists: Mapping[str, Array]) -> Matrix:
    result = {PLATFORM: twists[PLATFORM]}
    for name, (body, point) in thermal.assembly.points.items():
        carry = transport(point - thermal.assembly.bodies[body].reference)
        result[name] = carry @ twists[body] + thermal.growth(body, point)
    return _label(result, COMPONENTS, TWIST_UNITS)


def _gauges(thermal: _Thermal, twists: Mapping[str, Array]) -> Matrix:
    gauges = thermal.assembly.gauges
    rows = [sum(_reading(thermal, twists, sight) for sight in gauge.sights) for gauge in gauges.values()]
    values = np.stack(np.broadcast_arrays(*rows), axis=-2) if rows else np.zeros((0, 4))
    return Matrix(values, tuple(gauges), FIELDS, ratio_units(tuple(gauge.unit for gauge in gauges.values()), _FIELD_UNITS))


def _reading(thermal: _Thermal, twists: Mapping[str, Array], sight: Sight) -> Array:
    """Contribution of a line of sight to a reading (..., 4): expansion of the body relative to the base."""
    ends = [_material_motion(thermal, twists, body, at.position) for body, at in ((sight.body, sight.frame), (sight.base, sight.foot))]
    rows = slice(0, 3) if sight.component < 3 else slice(3, 6)
    direction = np.asarray(sight.weight)[..., None] * sight.frame.rotation[..., :, sight.component % 3]
    return (direction[..., None, :] @ (ends[0] - ends[1])[..., rows, :])[..., 0, :]


def _material_motion(thermal: _Thermal, twists: Mapping[str, Array], body: str, point: Array) -> Array:
    """Motion (..., 6, 4) of a body's material at a point."""
    grown = thermal.growth(body, point)
    return grown if body == GROUND else transport(point - thermal.assembly.bodies[body].reference) @ twists[body] + grown


def _label(blocks: Mapping[str, Array], components: tuple[str, ...], units: tuple[str, ...]) -> Matrix:
    rows = tuple(f"{name}.{component}" for name in blocks for component in components)
    return Matrix(join(blocks.values()), rows, FIELDS, ratio_units(units * len(blocks), _FIELD_UNITS))
