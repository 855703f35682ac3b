"""Lumped model: rigid bodies with six degrees of freedom, joined by links with 6x6 stiffness.

The stiffness is K = sum H^T k H, with H the relative twist at each link per coordinate. Bodies and parts contribute to the mass M. A stroke
is an imposed deformation of its actuator. A force is a pair of opposite wrenches, H^T w, on the two bodies of its actuator.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import cast

import numpy as np
import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Array, Number, first_design, join, same_batch
from flexstage.base.sparse import Rows, Sparse, below
from flexstage.base.storage.digest import digest
from flexstage.beams.compliance import Law, law, law_of, viscous_damping
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, PlacedSuperelement, by_part, expand
from flexstage.mechanism.assembly.incidence import LARGE, Layout, end_twists, is_single, layout, require_room, twist_at, with_ground
from flexstage.mechanism.assembly.moving_mass import moving_inertia
from flexstage.mechanism.drawn import as_drawn
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.mechanism.restrict import Freedoms
from flexstage.models.flexible_bodies import with_estimated_bodies
from flexstage.models.linear.channels import (
    Motions,
    absolute,
    exerted_wrenches,
    gauge_rows,
    imposed_strokes,
    input_channels,
    output_channels,
    place_twists,
    twist_places,
    wrench_owners,
    wrench_places,
)
from flexstage.models.linear.eigen import cholesky, sign_weights
from flexstage.models.linear.elimination import Elimination, eliminate, imposed_motion, unlike
from flexstage.models.linear.large import SINGULAR, Quadratic, Solver, surely_definite
from flexstage.models.linear.model import Contribution, Contributions, LinearModel, assemble, strain_forces
from flexstage.parts.condensation import Condensed, condense
from flexstage.parts.freedom import ALL, Freedom
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted
from flexstage.parts.stated import negative_part
from flexstage.spatial.frame import FORCES, spatial_rotation, twist_transform

_ROUNDING = 1e-12
_MASSLESS = 1e-12
_STILL = 1e-7
_BLOCKED = 1e-7
_APART = 1e-6
_MATRICES = 20.0
"""Dense matrices in memory at once, including modes and their energies by body: 19 to 24 on chains of 200 and 300 rods, measured."""
_STRETCHES = 1e-5
_OVER: Array = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])
"""Rotations are compared with translations over 0.1 m."""


class Masses(Enum):
    """Masses in the model: masses of all bodies and links, or only the mass of the platform with its payloads (Shin & Moon)."""

    ALL = "all"
    PLATFORM = "platform"


@dataclass(frozen=True, eq=False)
class _Stage:
    """Operators of the stage: twists of the `ends` of every link, `strains`, rows of locked `freedoms`, `rigid` motion with the ground.

    The ends of a superelement are its ports, its strains the port twists relative to the body of the first one.
    """

    assembly: Assembly
    order: Layout
    ends: Mapping[str, tuple[Array, ...]]
    strains: Mapping[str, Contribution]
    freedoms: Mapping[str, tuple[Freedom, ...]]
    rigid: Array

    @property
    def locked(self) -> Mapping[str, Array]:
        """The rows (..., l, N) of the locked DOFs of every link."""
        indices = {name: [freedom.index for freedom in freedoms] for name, freedoms in self.freedoms.items()}
        return {name: self.strains[name].operator[..., rows, :] for name, rows in indices.items()}

    @property
    def motions(self) -> Motions:
        bodies = {name: self.order.selector(name) for name in self.assembly.bodies}
        return Motions(bodies, lambda body, frame: twist_at(self.assembly, self.order, body, frame))


@check_arguments
def lumped(mechanism: Mechanism, masses: Masses = Masses.ALL) -> LinearModel:
    """Build the linear model of a stage: rigid bodies joined by links with 6x6 stiffness.

    The model is valid for small displacements about the nominal position and for frequencies below the first resonance of the parts.

    - Locked DOFs of `Restricted` and `Joint` parts are eliminated exactly. A stroke along a locked axis is an imposed motion.
    - Free internal modes without effect on the platform are removed from the coordinates and listed in `idle`; their inertia is still
      included.
    - With `elastic_bodies`, bodies have the compliance that `body_flexibilities` estimates. This option is limited to single designs.

    Raises `DesignError` if bodies can move freely (K is singular), with the names of these bodies, and if locked DOFs block a stroke. The
    function also raises this error if negative stiffnesses make the nominal position unstable. If the first design of a batch is stable,
    the stiffness of unstable designs is NaN.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(lumped(double_triangle()).coordinates)
    114
    """
    return _model(mechanism, _stage_without_zeros(mechanism) or _stage(mechanism), masses)


def variants(
    mechanism: Mechanism, kept: Iterable[Mapping[str, tuple[Freedoms, Freedoms]]], masses: Masses = Masses.ALL
) -> Iterator[LinearModel]:
    """Build one model for each mapping in `kept`; a mapping contains the new DOFs (elastic, free) of restricted parts by part name.

    The stage is expanded only once. Raises `DesignError` as `lumped` does.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.restrict import restrict
    >>> from flexstage.models.linear.static import static_gain
    >>> stage = restrict(double_triangle(), {"lever_notch": ((), (Freedom.RZ,))})
    >>> models = variants(stage, [{}, {"lever_notch": ((Freedom.RZ,), ())}])
    >>> [round(static_gain(model, ("platform.z",), ("B4",)).values.item(), 3) for model in models]
    [0.993, 0.969]
    """
    stage = _stage(mechanism)
    return (_model(mechanism, _restricted(stage, each), masses) for each in kept)


def _restricted(stage: _Stage, kept: Mapping[str, tuple[Freedoms, Freedoms]]) -> _Stage:
    """The stage with other DOFs of the named restricted parts."""
    links = dict(stage.assembly.links)
    for name, link in links.items():
        if link.link.part in kept:
            elastic, free = kept[link.link.part]
            links[name] = replace(link, part=replace(cast("Restricted", link.part), elastic=elastic, free=free))
    laws = {name: law(link.part, link.material) for name, link in links.items() if link.link.part in kept}
    strains = {name: replace(stage.strains[name], law=item.stiffness) for name, item in laws.items()}
    locked = {name: laws[name].locked if name in laws else stage.freedoms.get(name, ()) for name in links}
    return replace(
        stage,
        assembly=replace(stage.assembly, links=links),
        strains={**stage.strains, **strains},
        freedoms={name: freedoms for name, freedoms in locked.items() if freedoms},
    )


def _model(mechanism: Mechanism, stage: _Stage, masses: Masses) -> LinearModel:
    inertia = _inertia(mechanism, stage, masses)
    carried = _carrier_forces(stage, inertia)
    kept = _retain_motions(stage, inertia)
    basis = kept.basis
    force, imposed = _inputs(stage, kept.driven)
    output, feedthrough = _outputs(stage, imposed)
    if kept.driven is not None:
        feedthrough = feedthrough + _unsprung(stage, output) @ kept.driven
    idle = kept.idle
    model = LinearModel(
        coordinates=kept.coordinates,
        stiffness=_stable(stage, {name: _through(item, basis) for name, item in stage.strains.items()}, len(kept.coordinates)),
        inertia={name: _through(item, basis) for name, item in inertia.items()},
        inputs=input_channels(stage.assembly),
        force=_project(force, basis),
        imposed=imposed,
        outputs=output_channels(stage.assembly),
        output=output if basis is None else output @ basis,
        feedthrough=feedthrough,
        rigid=_rigid_coordinates(stage, kept.coordinates),
        rigid_output=_rigid_output(stage, output, carried, idle),
        base_inertia=_project(carried, basis),
        damping=mechanism.damping,
        idle=() if idle is None else idle.names,
        provenance=f"lumped model of {digest(mechanism, physics=True)[:16]}",
        inertial=None if kept.driven is None else _project(_momentum(inertia, kept.driven), basis),
        idle_output=None if idle is None else output @ idle.motions,
        idle_inertia=None if idle is None else _idle_inertia(stage, inertia, idle, carried),
        viscous=_viscous(stage.assembly),
        floating=kept.floating,
        unknown=tuple(f"{name}.{FORCES[freedom.index]}" for name, freedoms in stage.freedoms.items() for freedom in freedoms),
    )
    return with_estimated_bodies(model, mechanism) if mechanism.elastic_bodies else model


@dataclass(frozen=True, eq=False)
class _Idle:
    """Free internal modes (..., N, k), their coordinates, and which of them have inertia `mass` (..., h, h)."""

    motions: Array
    names: tuple[str, ...]
    heavy: tuple[int, ...]
    mass: Array

    def momentless(self, momentum: Array) -> Array:
        """Correction of a motion (..., N, m) of `momentum` M z (..., N, m) that leaves no momentum in the free internal modes."""
        heavy = self.motions[..., list(self.heavy)]
        return -(heavy @ np.linalg.solve(*same_batch(self.mass, heavy.mT @ momentum)))


@dataclass(frozen=True, eq=False)
class _RetainedMotions:
    """z = `basis` q + `driven` u: the retained motions (default: all), and motions imposed by inputs on locked DOFs (default: none)."""

    basis: Array | None
    driven: Array | None
    coordinates: tuple[str, ...]
    idle: _Idle | None
    floating: Array | None = None


def _stage_without_zeros(mechanism: Mechanism) -> _Stage | None:
    """Sparse operators of a large stage; `None` for small stages, batches, and stages with DOFs or motions that are not elastic."""
    assembly = expand(mechanism)
    if len(assembly.bodies) < LARGE or assembly.superelements or not is_single(assembly):
        return None
    stage = _stage(mechanism, sparse=True)
    if stage.freedoms or any(item.law.ndim > 2 or np.iscomplexobj(item.law) for item in stage.strains.values()):
        return None
    numbers = {name: place for place, name in enumerate(stage.order.bodies)} | {GROUND: len(stage.order.bodies)}
    joins = ((numbers[first], numbers[second]) for first, second in (link.joins for link in assembly.links.values()))
    laws = [item.law for item in stage.strains.values()]
    if surely_definite(laws, joins, len(stage.order.bodies)):
        return stage
    operators = (cast("Sparse", item.operator) for item in stage.strains.values())
    return stage if Solver(Quadratic.of(operators, laws, stage.order.size)).definite() else None


def _stage(mechanism: Mechanism, *, sparse: bool = False) -> _Stage:
    assembly = expand(mechanism)
    if not sparse:
        require_room(assembly, _MATRICES)
    with np.errstate(all="ignore"):  # overflow is refused below
        known = by_part(assembly.links, _law_and_whole)
    laws, whole = {name: own for name, (own, _) in known.items()}, {name: each for name, (_, each) in known.items()}
    inner = {name: item.inner.shape[-1] for name, item in laws.items() if item.inner is not None}
    inner |= {name: len(_condensed(element).squares) for name, element in assembly.superelements.items()}
    order = layout(assembly, inner, sparse=sparse)
    ends: dict[str, tuple[Array, ...]] = {name: end_twists(assembly, order, link) for name, link in assembly.links.items()}
    strains: dict[str, Contribution] = {}
    for name, link in assembly.links.items():
        operator = _with_inner(order, name, (ends[name][1] - ends[name][0],))
        strains[name] = Contribution(operator, whole[name], _loss_factor(as_drawn(mechanism, link)))
    for name, element in assembly.superelements.items():
        ends[name] = tuple(twist_at(assembly, order, port.body, port.frame) for port in element.ports.values())
        strains[name] = _strain_of(assembly, order, element)
    require(_non_finite(assembly, {name: item.stiffness for name, item in laws.items()}, "stiffness"))
    locked = {name: item.locked for name, item in laws.items() if item.locked}
    return _Stage(assembly, order, ends, strains, locked, with_ground(assembly, order))


def _condensed(element: PlacedSuperelement) -> Condensed:
    return condense(element.part, f"parts.{element.link.part}")


def _strain_of(assembly: Assembly, order: Layout, element: PlacedSuperelement) -> Contribution:
    """Stiffness of a superelement over the port twists relative to the body of the first port, and over its modes."""
    condensed = _condensed(element)
    first, *others = element.ports.values()
    relative = [twist_at(assembly, order, each.body, each.frame) - twist_at(assembly, order, first.body, each.frame) for each in others]
    loss = element.part.loss_factor
    law = _block_diagonal(condensed.stiffness, np.diag(condensed.squares))
    return Contribution(_with_inner(order, element.name, tuple(relative)), law, 0.0 if loss is None else loss)


def _with_inner(order: Layout, link: str, rows: tuple[Array, ...]) -> Array:
    """Rows (..., r, N) of a link stacked above those of its inner coordinates."""
    if order.sparse:
        return cast("Array", below(cast("tuple[Sparse, ...]", (*rows, order.inner_selector(link))), order.size))
    return join([*rows, order.inner_selector(link)])


def _law_and_whole(part: Part, material: Material | None) -> tuple[Law, Array]:
    """The law of a link, and the stiffness (..., 6 + m, 6 + m) of its relative twist and its inner coordinates, which are decoupled."""
    own = law(part, material)
    return own, own.stiffness if own.inner is None else _block_diagonal(own.stiffness, own.inner[..., None] * np.eye(own.inner.shape[-1]))


def _block_diagonal(first: Array, second: Array) -> Array:
    batch, count = np.broadcast_shapes(first.shape[:-2], second.shape[:-2]), first.shape[-1]
    size = count + second.shape[-1]
    result = np.zeros((*batch, size, size), dtype=np.result_type(first, second))
    result[..., :count, :count], result[..., count:, count:] = first, second
    return result


def _viscous(assembly: Assembly) -> dict[str, Array]:
    """Dampers of parts, by link."""
    dampers = by_part(assembly.links, lambda part, _: viscous_damping(part))
    elements = {name: _condensed(element).damping for name, element in assembly.superelements.items()}
    return {name: damping for name, damping in (*dampers.items(), *elements.items()) if damping is not None}


def _non_finite(assembly: Assembly, values: Mapping[str, Array], what: str) -> Iterator[Finding]:
    """Links with non-finite stiffness or inertia in the first design, once per part, with the numbers of the part."""
    listed: set[str] = set()
    for name, value in values.items():
        link = assembly.links[name]
        if link.link.part not in listed and not np.all(np.isfinite(np.real(first_design(value, 2)))):
            listed.add(link.link.part)
            numbers = node_of(type(link.part)).numbers(link.part)
            value_list = ", ".join(
                f"{place} {float(np.ravel(np.real(number))[0]):.4g} {node.quantity.si}" for place, number, node in numbers
            )
            advice = "Correct the extreme value"
            yield Finding(name, f"non-finite {what} for the numbers of part {link.link.part}: {value_list}", advice)


def _require_distinguishable(stage: _Stage, loose: Array, basis: Array | None) -> None:
    """Refuse stiffness ratios so large that rounding makes a motion with elastic deformation appear loose."""
    over = {
        name: np.tile(_OVER, (item.law.shape[-1] - stage.order.inner.get(name, 0)) // 6)[:, None] for name, item in stage.strains.items()
    }
    stiffness = {
        name: np.diag(np.real(first_design(item.law, 2)))[: len(over[name])] / over[name][:, 0] ** 2 for name, item in stage.strains.items()
    }
    full = loose if basis is None else np.real(first_design(basis, 2)) @ loose
    weights = sign_weights(stage.order.coordinates)
    size = np.max(np.abs(full) * weights[:, None], axis=0)
    strains = {
        name: np.abs(np.real(first_design(item.operator, 2))[: len(over[name])] @ full) * over[name] for name, item in stage.strains.items()
    }
    hidden = [name for name in stage.strains if np.any(strains[name][stiffness[name] > 0.0] > _STRETCHES * size)]
    if hidden:
        ends = {name: value[value > 0.0] for name, value in stiffness.items() if np.any(value > 0.0)}
        soft = min(hidden, key=lambda name: ends[name].min())
        stiff = max(ends, key=lambda name: ends[name].max())
        raise refuse(
            stiff,
            f"stiffnesses from {ends[soft].min():.3g} N/m ({soft}) to {ends[stiff].max():.3g} N/m ({stiff}) differ too much for "
            "double precision (rotational stiffnesses are divided by (0.1 m)^2)",
            f"Check for an extreme value in {stiff} or {soft}, or lock the stiff degrees of freedom",
        )


def _loss_factor(link: PlacedLink) -> Number:
    inner = link.part.part if isinstance(link.part, Restricted) else link.part
    holder = link.material if link.material is not None else inner
    value = getattr(holder, "loss_factor", None)
    return 0.0 if value is None else value


def _retain_motions(stage: _Stage, inertia: Mapping[str, Contribution]) -> _RetainedMotions:
    """Motions that satisfy the locked DOFs and have no momentum in free internal modes."""
    names = stage.order.coordinates
    scale = np.array([10.0 if name.rpartition(".")[2].startswith("r") else 1.0 for name in names])
    basis: Array | None = None
    driven: Array | None = None
    independent = tuple(range(stage.order.size))
    if stage.locked:
        rows = join(stage.locked.values())
        solution = eliminate(rows, scale, keep=tuple(range(6)))
        basis, independent = solution.basis, solution.independent
        driven = _stroke_motion(stage, solution, rows)
    if not independent:
        what = f"every degree of freedom is locked, by {', '.join(stage.freedoms)}, so that nothing is elastic"
        raise refuse("stage", what, "Add stiffness to a link; the ideal model computes the motion due to strokes")
    loose = np.zeros((len(names), 0)) if stage.order.sparse else _loose(stage, basis)
    if _moves_platform(loose, independent) and (floating := _driven_motions(stage, inertia, basis, loose)) is not None:
        return _RetainedMotions(basis, driven, tuple(names[index] for index in independent), None, floating)
    named = _loose_coordinates(stage, loose, independent)
    _require_same_loose(stage, basis, independent, named)
    if not named:
        return _RetainedMotions(basis, driven, tuple(names[index] for index in independent), None)
    left = [index for index in range(len(independent)) if index not in named]
    full = np.eye(stage.order.size) if basis is None else basis
    idle = _idle(stage, inertia, full, tuple(names[independent[index]] for index in named), left=left, named=named)
    kept, driven = (
        None if motion is None else motion + idle.momentless(_momentum(inertia, motion)) for motion in (full[..., left], driven)
    )
    return _RetainedMotions(kept, driven, tuple(names[independent[index]] for index in left), idle)


def _driven_motions(stage: _Stage, inertia: Mapping[str, Contribution], basis: Array | None, loose: Array) -> Array | None:
    """The `loose` motions (n, k), mass-normalised, if the force actuators of one design drive all of them."""
    full = loose if basis is None else basis @ loose
    wrenches = exerted_wrenches(stage.assembly)
    if not wrenches:
        return None
    mass = full.mT @ _momentum(inertia, full)
    laws = max(item.law.ndim for item in stage.strains.values())
    thrusts = sum((stage.strains[name].operator[..., :6, :].mT @ wrench for name, wrench in wrenches.items()), np.zeros((1, 1)))
    work = np.real(first_design(full.mT @ thrusts, 2))
    sizes = np.linalg.norm(work, axis=0)
    moved = work[:, sizes > _APART * np.max(sizes)] / sizes[sizes > _APART * np.max(sizes)]
    if np.linalg.matrix_rank(moved, tol=_APART) < loose.shape[1] or np.linalg.cond(np.real(first_design(mass, 2))) > 1.0 / _MASSLESS:
        return None
    if max(mass.ndim, full.ndim, thrusts.ndim, laws) > 2 or np.iscomplexobj(mass) or np.iscomplexobj(full):
        what = "forces drive a motion without stiffness, which is not supported for a batch of designs"
        raise refuse("stage", what, "Analyse the designs one by one, or add a spring")
    return loose @ np.linalg.inv(np.linalg.cholesky(mass)).T


def _stroke_motion(stage: _Stage, solution: Elimination, rows: Array) -> Array | None:
    """Motion (..., N, inputs) that strokes impose on locked DOFs; absent if no actuator is locked along its stroke."""
    locked = [(name, freedom) for name, freedoms in stage.freedoms.items() for freedom in freedoms]
    none = np.zeros((6, len(input_channels(stage.assembly))))
    strokes = _strokes(stage)
    imposed = np.stack(np.broadcast_arrays(*(strokes.get(name, none)[..., freedom.index, :] for name, freedom in locked)), axis=-2)
    if not imposed.any():
        return None
    motion = imposed_motion(solution, rows, imposed)
    missed = np.abs(np.real(rows @ motion - imposed)) > _BLOCKED
    require(_blocked_findings(stage, locked, np.any(missed, axis=tuple(range(missed.ndim - 2)))))
    return motion


def _blocked_findings(stage: _Stage, locked: list[tuple[str, Freedom]], missed: Array) -> Iterator[Finding]:
    """Errors of strokes (columns) that locked DOFs (rows) cannot follow."""
    for number, (name, link) in enumerate(stage.assembly.actuators.items()):
        blocking = [f"{locked[row][0]}.{locked[row][1].value}" for row in np.flatnonzero(missed[:, number])]
        if blocking:
            what = f"the stroke of actuator {name} is blocked: no DOF is elastic between its locked axis and {', '.join(blocking[:6])}"
            yield Finding(link, what, "Free one of these DOFs, or specify a stiffness for one of them")


def _idle(
    stage: _Stage, inertia: Mapping[str, Contribution], basis: Array, names: tuple[str, ...], *, left: list[int], named: list[int]
) -> _Idle:
    """Free internal modes, each with a unit in one of the `named` coordinates; the `left` ones follow: K_ll n_l = -K_ln."""
    stiffness = assemble({name: _through(item, basis) for name, item in stage.strains.items()}, basis.shape[-1])
    inner = stiffness[..., left, :][..., left]
    root = np.sqrt(np.abs(np.linalg.diagonal(np.real(inner))))
    root = np.where(root > 0.0, root, 1.0)
    solved = np.linalg.solve(inner / root[..., None] / root[..., None, :], stiffness[..., left, :][..., named] / root[..., None])
    small = np.zeros((*stiffness.shape[:-2], basis.shape[-1], len(named)), dtype=stiffness.dtype)
    small[..., left, :] = -solved / root[..., None]
    small[..., named, :] = np.eye(len(named))
    motions = basis @ small
    mass = motions.mT @ _momentum(inertia, motions)
    heavy = _inertial_modes_of_batch(np.real(mass), _largest(inertia, np.real(motions), stage.order.coordinates))
    return _Idle(motions, names, heavy, mass[..., heavy, :][..., heavy])


def _largest(inertia: Mapping[str, Contribution], motions: Array, coordinates: tuple[str, ...]) -> Array:
    """Sum of magnitudes of the terms of n^T M n (..., k): a free internal mode with much less inertia has rounding only.

    Coordinates at rest (to rounding) count as if they moved by a fraction of the largest, with angles times 0.1 m.
    """
    lengths = np.array([0.1 if name.rpartition(".")[2].startswith("r") else 1.0 for name in coordinates])[:, None]
    least = _STILL * np.max(lengths * np.abs(motions), axis=-2, keepdims=True) / lengths
    total = np.zeros(motions.shape[-1])
    for item in inertia.values():
        strains = np.abs(np.real(item.operator)) @ np.maximum(np.abs(motions), least)
        total = total + np.sum(strains * (np.abs(np.real(item.law)) @ strains), axis=-2)
    return total


def _inertial_modes_of_batch(mass: Array, largest: Array) -> tuple[int, ...]:
    """`_inertial_modes` of the first design of (..., k, k); raises if another design differs."""
    batch, count = np.broadcast_shapes(mass.shape[:-2], largest.shape[:-1]), mass.shape[-1]
    masses = np.broadcast_to(mass, (*batch, count, count)).reshape(-1, count, count)
    first, *others = map(_inertial_modes, masses, np.broadcast_to(largest, (*batch, count)).reshape(-1, count))
    for number, heavy in enumerate(others, 1):
        if heavy != first:
            raise unlike(number, "differs from the first design in the free internal modes that have inertia")
    return first


def _inertial_modes(mass: Array, largest: Array) -> tuple[int, ...]:
    """As many free internal modes as have independent inertia; M-orthogonality to these implies M-orthogonality to all."""
    some = np.flatnonzero(np.diag(mass) > _MASSLESS * largest)
    if not len(some):
        return ()
    root = np.sqrt(np.diag(mass)[some])
    _, triangle, order = scipy.linalg.qr(mass[np.ix_(some, some)] / root / root[:, None], pivoting=True)
    rank = int(np.sum(np.abs(np.diag(triangle)) > _MASSLESS))
    return tuple(sorted(int(some[index]) for index in order[:rank]))


def _momentum(inertia: Mapping[str, Contribution], motion: Array) -> Array:
    """Multiply M by a motion (..., N, m)."""
    return strain_forces(inertia, {name: item.operator @ motion for name, item in inertia.items()}) if inertia else np.zeros_like(motion)


def _unsprung(stage: _Stage, output: Array) -> Array:
    """Output rows (..., p, N) without link forces, which include imposed motions by their own deformation."""
    forces = 6 * len(wrench_owners(stage.assembly))
    return np.concatenate([output[..., : output.shape[-2] - forces, :], np.zeros((*output.shape[:-2], forces, output.shape[-1]))], axis=-2)


def _loose(stage: _Stage, basis: Array | None) -> Array:
    """Null space (n, k) of the first design's stiffness in the independent coordinates."""
    strains = _strains(stage, basis, lambda values: np.real(first_design(values, 2)))
    values, loose = _softest(assemble(strains, stage.order.size if basis is None else basis.shape[-1]))
    if np.min(values, initial=0.0) < -SINGULAR:
        raise _unstable(stage, strains, loose[:, 0] if basis is None else np.real(first_design(basis, 2)) @ loose[:, 0])
    _require_distinguishable(stage, loose, basis)
    return loose


