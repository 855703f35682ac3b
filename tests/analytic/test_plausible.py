"""Plausibility against the shipped catalogue: nothing real is doubted, a slip of the unit is."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import flexstage as fs
from flexstage.analysis.caveats import caveats
from flexstage.cases.registry import CASES, case
from flexstage.mechanism.store import loads, shipped_catalogue
from flexstage.parts.plausible import implausible

STEEL = fs.Material(young=200e9, poisson=0.3, density=7800.0, expansion=10.8e-6, yield_stress=1e9)
STACK = fs.Piezo(
    stroke=38e-6,
    stiffness=50e6,
    length=0.036,
    diameter=0.0079,
    voltage_low=-20.0,
    voltage_high=120.0,
    maximum_load=2000.0,
    capacitance=4e-6,
)


def told(item: object) -> list[str]:
    return [finding.where for finding in implausible([("it", item)])]


def test_nothing_shipped_is_doubted() -> None:
    for section in shipped_catalogue().sections:
        if not section.entries:
            continue
        table = section.key
        kind = f'kind = "{section.kind}", ' if section.kind else ""
        lines = [f'e{number} = {{ {kind}like = "{name}" }}' for number, name in enumerate(section.entries)]
        text = "\n".join(['format = "flexstage 1"', 'name = "all"', f"[{table}]", *lines])
        entries = getattr(loads(text, checked=False), table)
        assert len(entries) > 1
        assert [str(finding) for finding in implausible(entries.items())] == []
    for name in sorted(set(CASES) - {"telescope-mount"}):  # its source gives the struts' material a mass that it does not have
        assert not any("plausible" in each.what for each in caveats(case(name, {})).warnings), name


@pytest.mark.parametrize(
    ("item", "field"),
    [
        (replace(STEEL, young=200e6), "young"),
        (replace(STEEL, density=7.8), "density"),
        (replace(STEEL, density=7.8e6), "density"),
        (replace(STEEL, expansion=10.8), "expansion"),
        (replace(STEEL, yield_stress=1e12), "yield_stress"),
        (replace(STACK, stiffness=0.025), "stiffness"),
        (replace(STACK, stroke=0.038), "stroke"),
        (replace(STACK, voltage_low=-0.02), "voltage_low"),
        (replace(STACK, capacitance=4.0), "capacitance"),
        (replace(STACK, mass=15.0), "mass"),
        (fs.Gauge(range=0.5e-3, resolution=100e-6), "resolution"),
        (fs.Gauge(range=0.5), "range"),
        (fs.Gauge(range=0.5e-3, resolution=1e-9, noise_density=1e-8, bandwidth=5e3), "noise_density"),
        (fs.Gauge(range=0.5e-3, bandwidth=5.0), "bandwidth"),
        (replace(STEEL, expansion=10.8e-9), "expansion"),
        (replace(STEEL, loss_factor=2.5), "loss_factor"),
        (replace(STACK, capacitance=4e-3), "capacitance"),
        (replace(STACK, capacitance=4e-9), "capacitance"),
        (replace(STACK, maximum_load=2.0), "maximum_load"),
        (replace(STACK, maximum_load=2e6), "maximum_load"),
        (replace(STACK, tensile_limit=0.05), "tensile_limit"),
        (replace(STACK, tensile_limit=50e3), "tensile_limit"),
        (replace(STACK, preload=0.2), "preload"),
        (replace(STACK, bias=0.05), "bias"),
        (replace(STACK, resonance=40.0), "resonance"),
        (replace(STACK, resonance=40e6), "resonance"),
        (replace(STACK, expansion=-3e-9), "expansion"),
        (replace(STACK, expansion=-3e-3), "expansion"),
        (fs.Block("steel", (0.04, 0.03, 0.03e-3)), "size"),
        (fs.Cylinder("steel", 0.02e-3, 0.03), "size"),
        (fs.Body(mass=5.0, centre=(0.0, 0.0, 0.0), inertia=fs.Inertia(1e-6, 1e-6, 1e-6)), "inertia"),
        (fs.Payload("platform", 2000.0, (0.0, 0.0, 0.0), fs.Inertia(1e-3, 1e-3, 1e-3)), "inertia"),
        (fs.Leaf("steel", 4.0, 0.4, 2.0), "thickness"),
        (fs.Rod("steel", 1e-3, 1e-8), "diameter"),
    ],
)
def test_slips_of_units_are_told(item: object, field: str) -> None:
    assert told(STEEL) == told(STACK) == []
    assert told(item).count(f"it.{field}") == 1


def test_a_load_that_no_part_bears_is_told() -> None:
    """2000 kg on a stack of 7 mm that bears 2000 N."""
    stage = fs.Mechanism(
        "press",
        materials={"steel": STEEL},
        parts={"stack": STACK},
        bodies={"platform": fs.Body(mass=2000.0, centre=(0.0, 0.0, 0.036), inertia=fs.Inertia(1.0, 1.0, 1.0))},
        links={"pzt": fs.Link(("ground", "platform"), "stack", (0.0, 0.0, 0.018), (0.0, 0.0, 1.0))},
    )
    assert "9.81 times the maximum load" in {each.where: each.what for each in caveats(stage).warnings}["pzt"]


def test_a_preload_beyond_the_maximum_load_is_not_said_to_be_weight() -> None:
    """The stack of the parallelogram carries no weight; its preload alone is 1.2 times a maximum load of 500 N."""
    stage = fs.case("parallelogram")
    stack = replace(stage.parts["stack"], maximum_load=500.0, preload=600.0)
    (told,) = (each.what for each in caveats(replace(stage, parts={**stage.parts, "stack": stack})).warnings if each.where == "B")
    assert told == "compression under preload, weight, payloads and forces is 1.2 times the maximum load of the stack"


def test_no_ball_of_osmium_is_doubted() -> None:
    mass, density = 0.3, 22.5e3
    inertia = 0.4 * mass * (mass / density * 0.75 / math.pi) ** (2 / 3)
    assert told(fs.Body(mass=mass, centre=(0.0, 0.0, 0.0), inertia=fs.Inertia(inertia, inertia, inertia))) == []
    assert told(fs.Payload("platform", mass, (0.0, 0.0, 0.0), fs.Inertia(*(0.9 * inertia,) * 3))) == ["it.inertia"]


@pytest.mark.parametrize(
    ("path", "value", "where"),
    [
        ("gravity", (0.0, 0.0, -9806.65), "gravity"),
        ("gravity", (0.0, 0.0, -9.80665e-3), "gravity"),
        ("envelope", (160.0, 0.08, 0.025), "envelope.x"),
        ("payloads", {"mirror": fs.Payload("platform", 0.01, (0.0, 0.0, 0.0), fs.Inertia(5.0, 5.0, 5.0))}, "payloads.mirror.inertia"),
        ("opening", fs.Aperture((0.1e-3, 0.1e-3)), "opening.size"),
    ],
)
def test_what_does_not_fit_the_stage_is_told(path: str, value: object, where: str) -> None:
    stage = replace(case("parallelogram", {}), **{path: value})
    told = [each.where for each in caveats(stage).warnings if "not plausible" in each.what]
    assert told == [where]


def test_a_point_far_outside_is_told_wherever_the_stage_stands() -> None:
    stage = case("parallelogram", {})
    body = stage.bodies["platform"]
    far = replace(stage, bodies={**stage.bodies, "platform": replace(body, points={"corner": (30.0, 0.0, 0.0)})})
    assert [each.where for each in caveats(far).warnings if "not plausible" in each.what] == ["platform.points.corner"]


def test_a_link_farther_away_than_any_stage_is_large_is_told() -> None:
    """By a slip of the power of ten it stands 27 km away."""
    stage = case("parallelogram", {})
    links = {name: replace(link, at=(-27e3, 0.0, 0.0)) if name == "left" else link for name, link in stage.links.items()}
    told = {each.where: each.what for each in caveats(replace(stage, links=links)).warnings if "not plausible" in each.what}
    assert told["left"].startswith("distance to the platform not plausible (got 2.7e+04 m")
