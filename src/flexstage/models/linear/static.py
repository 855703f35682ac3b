"""Static solutions of a linear model."""

from __future__ import annotations

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.models.linear.model import LinearModel, label
from flexstage.models.linear.undetermined import require_known, require_still, require_unmoved


def displacement(model: LinearModel, load: Array) -> Array:
    """Compute the coordinates q = K^-1 load (..., n, k) under generalised forces `load` (..., n, k).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> import numpy as np
    >>> force = np.eye(6)[:, 2:3]
    >>> round(1e-6 / displacement(mapped(double_triangle()), force)[2].item(), 3)  # K_z, N/um
    10.093
    """
    return model.solve(load)


def input_motion(model: LinearModel, columns: list[int], amounts: Array | None = None) -> Array:
    """Compute the coordinates q = K^-1 B u (..., n, k) for the inputs in `columns`: one unit of each, or `amounts` (..., columns, k).

    In a large stage, strokes are imposed as strains, not as forces, because rounding errors of forces would disturb the equilibrium of a
    long chain.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> model = mapped(double_triangle())
    >>> round(input_motion(model, model.input_index(("B4",)))[2].item(), 9)
    1.0
    """

    def of_inputs(values: Array) -> Array:
        return values[..., columns] if amounts is None else values[..., columns] @ amounts

    if not model.is_sparse:
        return displacement(model, of_inputs(model.input_matrix))
    force = of_inputs(model.force)
    strains = {name: np.zeros((item.law.shape[-1], force.shape[-1])) for name, item in model.stiffness.items()}
    imposed = {name: -of_inputs(values) for name, values in model.imposed.items()}
    moved = model.follow(strains | imposed) if any(map(np.any, imposed.values())) else np.zeros_like(force)
    return moved + displacement(model, force) if np.any(force) else moved


def static_gain(model: LinearModel, outputs: tuple[str, ...], inputs: tuple[str, ...]) -> Matrix:
    """Compute the static gain C K^-1 B + D of named outputs to named inputs.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> round(static_gain(mapped(double_triangle()), ("platform.z",), ("B4",)).values.item(), 9)
    1.0
    """
    rows, columns = model.output_index(outputs), model.input_index(inputs)
    require_known(model, outputs)
    require_still(model, outputs)
    require_unmoved(model, inputs)
    motion = input_motion(model, columns)
    values = model.seen(rows, motion) + model.feedthrough[..., rows, :][..., columns]
    return label(model, values, outputs, inputs)


def part_deformation(model: LinearModel, motion: Array, inputs: Array | None = None) -> dict[str, Array]:
    """Compute the elastic deformation G q - imposed u of every part (..., r, k), for coordinates q (..., n, k) and inputs u (..., m, k).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> import numpy as np
    >>> sorted(part_deformation(mapped(double_triangle()), np.zeros((6, 1))))
    ['B1', 'B2', 'B3', 'B4', 'B5', 'B6']
    """
    result = {name: part.operator @ motion for name, part in model.stiffness.items()}
    if inputs is not None:
        for name, imposed in model.imposed.items():
            result[name] = result[name] - imposed @ inputs
    return result
