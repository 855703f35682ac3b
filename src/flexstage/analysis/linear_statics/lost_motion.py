"""Lost motion: deviation of the elastic motion from the ideal motion, budget of this deviation by link, and correction gains."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.labelled import NOISE, Matrix, ratio_units
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number
from flexstage.base.record import INNER, VIEW
from flexstage.base.units.quantity import LENGTH, RATIO
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import displacement, input_motion, part_deformation, static_gain
from flexstage.parts.freedom import ALL
from flexstage.parts.profile import single
from flexstage.spatial.frame import COMPONENTS, MOTION

_PLATFORM_TWIST = tuple(f"platform.{name}" for name in COMPONENTS)
INTERNAL = "internal stress"
LOADED = "geometric"
"""Name of a budget entry: the contribution of the geometric stiffness of a loaded or displaced stage."""


class Shares(dict[str, Array]):
    """Contributions (...) to a total, by name."""

    def __str__(self) -> str:
        """Contributions in the first design, largest first, with four digits; rounding errors (below 1e-9 of the largest) are omitted.

        >>> print(Shares({"foot.rz": np.array(0.01), "pzt.x": np.array(1e-17), "pivot.rz": np.array(0.25)}))
        pivot.rz  0.25
        foot.rz   0.01
        """
        first = {name: single(share) for name, share in self.items()}
        ranked = sorted(first, key=lambda name: -abs(first[name]))
        shown = [name for name in ranked if abs(first[name]) > NOISE * abs(first[ranked[0]])]
        width = max(map(len, shown), default=0)
        return "\n".join(f"{name:{width}}  {first[name]:.4g}" for name in shown)


@dataclass(frozen=True, eq=False)
class ActuatorLoss:
    """Transmission `gain` of an actuator (1: ideal) and its `loss`; `budget` has the contributions to the loss by link and axis."""

    gain: Annotated[Array, RATIO]
    loss: Annotated[Array, RATIO]
    budget: Annotated[Mapping[str, Array], RATIO]

    @property
    def budget_by_link(self) -> Annotated[Mapping[str, Array], RATIO]:
        """Contribution of each link to the loss."""
        links: dict[str, Any] = {}
        for key, share in self.budget.items():
            link = key.rpartition(".")[0] or key
            links[link] = links.get(link, 0.0) + share
        return links


class LostMotion(Result):
    """Lost motion of a stage with n strokes and f ideal motions.

    `gain` T (..., 6, n) is the elastic motion of the platform per stroke. `transfer` is R_a V^+ T (..., n, n): V^+ projects T onto the
    coordinates of the ideal motions, and R_a maps these coordinates to strokes. The diagonal of `transfer` contains the transmission of
    each actuator. `loss` Lambda is the unit matrix minus `transfer`. `parasitic` is the component of T outside the ideal motions. `budget`
    has the contribution of every link and axis to each entry of Lambda; the sum of all contributions is Lambda. `correction` is the matrix
    (R_a V^+ T)^-1 R_a, which maps the coordinates of a motion to the corrected strokes. `energy` is the strain energy of each part due to
    the stroke of one actuator, divided by the square of this stroke.
    """

    gain: Matrix
    transfer: Matrix
    loss: Matrix
    parasitic: Matrix
    budget: Annotated[Mapping[str, Matrix], INNER]
    correction: Matrix
    energy: Matrix
    length: Annotated[Number, LENGTH]
    provenance: str

    @property
    def actuators(self) -> Annotated[Mapping[str, ActuatorLoss], VIEW]:
        """Transmission of each actuator, and its own loss (diagonal entry of `loss`)."""
        return {name: ActuatorLoss(self.transfer.at(name, name), self.loss.at(name, name), self.of(name)) for name in self.loss.rows}

    def of(self, actuator: str) -> Shares:
        """Return the contributions of links and axes to an actuator's own (diagonal) loss; their sum is this loss."""
        index = self.loss.rows.index(actuator)
        return Shares({name: share.values[..., index, index] for name, share in self.budget.items()})


