"""Static solves of a linear model."""

from __future__ import annotations

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.readings.linear.model import LinearModel, labelled


def displacement(model: LinearModel, load: Array) -> Array:
    """Coordinates q = K^-1 load (..., n, k) under generalised forces (..., n, k)."""
    return np.linalg.solve(model.stiffness_matrix, load)


def static_gain(model: LinearModel, outputs: tuple[str, ...], inputs: tuple[str, ...]) -> Matrix:
    """Static response C K^-1 B + D of named outputs to named inputs."""
    rows, columns = model.output_index(outputs), model.input_index(inputs)
    motion = displacement(model, model.input_matrix[..., columns])
    values = model.output[..., rows, :] @ motion + model.feedthrough[..., rows, :][..., columns]
    return labelled(model, values, outputs, inputs)


def part_deformation(model: LinearModel, motion: Array, inputs: Array | None = None) -> dict[str, Array]:
    """Elastic deformation of every part (..., r, k): G q - imposed u, for coordinates (..., n, k) and inputs u (..., m, k)."""
    result = {name: part.operator @ motion for name, part in model.stiffness.items()}
    if inputs is not None:
        for name, imposed in model.imposed.items():
            result[name] = result[name] - imposed @ inputs
    return result
