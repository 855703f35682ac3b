"""Kinds of amplifiers in a set-up file. Other packages can add kinds."""

from flexstage.base.register import Register
from flexstage.control.study.hardware.amplifiers import AmplifierForm, AmplifierSetup, ChargeSetup

_OWN = (AmplifierSetup, ChargeSetup)
AMPLIFIERS: Register[type[AmplifierForm]] = Register("flexstage.amplifiers", {each.kind: each for each in _OWN})
"""Kinds of amplifiers by the `kind` of a set-up file; default: voltage amplifiers."""