def _strains(stage: _Stage, basis: Array | None, of_designs: Callable[[Array], Array]) -> dict[str, Contribution]:
    """Real strains of the links in the independent coordinates, without rounding, of selected designs."""
    own = None if basis is None else of_designs(basis)
    return {
        name: Contribution(_without_rounding(of_designs(item.operator), own), of_designs(item.law)) for name, item in stage.strains.items()
    }


def _softest(stiffness: Array) -> tuple[Array, Array]:
    """Eigenvalues (k,) below `SINGULAR` of a stiffness (n, n) scaled to a unit diagonal, ascending, and their motions (n, k)."""
    diagonal = np.sqrt(np.where(np.diag(stiffness) > 0.0, np.diag(stiffness), 1.0))
    scaled = stiffness / diagonal / diagonal[:, None]
    try:
        pivots = np.diag(np.linalg.cholesky(scaled))
        if np.min(pivots) ** 2 > SINGULAR:
            return np.zeros(0), np.zeros((len(diagonal), 0))
    except np.linalg.LinAlgError:
        pass
    values, vectors = np.linalg.eigh(scaled)
    return values[values < SINGULAR], vectors[:, values < SINGULAR] / diagonal[:, None]


def _require_same_loose(stage: _Stage, basis: Array | None, independent: tuple[int, ...], named: list[int]) -> None:
    """Refuse batch designs whose motions without stiffness differ from the first, or hardly depend on the `named` coordinates."""
    if stage.order.sparse or all(item.operator.ndim == item.law.ndim == 2 for item in stage.strains.values()):
        return
    laws = (np.linalg.diagonal(np.real(item.law)) for item in stage.strains.values())
    if all(np.all(law > 0.0) for law in laws):
        return
    stiffness = assemble(_strains(stage, basis, np.real), stage.order.size if basis is None else basis.shape[-1])
    designs = stiffness.reshape(-1, *stiffness.shape[-2:])
    for number in range(1, len(designs)):
        if np.all(np.isfinite(designs[number])) and not np.array_equal(designs[number], designs[number - 1]):
            values, loose = _softest(designs[number])
            steady = np.min(values, initial=0.0) >= -SINGULAR  # other designs are NaN: `_stable`
            if steady and (loose.shape[1] != len(named) or _moves_platform(loose, independent) or not _are_distinguishable(loose, named)):
                raise unlike(number, "differs from the first design in its motions without stiffness")


