"""Tables: every result has one, batches say so, and renderers agree."""

from __future__ import annotations

import html
from dataclasses import dataclass, fields, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.complete import Analysis, Model, analyse
from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.dynamics.response import response
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.linear_statics.units import units
from flexstage.analysis.loaded.misalign import Misalignments
from flexstage.analysis.loaded.stability import Stability
from flexstage.analysis.workspace.buckling import Buckling, Ends
from flexstage.analysis.workspace.stops import single_strokes
from flexstage.analysis.workspace.stroke import stroke_limits, utilisation
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.labelled import Matrix
from flexstage.base.record import INNER, Along, Graded, Heading, Layout, UnitIn, walk
from flexstage.base.units.quantity import ANGLE, FORCE, FREQUENCY, RATIO, SHARE, Bound
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import set_value
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.show.displaced import misalignment_tables
from flexstage.show.display import to_typography
from flexstage.show.page import BlockRow, Folded
from flexstage.show.render import fold, to_html, to_rich
from flexstage.show.sections.dynamics import mode_section, response_section
from flexstage.show.table import Column, Mark, Table, make_table, record_table, result_table, row_table
from flexstage.show.tables.description import value_tables
from flexstage.show.tables.lost_motion import budget_table, loss_table
from flexstage.show.tables.modes import mode_table
from flexstage.show.tables.overview import axis_table, summary_tables
from flexstage.show.tables.response import response_table
from flexstage.show.tables.statics import principal_table, stiffness_table
from flexstage.show.tables.workspace import corner_table
from flexstage.show.viewer.data import still_data
from flexstage.spatial.frame import COMPONENTS
from tests.show.stages import HOSTILE, NAMES, analysed, hostile, reported, seldom
from tests.show.widths import broken, printed

TITLES = {
    "loaded": "Weight, payloads and forces change",
    "second_order": "Over the strokes",
    "kinematics": "Actuator mapping R_a",
    "statics": "Stiffness at platform",
    "mass": "Mass at platform, whole stage",
    "deflection": "Deflection of platform under permanent load",
    "units": "Isolated units",
    "lost_motion": "Lost motion",
    "modes": "Modes",
    "response": "Frequency responses",
    "transmissibility": "ground.z",
    "workspace": "Single-axis strokes",
    "buckling": "Buckling",
    "stress": "Stress in the hinges",
    "drift": "Thermal drift",
    "error_budget": "Error budget, command by ideal mapping",
    "verdicts": "Requirements",
}
REACH = {
    "command": "All combinations of",
    "limits": "limited by",
    "single_axis": "Single-axis strokes",
    "corrected": "Single-axis strokes with corrected lost motion",
    "worst_case": "Simultaneous strokes",
    "polytope": "Reachable extents",
    "drive": "Drive",
    "map_error": "Error of the linear map",
    "gauges": "Gauge ranges",
    "resolution": "Pose resolution of the gauges",
    "clearance": "Clearance",
    "platform_lines": "Forces of the platform",
    "stack_lines": "Stacks pushing against the stage",
    "stress": "Stress in the hinges",
    "buckling": "Buckling",
    "loads": "Axial forces of the stacks",
}
NOT_SHOWN = {"mechanism", "model", "linear", "missing", "reasons"}


def test_every_result_is_presented() -> None:
    """A result that is added to the analysis fails here until the report shows it."""
    # reach: of stages that forces move, see test_voice_coil; freedoms: of stages with fewer than six; ends: warnings of stages with paths
    assert {field.name for field in fields(Analysis)} - NOT_SHOWN - {"force_workspace", "drive_force", "freedoms", "ends"} == set(TITLES)
    assert {field.name for field in fields(Workspace)} - NOT_SHOWN == set(REACH)
    page = reported("double-triangle")
    assert [title for title in (*TITLES.values(), *REACH.values()) if title not in page] == []
    assert "Stiffness by DOF at platform" in reported("parallelogram")


