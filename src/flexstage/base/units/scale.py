"""Unit factors and directions for descriptions written in Python: `1.54 * mm`, `along=X`.

Multiply a number by the factor to convert it to SI; divide an SI value by the factor to display it.
"""

from __future__ import annotations

import math

X = (1.0, 0.0, 0.0)
Y = (0.0, 1.0, 0.0)
Z = (0.0, 0.0, 1.0)

m = 1.0
mm = 1e-3
um = 1e-6
nm = 1e-9
rad = 1.0
mrad = 1e-3
urad = 1e-6
nrad = 1e-9
deg = math.pi / 180.0
kg = 1.0
N = 1.0
kN = 1e3
N_per_um = 1e6
N_per_m = 1.0
Pa = 1.0
MPa = 1e6
GPa = 1e9
Hz = 1.0
kHz = 1e3
V = 1.0
uF = 1e-6
K = 1.0
