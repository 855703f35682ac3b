"""Documents: results as plain JSON values for machines, one document a command (described in `docs/json.md`).

Matrices are {rows, columns, unit, values}; a scalar's unit stands in its key (`frequency_hz`). Numbers that are not finite become null,
with the reason under `reasons`.
"""
