"""The whole lumped model against a second, plain assembly of the same description (`direct_stiffness`), on random stages, to 1e-12."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings

from flexstage.models.lumped import lumped
from tests.elsewhere.direct_stiffness import AXES, direct
from tests.laws.strategies import mechanisms, platforms, rosettes

TOLERANCE = 1e-12

fewer = settings(max_examples=settings().max_examples // 8)
"""Stages are drawn anew here: these tests are seldom in the process that holds those of the laws, and drawing is what takes the time."""


def agrees(mechanism):
    """Every matrix of the model, entries measured by the sums of magnitudes they come from."""
    model, plain = lumped(mechanism), direct(mechanism)
    own = [plain.coordinates.index(name) for name in model.coordinates]
    assert sorted(own) == list(range(len(plain.coordinates) - 6))
    stiff, heavy = (np.sqrt(np.diag(natural)) for natural in (plain.natural_stiffness, plain.natural_inertia))
    near(model.stiffness_matrix, plain.stiffness[np.ix_(own, own)], stiff[own, None] * stiff[own])
    near(model.inertia_matrix, plain.inertia[np.ix_(own, own)], heavy[own, None] * heavy[own])
    near(model.rigid, plain.rigid[own], 1.0)
    near(model.base_inertia, (plain.inertia @ plain.rigid)[own], heavy[own, None] * (heavy @ np.abs(plain.rigid)))
    _inputs_agree(model, plain, own, stiff)
    _outputs_agree(model, plain, own, stiff)


def near(found, expected, measure):
    assert found.shape == expected.shape
    assert np.all(np.abs(found - expected) <= TOLERANCE * measure)


def _inputs_agree(model, plain, own, stiff):
    drives = list(plain.strokes)
    names = [name.rpartition("/")[0] or name for name in drives]
    assert [channel.name for channel in model.inputs if channel.unit == "m"] == names
    for name, drive in zip(names, drives, strict=True):
        column = model.input_matrix[:, model.input_index((name,))[0]]
        near(column, plain.strokes[drive][own], stiff[own] * np.sqrt(plain.own[drive][0, 0]))
    forces = model.input_index(tuple(f"platform.{name}" for name in ("fx", "fy", "fz", "mx", "my", "mz")))
    expected = np.zeros((len(plain.coordinates), 6))
    expected[[plain.coordinates.index(f"platform.{axis}") for axis in AXES], range(6)] = 1.0
    near(model.input_matrix[:, forces], expected[own], 1.0)


def _outputs_agree(model, plain, own, stiff):
    for name in model.coordinates:
        near(model.output[model.output_index((name,))[0]], np.eye(len(own))[model.coordinates.index(name)], 1.0)
    for name, row in plain.gauges.items():
        near(model.output[model.output_index((name,))[0]], row[own], 1.0)
    for name, rows in plain.resultants.items():
        picked = model.output_index(tuple(f"{name}.{force}" for force in ("fx", "fy", "fz", "mx", "my", "mz")))
        root = np.sqrt(np.diag(plain.own[name]))
        near(model.output[picked], rows[:, own], root[:, None] * stiff[own])
        for number, drive in enumerate(plain.strokes):
            expected = -plain.own[name][:, 0] if drive == name else np.zeros(6)
            near(model.feedthrough[picked, number], expected, root * root[0])


@settings(max_examples=settings().max_examples // 4)
@given(mechanisms.fresh())
def test_graphs_with_closed_loops(mechanism):
    agrees(mechanism)


@fewer
@given(platforms.fresh())
def test_platforms_on_units_in_any_pose(drawn):
    agrees(drawn[0])


@fewer
@given(rosettes.fresh())
def test_units_around_a_circle(mechanism):
    agrees(mechanism)
