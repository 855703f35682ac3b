"""Controller families by their names in set-up files. Other packages can register more families."""

from flexstage.base.register import Register
from flexstage.control.controllers.family import Family
from flexstage.control.controllers.positive_feedback import PPF, PVF

CONTROLLERS: Register[Family] = Register("flexstage.controllers", {"ppf": PPF, "pvf": PVF})
"""Single-loop controller families, in addition to PI, PID and integral resonant control."""
