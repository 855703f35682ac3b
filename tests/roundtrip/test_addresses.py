"""One scheme of addresses: what is set is got, overrides apply to the right copies, mistakes are told with their candidates."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.base.units.quantity import DIRECTION, LENGTH
from flexstage.mechanism.addresses.address import addresses, assign, get, provenance, quantity_of, set_value, tag_of
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar, Pose
from flexstage.mechanism.mechanism import Link, Mechanism, Placement, Probe, Unit
from flexstage.parts.body import Block, Body
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.freedom import Freedom
from flexstage.parts.gauge import Gauge, SensorSense
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.part import Restricted
from flexstage.parts.profile import Circular
from flexstage.parts.rod import Rod

X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def stage() -> Mechanism:
    neck = Neck("steel", thickness=0.0015, profile=Circular(0.005))
    compliance = tuple(tuple(1e-6 if row == column else 0.0 for column in range(6)) for row in range(6))
    unit = Unit(
        bodies={"knee": Body()},
        links={
            "back": Link(("ground", "knee"), "neck", (-0.1, 0.0, 0.0), X),
            "front": Link(("knee", "platform"), "neck", (0.0, 0.0, 0.0), X),
        },
    )
    return Mechanism(
        "addressed",
        materials={"steel": Material(200e9, 0.3, 7800.0)},
        parts={
            "neck": neck,
            "wire": Rod("steel", length=0.03, diameter=0.001),
            "pivot": ComplianceMatrix(compliance, free=(Freedom.RZ,)),
            "axial": Restricted(neck, elastic=(Freedom.X,)),
        },
        bodies={"platform": Body(solids={"plate": Block("steel", (0.3, 0.2, 0.02))})},
        links={"strut": Link(("ground", "platform"), "wire", (0.0, 0.0, -0.02), Z)},
        units={"leg": unit},
        placements={"L1-L3": Placement("leg", Polar(radius=0.08, first=0.0, facing=InstanceOrientation.TANGENT))},
        sensors={"gap": Gauge(range=1e-4)},
        gauges={"S1": Probe("gap", "platform", Pose(), SensorSense.OPENS)},
        tags={"parts.neck.thickness": "stated paper 2.2", "units.leg.links.front.at": "derived fit"},
        sources={"paper": "a paper", "fit": "a fit"},
    )


@pytest.mark.parametrize(
    ("short", "full"),
    [
        ("neck.thickness", "parts.neck.thickness"),
        ("parts.neck.radius", "parts.neck.profile.radius"),
        ("axial.radius", "parts.axial.part.profile.radius"),
        ("leg/front.radius", "leg/front.profile.radius"),
        ("leg/front.at.x", "units.leg.links.front.at.x"),
        ("units.leg.links.front.thickness", "leg/front.thickness"),
        ("L2/front.radius", "L2/front.profile.radius"),
        ("L2/front.at.0", "L2/front.at.x"),
        ("strut.length", "links.strut.length"),
        ("links.strut.length", "links.strut.length"),
        ("strut.at.z", "links.strut.at.z"),
        ("placements.L1-L3.radius", "placements.L1-L3.pattern.radius"),
        ("placements.L1-L3.polar.radius", "placements.L1-L3.pattern.radius"),
        ("platform.plate.size.y", "bodies.platform.solids.plate.size.y"),
        ("pivot.compliance.x.ry", "parts.pivot.compliance.x.ry"),
    ],
)
def test_what_is_set_is_got_under_both_names(short: str, full: str) -> None:
    changed = set_value(stage(), short, 0.0123)
    assert get(changed, full) == get(changed, short) == 0.0123
    assert changed != stage()


def test_every_number_has_an_address_that_sets_it() -> None:
    for address in addresses(stage()):
        changed = set_value(stage(), address, 0.25)
        assert get(changed, address) == 0.25
        assert addresses(changed) == addresses(stage())


def test_overrides_of_all_copies_and_of_one() -> None:
    changed = assign(assign(stage(), "leg/front.thickness=1.4mm"), "L2/front.thickness = 1.45 mm")
    assert dict(changed.overrides) == {"leg/front.thickness": 1.4e-3, "L2/front.thickness": 1.45e-3}
    links = expand(changed).links
    assert [links[f"{copy}/front"].part.thickness for copy in ("L1", "L2", "L3")] == [1.4e-3, 1.45e-3, 1.4e-3]
    assert [links[f"{copy}/back"].part.thickness for copy in ("L1", "L2", "L3")] == [1.5e-3] * 3
    assert get(changed, "parts.neck.thickness") == 1.5e-3


def test_an_override_of_all_copies_does_not_undo_that_of_one() -> None:
    changed = assign(assign(stage(), "L2/front.thickness=1.45 mm"), "leg/front.thickness=1.4 mm")
    assert expand(changed).links["L2/front"].part.thickness == 1.45e-3


def test_overrides_within_a_vector_are_merged() -> None:
    moved = set_value(stage(), "L2/front.at", (0.01, 0.02, 0.03))
    moved = assign(moved, "L2/front.at.y=5 mm")
    assert dict(moved.overrides) == {"L2/front.at": (0.01, 0.005, 0.03)}
    assert dict(set_value(assign(stage(), "L2/front.at.y=5 mm"), "L2/front.at", (0.0, 0.0, 0.0)).overrides) == {
        "L2/front.at": (0.0, 0.0, 0.0)
    }


def test_an_override_in_the_stages_own_link() -> None:
    changed = assign(stage(), "strut.length=40 mm")
    assert dict(changed.overrides) == {"links.strut.length": 0.04}
    assert expand(changed).links["strut"].part.length == 0.04


def test_a_compliance_stays_symmetric() -> None:
    changed = set_value(stage(), "parts.pivot.compliance.y.rz", 3e-6)
    assert changed.parts["pivot"].compliance[1][5] == changed.parts["pivot"].compliance[5][1] == 3e-6


def test_values_may_be_arrays_and_complex() -> None:
    values = np.array([1e-3, 2e-3])
    np.testing.assert_array_equal(get(set_value(stage(), "neck.thickness", values), "neck.thickness"), values)
    assert get(set_value(stage(), "neck.thickness", 1e-3 + 1e-30j), "neck.thickness") == 1e-3 + 1e-30j


def test_names_and_directions_are_assigned_too() -> None:
    assert get(assign(stage(), "leg/front.along=-y"), "units.leg.links.front.along") == (0.0, -1.0, 0.0)
    assert get(assign(stage(), "parts.neck.material=invar"), "parts.neck.material") == "invar"
    assert get(assign(stage(), "S1.positive=closes"), "gauges.S1.positive") is SensorSense.CLOSES


def test_quantities() -> None:
    assert quantity_of(stage(), "leg/front.radius") is LENGTH
    assert quantity_of(stage(), "leg/front.at") is LENGTH
    assert quantity_of(stage(), "leg/front.along") is DIRECTION
    assert quantity_of(stage(), "pivot.compliance.x.rx").name == "coupling compliance"


def test_tags_follow_the_value() -> None:
    assert tag_of(stage(), "neck.thickness") == tag_of(stage(), "L2/back.thickness") == "stated paper 2.2"
    assert tag_of(stage(), "leg/front.at.x") == tag_of(stage(), "L1/front.at.z") == "derived fit"
    assert tag_of(stage(), "wire.length") == "assumed"
    changed = assign(stage(), "neck.thickness=1.6 mm")
    assert tag_of(changed, "neck.thickness") == "assumed"
    departed = assign(stage(), "L2/back.thickness=1.6 mm")
    assert [tag_of(departed, f"{copy}/back.thickness") for copy in ("L1", "L2")] == ["stated paper 2.2", "assumed"]
    assert provenance(stage())["units.leg.links.front.at.y"] == "derived fit"


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("leg/frnt.thickness", ['"frnt"', "front"]),
        ("legs/front.thickness", ['"legs"', "leg"]),
        ("L4/front.thickness", ['"L4"', "L1", "L3"]),
        ("parts.nek.thickness", ['"nek"', "neck"]),
        ("parts.neck.thicknes", ["thickness"]),
        ("leg/front.at.w", ["Use x, y or z"]),
        ("leg/front.joins", ["cannot be overridden"]),
        ("leg/front", ["cannot be overridden"]),
        ("bodies.platform.inertia.xx", ['"xx"', "its parent is not specified", "Specify the parent first"]),
        ("tags.parts.neck.thickness", ["no values"]),
        ("", ["unknown name"]),
    ],
)
def test_misspelt_addresses_name_the_candidates(address: str, words: list[str]) -> None:
    with pytest.raises(DesignError) as caught:
        get(stage(), address)
    assert [word for word in words if word not in str(caught.value)] == []


def test_an_ambiguous_address_lists_its_places() -> None:
    twice = dataclasses.replace(stage(), bodies={**stage().bodies, "strut": Body(mass=1.0)})
    with pytest.raises(DesignError, match=r"bodies\.strut or links\.strut"):
        get(twice, "strut.at.z")


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("neck.thickness", ["equals sign"]),
        ("neck.thickness=1.4", ["unit missing"]),
        ("neck.thickness=1.4 kg", ["a mass"]),
        ("leg/front.at=1 mm", ["several values: x, y, z", '"leg/front.at.x=..."']),
        ("parts.neck=2mm", ["several values: thickness", "profile.radius", '"parts.neck.thickness=..."']),
        ("parts=1 kg", ["several values:", "and more"]),
        ("leg/front.along=up", ["-x"]),
        ("S1.positive=wide", ["Use opens or closes"]),
    ],
)
def test_assignments_that_cannot_be(assignment: str, words: list[str]) -> None:
    with pytest.raises(DesignError) as caught:
        assign(stage(), assignment)
    assert [word for word in words if word not in str(caught.value)] == []


@pytest.mark.parametrize(
    ("address", "value"), [("neck.thickness", "1 mm"), ("neck.thickness", True), ("leg/front.at", 1.0), ("neck.material", 1.0)]
)
def test_values_of_another_kind_are_refused(address: str, value: object) -> None:
    with pytest.raises(DesignError):
        set_value(stage(), address, value)
