"""Springs of specified stiffness."""

from flexstage.beams.law import PartLaw

SPRING = PartLaw(stiffness=lambda part: part.whole, mass=lambda part: part.stated().mass)
