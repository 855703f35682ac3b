"""Shear piezos as uniform blocks."""

from flexstage.beams.law import PartLaw

SHEAR_PIEZO = PartLaw(compliance=lambda part: part.compliance, mass=lambda part: part.stated().mass)
