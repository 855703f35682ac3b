"""Amplified actuators and stepping drives: the specified 6x6 stiffness matrix, with half of the mass and inertia at each face."""

from flexstage.beams.law import PartLaw

AMPLIFIED = PartLaw(stiffness=lambda part: part.between, mass=lambda part: part.carried, needs_material=False)
STEPPER = AMPLIFIED
