"""Data compared between test and model: frequencies of paired modes (for repeated modes their mean), and static gains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.analysis.assessment.sensitivities import project, slope, step_parameters, steppable
from flexstage.analysis.complete import platform_modes
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.experiment.comparison import Compared
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.updating.gains import Gains
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.eigen import Eigen, eigen
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped


@dataclass(frozen=True)
class ModeRow:
    """Row of data: one mode, or a group of repeated modes, of the model and of the test.

    `modes` are the numbers (from 0) of the row's modes among all modes of the model. `frequency` [Hz] is the square root of the mean
    squared frequency of the `measured` modes. This mean does not depend on the sequence of repeated modes, and is therefore a smooth
    function of every parameter. `deviation` is the relative standard deviation of the frequency.
    """

    name: str
    modes: tuple[int, ...]
    measured: tuple[int, ...]
    frequency: float
    deviation: float


@dataclass(frozen=True, eq=False)
class Design:
    """Intermediate design of an update: its lumped model, the model's modes, and the mode indices of each row."""

    mechanism: Mechanism
    model: LinearModel
    solved: Eigen
    modes: tuple[tuple[int, ...], ...]

    @property
    def frequencies(self) -> Array:
        """Frequency of each row [Hz]: sqrt(mean f^2) over the modes of the row."""
        means = [np.mean(self.solved.values[list(modes)]) for modes in self.modes]
        return np.sqrt(np.array(means)) / (2.0 * np.pi)


def mode_rows(mechanism: Mechanism, compared: Compared, experiment: Identified) -> tuple[ModeRow, ...]:
    """Extract the rows of a comparison: one for each identified platform mode, one for each group of repeated modes."""
    places = platform_modes(mechanism, lumped(mechanism)).platform
    repeated = [group.numbers for group in compared.repeated]
    groups = [*repeated, *((row.number,) for row in compared.modes if not any(row.number in group for group in repeated))]
    found = list[ModeRow]()
    for numbers in sorted(groups):
        rows = [compared.modes[number - 1] for number in numbers]
        measured = tuple(row.experiment.index for row in rows if row.experiment is not None)
        if measured:
            names = dict.fromkeys(row.name for row in rows)
            label = f"mode {', '.join(map(str, numbers))} ({', '.join(names)})"
            modes = tuple(places[number - 1] for number in numbers)
            found.append(ModeRow(label, modes, measured, *_mean(experiment, measured)))
    return tuple(found)


def _mean(experiment: Identified, measured: tuple[int, ...]) -> tuple[float, float]:
    chosen = list(measured)
    frequencies, deviations = experiment.frequencies[chosen], experiment.frequency_deviations[chosen]
    total = float(np.sum(frequencies**2))
    return float(np.sqrt(total / len(chosen))), float(np.sqrt(np.sum((frequencies * deviations) ** 2))) / total


def start_design(mechanism: Mechanism, rows: tuple[ModeRow, ...]) -> Design:
    """Return the start design of an update, with the modes paired in `rows`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> start_design(double_triangle(), (ModeRow("z", (2,), (0,), 126.0, 1e-4),)).frequencies.round(1).tolist()
    [126.2]
    """
    model = lumped(mechanism)
    return Design(mechanism, model, eigen(model), tuple(row.modes for row in rows))