def test_a_batch_shows_its_first_design_and_says_so() -> None:
    stage = set_value(double_triangle(), "lever_notch.thickness", np.array([1.0e-3, 1.2e-3]))
    kinematics, model = ideal(stage), lumped(stage)
    single = lumped(double_triangle())
    for batch, one in (
        (stiffness_table(statics(model)), stiffness_table(statics(single))),
        (mode_table(modes(model)), mode_table(modes(single))),
    ):
        # Of the modes those of the platform: repeated local ones may be told apart otherwise.
        assert batch.texts()[:7] == one.texts()[:7]
        assert any("first of 2 designs" in note for note in batch.notes)
    alone = lost_motion(ideal(double_triangle()), single)
    assert loss_table(lost_motion(kinematics, model)).texts() == loss_table(alone).texts()
    assert principal_table(statics(model)).texts() == principal_table(statics(single)).texts()


@pytest.mark.parametrize("name", [seldom(name) for name in NAMES])
def test_budgets_add_up_in_print(name: str) -> None:
    lost = analysed(name).lost_motion
    if lost is None:
        return
    table = budget_table(lost)
    for column, actuator in enumerate(lost.loss.rows, start=1):
        shares = [float(row[column].text.rstrip(" %") or 0.0) for row in table.rows]
        assert abs(sum(shares[:-1]) - shares[-1]) <= 2e-3 * max(1.0, abs(shares[-1])) * len(shares), actuator


def _values(name: str) -> list[list[str]]:
    return [[cell.text for cell in row] for table in value_tables(case(name)) for row in table.rows]


@pytest.mark.parametrize("name", NAMES)
def test_every_value_of_a_description_is_listed_once(name: str) -> None:
    names = [row[0] for row in _values(name)]
    assert len(names) == len(set(names)) > 0


def test_values_are_listed_with_their_unit_and_where_they_come_from() -> None:
    listed = {row[0]: row[1:] for row in _values("double-triangle")}
    assert listed["neck.thickness"] == ["1.54", "mm", "stated", "= neck_thickness; paper 2.2"]
    assert listed["steel.young"][2] == "assumed"
    assert {"N/mm", "ohm"} <= {row[2] for row in _values("z-stage")}


@pytest.mark.parametrize("name", [seldom(name) for name in NAMES])
def test_renderers_show_the_same_cells(name: str) -> None:
    loss = analysed(name).modes
    if loss is None:
        return
    table = mode_table(loss)
    assert table.provenance == loss.provenance
    assert Mark.PASS in {row[-1].mark for row in table.rows}
    page = html.unescape(to_html(table))
    assert all(to_typography(cell.text) in page for row in table.rows for cell in row)
    (shown,) = (each for each in to_rich(table, 1000) if hasattr(each, "row_count"))
    assert shown.row_count == len(table.rows)


@pytest.mark.parametrize("width", [40, 60, 80, 1000])
def test_tables_too_wide_go_on_below_with_their_rows_named_anew(width: int) -> None:
    table = make_table(
        "Errors",
        ["along", *(Column(head, "nm") for head in ("lost motion", "quantisation", "crosstalk", "root sum square"))],
        [(axis, *("-0.00012345",) * 4) for axis in "xyz"],
        notes=["Largest errors over all combinations of x +-50 um, y +-50 um."],
    )
    lines = printed(table, width)
    assert broken(table, width) == []
    assert sum(line.count("-0.00012345") for line in lines) == 12
    assert [line.split()[0] for line in lines if "-0.0" in line] == list("xyz") * {40: 2, 60: 2, 80: 1, 1000: 1}[width]


@given(st.text("ab1 ./", max_size=60), st.integers(2, 80))
def test_folded_lines_have_all_of_the_text(text: str, width: int) -> None:
    lines = fold(text, width)
    assert "".join("".join(lines).split()) == "".join(text.split())
    assert all(fold(line, width) == [line] for line in lines)


def test_html_escapes_what_users_write() -> None:
    shown = "".join(to_html(table) for table in value_tables(hostile()))
    assert HOSTILE not in shown
    assert "<script" not in shown
    assert "&lt;script&gt;" in shown


def test_ideal_reading_has_no_elastic_tables() -> None:
    page = reported("double-triangle", Model.IDEAL)
    assert "Stiffness at platform" not in page
    assert "the ideal model has no elasticity" in page


