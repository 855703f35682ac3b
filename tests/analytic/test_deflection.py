"""Dead load: against stiffness times displacement done by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.linear_statics.deflection import deflection
from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, double_triangle

GRAVITY = 9.80665


def test_weight_of_the_mapped_platform() -> None:
    """SM-REF-A, mapped: z = -m g / K_z, nothing else."""
    stage = double_triangle(SM_REF_A)
    model = fs.mapped(stage)
    sag = deflection(stage, model).total
    expected = -model.inertia_matrix[2, 2] * GRAVITY / model.stiffness_matrix[2, 2]
    np.testing.assert_allclose(sag, [0, 0, expected, 0, 0, 0], atol=1e-15)


def test_payload_adds_its_weight_and_moment() -> None:
    stage = replace(double_triangle(SM_REF_B), payloads={"wafer": fs.Payload("platform", 2.0, (0.05, 0.0, 0.2))})
    model = fs.lumped(stage)
    wrench = np.array([0.0, 0.0, -2.0 * GRAVITY, 0.0, 2.0 * GRAVITY * 0.05, 0.0])
    found = deflection(stage, model).by_cause
    column = found.values[:, found.columns.index("payload wafer")]
    np.testing.assert_allclose(column, fs.statics(model).compliance.values @ wrench, rtol=1e-9, atol=1e-15)
    empty = replace(stage, payloads={})
    own = deflection(empty, fs.lumped(empty)).by_cause.values[:, 0]
    np.testing.assert_allclose(found.values[:, 0], own, rtol=1e-9, atol=1e-15)


def test_gravity_may_point_anywhere() -> None:
    stage = double_triangle(SM_REF_A)
    for axis in range(3):
        gravity = tuple(GRAVITY * (index == axis) for index in range(3))
        model = fs.mapped(stage)
        sag = deflection(replace(stage, gravity=gravity), model).total
        assert sag[axis] == pytest.approx(model.inertia_matrix[0, 0] * GRAVITY / model.stiffness_matrix[axis, axis])
