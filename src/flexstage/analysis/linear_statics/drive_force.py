"""Drive force per displacement of force-driven flexure stages, compared with the ideal guide."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.workspace.force_workspace import ForceWorkspace
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array
from flexstage.base.record import VIEW, Layout
from flexstage.models.linear.eigen import sign_weights
from flexstage.models.linear.elimination import null_space
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import displacement, input_motion
from flexstage.parts.freedom import ALL
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS, WRENCH_UNITS


class DriveForce(Result):
    """Drive force divided by the displacement along each coordinate, compared with the ideal guide.

    The ideal guide has the same stiffness as the stage in the ideal DOFs of its flexures, and is rigid in all other DOFs. `force` is the
    generalised force of the actuators divided by the displacement, with a row for each coordinate, a column for the elastic stage and a
    column for the ideal guide. `shares` and `excess` have a row for each link and a column for each coordinate. The shares are the links'
    fractions of the elastic displacement, which add up to 1. The excesses are the links' contributions to `total`.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Drive force per displacement, compared with the ideal guide",
        "table",
        head="along",
        notes=("The ideal guide has the same flexures, rigid except in their ideal DOFs. Negative excess: softer than the ideal guide.",),
    )

    force: Matrix
    shares: Matrix
    excess: Matrix
    provenance: str

    @property
    def total(self) -> Array:
        """Excess of the force over the ideal guide's force, divided by the ideal guide's force, along each of f coordinates."""
        return np.sum(self.excess.values, axis=-2)

    @property
    def table(self) -> Annotated[Matrix, VIEW]:
        """Table of the coordinates (rows) with the force, the force of the ideal guide and the excess."""
        values = np.concatenate([self.force.values, self.total[..., None]], axis=-1)
        units = tuple((*row, "1") for row in self.force.unit)
        return Matrix(values, self.force.rows, ("force", "ideal guide", "excess"), units)


def drive_force(kinematics: Kinematics, model: LinearModel, workspace: ForceWorkspace) -> DriveForce:
    """Compare the elastic stage with its ideal guide under the inputs that move the platform along each coordinate.

    By reciprocity, the displacement along coordinate j is the sum of g_j^T k g_u over all links. Here k is a link's stiffness, g_j its
    deformation under a unit load on the platform along j, and g_u its deformation under the inputs. If deformations are possible only in
    the free DOFs of the ideal joints, this sum is the displacement of the ideal guide. Raises `DesignError` for batches and for large
    (sparse) stages.

    >>> import flexstage as fs
    >>> stage = fs.case("voice-coil-stage")
    >>> ideal, elastic = fs.ideal(stage), fs.lumped(stage)
    >>> result = drive_force(ideal, elastic, fs.force_workspace(stage, ideal, elastic))
    >>> bool(abs(result.total[0]) < 0.01), round(float(result.shares.values.sum()), 9)
    (True, 1.0)
    """
    if model.is_sparse or model.designs:
        raise refuse("drive force", "not computed for large stages and batches of designs", "Analyse one design with fewer bodies")
    names, inputs = workspace.coordinates, workspace.per_motion
    loads = model.output[model.output_index(tuple(f"{workspace.point}.{name}" for name in names))].mT
    driven = model.input_matrix[:, model.input_index(inputs.rows)] @ inputs.values
    basis = _ideal_motions(kinematics, model)
    inner = basis.T @ model.stiffness_matrix @ basis
    guided = [basis @ np.linalg.solve(inner, basis.T @ each) for each in (loads, driven)]
    elastic = displacement(model, loads), input_motion(model, model.input_index(inputs.rows), inputs.values)
    shares, ideal = _mutual_energy(model, *elastic), _mutual_energy(model, *guided)
    thrusts = [inputs.rows.index(name) for name in kinematics.thrusts]
    rows = [kinematics.coordinates.index(name) for name in names]
    force = np.diagonal(kinematics.thrust[rows] @ inputs.values[thrusts])
    reach = np.sum(ideal, axis=0)
    axes = [COMPONENTS.index(name) for name in names]
    units = tuple((f"{WRENCH_UNITS[axis]}/{TWIST_UNITS[axis]}",) * 2 for axis in axes)
    links = tuple(model.stiffness)
    return DriveForce(
        force=Matrix(np.stack([force, force / reach], axis=-1), names, ("elastic", "ideal"), units),
        shares=Matrix(shares, links, names, "1"),
        excess=Matrix(ideal - shares, links, names, "1"),
        provenance=f"{kinematics.provenance}; {model.provenance}",
    )


def _ideal_motions(kinematics: Kinematics, model: LinearModel) -> Array:
    """Motions (n, m) of the coordinates without deformation in the locked DOFs of the ideal joints."""
    locked = [
        model.stiffness[link].operator[[axis.index for axis in ALL if axis not in free]]
        for link, free in kinematics.free.items()
        if link in model.stiffness
    ]
    scale = 1.0 / sign_weights(model.coordinates)
    rows = np.concatenate([np.zeros((0, len(scale))), *locked]) * scale
    sizes = np.linalg.norm(rows, axis=1, keepdims=True)
    return scale[:, None] * null_space((rows / np.where(sizes > 0.0, sizes, 1.0))[np.any(rows, axis=1)])


def _mutual_energy(model: LinearModel, loaded: Array, driven: Array) -> Array:
    """g_j^T k g_u (links, f) of each link and coordinate."""
    rows: Mapping[str, Array] = {
        name: np.sum((item.operator @ loaded) * (item.law @ (item.operator @ driven)), axis=0) for name, item in model.stiffness.items()
    }
    return np.stack(list(rows.values()))
