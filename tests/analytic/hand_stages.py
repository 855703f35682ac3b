"""Four stages with closed forms: of the type of published ones, all values assumed."""

from __future__ import annotations

import math

XY = """
format = "flexstage 1"
name = "XY of eight double parallelograms"   # of the type of Awtar and Slocum's
damping = { law = "modal", ratio = 0.005 }
[numbers]
L = "50 mm"
[materials.al]
young = "70 GPa"
poisson = 0.33
density = "2700 kg/m^3"
yield_stress = "280 MPa"
expansion = "23e-6 1/K"
[parts.leaf]
kind = "leaf"
material = "al"
length = "L"
thickness = "0.6 mm"
width = "25 mm"
section = "beam"
[parts.coil]
kind = "voice_coil"
force_constant = "30 N/A"
peak_current = "4 A"
resistance = "3 ohm"
mass = "0.1 kg"
[bodies.platform]
mass = "0.5 kg"
inertia = { xx = "5e-4 kg m^2", yy = "5e-4 kg m^2", zz = "1e-3 kg m^2" }
[units.leg.bodies]
carriage = { mass = "0.2 kg", inertia = { xx = "2e-4 kg m^2", yy = "2e-4 kg m^2", zz = "2e-4 kg m^2" } }
inner = { mass = "40 g", inertia = { xx = "2e-5 kg m^2", yy = "2e-5 kg m^2", zz = "2e-5 kg m^2" } }
outer = { mass = "40 g", inertia = { xx = "2e-5 kg m^2", yy = "2e-5 kg m^2", zz = "2e-5 kg m^2" } }
[units.leg.links]
i1 = { joins = ["platform", "inner"], part = "leaf", from = ["55 mm", "15 mm", "0 mm"], to = ["55 mm + L", "15 mm", "0 mm"], bends = "z" }
i2 = { joins = ["platform", "inner"], part = "leaf", from = ["55 mm", "-15 mm", "0 mm"], to = ["55 mm + L", "-15 mm", "0 mm"], bends = "z" }
i3 = { joins = ["carriage", "inner"], part = "leaf", from = ["55 mm", "30 mm", "0 mm"], to = ["55 mm + L", "30 mm", "0 mm"], bends = "z" }
i4 = { joins = ["carriage", "inner"], part = "leaf", from = ["55 mm", "-30 mm", "0 mm"], to = ["55 mm + L", "-30 mm", "0 mm"], bends = "z" }
o1 = { joins = ["carriage", "outer"], part = "leaf", from = ["140 mm", "49 mm", "0 mm"], to = ["140 mm", "49 mm + L", "0 mm"], bends = "z" }
o2 = { joins = ["carriage", "outer"], part = "leaf", from = ["110 mm", "49 mm", "0 mm"], to = ["110 mm", "49 mm + L", "0 mm"], bends = "z" }
o3 = { joins = ["ground", "outer"], part = "leaf", from = ["155 mm", "49 mm", "0 mm"], to = ["155 mm", "49 mm + L", "0 mm"], bends = "z" }
o4 = { joins = ["ground", "outer"], part = "leaf", from = ["95 mm", "49 mm", "0 mm"], to = ["95 mm", "49 mm + L", "0 mm"], bends = "z" }
[units.driven]
like = "leg"
[units.driven.links]
motor = { joins = ["ground", "carriage"], part = "coil", at = ["130 mm", "0 mm", "0 mm"], along = "x" }
[placements]
X = { unit = "driven", polar = { radius = "0 mm", first = "0 deg", facing = "outward" } }
Y = { unit = "driven", polar = { radius = "0 mm", first = "90 deg", facing = "outward" } }
X2 = { unit = "leg", polar = { radius = "0 mm", first = "180 deg", facing = "outward" } }
Y2 = { unit = "leg", polar = { radius = "0 mm", first = "270 deg", facing = "outward" } }
[sensors.scale]
kind = "encoder"
range = "12 mm"
period = "20 um"
steps = 4096
[gauges]
GX = { gauge = "scale", body = "platform", pose = { at = ["22 mm", "0 mm", "0 mm"], along = "x" } }
GY = { gauge = "scale", body = "platform", pose = { at = ["0 mm", "22 mm", "0 mm"], along = "y" } }
[requirements]
"stroke.x" = "at least 5 mm"
"stroke.y" = "at least 5 mm"
"safety.at_strokes" = "at least 1.9"
"""

_RAYS = {"a": (60, "ground", "v1"), "b": (30, "hub", "v1"), "c": (150, "hub", "v2"), "d": (120, "platform", "v2")}


