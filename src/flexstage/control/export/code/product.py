"""Products of matrices and vectors in C: written out where few entries are not nought, by a table where many are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from flexstage.base.number import Array
from flexstage.control.export.code.code import Code
from flexstage.control.export.code.text import number, table, wrap

_WRITTEN_OUT = 200
"""Entries; more would not stay in a processor's memory for instructions."""
_ROWS = 8
MULTIPLY = (
    "/* sum += matrix vector; the matrix by groups of eight rows, each column by column: a compiler keeps eight sums at once. */",
    "static void multiply(const double *matrix, int groups, int columns, const double *vector, double *sum)",
    "{",
    "    int group, column, row;",
    "    for (group = 0; group < groups; group++) {",
    "        double part[8] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};",
    "        for (column = 0; column < columns; column++) {",
    "            const double factor = vector[column];",
    "            for (row = 0; row < 8; row++) part[row] += matrix[row] * factor;",
    "            matrix += 8;",
    "        }",
    "        for (row = 0; row < 8; row++) sum[8 * group + row] += part[row];",
    "    }",
    "}",
)
"""The function that products by tables call."""

Term = tuple[Array, str]
"""A matrix (rows, n) and the name of the vector it is applied to."""


def product(name: str, target: str, terms: Iterable[Term], size: int) -> Code:
    """target[i] = sum over the terms of matrix[i, j] vector[j], for i below `size`; tables are called after `name`.

    Entries that are 0 are left out where the product is written out, in the order of the columns.

    >>> product("sum", "y", [(np.array([[1.0, 0.0], [2.0, -0.5]]), "x")], 2).body
    ('y[0] = x[0];', 'y[1] = 2.0 * x[0] - 0.5 * x[1];')
    """
    used = tuple((matrix, vector) for matrix, vector in terms if np.any(matrix))
    if sum(np.count_nonzero(matrix) for matrix, _ in used) <= _WRITTEN_OUT:
        return Code(body=tuple(line for row in range(size) for line in wrap(f"{target}[{row}] = {_sum(used, row)};")))
    return _by_tables(name, target, used, size)


def _sum(terms: Sequence[Term], row: int) -> str:
    text = ""
    for matrix, vector in terms:
        for column in np.flatnonzero(matrix[row]):
            value = float(matrix[row, column])
            sign = ("-" if value < 0.0 else "") if not text else (" - " if value < 0.0 else " + ")
            factor = "" if abs(value) == 1.0 else f"{number(abs(value))} * "
            text += f"{sign}{factor}{vector}[{column}]"
    return text or "0.0"


def _by_tables(name: str, target: str, terms: Sequence[Term], size: int) -> Code:
    groups = -(-size // _ROWS)
    tables: list[str] = []
    body = ["{", f"    double sum[{_ROWS * groups}] = {{0.0}};"]
    for count, (matrix, vector) in enumerate(terms, 1):
        grouped = np.zeros((groups * _ROWS, matrix.shape[1]))
        grouped[:size] = matrix
        tables += table(f"{name}_{count}", grouped.reshape(groups, _ROWS, -1).transpose(0, 2, 1).reshape(-1, _ROWS))
        body.append(f"    multiply(&{name}_{count}[0][0], {groups}, {matrix.shape[1]}, {vector}, sum);")
    return Code(tuple(tables), (*body, f"    for (int row = 0; row < {size}; row++) {target}[row] = sum[row];", "}"))