def test_groups_hold_tables() -> None:
    # A page's blocks nest; tables in them must not be lost on the way.
    from flexstage.show.page import Head, Section, page

    table = Table("inner", (), ())
    nested = Folded("outer", (BlockRow((BlockRow((table,)),)),))
    assert "inner" in page(Head("t", "k", ()), [Section("s", (nested,))])


@pytest.mark.parametrize(("name", "moved"), [("parallelogram", ["y"]), ("bridge", ["y"]), ("tip-tilt", [*COMPONENTS])])
def test_rounding_noise_of_the_linear_map_is_shown_as_nothing(name: str, moved: list[str]) -> None:
    """A planar stage errs in its plane; what finite kinematics leave of the other axes is rounding, 1e-21 m and less."""
    found = analysed(name).workspace.map_error
    table = result_table(found)
    rows = {row[0]: row[1:] for row in table.texts()[1:]}
    assert [axis for axis in rows if rows[axis] != ["0", *"-" * len(found.actuators)]] == moved
    assert any("0: within the rounding error" in text for text in table.notes) == (len(moved) < 6)


def test_strokes_of_the_summary_are_those_with_corrected_lost_motion() -> None:
    analysis = analysed("double-triangle")
    found, plain = analysis.workspace.corrected, analysis.workspace.single_axis
    rows = {row[0]: row[1] for row in axis_table(analysis).texts()[1:]}
    for name, stroke, ideal_stroke in zip(found.coordinates, found.symmetric, plain.symmetric, strict=True):
        assert stroke != pytest.approx(ideal_stroke, rel=5e-3)
        assert rows[name] == f"+-{1e6 * stroke:.4g} {'urad' if name.startswith('r') else 'um'}"


def test_only_a_stated_opening_is_spoken_of() -> None:
    for name in ("double-triangle", "parallelogram"):
        reach = analysed(name).workspace
        stated = case(name).opening is not None
        assert any("clear opening" in note for note in result_table(reach.clearance).notes) == stated
    assert {case(name).opening is None for name in ("double-triangle", "parallelogram")} == {True, False}


STANDING = Stability(np.array(9.0), np.array(9.0), np.zeros(0), np.array(9.0), (), "")


@pytest.mark.parametrize(
    ("factor", "mark"),
    [(0.999, Mark.FAIL), (np.nan, Mark.FAIL), (1.0, Mark.WARN), (1.499, Mark.WARN), (1.5, Mark.PLAIN), (20.0, Mark.PLAIN)],
)
def test_what_would_yield_is_marked_and_what_nearly_would(factor: float, mark: Mark) -> None:
    """Below 1 a hinge yields and a column buckles; below 1.5 there is no margin to speak of."""
    column = Buckling(("B1/rod",), np.array([factor * 100.0]), np.array([100.0]), np.array([0.01]), (Ends.GUIDED,), "", STANDING)
    assert result_table(column, "factor").rows[0][1].mark is mark


@dataclass(frozen=True, eq=False)
class _Pressed:
    """Forces of bars."""

    bars: tuple[str, ...]
    axial: Annotated[np.ndarray, FORCE, Along("bars"), Heading("axial force")]
    used: Annotated[np.ndarray, SHARE, Bound(high=1.0), Along("bars")]
    kind: Annotated[tuple[Ends, ...], Along("bars")]


def test_fields_say_how_they_are_shown() -> None:
    bars = _Pressed(("a", "b"), np.array([2.5, 1e-12]), np.array([1.5, 1e-17]), (Ends.PINNED, Ends.FREE))
    table = row_table("Bars", bars)
    assert table.texts() == [["bar", "axial force [N]", "used", "kind"], ["a", "2.5", "150 %", "pinned"], ["b", "0", "0 %", "free"]]
    assert [row[2].mark for row in table.rows] == [Mark.FAIL, Mark.PLAIN]
    assert row_table("Bars", bars, "kind").texts()[0] == ["bar", "kind"]


@dataclass(frozen=True)
class _End:
    """A value at a place."""

    value: float