@check_arguments
def lost_motion(kinematics: Kinematics, model: LinearModel) -> LostMotion:
    """Compute lost motion from an elastic model and the ideal kinematics of the same stage.

    Lost motion is the matrix Lambda = I - R_a V^+ T, with the symbols of `LostMotion`. The budget of contributions by link is exact for any
    graph of links. By virtual work and reciprocity, the entry Lambda_ij is the sum of f_e . gamma_e over all links e. Here f_e is the force
    of link e that balances a wrench on the platform while the strokes are fixed; this wrench is row i of R_a V^+. The vector gamma_e is the
    deformation of link e in the ideal motion of stroke j. For one unloaded lever, the diagonal of Lambda is eps / (1 + eps), with eps =
    K_theta2 / (r_1^2 K_1) (equation 11 of Shin & Moon). K_theta2 is the pivot's stiffness, r_1 is the length of the short arm, and K_1 is
    the stiffness of stack and hinges. Motions are small.

    If the model is linearised about a displaced state, the ideal motion is still computed in the nominal position. The budget then requires
    a model from `linearise(state, inner=False)`. It has an additional contribution `geometric`, which is due to the geometric stiffness.
    Raises `DesignError` if the strokes do not determine the platform's motion.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> round(float(lost_motion(ideal(double_triangle()), lumped(double_triangle())).loss.at("B4", "B4")), 3)
    0.034
    """
    names, mapping = kinematics.actuators, kinematics.mapping.values
    gain = static_gain(model, _PLATFORM_TWIST, names)
    sense = mapping @ kinematics.projection
    transfer = sense @ gain.values
    loss = np.eye(len(names)) - transfer
    ideal_part = kinematics.motion @ (kinematics.projection @ gain.values)
    correction = np.linalg.solve(transfer, mapping) if kinematics.mobility == len(names) else _least(transfer, kinematics)
    return LostMotion(
        gain=gain,
        transfer=Matrix(transfer, names, names, "1"),
        loss=Matrix(loss, names, names, "1"),
        parasitic=Matrix(gain.values - ideal_part, _PLATFORM_TWIST, names, gain.unit),
        budget=_budget(kinematics, model, sense, loss),
        correction=Matrix(correction, names, kinematics.coordinates, _stroke_units(kinematics)),
        energy=_energy(kinematics, model),
        length=kinematics.length,
        provenance=f"{kinematics.provenance}; {model.provenance}",
    )


def _least(transfer: Array, kinematics: Kinematics) -> Array:
    """Correction for redundant strokes: commands in the range of R_a with the required elastic motion."""
    inner = kinematics.inverse @ transfer @ kinematics.actuation
    return kinematics.actuation @ np.linalg.inv(inner)


def _stroke_units(kinematics: Kinematics) -> tuple[tuple[str, ...], ...]:
    units = tuple(map(MOTION.unit, kinematics.coordinates))
    return ratio_units(("m",) * len(kinematics.actuators), units)


def _budget(kinematics: Kinematics, model: LinearModel, sense: Array, loss: Array) -> dict[str, Matrix]:
    """Link forces under the platform wrenches times the links' ideal deformations, axis by axis; none for flexures with internal modes."""
    names = kinematics.actuators
    rows = model.output_index(_PLATFORM_TWIST)
    loads = model.output[..., rows, :].mT @ sense.mT
    strains = part_deformation(model, displacement(model, loads))
    if any(strain.shape[-2] != kinematics.strains[link].shape[-2] for link, strain in strains.items() if link in kinematics.strains):
        return {}
    inverse = kinematics.inverse
    shares: dict[str, Array] = {}
    for link, strain in strains.items():
        if link in kinematics.strains:
            force = model.stiffness[link].law @ strain
            ideal = kinematics.strains[link] @ inverse
            shares |= {f"{link}.{freedom.value}": _product(force, ideal, freedom.index) for freedom in kinematics.free.get(link, ALL)}
    if kinematics.mobility < len(names):
        shares[INTERNAL] = _internal(kinematics, model, sense, strains)
    if LOADED in strains:
        shares[LOADED] = loss - sum(shares.values())
    return {name: Matrix(share, names, names, "1") for name, share in shares.items()}


def _product(force: Array, motion: Array, axis: int) -> Array:
    return force[..., axis, :, None] * motion[..., axis, None, :]


def _internal(kinematics: Kinematics, model: LinearModel, sense: Array, strains: Mapping[str, Array]) -> Array:
    """Loss of redundant strokes by constraint misfit: the misfit and the work of the other actuators."""
    names = kinematics.actuators
    feasible = kinematics.actuation @ kinematics.inverse
    columns = model.input_index(names)
    work = sense @ model.feedthrough[..., model.output_index(_PLATFORM_TWIST), :][..., columns]
    for link, imposed in model.imposed.items():
        force = model.stiffness[link].law @ strains[link]
        work = work + force.mT @ imposed[..., columns]
    return np.eye(len(names)) - feasible + work @ (feasible - np.eye(len(names)))


def _energy(kinematics: Kinematics, model: LinearModel) -> Matrix:
    """Strain energy in each part for a unit stroke of one actuator without other loads [J/m^2]."""
    columns = model.input_index(kinematics.actuators)
    motion = input_motion(model, columns)
    selector = np.zeros((len(model.inputs), len(columns)))
    selector[columns, range(len(columns))] = 1.0
    strains = part_deformation(model, motion, selector)
    rows = [0.5 * np.sum(strain * (model.stiffness[name].law @ strain), axis=-2) for name, strain in strains.items()]
    return Matrix(np.stack(np.broadcast_arrays(*rows), axis=-2), tuple(strains), kinematics.actuators, "J/m^2")
