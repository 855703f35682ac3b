"""Laws of the engine in studies: it gives what dense matrices give, to the bit the same however designs are cut, and no design is lost."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.assessment.judge import measure_all
from flexstage.analysis.assessment.requirements import measure
from flexstage.base.number import Table
from flexstage.cases.double_triangle import double_triangle
from flexstage.mechanism.addresses.address import get, quantity_of
from flexstage.models.batch.engine import Status, platform_modes
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.engine import Engine, engine_of
from flexstage.studies.sweeps.execution.evaluate import piece
from flexstage.studies.sweeps.plan import Plan, Sampling
from flexstage.studies.sweeps.variable import Variable, apply
from tests.conftest import examples

STAGE = double_triangle()
MOVED = (
    ("parts.neck.thickness",),
    ("parts.lever_notch.thickness", "parts.foot_notch.thickness"),
    ("bodies.platform.solids.plate.size.z",),
    ("materials.steel.density",),
    ("placements.B1-B3.pattern.radius", "placements.B4-B6.pattern.radius"),
    ("horizontal/front.thickness",),
    ("B2/front.width",),
    ("placements.B4-B6.pattern.turn",),
)
NONE = Engine(Table({}))
"""With it, everything is read by dense matrices."""


def study(moved, *, designs=8, seed=0, stage=STAGE, keys=("frequency.platform.1", "frequency.platform.6")):
    """Variables by 10 % around what the stage states, each moving one or several numbers."""
    variables = tuple(Variable(each[0], each, quantity_of(stage, each[0]), 0.9, 1.1, relative=True) for each in moved)
    asked = Table({key: measure(stage, key, key) for key in keys})
    return Study("law", stage, variables, asked, (), Plan(Sampling.MONTE_CARLO, len(moved), count=designs, seed=seed))


@examples(2)
@given(st.lists(st.sampled_from(MOVED), min_size=1, max_size=4, unique=True), st.integers(0, 99))
def test_frequencies_are_those_of_dense_matrices(moved, seed):
    asked = study(moved, seed=seed)
    found = piece(asked, 0, 2)
    for values, responses in zip(found.variables, found.responses, strict=True):
        alone = measure_all(apply(STAGE, asked.variables, values), tuple(asked.columns.values()))
        np.testing.assert_allclose(responses, [float(value) for value in alone], rtol=1e-6)


@pytest.fixture(scope="module")
def many():
    """A study of designs enough to be fitted, and its engine."""
    asked = study(MOVED[:2], designs=50_000, keys=("frequency.platform.1", "mass", "frequency.platform.4"))
    return asked, engine_of(asked)


def test_fitting_pays_for_many_designs_only(many):
    asked, engine = many
    assert engine.plan.surface is not None
    assert engine_of(replace(asked, plan=replace(asked.plan, count=1000))).plan.surface is None


def test_a_design_is_the_same_to_the_bit_in_every_piece(many):
    asked, engine = many
    whole = piece(asked, 100, 140, engine)
    again = engine_of(asked)  # another process makes its own
    parts = [piece(asked, *ends, again) for ends in ((100, 101), (101, 117), (117, 140))]
    np.testing.assert_array_equal(np.concatenate([part.responses for part in parts]), whole.responses)
    dense = piece(asked, 100, 103, NONE)
    np.testing.assert_allclose(whole.responses[:3], dense.responses, rtol=1e-6)
    np.testing.assert_allclose(whole.responses[:3, 1], dense.responses[:, 1], rtol=1e-12)


EVERY = ("stroke.z", "safety", "loss.B4", "crosstalk", "stiffness.x", "frequency.2", "mass", "drift.z", "load", "gauge.range", "corner")


def test_a_batch_is_a_loop():
    """Every measure of designs together, and of each alone: no design depends on its neighbours."""
    asked = study(MOVED[:4], keys=EVERY)
    whole = piece(asked, 0, 4)
    assert not whole.failures
    for number in range(4):
        np.testing.assert_allclose(piece(asked, number, number + 1).responses[0], whole.responses[number], rtol=1e-12)


def test_designs_within_the_ranges_are_all_fitted(many):
    engine = many[1]
    corners = np.array([[0.9, 1.1], [1.1, 0.9]])
    assert engine.plan.surface.holds(corners).all()
    assert (platform_modes(engine.plan, corners).status == Status.ITERATED).all()


def test_designs_that_fail_keep_place_and_reason():
    asked = study(MOVED[:1], keys=("frequency.platform.1", "frequency.platform.6"))
    wrong = replace(asked, variables=(replace(asked.variables[0], low=-1.0),))
    found = piece(wrong, 0, 8)
    negative = np.flatnonzero(found.variables[:, 0] <= 0.0)
    assert 0 < len(negative) < 8
    assert sorted(found.failures) == negative.tolist()
    assert all("parts.neck.thickness" in reason for reason in found.failures.values())
    assert np.all(np.isfinite(np.delete(found.responses, negative, axis=0)))


def test_fewer_modes_than_six_are_numbered_as_one_design_numbers_them():
    """The limit lies below the platform's highest modes: the lower ones have numbers, the sixth is told missing."""
    stage = replace(STAGE, max_mode_frequency=150.0)
    low, high = study(MOVED[:1], stage=stage, keys=("frequency.platform.1",)), study(MOVED[:1], stage=stage)
    found = piece(low, 0, 2)
    assert not found.failures
    np.testing.assert_allclose(found.responses, piece(study(MOVED[:1]), 0, 2).responses[:, :1], rtol=1e-6)
    assert all("the stage has only 4 such modes" in reason for reason in piece(high, 0, 2).failures.values())


def test_numbers_that_depart_go_before_shared_ones_in_either_order():
    moved = (("B2/front.thickness",), ("parts.neck.thickness",))
    for order in (moved, moved[::-1]):
        asked = study(order, keys=("frequency.platform.2",))
        found = piece(asked, 0, 2)
        for values, response in zip(found.variables, found.responses, strict=True):
            stage = apply(STAGE, asked.variables, values)
            share = dict(zip((each.name for each in asked.variables), values, strict=True))["B2/front.thickness"]
            assert get(stage, "B2/front.thickness") == pytest.approx(share * get(STAGE, "B2/front.thickness"))
            assert response[0] == pytest.approx(float(measure_all(stage, tuple(asked.columns.values()))[0]), rel=1e-6)


def test_a_study_that_describes_designs_in_its_own_way_is_read_by_it():
    class Heavier(Study):
        def mechanism_for(self, values):
            return apply(STAGE, self.variables, 2.0 * values)

    asked = study((("materials.steel.density",),))
    own = Heavier(**{name: getattr(asked, name) for name in asked.__dataclass_fields__})
    assert engine_of(asked).modes
    assert not engine_of(own).modes
    assert np.all(piece(own, 0, 2).responses < 0.8 * piece(asked, 0, 2).responses)


def test_dense_batches_choose_modes_design_by_design():
    """Beside a design whose platform is light, another's modes are still its own."""
    variable = Variable(
        "plate", ("bodies.platform.solids.plate.size.z",), quantity_of(STAGE, "bodies.platform.mass"), 0.3, 3.0, relative=True
    )
    values = np.array([[0.3], [1.0], [3.0]])
    asked = tuple(measure(STAGE, f"frequency.platform.{number}", "here") for number in (1, 6))
    together = measure_all(apply(STAGE, (variable,), values), asked)
    for row, value in enumerate(values):
        alone = measure_all(apply(STAGE, (variable,), value), asked)
        assert [float(each[row]) for each in together] == pytest.approx([float(each) for each in alone], rel=1e-9)
