"""Stages with locked or loose freedoms: the constraints tie bodies together, so each design is read and solved whole."""

from __future__ import annotations

import numpy as np

from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.batch.choice import Choice, groups, means, platform_rows
from flexstage.models.batch.dense import Whole, whole
from flexstage.models.batch.parameters.numbers import Family, describe, step_numbers, width
from flexstage.models.batch.solution import Solution, platform_indices
from flexstage.models.linear.model import Contributions, LinearModel, assemble
from flexstage.models.lumped import lumped


def locked_solution(family: Family, values: Array, choice: Choice, *, slopes: bool) -> Solution:
    """The platform's modes of one design (P,); none where it can move freely.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.parameters.numbers import family
    >>> found = locked_solution(family(double_triangle(), ()), np.zeros(0), Choice(), slopes=False)
    >>> (found.values[0, :2] ** 0.5 / (2 * np.pi)).round(1).tolist()
    [106.0, 106.0]
    """
    variables = len(family.addresses) if slopes else 0
    try:
        mechanism = describe(family, values[None])
        model = lumped(mechanism)
        modes = _modes(model, choice)
    except DesignError:
        return _none(variables)
    if not len(modes.values):
        return _none(variables)
    picked = platform_indices(modes, choice)
    found, shapes = modes.values[None, picked], modes.shapes[:, picked]
    group = groups(found, choice.cluster)
    value = means(found, group)[0]
    (rows, columns), diagonal = np.triu_indices(len(picked), 1), range(len(picked))
    own, between = np.zeros((1, variables, len(picked))), np.zeros((1, variables, len(rows)))
    for variable in range(variables):
        change = lumped(step_numbers(family, mechanism, values[None], (variable,)))
        stiff, heavy = (_project(items, shapes) / width(family, variable) for items in (change.stiffness, change.inertia))
        slope = np.where(group[0][:, None] == group[0], stiff - value * heavy, 0.0)
        own[0, variable], between[0, variable] = slope[diagonal, diagonal], slope[rows, columns]
    return Solution(found, modes.share[None, picked], np.array([True]), own, between)


def _none(variables: int) -> Solution:
    return Solution(np.zeros((1, 0)), np.zeros((1, 0)), np.array([False]), *2 * (np.zeros((1, variables, 0)),))


def _modes(model: LinearModel, choice: Choice) -> Whole:
    size = len(model.coordinates)
    own = {name: item for name, item in model.inertia.items() if name == PLATFORM}
    stiffness, inertia, platform = (
        np.broadcast_to(item, (1, size, size))[0] for item in (model.stiffness_matrix, model.inertia_matrix, assemble(own, size))
    )
    rows = platform_rows(model)
    return whole(stiffness, inertia, platform, np.broadcast_to(rows, (1, *rows.shape[-2:]))[0], choice.cluster)


def _project(items: Contributions, shapes: Array) -> Array:
    total = np.zeros((shapes.shape[1],) * 2)
    for item in items.values():
        seen = item.operator @ shapes
        product = np.imag(np.swapaxes(seen, -1, -2) @ item.law @ seen)
        total = total + product.reshape(-1, *product.shape[-2:])[0]
    return total
