"""Voice coils: the magnets' stiffness and the damping along x, both sides' masses."""

from flexstage.beams.law import PartLaw

VOICE_COIL = PartLaw(
    stiffness=lambda part: part.stated().stiffness,
    damping=lambda part: part.stated().damping,
    mass=lambda part: part.stated().mass,
    needs_material=False,
)