def _unstable(stage: _Stage, strains: Contributions, motion: Array) -> DesignError:
    """Error of a nominal position that negative stiffnesses make unstable in a `motion` (N,): parts, values and stable limits."""
    depths = {name: negative_part(strains[name].law, _OVER) for name in stage.assembly.links}
    pushing = {name: Contribution(strains[name].operator, depth) for name, depth in depths.items() if depth.any()}
    size = strains[next(iter(strains))].operator.shape[-1]
    steep = assemble(pushing, size)
    share = _critical_share(assemble(strains, size) + steep, steep)
    stiffnesses = ", ".join(f"{name} has {_least_entry(np.diag(strains[name].law), share)}" for name in pushing)
    what = f"the nominal position is unstable: {stiffnesses}. The stage buckles in {_largest_coordinate(stage, motion)}"
    return refuse(", ".join(pushing), what, "Make this stiffness less negative, or the stage stiffer in that motion")


def _critical_share(other: Array, steep: Array) -> float:
    """Largest stable factor on the negative stiffness `steep`, given the other stiffness `rest` (n, n)."""
    root = np.sqrt(np.where(np.diag(other) > 0.0, np.diag(other), 1.0))
    other, steep = (each / root / root[:, None] for each in (other, steep))
    values, vectors = np.linalg.eigh(other)
    loose, stiff = vectors[:, values < SINGULAR], vectors[:, values >= SINGULAR]
    if np.max(np.diag(loose.T @ steep @ loose), initial=0.0) > SINGULAR * np.max(np.diag(steep)):
        return 0.0
    half = stiff / np.sqrt(values[values >= SINGULAR])
    return float(1.0 / np.linalg.eigvalsh(half.T @ steep @ half)[-1])


