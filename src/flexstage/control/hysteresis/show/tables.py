"""Tables of a stack's test: accuracy of the hysteresis model, and its plays."""

from __future__ import annotations

from flexstage.control.hysteresis.stack_test import StackTest
from flexstage.show.table import Table, array_table, result_table


def stack_tables(test: StackTest) -> tuple[Table | None, Table]:
    """Tabulate the range of a record, the model errors, and the thresholds and weights of the plays.

    >>> from flexstage.control.hysteresis.example import example_test
    >>> [table.texts()[1] for table in stack_tables(example_test()) if table is not None]
    [['voltage range', '0 to 1000', 'V'], ['0', '83.62', '83.62']]
    """
    plays = array_table("Plays", test.hysteresis.plays, "thresholds", "weights", "slopes")
    return result_table(test, provenance=test.source), plays
