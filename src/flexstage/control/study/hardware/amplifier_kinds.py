"""Kinds of amplifiers that a set-up file may state. Other packages offer theirs."""

from flexstage.base.register import Register
from flexstage.control.study.hardware.amplifiers import AmplifierForm, AmplifierSetup, ChargeSetup

_OWN = (AmplifierSetup, ChargeSetup)
AMPLIFIERS: Register[type[AmplifierForm]] = Register("flexstage.amplifiers", {each.kind: each for each in _OWN})
"""Kinds of amplifiers by the `kind` of a set-up file; a table without one is that of voltage amplifiers."""
