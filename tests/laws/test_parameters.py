"""Laws of cases' parameters: a batch of them is a batch of stages, to the last bit; derivatives pass through them; studies vary them."""

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import measure_all
from flexstage.base.finding import DesignError
from flexstage.cases.parameters import parameters
from flexstage.cases.registry import CASES, Variant, case
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.batch.engine import plan_family, platform_modes
from flexstage.models.batch.family import drawn_family
from flexstage.studies.sweeps.execution.engine import engine_of
from flexstage.studies.sweeps.execution.evaluate import piece
from flexstage.studies.sweeps.file import loads_study
from flexstage.studies.sweeps.variable import apply_columns

STUDY = """
format = "flexstage study 1"
case = "double-triangle"
parameters.long_arm = "80 mm"
responses.mass = "mass"
sweep = { sampling = "sobol", designs = 4, seed = 1 }
[variables]
arm = { parameter = "short_arm", from = "24 mm", to = "28 mm" }
plate = { parameter = "plate_thickness", from = "-10 %", to = "10 %" }
side = { address = "bodies.platform.solids.plate.size.x", from = "-1 %", to = "1 %" }
"""

NECK = 'a = { parameter = "neck_thickness", from = "1 mm", to = "2 mm" }\n'


def values_of(mechanism):
    return {address: value for address, value, _ in node_of(Mechanism).numbers(mechanism)}


@pytest.mark.parametrize("name", CASES)
def test_a_batch_of_parameters_is_its_stages_one_by_one(name):
    factors = np.array([1.0, 0.99, 0.98])  # shares stay below one
    varying = {each.name: each.value * factors for each in parameters(case(name)).values()}
    batch = values_of(Variant(name).mechanism_at(varying))
    for index in range(len(factors)):
        alone = values_of(Variant(name).mechanism_at({key: float(value[index]) for key, value in varying.items()}))
        assert alone.keys() == batch.keys()
        assert all(np.broadcast_to(batch[address], (3,))[index] == value for address, value in alone.items())


def test_what_formulas_make_of_parameters_follows_them():
    """By hand: the neck's ends and the lever's hinges are where the parameters put them, and tags of other numbers stay."""
    drawn = CASES["double-triangle"].build({"short_arm": "25 mm", "neck_length": 0.013})
    assert drawn.parts["neck"].profile == fs.Straight(0.013)
    lug = drawn.units["horizontal"].bodies["lug"].solids["nose"]
    assert lug.at[0] - 0.5 * lug.size[0] == pytest.approx(95.6175e-3 + 0.5 * 0.013, rel=1e-12)
    assert drawn.units["vertical"].links["back"].at[2] == pytest.approx(0.025 - 0.060, rel=1e-12)
    assert "parts.neck.profile.length" not in drawn.tags
    assert "parts.neck.thickness" in drawn.tags


def vertical(mapping):
    """What B4 has to do for a unit of z."""
    return mapping.values[..., mapping.rows.index("B4"), mapping.columns.index("z")]


def test_a_lever_gains_by_its_arms():
    """The ideal stroke of a vertical actuator for a height is r1/r2 of it; so is the derivative, by complex step through the case."""
    arm = np.array([0.024, 0.026, 0.028])
    variant = Variant("double-triangle", (("long_arm", 0.08),))
    np.testing.assert_allclose(vertical(fs.ideal(variant.mechanism_at({"short_arm": arm})).mapping), arm / 0.08, rtol=1e-9)
    stepped = vertical(fs.ideal(variant.mechanism_at({"short_arm": 0.026 + 1e-20j})).mapping)
    assert np.imag(stepped) / 1e-20 == pytest.approx(1.0 / 0.08, rel=1e-9)


def test_studies_vary_parameters_and_addresses_together():
    study = loads_study(STUDY)
    found = piece(study, 0, 4)
    assert not found.failures
    for values, responses in zip(found.variables, found.responses, strict=True):
        alone = measure_all(study.mechanism_for(values), tuple(study.columns.values()))
        np.testing.assert_allclose(responses, [float(value) for value in alone], rtol=1e-12)


def test_addresses_are_written_on_top_of_parameters():
    study = loads_study(STUDY)
    values = np.array([[0.025, 0.9, 1.01], [0.027, 1.1, 0.99]])
    for row in values:
        alone = study.mechanism_for(row)
        size = alone.bodies["platform"].solids["plate"].size
        assert size[0] == 340.64498e-3 * row[2]
        assert size[2] == 18.96433e-3 * row[1]
        assert alone.units["vertical"].links["front"].at[0] == 0.08
        batch = study.mechanism_for(values).bodies["platform"].solids["plate"].size
        assert size[0] in batch[0]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ('arm = { parameter = "shrt_arm", from = "1 mm", to = "2 mm" }', "Use short_arm"),
        ('arm = { parameter = "short_arm", address = "mass", from = "1 mm", to = "2 mm" }', "both an address and a parameter"),
        ('arm = { parameter = "plate.side", from = "1 mm", to = "2 mm" }', "Use plate_side"),
        ('arm = { parameter = "short_arm", from = "1 kg", to = "2 kg" }', "must be a length"),
        ('arm = { parameter = ["short_arm", "vertical_turn"], from = "1 mm", to = "2 mm" }', "different quantities"),
        (NECK + 'b = { address = "parts.neck.thickness", from = "1 mm", to = "2 mm" }', "and so does variable b"),
        (NECK + 'b = { parameter = "neck_thickness", from = "-1 %", to = "1 %" }', "already set by a"),
    ],
)
def test_bad_parameters_of_variables_are_told(line, told):
    text = STUDY.partition("\narm = ")[0] + "\n" + line
    with pytest.raises(DesignError, match=told):
        loads_study(text)


def test_bad_parameters_of_cases_are_told_all_at_once():
    text = STUDY.replace('parameters.long_arm = "80 mm"', 'parameters.long_arm = 80\nparameters.plate_sid = "1 mm"')
    with pytest.raises(DesignError) as error:
        loads_study(text)
    assert "long_arm: unit missing (got 80)" in str(error.value)
    assert "Use plate_side" in str(error.value)
    with pytest.raises(DesignError, match="must be a length"):
        fs.case("double-triangle", {"long_arm": "80 kg"})
    with pytest.raises(DesignError, match="finite number"):
        fs.case("double-triangle", {"long_arm": np.inf})


def test_many_designs_are_drawn_from_parameters():
    """The engine's frequencies are those of the lumped model."""
    study = loads_study(STUDY.replace('responses.mass = "mass"', 'responses.f = "frequency.platform.1"'))
    values = study.sample(0, 1)
    names = tuple(each.name for each in study.variables)
    family = plan_family(drawn_family(lambda columns: apply_columns(study.design, study.variables, columns), names, values[0]))
    found = platform_modes(family, values).frequencies
    np.testing.assert_allclose(engine_of(study).answers(values)[0], found[:, :1], rtol=1e-9)
    np.testing.assert_allclose(found[0], fs.modes(fs.lumped(study.mechanism_for(values[0]))).frequencies[:6], rtol=1e-7)
