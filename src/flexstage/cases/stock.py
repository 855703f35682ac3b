"""Materials, stacks and gauges that several shipped cases are made of.

What the catalogue states of a material is taken from there, so that it has one source (`tests/analytic/test_stock.py`).
"""

from __future__ import annotations

from collections.abc import Mapping

from flexstage.base.units.scale import GPa, MPa, N_per_um, kHz, mm, nm, uF, um
from flexstage.parts.encoder import Encoder
from flexstage.parts.gauge import Gauge
from flexstage.parts.material import Material
from flexstage.parts.piezo import Piezo
from flexstage.parts.voice_coil import VoiceCoil

ALUMINIUM = Material(
    young=71.7 * GPa,
    poisson=0.33,
    density=2810.0,
    yield_stress=503 * MPa,
    expansion=23.6e-6,
    loss_factor=0.001,
    source="EN AW-7075-T6, typical; loss factor assumed",
)

STEEL = Material(
    young=200 * GPa,
    poisson=0.285,
    density=7750.0,
    yield_stress=1170 * MPa,
    expansion=10.8e-6,
    loss_factor=0.002,
    source="17-4PH, H900; yield stress typical, loss factor assumed",
)

GLASS_CERAMIC = Material(
    young=91 * GPa,
    poisson=0.24,
    density=2530.0,
    expansion=0.02e-6,
    loss_factor=0.001,
    source="Zerodur glass ceramic; loss factor assumed",
)

SLIM_STACK = Piezo(
    stroke=38 * um,
    stiffness=25 * N_per_um,
    length=36 * mm,
    diameter=5.642 * mm,
    mass=7.0e-3,
    maximum_load=950.0,
    tensile_limit=50.0,
    preload=200.0,
    resonance=40 * kHz,
    voltage_low=-20.0,
    voltage_high=120.0,
    bias=50.0,
    capacitance=3.1 * uF,
    expansion=-3e-6,
    loss_factor=0.02,
    source="multilayer stack 5 x 5 x 36 mm (diameter of equal area), typical",
)

STRONG_STACK = Piezo(
    stroke=38 * um,
    stiffness=100 * N_per_um,
    length=36 * mm,
    diameter=11.284 * mm,
    mass=28.1e-3,
    maximum_load=3800.0,
    tensile_limit=200.0,
    preload=800.0,
    resonance=40 * kHz,
    voltage_low=-20.0,
    voltage_high=120.0,
    bias=50.0,
    capacitance=13 * uF,
    expansion=-3e-6,
    loss_factor=0.02,
    source="multilayer stack 10 x 10 x 36 mm (diameter of equal area), typical",
)

GAUGE = Gauge(
    range=200 * um, resolution=0.5 * nm, noise_density=0.01 * nm, bandwidth=3 * kHz, source="capacitive gauge of 200 um range, typical"
)

COIL = VoiceCoil(
    force_constant=10.0,
    peak_current=3.0,
    continuous_current=1.0,
    resistance=5.0,
    inductance=1e-3,
    mass=0.06,
    magnet_mass=0.25,
    damping=0.5,
    travel=6 * mm,
    thermal_resistance=10.0,
    temperature_rise=80.0,
    source="moving coil of 10 N, typical",
)

SCALE = Encoder(range=6 * mm, period=20 * um, steps=4096.0, source="linear encoder, typical")

SOURCES: Mapping[str, str] = {
    "handbook": "typical handbook value of the material, that of the shipped catalogue",
    "typical": "typical of the maker's class of part; put the data sheet of the part you buy in its place",
    "layout": "a layout that fits, chosen here",
}

MATERIAL_FIELDS = ("young", "poisson", "density", "expansion")
STACK_FIELDS = ("stroke", "stiffness", "length", "mass", "maximum_load", "resonance", "voltage_low", "voltage_high", "capacitance")


def stock_tags(materials: tuple[str, ...], stacks: tuple[str, ...], gauges: tuple[str, ...]) -> dict[str, str]:
    """Provenance of stock entries under the names a case gives them.

    >>> stock_tags((), (), ("probe",))
    {'sensors.probe.range': 'assumed typical', 'sensors.probe.resolution': 'assumed typical'}
    """
    tags = {f"materials.{name}.{key}": "stated handbook" for name in materials for key in MATERIAL_FIELDS}
    tags |= {f"parts.{name}.{key}": "assumed typical" for name in stacks for key in STACK_FIELDS}
    return tags | {f"sensors.{name}.{key}": "assumed typical" for name in gauges for key in ("range", "resolution")}
