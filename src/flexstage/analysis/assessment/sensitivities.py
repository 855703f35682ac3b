"""Exact sensitivities of frequencies and gains to every number of a description.

Derivatives of stiffness K, mass M and gains are computed by complex steps through the models' formulas; each parameter is one design of a
batch. Eigenvalue derivatives are analytic: d lambda = phi^T (dK - lambda dM) phi, with the mode shape phi.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Annotated

import numpy as np

from flexstage.analysis.attempt import Attempts
from flexstage.analysis.dynamics.modes import clusters
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.loaded.standing import standing
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Table
from flexstage.base.processes.threads import one_thread
from flexstage.base.record import VIEW, Along, Called
from flexstage.base.units.quantity import FREQUENCY
from flexstage.mechanism.addresses.address import addresses, get, quantity_of, set_value
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.grammar.formulas import depth
from flexstage.mechanism.grammar.node import NumberNode
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import Eigen, eigen
from flexstage.models.linear.model import Contributions, LinearModel
from flexstage.models.lumped import lumped

_STEP = 1e-20
_CHUNK = 24


class Sensitivities(Result):
    """Derivatives of modes and gains with respect to P parameters at one design.

    `frequency` (P, k) contains the derivatives of k frequencies, in Hz per SI unit of the parameter; for the modes of a cluster, it
    contains the derivatives of the cluster's mean frequency. `clusters` lists the groups of modes. For each cluster of c modes, `one_sided`
    has the eigenvalues (P, c) of Phi^T (dK - lambda dM) Phi, converted to frequency slopes. Phi contains the mode shapes, lambda is the
    mean squared angular frequency, and dK and dM are the derivatives of stiffness and mass. The slopes in `one_sided` are valid for changes
    of a single parameter and cannot be added. `gain` and `loss` (P, n) are the derivatives of each actuator's gain and lost motion; n = 0
    if the strokes do not determine the platform's motion. `missing` has the reasons for absent results.
    """

    parameters: tuple[str, ...]
    units: Annotated[tuple[str, ...], Along("parameters"), Called("unit")]
    values: Annotated[Array, Along("parameters"), Called("value")]
    frequencies: Annotated[Array, FREQUENCY]
    frequency: Array
    clusters: tuple[tuple[int, ...], ...]
    one_sided: Annotated[tuple[Array, ...], VIEW]
    actuators: tuple[str, ...]
    gain: Array
    loss: Array
    missing: Mapping[str, str]
    provenance: str

    @property
    def frequency_slopes(self) -> Annotated[Matrix, VIEW]:
        """Change of each frequency per unit of each parameter; for a cluster of modes, the change of the cluster's mean frequency."""
        return self._slopes(self.frequency, self._modes, "Hz")

    @property
    def gain_slopes(self) -> Annotated[Matrix, VIEW]:
        """Change of each actuator's gain per unit of each parameter."""
        return self._slopes(self.gain, self.actuators, "1")

    @property
    def loss_slopes(self) -> Annotated[Matrix, VIEW]:
        """Change of each actuator's lost motion per unit of each parameter."""
        return self._slopes(self.loss, self.actuators, "1")

    def _slopes(self, values: Array, columns: tuple[str, ...], top: str) -> Matrix:
        units = (top if unit == "1" else f"{top}/{unit}" for unit in self.units)
        return Matrix(values, self.parameters, columns, tuple((unit,) * len(columns) for unit in units))

    @property
    def _modes(self) -> tuple[str, ...]:
        return tuple(f"mode {index + 1}" for index in range(len(self.frequencies)))

    @property
    def relative_frequency(self) -> Annotated[Matrix, VIEW]:
        """Relative change of each frequency per relative change of each parameter, shape (P, k)."""
        return Matrix(self.frequency * self.values[:, None] / self.frequencies, self.parameters, self._modes, "1")

    @property
    def relative_loss(self) -> Annotated[Matrix, VIEW]:
        """Change of each actuator's lost motion per relative change of each parameter, shape (P, n)."""
        return Matrix(self.loss * self.values[:, None], self.parameters, self.actuators, "1")


@check_arguments
@one_thread
def sensitivities(
    mechanism: Mechanism, parameters: tuple[str, ...] | None = None, *, modes: int = 12, cluster: float = 1e-6
) -> Sensitivities:
    """Compute derivatives of the lowest `modes` natural frequencies and of all actuators' gains with respect to `parameters`.

    `parameters` are addresses of numbers in the description, such as `materials.steel.density` (default: all numbers of the description).
    Modes with a relative frequency gap below `cluster` form a cluster of repeated modes; only the derivative of their mean frequency is
    smooth. The result includes all modes of a cluster. Gains require strokes that determine the platform's motion; otherwise `missing`
    contains the reason. Raises `DesignError` for an unknown address, and for an address without a single specified number.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> result = sensitivities(double_triangle(), ("materials.steel.density",), modes=6)
    >>> bool((result.relative_frequency.values < 0.0).all())  # heavier is slower
    True
    """
    names = addresses(mechanism) if parameters is None else parameters
    require(not_numbers(mechanism, names))
    solved = eigen(standing(mechanism))
    groups = [group for group in clusters(solved.values, cluster) if group[0] < modes]
    count = groups[-1][-1] + 1 if groups else 0
    solved = Eigen(solved.values[:count], solved.shapes[:, :count])
    attempt = Attempts()
    actuators = attempt.of("lost_motion", lambda: ideal(mechanism).mapping.rows) or ()
    chunks = list(steppable(mechanism, names))
    batches = (step_parameters(mechanism, tuple(names[position] for position in chunk)) for chunk in chunks)
    pieces = [_piece(batch, len(chunk), solved, groups, gains=bool(actuators)) for batch, chunk in zip(batches, chunks, strict=True)]
    back = np.argsort([position for chunk in chunks for position in chunk])
    slopes = [np.concatenate([piece[0][number] for piece in pieces])[back] for number in range(len(groups))]
    losses = np.concatenate([piece[1] for piece in pieces])[back]
    frequencies = np.sqrt(solved.values) / (2.0 * np.pi)
    scale = 1.0 / (8.0 * np.pi**2 * frequencies)
    mean = np.concatenate([np.repeat(slope.mean(axis=1, keepdims=True), slope.shape[1], axis=1) for slope in slopes], axis=1)
    return Sensitivities(
        parameters=names,
        units=tuple(quantity_of(mechanism, name).si for name in names),
        values=np.array([get(mechanism, name) for name in names]),
        frequencies=frequencies,
        frequency=mean * scale,
        clusters=tuple(tuple(group) for group in groups),
        one_sided=tuple(slope * scale[group[0]] for slope, group in zip(slopes, groups, strict=True)),
        actuators=actuators,
        gain=-losses,
        loss=losses,
        missing=Table(attempt.missing),
        provenance=lumped(mechanism).provenance,
    )


