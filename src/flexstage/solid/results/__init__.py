"""Results of the solid model: stage, units, hinges, verification and calibration."""
