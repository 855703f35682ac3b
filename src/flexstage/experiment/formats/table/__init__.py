"""CSV files: columns of numbers under a header that names channels and units."""

from flexstage.experiment.formats.format import Format
from flexstage.experiment.formats.table.read import is_text, read_table
from flexstage.experiment.formats.table.write import write_table

CSV = Format((".csv", ".txt"), is_text, read_table, write_table)
"""CSV format: numbers keep all bits, but files are large."""
