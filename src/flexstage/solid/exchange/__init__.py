"""Solids in files for other programs: STEP, VTU, GLB."""
