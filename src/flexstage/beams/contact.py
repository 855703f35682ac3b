"""Hertz-Mindlin contacts, linearised about their preload."""

import numpy as np

from flexstage.beams.law import PartLaw
from flexstage.parts.contact import contact_stiffness

CONTACT = PartLaw(material_stiffness=contact_stiffness, mass=lambda _: np.zeros((12, 12)))