def _ray(radius: float, angle: float) -> str:
    x, y = (radius * each(math.radians(angle)) for each in (math.cos, math.sin))
    return f'["{x!r} mm", "{y!r} mm", "0 mm"]'


BUTTERFLY = """
format = "flexstage 1"
name = "butterfly pivot"                     # of the type of Henein's: four remote-centre pivots in series
damping = { law = "modal", ratio = 0.005 }
[materials.ti]
young = "114 GPa"
poisson = 0.34
density = "4430 kg/m^3"
yield_stress = "830 MPa"
expansion = "9e-6 1/K"
[parts.blade]
kind = "leaf"
material = "ti"
length = "20 mm"
thickness = "0.2 mm"
width = "10 mm"
section = "beam"
[parts.coil]
kind = "voice_coil"
force_constant = "5 N/A"
peak_current = "2 A"
[bodies]
hub = { mass = "5 g", inertia = { xx = "1e-7 kg m^2", yy = "1e-7 kg m^2", zz = "1e-7 kg m^2" } }
v1 = { mass = "20 g", inertia = { xx = "5e-6 kg m^2", yy = "5e-6 kg m^2", zz = "1e-5 kg m^2" } }
v2 = { mass = "20 g", inertia = { xx = "5e-6 kg m^2", yy = "5e-6 kg m^2", zz = "1e-5 kg m^2" } }
platform = { mass = "200 g", inertia = { xx = "5e-5 kg m^2", yy = "5e-5 kg m^2", zz = "1e-4 kg m^2" } }
[sensors.scale]
range = "10 mm"
resolution = "1 nm"
[gauges]
G = { gauge = "scale", body = "platform", pose = { at = ["0 mm", "30 mm", "0 mm"], along = "x" }, positive = "opens" }
[requirements]
"stroke.rz" = "at least 5 deg"
"frequency.platform.1" = "at least 5 Hz"
"safety.at_strokes" = "at least 1.5"
[links]
motor = { joins = ["ground", "platform"], part = "coil", at = ["0 mm", "30 mm", "0 mm"], along = "x" }
""" + "\n".join(
    f'{name}{number} = {{ joins = ["{near}", "{far}"], part = "blade", from = {_ray(5.0, sign * angle)}, to = {_ray(25.0, sign * angle)}, '
    'bends = "z" }'
    for name, (angle, near, far) in _RAYS.items()
    for number, sign in ((1, 1), (2, -1))
)

CUBE = """
format = "flexstage 1"
name = "XYZ cube"
damping = { law = "modal", ratio = 0.01 }
[materials.steel]
young = "200 GPa"
poisson = 0.3
density = "7800 kg/m^3"
yield_stress = "1000 MPa"
expansion = "11e-6 1/K"
[parts]
wire = { kind = "rod", material = "steel", length = "25 mm", diameter = "1 mm" }
leaf = { kind = "leaf", material = "steel", length = "20 mm", thickness = "0.4 mm", width = "12 mm", section = "beam" }
[parts.stack]
kind = "piezo"
stroke = "38 um"
stiffness = "50 N/um"
length = "36 mm"
diameter = "7 mm"
voltage_high = "150 V"
capacitance = "2 uF"
bias = "75 V"
expansion = "-3e-6 1/K"
mass = "12 g"
preload = "200 N"
[bodies.platform]
mass = "0.2 kg"
inertia = { xx = "5e-5 kg m^2", yy = "5e-5 kg m^2", zz = "5e-5 kg m^2" }
[units.leg.bodies]
carriage = { mass = "80 g", inertia = { xx = "1e-5 kg m^2", yy = "1e-5 kg m^2", zz = "1e-5 kg m^2" } }
[units.leg.links]
w1 = { joins = ["platform", "carriage"], part = "wire", from = ["20 mm", "12 mm", "12 mm"], to = ["45 mm", "12 mm", "12 mm"] }
w2 = { joins = ["platform", "carriage"], part = "wire", from = ["20 mm", "-12 mm", "12 mm"], to = ["45 mm", "-12 mm", "12 mm"] }
w3 = { joins = ["platform", "carriage"], part = "wire", from = ["20 mm", "-12 mm", "-12 mm"], to = ["45 mm", "-12 mm", "-12 mm"] }
w4 = { joins = ["platform", "carriage"], part = "wire", from = ["20 mm", "12 mm", "-12 mm"], to = ["45 mm", "12 mm", "-12 mm"] }
g1 = { joins = ["carriage", "ground"], part = "leaf", from = ["50 mm", "15 mm", "0 mm"], to = ["50 mm", "35 mm", "0 mm"], bends = "z" }
g2 = { joins = ["carriage", "ground"], part = "leaf", from = ["70 mm", "15 mm", "0 mm"], to = ["70 mm", "35 mm", "0 mm"], bends = "z" }
g3 = { joins = ["carriage", "ground"], part = "leaf", from = ["50 mm", "-15 mm", "0 mm"], to = ["50 mm", "-35 mm", "0 mm"], bends = "z" }
g4 = { joins = ["carriage", "ground"], part = "leaf", from = ["70 mm", "-15 mm", "0 mm"], to = ["70 mm", "-35 mm", "0 mm"], bends = "z" }
pzt = { joins = ["ground", "carriage"], part = "stack", from = ["111 mm", "0 mm", "0 mm"], to = ["75 mm", "0 mm", "0 mm"] }
[placements]
X = { unit = "leg", pose = { along = "x", up = "z" } }
Y = { unit = "leg", pose = { along = "y", up = "x" } }
Z = { unit = "leg", pose = { along = "z", up = "y" } }
[sensors.cap]
range = "100 um"
resolution = "1 nm"
noise_density = "0.02 nm/Hz^0.5"
[gauges]
SX = { gauge = "cap", body = "platform", pose = { at = ["-20 mm", "0 mm", "0 mm"], along = "x" }, positive = "opens" }
SY = { gauge = "cap", body = "platform", pose = { at = ["0 mm", "-20 mm", "0 mm"], along = "y" }, positive = "opens" }
SZ = { gauge = "cap", body = "platform", pose = { at = ["0 mm", "0 mm", "-20 mm"], along = "z" }, positive = "opens" }
[requirements]
"stroke.x" = "at least 15 um"
"stroke.y" = "at least 15 um"
"stroke.z" = "at least 15 um"
"safety.at_strokes" = "at least 2"
"""

