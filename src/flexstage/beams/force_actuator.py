"""Force actuators without stiffness, with half of the mass on each body."""

from flexstage.beams.law import PartLaw

FORCE_ACTUATOR = PartLaw(stiffness=lambda part: part.stated().stiffness, mass=lambda part: part.stated().mass, needs_material=False)