@dataclass(frozen=True, eq=False)
class _Passed:
    """Errors by axis after passes."""

    TABLE: ClassVar[Layout] = Layout("Passes", "rms last.value", head="path, axis", notes=("In {self.axes}.", "Gain {self.gain:g}."))
    axes: tuple[str, ...]
    units: Annotated[tuple[str, ...], INNER]
    rms: Annotated[np.ndarray, Along("axes"), UnitIn("units")]
    last: Annotated[_End, ANGLE, Heading("turn")]
    gain: float


def test_results_by_name_with_arrays_are_a_row_an_entry_each() -> None:
    """Names of both stand before the row, what has one value a result is repeated, and notes that differ say of which result they are."""
    one = _Passed(("x", "rz"), ("m", "rad"), np.array([2e-9, 3e-6]), _End(np.pi), 0.5)
    table = result_table({"raster": one, "sine": replace(one, last=_End(0.0), gain=0.6)})
    assert table is not None
    assert table.texts() == [
        ["path", "axis", "rms", "turn [deg]"],
        ["raster", "x", "2 nm", "180"],
        ["raster", "rz", "3 urad", "180"],
        ["sine", "x", "2 nm", "0"],
        ["sine", "rz", "3 urad", "0"],
    ]
    assert table.notes == ("In ('x', 'rz').", "raster: Gain 0.5.", "sine: Gain 0.6.")
    assert row_table("Both", {("a", "b"): one.last, ("a", "c"): one.last}, "value", head="of, at").texts()[2] == ["a", "c", "3.1416"]


def test_records_are_rows_and_what_is_absent_has_a_dash() -> None:
    rows = row_table("Units", units(case("parallelogram")), "axial", "series", "gain", head="unit")
    assert rows.texts()[0] == ["unit", "axial stiffness [N/um]", "in actuator coordinates [N/um]", "gain"]
    one = Buckling(("a",), np.ones(1), np.ones(1), np.ones(1), (Ends.FREE,), "", Stability(*[np.array(2.0)] * 4, (), ""))
    assert record_table("Stage", one, "min_factor", "weakest").texts()[1:] == [["min factor", "2", ""], ["weakest", "a", ""]]
    assert record_table("Stage", replace(one, links=()), "weakest").texts()[1:] == [["weakest", "-", ""]]
    unknown = _Pressed(("a", "b"), np.array([1.0, np.nan]), np.array([np.nan, 0.5]), (Ends.FREE, Ends.FREE))
    assert [row[1:3] for row in row_table("Bars", unknown).texts()[1:]] == [["1", "-"], ["-", "50 %"]]


@dataclass(frozen=True)
class _Seen:
    """A measured value and its interval."""

    value: Annotated[float, FREQUENCY, Heading("seen", absent="not found")]
    ends: Annotated[tuple[float, float], FREQUENCY, Heading("interval")]


@dataclass(frozen=True)
class _Figure:
    """A number with a unit of its own, and what was seen of it."""

    TABLE: ClassVar[Layout] = Layout("Figures of {self.group}", "name value off other seen.value seen.ends doubled")

    group: str
    name: str
    unit: str
    value: Annotated[float | None, UnitIn("unit")]
    off: Annotated[float | None, RATIO, Heading(unit="%", mark=Graded(0.02, 0.1))]
    seen: _Seen | None = None
    other: float | None = None

    @property
    def doubled(self) -> Annotated[int, INNER]:
        """For tables alone."""
        return 2 * len(self.name)


def test_a_layout_reaches_into_results_with_units_grades_and_words_for_what_is_absent() -> None:
    rows = (
        _Figure("a", "k", "N/m", 2e7, 0.01, _Seen(118.0, (117.95, 118.05))),
        _Figure("a", "f", "Hz", None, -0.05),
        _Figure("a", "m", "kg", 1.5, 0.2),
    )
    table = result_table(rows, notes=["said"])
    assert table is not None
    assert (table.title, table.notes) == ("Figures of a", ("said",))
    assert table.texts() == [
        ["name", "value", "off", "seen [Hz]", "interval [Hz]", "doubled"],  # no row has the other value
        ["k", "20 N/um", "1 %", "118", "117.950 to 118.050", "2"],
        ["f", "-", "-5 %", "not found", "-", "2"],
        ["m", "1.5 kg", "20 %", "not found", "-", "2"],
    ]
    assert [row[2].mark for row in table.rows] == [Mark.PASS, Mark.WARN, Mark.FAIL]
    assert "doubled" not in walk(rows[0])
    assert result_table(()) is None