def _least_entry(diagonal: Array, share: float) -> str:
    """The most negative stiffness of a part by DOF, rotations over 0.1 m, and its stable fraction."""
    place = int(np.argmin(diagonal / _OVER**2))
    if diagonal[place] >= 0.0:
        return f"a negative stiffness with coupled degrees of freedom (stable limit {share:.4g} times this stiffness)"
    unit = "N/m" if place < len(_OVER) // 2 else "N m/rad"
    limit = f"stable limit {share * diagonal[place]:.6g} {unit}, {share:.4g} times this stiffness"
    return f"{diagonal[place]:.6g} {unit} in {ALL[place].value} ({limit})"


def _largest_coordinate(stage: _Stage, motion: Array) -> str:
    """The coordinate of largest motion, rotations over 0.1 m."""
    return stage.order.coordinates[int(np.argmax(np.abs(motion) * sign_weights(stage.order.coordinates)))]


def _stable(stage: _Stage, strains: Contributions, size: int) -> Contributions:
    """The contributions, with NaN for later designs of a batch that negative stiffnesses make unstable."""
    links = stage.assembly.links.items()
    original = next((name for name, link in links if (known := law_of(link.part)) is not None and known.stiffness is not None), None)
    if original is None or stage.order.sparse:
        return strains
    total = assemble(strains, size)
    if total.ndim == 2:
        return strains
    failed = np.isnan(cholesky(np.real(total))[..., :1, :1])
    return {**strains, original: replace(strains[original], law=np.where(failed, np.nan, strains[original].law))}


