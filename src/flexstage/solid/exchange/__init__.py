"""Export of solids to files for other programs: STEP, VTU, GLB."""
