"""Universal files: functions at nodal degrees of freedom (data set 58), in ASCII and in binary."""

from flexstage.experiment.formats.format import Format
from flexstage.experiment.formats.uff.read import is_uff, read_uff
from flexstage.experiment.formats.uff.write import write_uff

UFF = Format((".uff", ".unv", ".58", ".ufb"), is_uff, read_uff, write_uff)
"""Universal file format, written in binary: numbers keep all bits."""
