"""Descriptions made in Python: what is no number, names nothing or was not read is refused in words where it is given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.addresses.address import set_value
from flexstage.parts.part import Restricted

STAGE = parallelogram()
PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Entries of moments and products of inertia."""


@pytest.mark.parametrize(
    "made",
    [
        lambda: fs.Leaf("steel", length=0.05, thickness="0.4 mm", width=0.01),
        lambda: fs.Notch("steel", thickness="0.4 mm", width=0.01, profile=fs.Circular(0.002)),
        lambda: fs.Body(mass="1 kg"),
        lambda: fs.Link(("ground", "platform"), "leaf", at=("1 mm", 0.0, 0.0), along=(1.0, 0.0, 0.0)),
        lambda: fs.Body(points={"tip": (0.0, "1 mm", 0.0)}),
    ],
)
def test_a_text_is_no_number(made):
    with pytest.raises(fs.DesignError, match=r"must be a number \(got the string '.*'\)"):
        made()


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: fs.Rod("steel", length=np.array([0.1, np.inf]), diameter=0.01), ["Rod.length at index 1", "inf", "a finite number"]),
        (lambda: fs.Rod("steel", length=None, diameter=0.1), ["Rod.length", "None", "a number"]),
        (lambda: fs.Rod("steel", length=True, diameter=0.1), ["Rod.length", "True", "a number"]),
        (lambda: fs.Mechanism("", parts={"p": "wire"}), ["Mechanism.parts.p", "'wire'", "Elastic"]),
        (lambda: fs.ComplianceMatrix(np.eye(6), ()), ["ComplianceMatrix.compliance", "ndarray", "6 values", "tuple"]),
    ],
)
def test_values_of_another_kind_are_refused_at_construction(made, words):
    with pytest.raises(fs.DesignError) as refusal:
        made()
    assert all(word in str(refusal.value) for word in words)


@pytest.mark.parametrize(
    "asked",
    [
        fs.modes,
        fs.statics,
        fs.transmissibility,
        lambda stage: fs.response(stage, ["platform"], ["B"]),
        lambda stage: fs.deflection(stage, stage),
        lambda stage: fs.lost_motion(fs.ideal(stage), stage),
        lambda stage: fs.lost_motion(stage, fs.lumped(stage)),
        lambda stage: fs.drift(stage, stage),
    ],
)
def test_a_description_is_no_model(asked):
    with pytest.raises(TypeError, match=r"takes a model, not a description: \w+\(.*fs\.lumped\(stage\)"):
        asked(STAGE)


def test_names_that_name_nothing_are_told_with_the_nearest():
    left = STAGE.links["left"]
    for wrong, message in (
        (replace(STAGE, links={**STAGE.links, "left": replace(left, part="leav")}), r'links\.left\.part: .* "leav".*leaf'),
        (replace(STAGE, links={**STAGE.links, "left": replace(left, joins=("ground", "platfrm"))}), r'left\.joins: .*"platfrm".*platform'),
        (replace(STAGE, materials={"aluminum": STAGE.materials["aluminium"]}), r'parts\.leaf\.material: .*"aluminium".*aluminum'),
        (replace(STAGE, sensors={}), r"gauges\.S\.gauge"),
    ):
        for read in (fs.ideal, fs.lumped):
            with pytest.raises(fs.DesignError, match=message):
                read(wrong)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"parts.leaf.length": 25e-12}, r"left: non-finite stiffness.* length 2\.5e-11 m"),
        ({"parts.leaf.width": 1e9}, r"left: non-finite stiffness.* width 1e\+09 m"),
        ({"parts.stack.stiffness": 1e36}, r"B/pzt: stiffnesses from .* N/m \(left\) to 1e\+36 N/m \(B/pzt\)"),
    ],
)
def test_numbers_beyond_computing_are_told_with_their_link(changes, told):
    stage = STAGE
    for name, value in changes.items():
        stage = set_value(stage, name, value)
    with pytest.raises(fs.DesignError, match=told):
        fs.modes(fs.lumped(stage))


