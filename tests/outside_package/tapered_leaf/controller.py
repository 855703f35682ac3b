"""A kind of controller: integrators alone, of the gain that passes 1 where it shall."""

from flexstage.control.controllers.family import Family
from flexstage.control.controllers.pi import PI


def integrators(place, step):
    """One law: k / s with |k g / (2 pi f)| = 1."""
    return [PI(0.0, 6.283185307179586 * place.frequency / abs(place.gain))]


INTEGRATORS = Family("integrators", integrators, others="pi")