def _without_rounding(operator: Array, basis: Array | None) -> Array:
    """The operator in the basis without entries of pure rounding, which would give an idle coordinate a spurious stiffness."""
    if basis is None:
        return operator
    product = operator @ basis
    largest = np.max(np.abs(operator), axis=-1, keepdims=True) * np.max(np.abs(basis), axis=-2, keepdims=True)
    return np.where(np.abs(product) > _ROUNDING * largest, product, 0.0)


def _loose_coordinates(stage: _Stage, loose: Array, independent: tuple[int, ...]) -> list[int]:
    """Coordinates that distinguish the loose motions; raises for a mechanism, with a loose motion of the platform."""
    if _moves_platform(loose, independent):
        raise refuse(
            "stage",
            f"the stiffness matrix is singular: {loose.shape[1]} motion(s) without stiffness move the platform and "
            f"{', '.join(_moving(stage, loose, independent))}",
            "Add a link that constrains this motion, or check the free degrees of freedom of the links",
        )
    order = scipy.linalg.qr(_as_ones(loose).T, pivoting=True)[2]
    return sorted(int(index) for index in order[: loose.shape[1]])


def _moves_platform(loose: Array, independent: tuple[int, ...]) -> bool:
    platform = [position for position, index in enumerate(independent) if index < 6]
    return bool(np.any(np.abs(_as_ones(loose)[platform]) > 1e-6))


