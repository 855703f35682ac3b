"""Results of the whole stage as a solid: directional stiffness, modes, and the highest stress of every link over the strokes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.modes import Modes
from flexstage.analysis.linear_statics.statics import Statics, statics
from flexstage.analysis.workspace.load import dead_loads
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Called, Heading
from flexstage.base.units.quantity import RATIO
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.static import displacement
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.ties import stated_links
from flexstage.solid.results.read import STANDARD_REDUCTION, STANDARD_SOLIDS, SolidRead, Solids, read_solid
from flexstage.solid.results.stress import LinkStress, link_stress
from flexstage.spatial.frame import COMPONENTS

if TYPE_CHECKING:
    from flexstage.models.linear.model import Contribution, LinearModel

_BODY = " (body)"


@dataclass(frozen=True, eq=False)
class BodyCost:
    """Strain-energy fraction of elastic bodies in each platform mode (k,), and the resulting change of the frequency."""

    strain_energy_share: Annotated[Array, RATIO, Heading("strain energy in bodies", digits=3, unit="%")]
    cost_in_frequency: Annotated[Array, RATIO, Heading("frequency change", digits=3, unit="%")]


@dataclass(frozen=True, eq=False)
class SolidStage(InNotebook):
    """Results of a stage by the solid model.

    `statics` and `modes` are defined as for any model. `stress` is the highest stress of every link and body with permanent load, over all
    corners of the stroke ranges. Strokes are measured from zero voltage. `stress` is `None` if there are no strokes or too many corners.
    `worst` (N,) are the model's coordinates at the corner with the highest stress of the weakest link. `blocks` (k,) is the strain-energy
    fraction of the elastic bodies in each mode.
    """

    statics: Annotated[Statics, Called("stiffness")]
    modes: Modes
    stress: LinkStress | None
    worst: Array | None
    blocks: Array
    read: Annotated[SolidRead, INNER]

    @property
    def figures(self) -> Mapping[str, float]:
        """Values for which errors are estimated, by name, in SI units: stiffness and platform frequencies."""
        return _figures(self.statics, self.modes)

    @property
    def flexible(self) -> Array:
        """First-order relative change (k,) of each frequency due to the elasticity of bodies: sqrt(1 - strain-energy fraction) - 1."""
        return np.sqrt(1.0 - self.blocks) - 1.0

    @property
    def bodies(self) -> Annotated[BodyCost, VIEW]:
        """Effect of the elasticity of the bodies on the platform's modes."""
        platform = list(self.modes.platform)
        return BodyCost(self.blocks[platform], self.flexible[platform])

    @property
    def as_stated(self) -> Annotated[Mapping[str, str], VIEW]:
        """Links without a shape, with the kind of their part. As in any model, these links have their specified stiffness and mass."""
        return stated_links(expand(self.read.mechanism))

    @property
    def elements(self) -> Annotated[int, VIEW]:
        """Number of finite elements of all distinct components."""
        return self.read.elements

    @property
    def freedoms(self) -> Annotated[int, VIEW]:
        """Number of unknowns before reduction."""
        return self.read.freedoms

    @property
    def coordinates(self) -> Annotated[int, VIEW]:
        """Number of coordinates of the reduced model."""
        return len(self.read.model.coordinates)

    @property
    def provenance(self) -> Annotated[str, VIEW]:
        """Origin of the results: digest of the stage, and resolution of the model."""
        return self.read.model.provenance


def _figures(found: Statics, modes: Modes) -> dict[str, float]:
    return stiffness_figures(found) | mode_figures(modes)


def mode_figures(modes: Modes) -> dict[str, float]:
    """Return the frequencies of the platform's modes by name [Hz]."""
    return {f"platform mode {number + 1}": float(value) for number, value in enumerate(modes.platform_frequencies)}


