"""Law of amplified actuators and stepping drives: their specified 6x6 stiffness matrix, and half of their mass and inertia at each face."""

from flexstage.beams.law import PartLaw

AMPLIFIED = PartLaw(stiffness=lambda part: part.between, mass=lambda part: part.carried, needs_material=False)
STEPPER = AMPLIFIED