def _are_distinguishable(loose: Array, named: list[int]) -> bool:
    """Whether the named coordinates distinguish the loose motions (n, k)."""
    return not named or bool(np.linalg.svd(_as_ones(loose)[named], compute_uv=False)[-1] > _APART)


def _as_ones(motions: Array) -> Array:
    """Motions (n, k) scaled to a largest coordinate of one."""
    return motions / np.max(np.abs(motions), axis=0, initial=0.0)


def _moving(stage: _Stage, loose: Array, independent: tuple[int, ...]) -> list[str]:
    size = np.max(np.abs(loose), axis=1)
    names = [stage.order.coordinates[independent[index]].rpartition(".")[0] for index in np.flatnonzero(size > 0.1 * size.max())]
    return list(dict.fromkeys(names))[:6]


def _through(item: Contribution, basis: Array | None) -> Contribution:
    return item if basis is None else Contribution(item.operator @ basis, item.law, item.loss_factor)


def _project(force: Array, basis: Array | None) -> Array:
    return force if basis is None else basis.mT @ force


def _inertia(mechanism: Mechanism, stage: _Stage, masses: Masses) -> dict[str, Contribution]:
    result: dict[str, Contribution] = {}
    for name, placed in stage.assembly.bodies.items():
        if masses is Masses.PLATFORM and name != PLATFORM:
            continue
        matrix = moving_inertia(mechanism, placed)
        if matrix is not None:
            result[name] = Contribution(stage.order.selector(name), matrix)
    if masses is Masses.ALL:
        own = by_part(stage.assembly.links, mass)
        require(_non_finite(stage.assembly, own, "inertia"))
        for name, matrix in own.items():
            result[_of_link(name)] = Contribution(_with_inner(stage.order, name, stage.ends[name]), matrix)
        for name, element in stage.assembly.superelements.items():
            result[_of_link(name)] = Contribution(_with_inner(stage.order, name, stage.ends[name]), _condensed(element).inertia)
    return result