def test_a_stage_without_sections_or_freedoms_is_told():
    stack = fs.Piezo(stroke=50e-6, stiffness=50e6, length=0.05, diameter=0.01)
    stage = fs.Mechanism(
        "minimal",
        parts={"stack": stack},
        bodies={"platform": fs.Body(mass=1.0)},
        links={"pzt": fs.Link(("ground", "platform"), "stack", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))},
    )
    found = fs.analyse(stage)
    assert found.workspace.stress is None
    assert "no link has a section" in found.workspace.reasons["stress"]
    locked = replace(stage, parts={"stack": Restricted(stack, ())})
    assert fs.ideal(locked).mapping.values[0, 0] == 1.0
    with pytest.raises(fs.DesignError, match="every degree of freedom is locked, by pzt"):
        fs.lumped(locked)


def test_what_does_not_fit_into_memory_is_refused_with_what_would(monkeypatch):
    monkeypatch.setattr("flexstage.base.processes.memory.available", lambda: 1e3)
    monkeypatch.setattr("flexstage.base.processes.memory.ALWAYS", 0.0)
    for read in (fs.ideal, fs.lumped):
        with pytest.raises(
            fs.DesignError,
            match=r"3 bodies and .* links need about .* GB of memory, but only 1e-06 GB is available\. Join .* about \d+ bodies",
        ):
            read(STAGE)


def test_whole_numbers_are_numbers_wherever_they_are_given():
    """Also in tables by name: a file then holds them as lengths, weights and temperatures."""
    platform = replace(STAGE.bodies["platform"], points={"tip": (0, 0, 3)})
    stage = replace(STAGE, bodies={**STAGE.bodies, "platform": platform}, temperatures={"all": 2})
    assert "error" not in {each.severity.value for each in fs.check(stage)}
    assert fs.loads(fs.dumps(stage)) == stage


@pytest.mark.parametrize("digits", [5, 6, 9])
def test_rounding_of_written_digits_makes_no_thin_bar_impossible(digits):
    """The inertia of a bar along any direction, m L^2 / 12 (1 - n n^T), written with so many digits."""
    for seed in range(20):
        along = np.random.default_rng(seed).normal(size=3)
        moments = 5e-5 * (np.eye(3) - np.outer(along, along) / (along @ along))
        written = [float(f"{sign * moments[place]:.{digits}g}") for sign, place in zip((1, 1, 1, -1, -1, -1), PLACES, strict=True)]
        bar = replace(STAGE.bodies["platform"], solids={}, mass=0.06, centre=(0.0, 0.0, 0.0), inertia=fs.Inertia(*written))
        stage = replace(STAGE, bodies={**STAGE.bodies, "platform": bar})
        assert "error" not in {each.severity.value for each in fs.check(stage)}
        assert np.all(fs.modes(fs.lumped(stage)).frequencies > 0.0)


@pytest.mark.parametrize("moments", [(1.0, 2.0, 3.01), (1.0e-4, 1.0e-4, 2.001e-4), (4.12345678e-7, 4.12345678e-7, 8.247e-7)])
def test_moments_that_no_mass_has_are_refused(moments):
    body = fs.Body(mass=1.0, centre=(0.0, 0.0, 0.0), inertia=fs.Inertia(*moments))
    told = [finding.what for finding in fs.check(replace(STAGE, bodies={**STAGE.bodies, "platform": body}))]
    assert any("expected each between 0 and the sum of the other two" in each for each in told)


def test_a_value_that_its_formula_does_not_give_is_written_without_it():
    """Written, the formula would take the place of the value."""
    stage = fs.case("parallelogram")
    left = replace(stage.links["left"], at=(0.0, 1e-3, 0.0))
    changed = replace(stage, links={**stage.links, "left": left})
    back = fs.loads(fs.dumps(changed))
    assert back.links == changed.links
    lost = changed.formulas.keys() - back.formulas.keys()
    assert lost == {"links.left.at.x", "links.left.at.y"}