ROBERTS = """
format = "flexstage 1"
name = "Roberts linkage"
damping = { law = "modal", ratio = 0.005 }
[numbers]
half = "30 mm"
high = "40 mm"
[materials.steel]
young = "200 GPa"
poisson = 0.3
density = "7800 kg/m^3"
yield_stress = "1000 MPa"
expansion = "11e-6 1/K"
[parts.notch]
kind = "notch"
material = "steel"
thickness = "0.4 mm"
width = "10 mm"
profile = { shape = "circular", radius = "3 mm" }
[parts.coil]
kind = "voice_coil"
force_constant = "10 N/A"
peak_current = "2 A"
[bodies.platform]
mass = "0.1 kg"
centre = ["0 mm", "20 mm", "0 mm"]
inertia = { xx = "4e-5 kg m^2", yy = "4e-5 kg m^2", zz = "4e-5 kg m^2" }
reference = ["0 mm", "0 mm", "0 mm"]
[bodies.left]
mass = "20 g"
centre = ["-0.75*half", "high/2", "0 mm"]
inertia = { xx = "3e-6 kg m^2", yy = "3e-6 kg m^2", zz = "3e-6 kg m^2" }
[bodies.right]
mass = "20 g"
centre = ["0.75*half", "high/2", "0 mm"]
inertia = { xx = "3e-6 kg m^2", yy = "3e-6 kg m^2", zz = "3e-6 kg m^2" }
[links]
A = { joins = ["ground", "left"], part = "notch", at = ["-half", "0 mm", "0 mm"], along = [15, 40, 0], bends = "z" }
B = { joins = ["ground", "right"], part = "notch", at = ["half", "0 mm", "0 mm"], along = [-15, 40, 0], bends = "z" }
C = { joins = ["left", "platform"], part = "notch", at = ["-half/2", "high", "0 mm"], along = [15, 40, 0], bends = "z" }
D = { joins = ["right", "platform"], part = "notch", at = ["half/2", "high", "0 mm"], along = [-15, 40, 0], bends = "z" }
m = { joins = ["ground", "platform"], part = "coil", at = ["0 mm", "0 mm", "0 mm"], along = "x" }
[sensors.cap]
range = "2 mm"
resolution = "1 nm"
[gauges]
G = { gauge = "cap", body = "platform", pose = { at = ["20 mm", "0 mm", "0 mm"], along = "x" }, positive = "opens" }
[requirements]
"stroke.x" = "at least 0.5 mm"
"safety.at_strokes" = "at least 1"
"""
STAGES = {"xy": XY, "butterfly": BUTTERFLY, "cube": CUBE, "roberts": ROBERTS}
