"""Pictures of tests: what is drawn is what was measured and fitted; peaks survive thinning; names reach the page as they are."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.cases.double_triangle import double_triangle
from flexstage.experiment.comparison import FurtherMode, compare
from flexstage.experiment.example import one_mode_record
from flexstage.experiment.identification.cluster import stabilisation
from flexstage.experiment.identification.identify import identify
from flexstage.experiment.identification.lscf import Poles
from flexstage.experiment.pipeline import Identification, identification
from flexstage.experiment.records.record import Channel, Responses, Role, in_memory
from flexstage.experiment.show.comparison_figures import compare_figure
from flexstage.experiment.show.figures import (
    coherence_figure,
    estimator_figure,
    focus,
    response_matrix_figure,
    stabilisation_figure,
)
from flexstage.experiment.show.report import identify_report
from flexstage.experiment.show.sections import coherence_section, response_data_section, stabilisation_section
from flexstage.experiment.show.tables import identified_table, measured_shape_table
from flexstage.experiment.spectral.cross_spectra import example_spectra
from flexstage.experiment.spectral.transfer import h1
from flexstage.models.lumped import lumped
from flexstage.show.figures.export import to_svg
from flexstage.show.table import result_table
from tests.models.stage_records import stage_record

STAGE = double_triangle()


@pytest.fixture(scope="module")
def seen() -> Identification:
    return identification((stage_record(STAGE),))


def of(axes: Any, colour: str) -> Any:
    """The one line of a colour."""
    (line,) = (each for each in axes.lines if each.get_color() == colour)
    return line


def test_the_fit_runs_through_the_data(seen: Identification) -> None:
    figure = response_matrix_figure(seen.found)
    assert len(figure.axes) == 2 * 36
    low, high = focus(seen.found)
    for row in range(6):
        axes = figure.axes[12 * row + row]  # S1 over B1, S2 over B2 ...
        data, fit = of(axes, "#9aa5b1"), of(axes, "#0077bb")
        assert axes.get_xlim() == (low, high)
        known = np.interp(fit.get_xdata(), data.get_xdata(), np.log(data.get_ydata()))
        strong = np.log(fit.get_ydata()) > np.max(np.log(fit.get_ydata())) - 3.0
        assert np.median(np.abs(known - np.log(fit.get_ydata()))[strong]) < 0.2


def test_peaks_survive_thinning(seen: Identification) -> None:
    figure = response_matrix_figure(seen.found)
    data = seen.found.responses
    inside = (data.frequencies >= focus(seen.found)[0]) & (data.frequencies <= focus(seen.found)[1])
    drawn = of(figure.axes[0], "#9aa5b1").get_ydata()
    assert np.max(drawn) == np.max(np.abs(data.values[inside, 0, 0]))


def test_coherence_is_the_one_of_the_spectra(seen: Identification) -> None:
    figure = coherence_figure(seen.found, seen.multiple)
    assert len(figure.axes) == 6
    assert seen.spectra is not None
    for axes in figure.axes:
        assert len(axes.lines) == 7
        multiple, *ordinary = (np.asarray(line.get_ydata()) for line in reversed(axes.lines))
        assert 0.0 <= np.min(multiple) <= np.max(multiple) <= 1.0
        # No input alone explains more than all together, apart from averaging over the lines of a point.
        assert np.all(np.max(ordinary, axis=0) <= multiple + 1e-9)
        # Inputs are independent: their shares add up to the whole, each with the share that noise has by chance.
        assert np.mean(np.sum(ordinary, axis=0)) - np.mean(multiple) == pytest.approx(6.0 / seen.spectra.independent, abs=0.1)


def test_captions_tell_that_only_six_outputs_are_drawn() -> None:
    one = one_mode_record(seconds=16.0)
    noise = 0.05 * np.random.default_rng(0).standard_normal((one.length, 8)) * np.std(one.values[:, 1])
    channels = (one.channels[0], *(replace(one.channels[1], name=f"y{number}") for number in range(8)))
    many = identification((in_memory(channels, one.rate, np.hstack([one.values[:, :1], one.values[:, 1:] + noise])),))
    assert many.spectra is not None
    assert len(coherence_figure(many.found, many.multiple, many.spectra.frequencies).axes) == 6
    assert many.found.responses.frequencies[1] < many.spectra.frequencies[1]  # a second search has longer segments
    assert "Segments of the multiple coherence: 0.6667 s" in str(coherence_section(many))
    for drawn, count in ((coherence_section(many), 1), (response_data_section(many), 2)):
        texts = re.findall(r"at most six|at most 6", str(drawn), re.IGNORECASE)
        assert len(texts) == count


def test_a_pole_is_compared_with_the_last_one_found_even_if_orders_between_have_none() -> None:
    found = [Poles(order, np.array([-0.1 + 10j])[: order != 2], np.ones((int(order != 2), 1))) for order in (1, 2, 3)]
    diagram, _ = stabilisation(tuple(found), 0.1)
    assert diagram.stable.tolist() == [0, 3]
    assert "a pole of a lower order" in str(stabilisation_section(identify(one_mode_record(seconds=16.0))))


def test_every_mode_stands_in_the_stabilisation_diagram(seen: Identification) -> None:
    axes = stabilisation_figure(seen.found).axes[0]
    marked = [float(line.get_xdata()[0]) for line in axes.lines if line.get_linestyle() == ":"]
    assert marked == pytest.approx(seen.found.frequencies.tolist())
    poles = np.concatenate([line.get_xdata() for line in axes.lines if line.get_linestyle() == "None" and line.get_marker() != "."])
    for frequency in seen.found.frequencies:
        assert np.min(np.abs(poles / frequency - 1.0)) < 0.01


def test_estimators_are_those_of_the_spectra(seen: Identification) -> None:
    assert seen.spectra is not None
    assert seen.second is not None
    first = h1(seen.spectra)
    low, high = focus(seen.found)
    inside = (first.frequencies >= low) & (first.frequencies <= high)
    figure = estimator_figure(first, [seen.second], (low, high))
    for row, axes in enumerate(figure.axes):
        column = int(np.argmax(np.sum(np.abs(first.values[inside, row]) ** 2, axis=0)))
        assert axes.get_title() == f"S{row + 1} / B{column + 1}"
        for line, each in zip(axes.lines, (first, seen.second), strict=True):
            assert np.max(line.get_ydata()) == np.max(np.abs(each.values[inside, row, column]))


def test_bars_stand_as_high_as_the_frequencies(seen: Identification) -> None:
    model = lumped(STAGE)
    found = compare(STAGE, seen.found, FeaModes(platform_modes(STAGE, model), model, 3, (0.01,) * 6))
    upper, lower = compare_figure(found).axes
    heights = [bar.get_height() for bar in upper.patches]
    assert heights[:6] == pytest.approx([row.theory for row in found.modes])
    assert heights[6:12] == pytest.approx([row.fea for row in found.modes])
    assert heights[12:18] == pytest.approx([row.experiment.frequency for row in found.modes if row.experiment])
    bands = [bar.get_height() for bar in lower.patches]
    assert bands == pytest.approx([200.0 * (row.uncertainty or 0.0) for row in found.modes])


def test_a_comparison_without_any_partner_is_drawn(seen: Identification) -> None:
    silent = in_memory(stage_record(STAGE).channels, 1024.0, np.random.default_rng(1).standard_normal((8192, 12)))
    found = compare(STAGE, identification((silent,)).found)
    assert all(row.experiment is None for row in found.modes)
    ET.fromstring(to_svg(compare_figure(found), "none", "no mode"))  # noqa: S314  our own text
    modes, repeated = result_table(found.modes), result_table(found.repeated)
    assert modes is not None
    assert modes.texts()[1][3] == "not found"
    assert repeated is not None
    assert repeated.texts()[1][:2] == ["1, 2", "0"]


def test_the_table_says_what_was_found(seen: Identification) -> None:
    rows = identified_table(seen.found).texts()[1:]
    assert [float(row[1]) for row in rows] == pytest.approx(seen.found.frequencies.tolist(), rel=1e-5)
    assert "Modes 1 and 2 are closer than their half-widths: compare the subspace of their shapes." in identified_table(seen.found).notes
    shapes = measured_shape_table(seen.found).texts()[1:]
    assert np.array([[float(cell) for cell in row[1:]] for row in shapes]) == pytest.approx(seen.found.real_shapes, abs=1e-3)


def test_modes_without_a_partner_are_listed(seen: Identification) -> None:
    found = compare(STAGE, seen.found)
    assert result_table(found.further) is None
    assert found.modes[0].experiment is not None
    extra = replace(found, further=(FurtherMode(found.modes[0].experiment),))
    table = result_table(extra.further)
    assert table is not None
    assert table.texts()[1][0] == "1"


def test_names_are_escaped() -> None:
    random = np.random.default_rng(0)
    drive = random.standard_normal(4096)
    names = [Channel("<b>$u$", "V", Role.INPUT), Channel("a & b", "um", Role.OUTPUT)]
    page = identify_report(identification((in_memory(names, 128.0, np.stack([drive, random.standard_normal(4096)], axis=1)),)))
    assert "<b>$u$" not in page
    assert "&lt;b&gt;$u$" in page
    assert "a &amp; b" in page


def test_responses_of_an_analyser_are_reported() -> None:
    lines = np.linspace(1.0, 40.0, 400)
    natural, damping = 20.0, 0.02
    values = natural**2 / (natural**2 - lines**2 + 2j * damping * natural * lines)
    scatter = 0.01 * np.random.default_rng(3).standard_normal((2, 400))
    both = Responses(
        lines, (Channel("y", "um", Role.OUTPUT),), (Channel("u", "V", Role.INPUT),), (values + scatter[0] + 1j * scatter[1])[:, None, None]
    )
    seen = identification(both)
    assert seen.found.frequencies == pytest.approx([20.0], rel=1e-3)
    page = identify_report(seen)
    assert "<h2>Coherence</h2>" not in page
    assert "<h2>Responses</h2>" in page


def test_estimates_on_other_lines_are_drawn_on_their_own() -> None:
    first = h1(example_spectra())
    every_second = replace(first, frequencies=first.frequencies[::2], values=first.values[::2], coherence=None)
    (axes,) = estimator_figure(first, [every_second], (1.0, 8.0)).axes
    fine, coarse = (set(line.get_xdata()) for line in axes.lines)
    assert coarse < fine
