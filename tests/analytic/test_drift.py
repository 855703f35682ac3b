"""Drift by hand: bars in a row, two posts of different materials, what is not stated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import judge
from flexstage.analysis.linear_statics.drift import drift
from flexstage.mechanism.assembly.expansion import Ground, expansion, ground_of
from flexstage.models.lumped import lumped
from flexstage.show.tables.errors import drift_table

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
STEEL = fs.Material(young=200e9, poisson=0.3, density=7750.0, expansion=10e-6)
ALUMINIUM = fs.Material(young=70e9, poisson=0.33, density=2700.0, expansion=23e-6)
INVAR = fs.Material(young=140e9, poisson=0.3, density=8100.0, expansion=1e-6)


def bar(**fields):
    """Ground, 40 mm of rod (steel) from x = 10 to 50 mm, then a platform of aluminium whose reference is at x = 80 mm."""
    block = fs.Block("aluminium", (0.06, 0.02, 0.02), (0.08, 0.0, 0.0))
    return fs.Mechanism(
        name="bar",
        materials={"steel": STEEL, "aluminium": ALUMINIUM, "invar": INVAR},
        parts={"rod": fs.Rod("steel", 0.04, 0.004)},
        bodies={"platform": fs.Body(solids={"block": block}, points={"end": (0.11, 0.0, 0.0)})},
        links={"rod": fs.Link(("ground", "platform"), "rod", (0.03, 0.0, 0.0), X)},
        **fields,
    )


def test_a_bar_grows_piece_by_piece():
    """10 mm of invar frame, 40 mm of steel, 30 mm of aluminium to the reference, 30 more to the end."""
    found = drift(bar(), lumped(bar()), ground="invar")
    reference = 0.01 * 1e-6 + 0.04 * 10e-6 + 0.03 * 23e-6
    assert found.motion.at("platform.x", "uniform") == pytest.approx(reference, rel=1e-12)
    assert found.motion.at("end.x", "uniform") == pytest.approx(reference + 0.03 * 23e-6, rel=1e-12)
    np.testing.assert_allclose(found.forces.values, 0.0, atol=1e-9)
    assert found.taken["platform"] == "aluminium, of its solids"
    shown = drift_table(drift(bar(), lumped(bar()), ground="invar", datum=(0.01, 0.0, 0.0)))
    assert shown.texts()[1][:2] == ["platform.x [nm]", "1090"]  # per K, without the 10 mm of invar
    assert "Fixed point of the ground: (10, 0, 0) mm." in shown.notes[0]


def test_a_still_ground():
    """Without a ground material only rod and platform grow, from the rod's own foot."""
    found = drift(bar(), lumped(bar()), ground="none")
    assert found.motion.at("platform.x", "uniform") == pytest.approx(0.04 * 10e-6 + 0.03 * 23e-6, rel=1e-12)
    assert found.taken["ground"] == "no expansion, as requested"


def test_a_gradient_along_the_bar():
    """T = x: each piece takes its own integral of alpha x dx."""
    found = drift(bar(), lumped(bar()), ground="invar")
    pieces = ((1e-6, 0.0, 0.01), (10e-6, 0.01, 0.05), (23e-6, 0.05, 0.08))
    total = sum(0.5 * alpha * (end**2 - start**2) for alpha, start, end in pieces)
    assert found.motion.at("platform.x", "gradient.x") == pytest.approx(total, rel=1e-12)


def test_a_gradient_across_the_bar_bends_it():
    """T = y: curvature alpha in every piece, so slope -sum alpha l (about z) and deflection by the arms to the reference."""
    found = drift(bar(), lumped(bar()), ground="invar")
    pieces = ((1e-6, 0.0, 0.01), (10e-6, 0.01, 0.05), (23e-6, 0.05, 0.08))
    slope = -sum(alpha * (end - start) for alpha, start, end in pieces)
    sag = -sum(alpha * (end - start) * (0.08 - 0.5 * (start + end)) for alpha, start, end in pieces)
    assert found.motion.at("platform.rz", "gradient.y") == pytest.approx(slope, rel=1e-12)
    assert found.motion.at("platform.y", "gradient.y") == pytest.approx(sag, rel=1e-12)


def test_two_posts_of_different_materials_share():
    """A stiff platform on two collinear rods between fixed grounds: the force is the misfit over the sum of compliances."""
    stage = replace(
        bar(),
        parts={"rod": fs.Rod("steel", 0.04, 0.004), "other": fs.Rod("aluminium", 0.03, 0.004)},
        bodies={"platform": fs.Body(solids={"grain": fs.Block("invar", (1e-3, 1e-3, 1e-3), (0.05, 0.0, 0.0))})},
        links={
            "rod": fs.Link(("ground", "platform"), "rod", (0.03, 0.0, 0.0), X),
            "other": fs.Link(("platform", "ground"), "other", (0.065, 0.0, 0.0), X),
        },
    )
    found = drift(stage, lumped(stage), ground="none")
    area = np.pi / 4.0 * 0.004**2
    first, second = 200e9 * area / 0.04, 70e9 * area / 0.03
    force = (0.04 * 10e-6 + 0.03 * 23e-6) / (1.0 / first + 1.0 / second)
    assert found.forces.at("rod.fx", "uniform") == pytest.approx(-force, rel=1e-9)
    assert found.motion.at("platform.x", "uniform") == pytest.approx(0.04 * 10e-6 - force / first, rel=1e-9)


