"""The JSON Schema says of a file what the loader says: shipped cases and random designs fit, mistakes do not."""

from __future__ import annotations

import json
import re
import tomllib
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from flexstage.base.finding import DesignError
from flexstage.base.units import quantity
from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import parse
from flexstage.cases.registry import CASES
from flexstage.control.hysteresis.creep import LogCreep
from flexstage.control.hysteresis.models.envelope import Envelope
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.stack import dumps_hysteresis, hysteresis_schema, stack_hysteresis
from flexstage.control.study.file import setup_schema
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import dumps, schema
from flexstage.studies.form import study_schema
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.sweeps.file import loads_study
from flexstage.studies.tolerances.file import loads_tolerance
from tests.conftest import examples
from tests.roundtrip.designs import TEXT, mechanisms

SCHEMA = schema()
KNOWN = {
    "$ref", "$schema", "$defs", "title", "description", "examples", "type", "const", "enum", "pattern", "properties", "required", "oneOf",
    "anyOf", "additionalProperties", "items", "prefixItems", "minItems", "maxItems", "minimum", "maximum", "exclusiveMinimum",
    "exclusiveMaximum", "default",
}  # fmt: skip
TYPES = {"object": dict, "array": list, "string": str, "number": (int, float), "integer": int, "boolean": bool}


class Rules:
    """The part of JSON Schema 2020-12 that ours uses."""

    def __init__(self, root: dict[str, Any]) -> None:
        self.root = root

    def fits(self, value: Any, rule: Any) -> bool:
        if isinstance(rule, bool):
            return rule
        assert set(rule) <= KNOWN, set(rule) - KNOWN
        if "$ref" in rule:
            return self.fits(value, self.root["$defs"][rule["$ref"].removeprefix("#/$defs/")])
        if "type" in rule and not isinstance(value, TYPES[rule["type"]]):
            return False
        return all(check(value, rule) for check in (self.alternative, self.text, self.number, self.list, self.table))

    def alternative(self, value: Any, rule: dict[str, Any]) -> bool:
        if "oneOf" in rule and sum(self.fits(value, option) for option in rule["oneOf"]) != 1:
            return False
        if "anyOf" in rule and not any(self.fits(value, option) for option in rule["anyOf"]):
            return False
        return value == rule.get("const", value) and value in rule.get("enum", [value])

    def text(self, value: Any, rule: dict[str, Any]) -> bool:
        return not isinstance(value, str) or "pattern" not in rule or re.search(rule["pattern"], value) is not None

    def number(self, value: Any, rule: dict[str, Any]) -> bool:
        if not isinstance(value, (int, float)):
            return True
        low = value >= rule.get("minimum", value) and ("exclusiveMinimum" not in rule or value > rule["exclusiveMinimum"])
        return low and value <= rule.get("maximum", value) and ("exclusiveMaximum" not in rule or value < rule["exclusiveMaximum"])

    def list(self, value: Any, rule: dict[str, Any]) -> bool:
        if not isinstance(value, list):
            return True
        first = rule.get("prefixItems", [])
        rest = all(self.fits(item, rule.get("items", True)) for item in value[len(first) :])
        sized = rule.get("minItems", 0) <= len(value) <= rule.get("maxItems", len(value))
        return rest and sized and all(self.fits(item, inner) for item, inner in zip(value, first, strict=False))

    def table(self, value: Any, rule: dict[str, Any]) -> bool:
        if not isinstance(value, dict):
            return True
        known, others = rule.get("properties", {}), rule.get("additionalProperties", True)
        present = all(key in value for key in rule.get("required", []))
        return present and all(self.fits(item, known.get(key, others)) for key, item in value.items())


def fits(text: str, schema: dict[str, Any] = SCHEMA) -> bool:
    """Whether a design file's text fits the schema."""
    return Rules(schema).fits(tomllib.loads(text), schema)


def test_the_schema_is_json_and_names_its_version() -> None:
    assert json.loads(json.dumps(SCHEMA)) == SCHEMA
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"


@pytest.mark.parametrize(
    "schema", [SCHEMA, study_schema(), setup_schema(), hysteresis_schema()], ids=["design", "study", "loop", "hysteresis"]
)
def test_defaults_fit_their_own_fields(schema: dict[str, Any]) -> None:
    rules = [rule for table in (schema, *schema["$defs"].values()) for rule in table.get("properties", {}).values() if "default" in rule]
    assert rules
    assert all(Rules(schema).fits(rule["default"], rule) for rule in rules)


@pytest.mark.parametrize("name", CASES)
def test_shipped_cases_fit(name: str) -> None:
    assert fits(dumps(CASES[name].build()))


@examples(6)
@given(mechanisms())
def test_any_description_fits_but_for_its_bounds(mechanism: Mechanism) -> None:
    assert fits(dumps(mechanism), UNBOUNDED)


def without_bounds(rule: Any) -> Any:
    """The schema without the bounds of bare numbers, which random designs do not keep."""
    if isinstance(rule, dict):
        bounds = [key for key, item in rule.items() if key.lower().endswith(("minimum", "maximum")) and not isinstance(item, dict)]
        return {key: without_bounds(item) for key, item in rule.items() if key not in bounds}  # `maximum` is a key of force actuators, too
    return [without_bounds(item) for item in rule] if isinstance(rule, list) else rule


