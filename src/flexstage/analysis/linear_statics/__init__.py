"""Static analyses: stiffness, lost motion, drift, mass, single units."""