def test_what_is_not_stated_is_named():
    stack = fs.Piezo(stroke=1e-5, stiffness=1e7, length=0.02, diameter=0.01)
    stage = replace(
        bar(),
        materials={"steel": replace(STEEL, expansion=None), "aluminium": ALUMINIUM},
        parts={"rod": fs.Rod("steel", 0.04, 0.004), "stack": stack},
        links={**bar().links, "pzt": fs.Link(("ground", "platform"), "stack", (0.03, 0.02, 0.0), X)},
    )
    with pytest.raises(fs.DesignError) as told:
        expansion(stage)
    assert [finding.where for finding in told.value.findings] == ["materials.steel", "parts.stack"]
    with pytest.raises(fs.DesignError, match="Use steel"):
        expansion(stage, ground="stele")


def test_bodies_of_several_and_of_no_material():
    """The heaviest solid leads; a body of nothing between two materials is not known."""
    mirror = fs.Block("invar", (0.01, 0.01, 0.01), (0.08, 0.0, 0.02))
    stage = replace(
        bar(), bodies={"platform": replace(bar().bodies["platform"], solids={**bar().bodies["platform"].solids, "mirror": mirror})}
    )
    assert expansion(stage).taken["platform"] == "aluminium, of its heaviest solid, block"
    bare = replace(
        bar(),
        bodies={"platform": fs.Body(reference=(0.08, 0.0, 0.0))},
        parts={"rod": fs.Rod("steel", 0.04, 0.004), "other": fs.Rod("aluminium", 0.04, 0.004)},
        links={**bar().links, "other": fs.Link(("ground", "platform"), "other", (0.03, 0.02, 0.0), X)},
    )
    with pytest.raises(fs.DesignError, match=r"platform: thermal expansion unknown: .* its links are of aluminium, steel"):
        expansion(bare, ground="steel")


def mixed(order):
    """A bar on a rod of steel, and one of aluminium beside it."""
    parts = {"rod": fs.Rod("steel", 0.04, 0.004), "other": fs.Rod("aluminium", 0.04, 0.004)}
    links = {**bar().links, "other": fs.Link(("ground", "platform"), "other", (0.03, 0.02, 0.0), X)}
    return replace(bar(), parts=parts, links=dict(list(links.items())[::order]))


def test_the_ground_is_of_the_one_material_on_it():
    assert ground_of(bar()) == Ground("steel", "material of all links on it")
    assert not ground_of(bar()).stated
    assert "Ground assumed to be steel: material of all links" in " ".join(drift_table(drift(bar(), lumped(bar()))).notes)


@pytest.mark.parametrize("order", [1, -1])
def test_a_ground_of_several_materials_is_asked_for(order):
    """Never guessed from how many links are of which, nor from their order."""
    stage = mixed(order)
    asked = r'ground: .* of aluminium, steel\. Specify the material in the design: ground = "aluminium"; "none"'
    with pytest.raises(fs.DesignError, match=asked):
        drift(stage, lumped(stage))
    with pytest.raises(fs.DesignError, match="of no material"):
        ground_of(replace(bar(), parts={"rod": fs.Joint()}))
    found = fs.analyse(stage)
    assert found.drift is None
    assert 'ground = "aluminium"' in found.missing["drift"]
    required = replace(stage, requirements={"drift.x": "at most 1 um/K"})
    assert any("ground" in str(verdict) for verdict in judge(required))


@pytest.mark.parametrize("order", [1, -1])
def test_the_stated_ground_counts(order):
    values = {}
    for ground in ("steel", "aluminium", "invar", "none"):
        stage = replace(mixed(order), ground=ground)
        assert ground_of(stage).stated
        values[ground] = drift(stage, lumped(stage)).motion.at("platform.x", "uniform")
        asked = drift(mixed(order), lumped(mixed(order)), ground=ground)
        assert asked.motion.at("platform.x", "uniform") == values[ground]
        assert fs.loads(fs.dumps(stage)) == stage
    assert values["none"] < values["invar"] < values["steel"] < values["aluminium"]
    findings = fs.check(replace(bar(), ground="stele"))
    assert any(finding.where == "ground" and "steel" in finding.advice for finding in findings)


def test_a_batch_of_expansions():
    """An array of coefficients gives an array of drifts."""
    values = np.array([10e-6, 12e-6])
    stage = replace(bar(), materials={**bar().materials, "steel": replace(STEEL, expansion=values)})
    found = drift(stage, lumped(stage), ground="none").motion.at("platform.x", "uniform")
    np.testing.assert_allclose(found, 0.04 * values + 0.03 * 23e-6, rtol=1e-12)


def test_locked_freedoms_that_cannot_follow_are_refused():
    """Two welds between the ground and a platform of aluminium, 50 mm apart: no elasticity takes the growth."""
    stage = replace(
        bar(),
        parts={"weld": fs.Joint()},
        links={
            "one": fs.Link(("ground", "platform"), "weld", (0.05, 0.0, 0.0), X),
            "two": fs.Link(("ground", "platform"), "weld", (0.1, 0.0, 0.0), X),
        },
    )
    loose = bar()
    with pytest.raises(fs.DesignError, match="locked degrees of freedom block thermal expansion"):
        drift(stage, lumped(loose), ground="none")
