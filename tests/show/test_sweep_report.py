"""Reports of sweeps: complete where designs fail, limits contradict or variables interact; nothing is drawn of nothing."""

import numpy as np
import pytest

from flexstage.base.storage.document import plain
from flexstage.studies.sweeps.effects import effects
from flexstage.studies.sweeps.execution.store import Results, columns_of
from flexstage.studies.sweeps.file import loads_study
from flexstage.studies.sweeps.result import Sweep
from flexstage.studies.sweeps.show.report import sweep_report
from flexstage.studies.sweeps.show.tables import study_tables

STUDY = """
format = "flexstage study 1"
case = "parallelogram"
responses.f = "frequency.1"
limits.mass = "at most 0.2 kg"
limits."stiffness.x" = "at least 20 N/um"
sweep.sampling = "{sampling}"
[variables]
leaf = {{ address = "parts.leaf.thickness", from = "0.8 mm", to = "1.2 mm", levels = 4 }}
young = {{ address = "materials.aluminium.young", from = "-10 %", to = "+10 %", levels = 4 }}
"""


def swept(responses, failures=None, sampling="grid"):
    study = loads_study(STUDY.format(sampling=sampling))
    values = study.sample(0, 16)
    return study, Results(np.arange(16), values, responses(study, values), failures or {}, *columns_of(study), 16, {}, "")


def told(study, results):
    tables = study_tables(Sweep(study, results, effects(results, study.plan)))
    return "\n".join(str(line) for table in tables if table for line in (*table.texts(), *table.notes))


def page_of(study, results):
    return sweep_report(Sweep(study, results, effects(results, study.plan)))


def mass_and_stiffness(mass, stiffness):
    def responses(_, values):
        frequency = 1e6 * values[:, 0] * values[:, 1] ** 2
        return np.column_stack([frequency, np.broadcast_to(mass(values), 16), np.broadcast_to(stiffness(values), 16)])

    return responses


@pytest.mark.parametrize("sampling", ["grid", "sobol"])
def test_where_all_designs_fail_reasons_are_told(sampling):
    nothing = swept(lambda *_: np.full((16, 3), np.nan), {row: f"leaf at {row}.5 mm is too thin" for row in range(16)}, sampling)
    tables, page = told(*nothing), page_of(*nothing)
    assert tables.count("is too thin") == 1
    assert page.count("<svg") == 1  # the stage
    assert "No design meets" in tables


def test_what_a_sweep_tells_is_what_its_designs_have():
    """Told response by response under its unit, with the failed designs."""
    study, results = swept(mass_and_stiffness(lambda _: 0.1, lambda values: 1e7 * values[:, 1]), {3: "too thin"})
    told = plain(Sweep(study, results, effects(results, study.plan)))
    assert told["designs"] == {"planned": 16, "computed": 16, "failed": 1}
    assert told["failures"] == [{"design": 3, "reason": "too thin"}]
    assert [(each["name"], each["from"], each["to"], each["unit"]) for each in told["variables"]] == [
        ("leaf", 0.8e-3, 1.2e-3, "m"),
        ("young", 0.9, 1.1, "1"),
    ]
    for each, values in zip(told["responses"], results.responses.T, strict=True):
        expected = (values.min(), values.mean(), values.std(), values.max())
        assert [each[key] for key in ("min_value", "mean", "deviation", "max_value")] == pytest.approx(expected)
        assert each["unit"] == study.columns[each["name"]].quantity.si
    assert told["responses"][2]["first_order"] == pytest.approx({"leaf": 0.0, "young": 1.0})


def test_limits_that_contradict_are_named():
    heavy = swept(
        mass_and_stiffness(lambda values: np.where(values[:, 0] > 1e-3, 0.3, 0.1), lambda values: np.where(values[:, 0] > 1e-3, 3e7, 1e7))
    )
    assert "no design meets both mass at most 0.2 kg and stiffness.x at least 20 N/um" in told(*heavy)
    never = swept(mass_and_stiffness(lambda _: 0.3, lambda _: 3e7))
    assert "No design meets mass at most 0.2 kg. Widen" in told(*never)
    some = swept(mass_and_stiffness(lambda _: 0.1, lambda values: np.where(values[:, 0] > 1e-3, 3e7, 1e7)))
    assert "50 % of the designs meet all limits." in told(*some)


def test_a_pair_that_interacts_is_drawn():
    paired = swept(mass_and_stiffness(lambda _: 0.1, lambda values: 2e10 * (values[:, 0] - 1e-3) * (values[:, 1] - 1.0) + 3e7))
    tables, page = told(*paired), page_of(*paired)
    assert "leaf, young" in tables
    assert page.count("<svg") == 4
    assert "leaf [mm]" in page
    assert "young [%]" in page
