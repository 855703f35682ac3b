"""Matrix products as C code: file-level tables, and the statements that use them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.export.code.text import number, table, wrap

_SPARSE, _FEW, _ROWS = 0.2, 36, 8
"""A matrix with more nonzero entries, or a larger fraction of them, becomes a table."""
MULTIPLY = (
    "/* sum += matrix * vector, the matrix in groups of eight rows, each group by columns: a compiler keeps eight sums at once. */",
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
"""C function for products with tables."""

Term = tuple[Array, str]
"""A matrix (rows, n) and the name of the vector that it multiplies."""


@dataclass(frozen=True)
class Code:
    """C code: file-level tables and functions, body statements, and the number of additions and multiplications."""

    tables: tuple[str, ...] = ()
    body: tuple[str, ...] = ()
    flops: int = 0


def product(name: str, target: str, terms: Iterable[Term], size: int) -> Code:
    """Generate C code that adds the matrix-vector products `terms`, and stores their sum in the `size` elements of `target`.

    Sparse matrices become single statements. Dense matrices become tables; the names of these tables start with `name`.

    >>> product("seen", "y", [(np.array([[2.0, 0.0], [0.0, -1.0]]), "x")], 2).body
    ('y[0] = 2.0 * x[0];', 'y[1] = -x[1];')
    """
    used = [term for term in terms if np.any(term[0])]
    sparse = [term for term in used if not _is_dense(term[0])]
    dense = [term for term in used if _is_dense(term[0])]
    body = [line for row in range(size) for line in wrap(f"{target}[{row}] = {_sum(sparse, row)};")]
    tables: list[str] = []
    groups = -(-size // _ROWS)
    for place, (matrix, vector) in enumerate(dense):
        padded = np.zeros((groups * _ROWS, matrix.shape[1]))
        padded[:size] = matrix
        tables += table(f"{name}_{place}", padded.reshape(groups, _ROWS, -1).transpose(0, 2, 1).reshape(-1, _ROWS))
        body += [
            "{",
            f"    double sum[{_ROWS * groups}] = {{0.0}};",
            f"    multiply(&{name}_{place}[0][0], {groups}, {matrix.shape[1]}, {vector}, sum);",
            f"    for (int row = 0; row < {size}; row++) {target}[row] += sum[row];",
            "}",
        ]
    flops = 2 * (sum(np.count_nonzero(matrix) for matrix, _ in sparse) + sum(matrix.size for matrix, _ in dense))
    return Code(tuple(tables), tuple(body), int(flops))


def _is_dense(matrix: Array) -> bool:
    return bool(np.count_nonzero(matrix) > max(_FEW, _SPARSE * matrix.size))


def _sum(terms: Sequence[Term], row: int) -> str:
    text = ""
    for matrix, vector in terms:
        for column in np.flatnonzero(matrix[row]):
            value = matrix[row, column]
            sign = ("-" if value < 0.0 else "") if not text else (" - " if value < 0.0 else " + ")
            factor = "" if abs(value) == 1.0 else f"{number(abs(value))} * "
            text += f"{sign}{factor}{vector}[{column}]"
    return text or "0.0"
