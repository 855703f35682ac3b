"""A kind of controller: integrators alone, of the gain that passes 1 where it shall."""

import numpy as np

from flexstage.control.controllers.family import Family, Place
from flexstage.control.controllers.law import Law
from flexstage.control.controllers.pi import PI


def integrators(place: Place, _step: float | None) -> list[Law]:
    """Return one integrator, k / s with |k g / (2 pi f)| = 1."""
    return [PI(0.0, 2.0 * np.pi * place.frequency / abs(place.gain))]


INTEGRATORS = Family("integrators", integrators, others="pi")
