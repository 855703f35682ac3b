"""MATLAB files (v5): mappings, matrices and state space of a stage under textbook names, with row and column names and units."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable
from itertools import product
from typing import Any

import numpy as np
import scipy

from flexstage.analysis.complete import Analysis
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.base.labelled import Matrix
from flexstage.base.storage.digest import digest
from flexstage.base.storage.sheet import NUMBERS, Sheet, parts
from flexstage.base.text import printable
from flexstage.base.version import __version__
from flexstage.models.linear.damping import damping_law
from flexstage.models.linear.model import Channel, LinearModel
from flexstage.models.linear.port import ports
from flexstage.models.linear.state_space import state_space


def as_mat(analysis: Analysis) -> bytes:
    """Convert an analysis to the bytes of a MATLAB v5 file (see `mat_variables`).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> as_mat(analyse(double_triangle(), Model.IDEAL))[:10]
    b'MATLAB 5.0'
    """
    return _write_mat(mat_variables(analysis))


def _write_mat(variables: dict[str, Any]) -> bytes:
    content = io.BytesIO()
    scipy.io.savemat(content, variables, do_compression=True, oned_as="column", long_field_names=True)
    return content.getvalue()


@check_arguments
def to_mat(result: Any) -> bytes:
    """Convert a result to the bytes of a MATLAB v5 file, in SI units.

    Each part of the result is a struct with one field for each column. The struct of a matrix has `values`, `rows`, `columns` and `unit`.
    Names are as in the JSON document, with `_` for characters that MATLAB names cannot contain.

    >>> import scipy.io
    >>> scipy.io.loadmat(io.BytesIO(to_mat({"loss": {"B/1": 0.1}})), simplify_cells=True)["loss"]
    {'name': 'B/1', 'loss': 0.1}
    """
    found = dict[str, Any]()
    for path, part in parts(result):
        under = found
        for step in filter(None, path.split(".")):
            under = under.setdefault(_identifier(step), {})
        under |= _matrix(part) if isinstance(part, Matrix) else _sheet(part)
    return _write_mat(found)


def _identifier(name: str) -> str:
    """A valid MATLAB name: letters, digits and _, beginning with a letter."""
    return re.sub(r"^(?![A-Za-z])", "x", re.sub(r"\W", "_", name, flags=re.ASCII))[:63]


def _matrix(matrix: Matrix) -> dict[str, Any]:
    return {key.removeprefix("values").removeprefix("_") or key: value for key, value in _matrix_variables("values", matrix).items()}


def _sheet(sheet: Sheet) -> dict[str, Any]:
    """Columns; if the rows are all combinations of names, the names once and arrays with one axis for each name."""
    ends = [tuple(dict.fromkeys(each)) for each in sheet.names.values()]
    whole = len(ends) > 1 and list(zip(*sheet.names.values(), strict=True)) == list(product(*ends))
    names, shape = (ends, [len(each) for each in ends]) if whole else (list(sheet.names.values()), [-1])
    heads = {_identifier(head): _column(each) for head, each in sheet.heads.items()}
    axes = {head: _column(each) for head, each in zip(heads, names, strict=False)}
    return axes | {head: each.reshape(shape) for head, each in heads.items() if head not in axes}


def _column(values: tuple[Any, ...]) -> Any:
    if all(each is None or isinstance(each, NUMBERS) for each in values):
        return np.array([np.nan if each is None else each for each in values])
    return cells("" if each is None else str(each) for each in values)


def mat_variables(analysis: Analysis) -> dict[str, Any]:
    """Return the variables of the MATLAB file: mappings R_a (actuators) and R_s (gauges); for elastic models also matrices and state space.

    The model is M q'' + K q = B u, y = C q + D u in SI units, with the coordinates q, inputs u and outputs y. Variables that do not exist
    for the model or the stage are left out, with the reason in `notes`. Names and units of rows and columns are in cell arrays.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> mat_variables(analyse(double_triangle(), Model.IDEAL))["R_a"].shape
    (6, 6)
    """
    kinematics, notes = analysis.kinematics, []
    variables: dict[str, Any] = {
        "name": printable(analysis.mechanism.name),
        "model": analysis.model.value,
        "flexstage_version": __version__,
        "physics_digest": digest(analysis.mechanism, physics=True),
        **_matrix_variables("R_s", kinematics.gauge_mapping),
    }
    if kinematics.actuated:
        variables |= _matrix_variables("R_a", kinematics.mapping)
    else:
        notes.append("R_a: the strokes do not determine the platform")
    if analysis.linear is None:
        notes.append("K, M, B, C, D: the ideal model has no elasticity")
    else:
        variables |= _model(analysis.linear) | _state_space(analysis.linear, notes)
    if analysis.modes is not None:
        variables |= {
            "frequencies_hz": analysis.modes.frequencies,
            "platform_modes": np.array(analysis.modes.platform, dtype=float) + 1.0,
            "mode_names": cells(analysis.modes.names),
        }
    return {**variables, "notes": cells(notes)}


def _matrix_variables(name: str, matrix: Matrix) -> dict[str, Any]:
    shape = (len(matrix.rows), len(matrix.columns))
    unit = matrix.unit if isinstance(matrix.unit, str) else np.array(matrix.unit, dtype=object).reshape(shape)
    return {name: matrix.values, f"{name}_rows": cells(matrix.rows), f"{name}_columns": cells(matrix.columns), f"{name}_unit": unit}


def _model(model: LinearModel) -> dict[str, Any]:
    return {
        "K": model.stiffness_matrix,
        "M": model.inertia_matrix,
        "B": model.input_matrix,
        "C": model.output,
        "D": model.feedthrough,
        **({} if model.inertial is None else {"Mu": model.inertial}),
        "coordinates": cells(model.coordinates),
        "coordinate_units": cells([_coordinate_unit(name.rpartition(".")[2]) for name in model.coordinates]),
        **channel_variables("input", model.inputs),
        **channel_variables("output", model.outputs),
    }


def _coordinate_unit(component: str) -> str:
    """The unit of a twist's component, or of a mass-normalised mode's amplitude."""
    return "m kg^0.5" if component.startswith("mode") else "rad" if component.startswith("r") else "m"


def channel_variables(kind: str, channels: tuple[Channel, ...]) -> dict[str, Any]:
    """Return names and units of the channels of a kind as variables of a MATLAB file."""
    return {f"{kind}s": cells([each.name for each in channels]), f"{kind}_units": cells([each.unit for each in channels])}


def _state_space(model: LinearModel, notes: list[str]) -> dict[str, Any]:
    """State space from all inputs to the external outputs: twists of platform and points, gauges."""
    places = {each.name.rpartition(".")[0] for each in model.inputs if each.unit != "m"}
    outputs = [each.name for each in model.outputs if each.name.rpartition(".")[0] in places | {""}]
    try:
        law = damping_law(model)
    except DesignError as error:
        notes.append(f"state_space: {error}")
        return {}
    space = state_space(model, ports(model, outputs, [each.name for each in model.inputs]), law)
    named = {key: cells(value) if isinstance(value, list) else value for key, value in space.to_dict().items()}
    return {"state_space": named}


def cells(texts: Iterable[str]) -> Any:
    """Return texts as a column of cells of a MATLAB file; invisible characters are escaped."""
    return np.array([printable(each) for each in texts], dtype=object).reshape(-1, 1)