def not_numbers(mechanism: Mechanism, names: tuple[str, ...]) -> Iterator[Finding]:
    """Return errors for addresses that are not a single number in the description.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [str(each) for each in not_numbers(double_triangle(), ("bodies.platform.mass",))]
    ['bodies.platform.mass: not specified in the description. Specify its value, or choose another number.']
    """
    for name in names:
        place = locate(mechanism, name)
        if not isinstance(place.node, NumberNode):
            inner = [each for each in addresses(mechanism) if each.startswith(f"{place.address}.")]
            yield Finding(
                name,
                "not a single number",
                f"Use one of its numbers. {suggest_nearest(name, inner)}" if inner else "Use the address of a number",
            )
        elif get(mechanism, name) is None:
            yield Finding(name, "not specified in the description", "Specify its value, or choose another number")


def override_level(mechanism: Mechanism, name: str) -> int:
    """Return the override level of an address: 0 for no override, 1 for all instances of a unit, 2 for a single instance.

    Named numbers have higher levels. A number defined by a formula has a higher level than the numbers in the formula.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [override_level(double_triangle(), f"{place}.thickness") for place in ("parts.neck", "horizontal/front", "B1/front")]
    [0, 1, 2]
    """
    if number := locate(mechanism, name).number:
        return 3 + depth(mechanism, number)
    return 0 if "/" not in name else 1 if name.rpartition("/")[0] in mechanism.units else 2


def steppable(mechanism: Mechanism, names: tuple[str, ...]) -> Iterator[list[int]]:
    """Yield groups of parameters (indices) whose derivatives can be computed in one batch.

    An override hides the number that it replaces, and a formula's result hides its named numbers. Therefore, numbers of different override
    levels are in different groups.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> list(steppable(double_triangle(), ("parts.neck.thickness", "horizontal/front.thickness", "materials.steel.young")))
    [[0, 2], [1]]
    """
    level = [override_level(mechanism, name) for name in names]
    for target in sorted(set(level)):
        members = [position for position, result in enumerate(level) if result == target]
        for start in range(0, len(members), _CHUNK):
            yield members[start : start + _CHUNK]


def step_parameters(mechanism: Mechanism, names: tuple[str, ...]) -> Mechanism:
    """Return the description with one batch axis: design k has a small imaginary step in parameter k.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> step_parameters(double_triangle(), ("parts.neck.thickness",)).parts["neck"].thickness.real.round(9).tolist()
    [0.00154]
    """
    result = replace(mechanism, requirements={}, tags={})  # avoids a search for tags at every step
    for number, name in enumerate(names):
        values = np.full(len(names), get(mechanism, name), dtype=complex)
        values[number] += 1j * _STEP
        result = set_value(result, name, values)
    return result


def _piece(batch: Mechanism, count: int, solved: Eigen, groups: list[list[int]], *, gains: bool) -> tuple[list[Array], Array]:
    """Slopes of lambda (p, c) by cluster, and the derivative of every actuator's loss (p, n); n = 0 without `gains`."""
    model = lumped(batch)
    slopes = [_slopes(model, solved, group, count) for group in groups]
    if not gains:
        return slopes, np.zeros((count, 0))
    loss = lost_motion(ideal(batch), model).loss.values
    diagonal = slope(np.linalg.diagonal(loss))
    return slopes, np.broadcast_to(diagonal, (count, diagonal.shape[-1]))


def _slopes(model: LinearModel, solved: Eigen, group: list[int], count: int) -> Array:
    shapes = solved.shapes[:, group]
    value = solved.values[group].mean()
    change = project(model.stiffness, shapes) - value * project(model.inertia, shapes)
    return np.linalg.eigvalsh(np.broadcast_to(change, (count, len(group), len(group))))


def project(contributions: Contributions, shapes: Array) -> Array:
    """Compute Phi^T dA Phi (p, k, k) for mode shapes Phi (n, k).

    A is the sum of the `contributions`. Their complex steps give the derivative dA.

    >>> from flexstage.models.linear.model import Contribution
    >>> one = np.ones((1, 1))
    >>> project({"a": Contribution(one, one + 3e-20j)}, 2.0 * one).round(9).tolist()
    [[12.0]]
    """
    total = np.zeros((shapes.shape[1], shapes.shape[1]))
    for item in contributions.values():
        seen = item.operator @ shapes
        total = total + slope(seen.mT @ item.law @ seen)
    return total


def slope(values: Array) -> Array:
    """Return derivatives from values that were computed with complex steps.

    >>> slope(np.array([1.0 + 2e-20j])).round(9).tolist()
    [2.0]
    """
    return np.imag(values) / _STEP