def stage_figures(mechanism: Mechanism, reduction: Reduction = STANDARD_REDUCTION, reduce: Solids = STANDARD_SOLIDS) -> dict[str, float]:
    """Compute only the `figures` of a `SolidStage`, without stress. Raises the same `DesignError` as `solid_stage`."""
    model = read_solid(mechanism, reduction, reduce).model
    return _figures(statics(model), platform_modes(mechanism, model))


def stiffness_figures(found: Statics) -> dict[str, float]:
    """Return the platform's stiffness by name [SI]: principal values in the plane, and values along and about the other axes.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> round(stiffness_figures(statics(mapped(double_triangle())))["in-plane stiffness (stiffest), others fixed"] / 1e6, 2)  # N/um
    15.45
    """
    held, free = found.held.principal, found.free.principal
    return {
        "in-plane stiffness (stiffest), others fixed": float(held[0]),
        "in-plane stiffness (softest), others fixed": float(held[1]),
        "in-plane stiffness (stiffest), others free": float(free[0]),
        "in-plane stiffness (softest), others free": float(free[1]),
        **{f"stiffness {COMPONENTS[index]}": float(found.stiffness.values[index, index]) for index in (2, 3, 4, 5)},
    }


@check_arguments
def solid_stage(mechanism: Mechanism, reduction: Reduction = STANDARD_REDUCTION, reduce: Solids = STANDARD_SOLIDS) -> SolidStage:
    """Model a whole stage as a solid, and compute its stiffness, modes and stress.

    Raises `DesignError` for links with neither a shape nor a specified stiffness, for outlines that do not touch, and if the stage has a
    rigid-body motion.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.restrict import restrict
    >>> from flexstage.parts.freedom import Freedom
    >>> solid_stage(restrict(parallelogram(), {'leaf': ((Freedom.X,), ())}))
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: left: some of its DOFs are locked or freed by a restriction. ...
    """
    read = read_solid(mechanism, reduction, reduce)
    found = platform_modes(mechanism, read.model)
    corners = _corners(read)
    stress = None if corners is None else link_stress(read, *corners)
    return SolidStage(
        statics=statics(read.model),
        modes=found,
        stress=stress,
        worst=None if corners is None or stress is None else corners[0][:, stress.worst_case],
        blocks=block_energy(read.model, found.shapes),
        read=read,
    )


def _corners(read: SolidRead) -> tuple[Array, dict[str, Array]] | None:
    """Coordinates (N, 2^n) at the corners of the strokes from zero, permanent load included, and the strokes by input."""
    if not read.model.strokes:
        return None
    limits = stroke_limits(read.mechanism).from_zero
    try:
        strokes = limits.corners
    except DesignError:
        return None
    columns = read.model.input_index(limits.actuators)
    dead = sum(dead_loads(read.mechanism, read.model).values(), np.zeros(len(read.model.coordinates)))
    motion = displacement(read.model, read.model.input_matrix[:, columns] @ strokes.T + dead[:, None])
    return motion, {name: strokes[:, number] for number, name in enumerate(limits.actuators)}


def worst_strokes(stage: SolidStage) -> dict[str, float]:
    """Return the stroke [m] of each actuator at the corner with the highest stress of the weakest link."""
    if stage.stress is None:
        return {}
    limits = stroke_limits(stage.read.mechanism).from_zero
    return dict(zip(limits.actuators, limits.corners[stage.stress.worst_case].tolist(), strict=True))


def block_energy(model: LinearModel, shapes: Array) -> Array:
    """Compute the strain-energy fraction (k,) of the elastic bodies in shapes (N, k).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(double_triangle())
    >>> block_energy(model, np.eye(len(model.coordinates))[:, :1]).tolist()  # the lumped model's are rigid
    [0.0]
    """
    bodies = sum((_energy(item, shapes) for name, item in model.stiffness.items() if name.endswith(_BODY)), np.zeros(shapes.shape[1]))
    return bodies / sum(_energy(item, shapes) for item in model.stiffness.values())


def _energy(item: Contribution, shapes: Array) -> Array:
    strain = item.operator @ shapes
    return np.sum(strain * (item.law @ strain), axis=0)