def _of_link(name: str) -> str:
    return f"{name} (link)"


def _carrier_forces(stage: _Stage, inertia: Mapping[str, Contribution]) -> Array:
    """Inertial forces (..., n, 6) on the coordinates under a rigid acceleration of the stage and the ground."""
    centre = stage.assembly.bodies[PLATFORM].reference
    carried = {name: stage.rigid[..., stage.order.columns(name), :] for name in stage.order.bodies}
    for name, link in stage.assembly.links.items():
        carry = twist_transform(link.frame, centre)
        still = np.zeros((*carry.shape[:-2], stage.order.inner.get(name, 0), 6))
        carried[_of_link(name)] = np.concatenate([carry, carry, still], axis=-2)
    for name, element in stage.assembly.superelements.items():
        carries = [twist_transform(port.frame, centre) for port in element.ports.values()]
        carried[_of_link(name)] = join([*carries, np.zeros((stage.order.inner[name], 6))])
    return strain_forces(inertia, carried) if inertia else np.zeros((stage.order.size, 6))


def _idle_inertia(stage: _Stage, inertia: Mapping[str, Contribution], idle: _Idle, carried: Array) -> Array:
    """Inertial forces on the free internal modes per ground acceleration (..., k, 6), without rounding."""
    exerted = idle.motions.mT @ carried
    names = stage.order.coordinates
    spin, rigid = (_largest(inertia, np.real(motions), names) for motions in (idle.motions, stage.rigid))
    most = spin[..., :, None] * rigid[..., None, :]
    return np.where(np.abs(np.real(exerted)) > _ROUNDING * np.sqrt(most), exerted, 0.0)


