"""Law of springs and actuators with a specified 6x6 stiffness and mass; coils also have a specified damping."""

from flexstage.beams.law import PartLaw

STATED = PartLaw(
    stiffness=lambda part: part.stated().stiffness, damping=lambda part: part.stated().damping, mass=lambda part: part.stated().mass
)