def test_responses_that_are_only_rounding_are_0():
    """A leaf guide that is pushed does not rise: gains of 1e-20 had peaks, at a frequency that rounding chose."""
    table = response_table(response(lumped(case("parallelogram")), ("platform.y", "platform.x", "platform.z"), ("B",)))
    rows = {row[0]: row[1:] for row in table.texts()[1:]}
    assert rows["platform.z, B"] == ["0", "0", "-", "-"]
    assert "0" not in rows["platform.y, B"]
    assert any("0: rounding noise" in note for note in table.notes)


def test_texts_on_modes_are_true_for_light_platforms():
    """In the bridge, a platform mode has 5 % of its kinetic energy in the platform, and a local mode 69 %."""
    found = analyse(case("bridge"), whole=False)
    shares = [found.modes.mode(place).platform_share for place in (*found.modes.platform, *found.modes.local)]
    assert min(shares[: len(found.modes.platform)]) < 0.1
    assert max(shares[len(found.modes.platform) :]) > 0.5
    notes = [note for each in summary_tables(found, explained=True) if isinstance(each, Table) for note in each.notes]
    bare = replace(found, modes=replace(found.modes, platform=()))
    texts = [*notes, mode_section(bare, still_data(found.mechanism)).blocks[0].text]
    assert not [text for text in texts if "at rest" in text or "kinetic" in text]


def test_the_limit_of_a_stroke_is_that_of_the_listed_stroke():
    """Lost motion changes which actuator limits the stroke along y."""
    found = analyse(double_triangle(), whole=False)
    limits = dict(zip(found.workspace.corrected.coordinates, found.workspace.corrected.limiting, strict=True))
    assert {row[0]: row[2] for row in axis_table(found).texts()[1:]} == limits


def test_a_force_driven_stage_has_no_response_per_stroke():
    (picture, *_) = response_section(analysed("voice-coil-stage", Model.LUMPED)).blocks
    assert "per stroke" not in picture.caption


def test_an_unknown_critical_misalignment_is_stable_only_as_far_as_computed():
    """Without a critical misalignment, the computed path may end before the largest one."""
    one, none = (Matrix(np.full((1, 1), value), ("a",), ("rx",), (("rad",),)) for value in (0.01, np.nan))
    table = misalignment_tables(Misalignments(none, one, 1e-3, one, one, None))[0]
    assert table.notes == ("Each instance is misaligned individually, in its own frame. -: stable up to the values below.",)


def test_an_unknown_safety_factor_names_the_hinges_without_a_limit():
    """Not the hinge of least known factor."""
    found = analyse(double_triangle(), whole=False)
    stress = found.workspace.stress
    limit = np.where(np.array(stress.links) == "B1/back", np.nan, stress.allowed)
    less = replace(found, stress=None, workspace=replace(found.workspace, stress=replace(stress, limit=limit)))
    (*_, text) = summary_tables(less, explained=False)
    assert text.startswith(
        "Smallest safety factor at the worst corner of all strokes from zero voltage: unknown, because B1/back has no stress limit.\n"
    )


def test_the_used_share_of_compression_is_said_to_include_the_preload():
    """The largest force of the stack is without preload, its used share with it."""
    bearing = analysed("parallelogram", Model.LUMPED).workspace.bearing
    stack = case("parallelogram").parts["stack"]
    assert bearing.usage == pytest.approx((bearing.max_force + stack.preload) / stack.maximum_load)
    assert "the share used in compression includes it." in " ".join(result_table(bearing).notes)


def test_a_single_axis_stroke_is_within_reach():
    """The ratio of required to available stroke is 1, but for rounding."""
    stage = case("stewart")
    kinematics = ideal(stage)
    strokes = single_strokes(stage, kinematics)
    for name, value in zip(strokes.coordinates, strokes.symmetric.tolist(), strict=True):
        used = utilisation(kinematics.mapping, stroke_limits(stage), {name: value})
        assert used.reachable
        assert "within reach; all ranges can be scaled by 1." in corner_table(used).notes[0]
