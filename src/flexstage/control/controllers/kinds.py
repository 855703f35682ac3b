"""Kinds of controllers that are families of laws, by their names in set-up files; other packages add to them."""

from flexstage.base.register import Register
from flexstage.control.controllers.family import Family
from flexstage.control.controllers.positive_feedback import PPF, PVF

CONTROLLERS: Register[Family] = Register("flexstage.controllers", {"ppf": PPF, "pvf": PVF})
"""Kinds of controllers that are families of laws of single loops, besides PI, PID and integral resonant control."""
