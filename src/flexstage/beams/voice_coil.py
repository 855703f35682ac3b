"""Voice coils: magnet stiffness and damping along x (for rotary coils, about x), and the masses of coil and magnet."""

from flexstage.beams.law import PartLaw

VOICE_COIL = PartLaw(
    stiffness=lambda part: part.stated().stiffness,
    damping=lambda part: part.stated().damping,
    mass=lambda part: part.stated().mass,
    needs_material=False,
)