def _inputs(stage: _Stage, driven: Array | None) -> tuple[Array, dict[str, Array]]:
    """Direct forces, and imposed deformations of links: strokes of sprung actuators, less the part of motions imposed elsewhere."""
    wrenches = [rows.mT for rows in place_twists(wrench_places(stage.assembly), stage.motions)]
    force = join([np.zeros((stage.order.size, len(stage.assembly.actuators))), *wrenches], axis=-1)
    for name, wrench in exerted_wrenches(stage.assembly).items():
        force = force + stage.strains[name].operator[..., :6, :].mT @ wrench
    imposed = _strokes(stage)
    if driven is not None:
        imposed = {name: imposed.get(name, 0.0) - item.operator @ driven for name, item in stage.strains.items()}
    return force, imposed


def _strokes(stage: _Stage) -> dict[str, Array]:
    """Imposed deformations of stroke-actuator links (..., r, inputs): their free deformations, zero on inner coordinates."""
    free: dict[str, Array] = {}
    for name, link in stage.assembly.strokes.items():
        own = stage.assembly.actuator(name).free_deformation
        inner = np.zeros((*own.shape[:-1], stage.order.inner.get(link, 0)))
        free[link] = np.concatenate([own, inner], axis=-1)
    return imposed_strokes(stage.assembly, free)


def _outputs(stage: _Stage, imposed: Mapping[str, Array]) -> tuple[Array, Array]:
    rows = [*place_twists(twist_places(stage.assembly), stage.motions), *gauge_rows(stage.assembly, stage.motions)]
    inputs = len(input_channels(stage.assembly))
    passed = [np.zeros((row.shape[-2], inputs)) for row in rows]
    exerted = exerted_wrenches(stage.assembly)
    for name, item in stage.strains.items():
        element = stage.assembly.superelements.get(name)
        law = item.law[..., :6, :] if element is None else _port_wrenches(element) @ item.law[..., : 6 * len(element.ports) - 6, :]
        rows.append(law @ item.operator)
        own = -law @ imposed[name] if name in imposed else np.zeros((law.shape[-2], inputs))
        passed.append(own - exerted[name] if name in exerted else own)
    through = join(passed)
    if stage.order.sparse:
        return cast("Array", Rows.of(cast("list[Sparse]", rows), stage.order.size)), through
    return join(rows), through


def _port_wrenches(element: PlacedSuperelement) -> Array:
    """Matrix (..., 6 p, 6 (p - 1)) to the wrenches at all ports from those at all but the first, which balances them."""
    first, *others = (port.frame for port in element.ports.values())
    carries = [twist_transform(frame, first.position) @ spatial_rotation(first.rotation) for frame in others]
    balance = -join(carries).mT
    return join([balance, np.eye(balance.shape[-1])])


def _rigid_coordinates(stage: _Stage, coordinates: tuple[str, ...]) -> Array:
    places = {name: number for number, name in enumerate(stage.order.coordinates)}
    return stage.rigid[..., [places[name] for name in coordinates], :]


def _rigid_output(stage: _Stage, output: Array, carried: Array, idle: _Idle | None) -> Array:
    """Outputs that move with the ground (..., p, 6); free internal modes stay behind, as only inertia moves them."""
    carried_along = np.where(absolute(stage.assembly)[:, None], output @ stage.rigid, 0.0)
    return carried_along if idle is None else carried_along + output @ idle.momentless(carried)