UNBOUNDED = without_bounds(SCHEMA)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"30 mm"', "30"),
        ('"30 mm"', '"30"'),
        ('"30 mm"', '"1e5"'),
        ('"30 mm"', '"thirty mm"'),
        ("diameter =", "diametre ="),
        ('kind = "rod"\n', ""),
        ('kind = "rod"', 'kind = "rodd"'),
        ('facing = "tangent"', 'facing = "tangential"'),
        ('along = "z"', 'along = "up"'),
        ('along = "z"', "along = [0, 0]"),
        ('["1 mm", "0 mm", "0 mm"]', '["1 mm", "0 mm"]'),
        ('["ground", "platform"]', '["ground"]'),
        ('"stated paper 2"', '"published"'),
        ('format = "flexstage 1"', 'format = "flexstage 9"'),
        ('name = "wire"', ""),
        ("polar = { ", "polar = { diameter = 1, "),
        ('unit = "leg", polar =', 'unit = "leg", polar2 ='),
    ],
)
def test_mistakes_do_not_fit(old: str, new: str) -> None:
    assert fits(TEXT)
    assert old in TEXT
    assert not fits(TEXT.replace(old, new))


def test_every_class_is_described_and_every_example_parses() -> None:
    assert all(definition["description"] for definition in SCHEMA["$defs"].values())
    kinds = {value.name: value for value in vars(quantity).values() if isinstance(value, Quantity)}
    found = list(examples(SCHEMA))
    assert len(found) > 100
    for name, example in found:
        assert parse(str(example), kinds[name]) == parse(kinds[name].example, kinds[name])


def examples(rule: Any) -> list[tuple[str, Any]]:
    """Every quantity's name and example in a schema."""
    if isinstance(rule, list):
        return [found for item in rule for found in examples(item)]
    if not isinstance(rule, dict):
        return []
    own = [(rule["description"].partition(",")[0], rule["examples"][0])] if "examples" in rule and "description" in rule else []
    return own + [found for item in rule.values() for found in examples(item)]


STUDY = """format = "flexstage study 1"
name = "leaves"
case = "parallelogram"
parameters = { spacing = "52 mm" }
responses = { f = "frequency.platform.1", m = "mass" }
limits = { mass = "at most 14 kg" }
sweep = { sampling = "latin hypercube", designs = 8, seed = 3, pairs = false }
optimise = { maximise = ["f"], minimise = "m", starts = 2, pareto_points = 5, requirements = false }
tolerance = { copies = 64, sampling = "sobol", yield = "90 %", requirements = false, crosstalk = false, point = "platform" }
[variables]
young = { address = "materials.aluminium.young", from = "-10 %", to = "10 %", logarithmic = true }
leaf = { address = ["parts.leaf.width"], from = "40 mm", to = "0.06 m", levels = 3, step = "1 mm" }
[scatter]
wire = { address = "parts.leaf.thickness", normal = "5 um", within = "9 um", independent = false }
wear = { address = "links.left.thickness", uniform = "5 um" }
grind = { address = "links.right.thickness", interval = ["-1 um", "5 um"] }
"""
"""Every key that a study's file may have."""


def test_a_study_fits_and_is_read() -> None:
    assert fits(STUDY, study_schema())
    assert loads_study(STUDY).variables[1].step == pytest.approx(1e-3)
    assert len(load_optimisation(loads_study(STUDY)).objectives) == 2
    assert [each.name for each in loads_tolerance(STUDY).scatters] == ["wire", "wear", "grind"]
    keys = {key for table in study_schema()["$defs"].values() for key in table["properties"]} | set(study_schema()["properties"])
    assert {key for key in keys if not re.search(rf"\b{key}\b", STUDY)} == {"design", "parameter"}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("flexstage study 1", "flexstage 1"),
        ('name = "leaves"', "name = 1"),
        ('"mass"', "3"),
        ("seed = 3", "sed = 3"),
        ("designs = 8", "designs = 0"),
        ("pairs = false", 'pairs = "no"'),
        ('"latin hypercube"', '"latin"'),
        ('"sobol"', '"grid"'),
        ('["f"]', "[]"),
        ('"90 %"', "1.5"),
        (', from = "-10 %"', ""),
        ("levels = 3", "levels = 1"),
        ('"1 mm"', '["1 mm"]'),
        ("[scatter]", "[scater]"),
    ],
)
def test_mistakes_in_a_study_are_refused_by_all_commands(old: str, new: str) -> None:
    text = STUDY.replace(old, new, 1)
    assert old in STUDY
    assert not fits(text, study_schema())
    for read in (loads_study, loads_tolerance):
        with pytest.raises(DesignError):
            read(text)


def test_a_study_may_name_anything_as_it_likes() -> None:
    """A study has no tags: the word is a name as any other."""
    text = STUDY.replace("young = {", "tags = {")
    assert fits(text, study_schema())
    assert [each.name for each in loads_study(text).variables] == ["tags", "leaf"]


def test_a_hysteresis_file_fits() -> None:
    envelope = Envelope(np.array([0.0, 50.0, 100.0]), np.array([0.0, 40.0, 100.0]))
    model = PrandtlIshlinskii([0.0, 50.0], [1e-7, 2e-8], envelope)
    text = dumps_hysteresis(stack_hysteresis(model, creep=LogCreep(0.02), volts=(0.0, 100.0), rms=0.01, source="test"))
    assert fits(text, hysteresis_schema())
    assert not fits(text.replace("thresholds", "threshold"), hysteresis_schema())