def follow_modes(before: Design, mechanism: Mechanism) -> Design:
    """Compute the modes of a changed `mechanism`. Each row gets the modes that are most similar to its modes in the design `before`.

    Similarity is measured with the mass matrix of the previous design; all rows are assigned together. Modes whose frequencies cross
    therefore keep their rows.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> here = start_design(double_triangle(), (ModeRow("z", (2,), (0,), 126.0, 1e-4),))
    >>> follow_modes(here, double_triangle()).modes
    ((2,),)
    """
    model = lumped(mechanism)
    solved = eigen(model)
    if len(solved.shapes) != len(before.solved.shapes):
        what = f"the changed parameters give the model {len(solved.shapes)} coordinates instead of {len(before.solved.shapes)}"
        raise refuse("update", what, "Check units and names of the record's channels (flexstage compare), or specify narrower priors")
    weighted = before.model.inertia_matrix @ before.solved.shapes
    likeness = []
    for modes in before.modes:
        inside = np.sum((weighted[:, list(modes)].T @ solved.shapes) ** 2, axis=0)
        likeness += [np.nan_to_num(inside)] * len(modes)
    _, columns = scipy.optimize.linear_sum_assignment(-np.array(likeness))
    ends = np.cumsum([len(modes) for modes in before.modes])[:-1]
    groups = tuple(tuple(sorted(group.tolist())) for group in np.split(columns, ends))
    return Design(mechanism, model, solved, groups)


def frequency_slopes(design: Design, names: tuple[str, ...]) -> Array:
    """Compute the exact derivatives d ln f / d p (rows, P) of each row's frequency f with respect to the parameters p.

    The derivative is the sum of phi^T (dK - lambda dM) phi over the row's modes, divided by twice the sum of their eigenvalues lambda. Here
    phi are the mode shapes, dK and dM the derivatives of the stiffness and mass matrices.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> here = start_design(double_triangle(), (ModeRow("z", (2,), (0,), 126.0, 1e-4),))
    >>> (frequency_slopes(here, ("materials.steel.density",)) * 7750.0).round(4).tolist()
    [[-0.4923]]
    """
    used = [mode for modes in design.modes for mode in modes]
    shapes, values = design.solved.shapes[:, used], design.solved.values[used]
    ends = np.cumsum([0, *(len(modes) for modes in design.modes)])[:-1]
    result = np.zeros((len(design.modes), len(names)))
    for chunk, model in _complex_steps(design, names):
        change = project(model.stiffness, shapes) - values * project(model.inertia, shapes)
        moved = np.broadcast_to(np.diagonal(change, axis1=-2, axis2=-1), (len(chunk), len(used)))
        result[:, chunk] = (np.add.reduceat(moved, ends, axis=1) / (2.0 * np.add.reduceat(values, ends))).T
    return result


def static_gains(design: Design, gains: Gains) -> Array:
    """Compute the model's static gains (p, m) for the outputs and inputs of the measured `gains`."""
    return static_gain(design.model, gains.outputs, gains.inputs).values


def gain_slopes(design: Design, names: tuple[str, ...], gains: Gains) -> Array:
    """Compute the derivatives (p, m, P) of the model's static gains with respect to the parameters at the addresses `names`."""
    result = np.zeros((*gains.values.shape, len(names)))
    for chunk, model in _complex_steps(design, names):
        moved = slope(static_gain(model, gains.outputs, gains.inputs).values)
        result[..., chunk] = np.moveaxis(np.broadcast_to(moved, (len(chunk), *gains.values.shape)), 0, -1)
    return result


def _complex_steps(design: Design, names: tuple[str, ...]) -> list[tuple[list[int], LinearModel]]:
    chunks = steppable(design.mechanism, names)
    return [(chunk, lumped(step_parameters(design.mechanism, tuple(names[index] for index in chunk)))) for chunk in chunks]


def same_pairs(rows: tuple[ModeRow, ...], design: Design, again: tuple[ModeRow, ...]) -> bool:
    """Check whether a new comparison, `again`, pairs measured modes with the same model modes as the tracked rows.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from dataclasses import replace
    >>> row = ModeRow("z", (2,), (0,), 126.0, 1e-4)
    >>> here = start_design(double_triangle(), (row,))
    >>> same_pairs((row,), here, (row,)), same_pairs((row,), here, (replace(row, modes=(3,)),))
    (True, False)
    """
    followed_to = {(row.measured, modes) for row, modes in zip(rows, design.modes, strict=True)}
    return followed_to == {(row.measured, tuple(sorted(row.modes))) for row in again}
