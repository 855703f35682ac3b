"""Table 1 of the paper: what it says of itself, and that it disagrees with Eq. 2."""

from __future__ import annotations

import numpy as np

import flexstage as fs
from flexstage.cases.double_triangle import SM_REF_B, double_triangle
from tests.paper.test_disagreements import ANGLES, AXIAL, DISPLACEMENT, LATERAL, LOAD, STIFFNESS
from tools.validation.row import Row, Section, Tolerance, relative

_DERIVED = "derived from Table 1"


def sections() -> list[Section]:
    """The sections on Table 1."""
    return [_agreement(), _fit(), _hypothesis()]


def _agreement() -> Section:
    free = 1e-6 * fs.statics(fs.lumped(double_triangle(SM_REF_B))).free.along(ANGLES)
    rows = [
        Row(f"stiffness at {angle:.0f} deg", "paper Table 1 (FEA)", f"{value:.2f}", float(ours), "N/um", relative(0.1), recorded=True)
        for angle, value, ours in zip(np.rad2deg(ANGLES), STIFFNESS, free, strict=True)
    ]
    factor = 1.5 * (AXIAL + LATERAL) / STIFFNESS
    rows += [
        Row("least factor of Eq. 2 over Table 1", _DERIVED, "6.44", float(factor.min()), "1"),
        Row("largest factor", _DERIVED, "7.03", float(factor.max()), "1", Tolerance(0.01)),
        Row("100 N / displacement - stiffness, largest", _DERIVED, "0.0034", float(np.abs(LOAD / DISPLACEMENT - STIFFNESS).max()), "N/um"),
    ]
    text = (
        "Ours is what a push test on the platform's centre of mass measures, free to tilt: less than Eq. 2, because the inner units "
        "push 25 mm below it. Eq. 2 and Table 1 contradict each other, and no model comes near Table 1: "
        "[recorded](../disagreements.md), never fitted."
    )
    return Section("Table 1 against Equation 2", text, tuple(rows))


def _fit() -> Section:
    columns = np.stack([np.ones_like(ANGLES), np.cos(2 * ANGLES), np.sin(2 * ANGLES)], axis=1)
    mean, cosine, sine = (float(value) for value in np.linalg.lstsq(columns, DISPLACEMENT, rcond=None)[0])
    rms = float(np.sqrt(np.mean((columns @ [mean, cosine, sine] - DISPLACEMENT) ** 2)))
    swing = float(np.hypot(cosine, sine))
    rows = (
        Row("mean A", _DERIVED, "41.89", mean, "um"),
        Row("cosine B", _DERIVED, "0.10", cosine, "um"),
        Row("sine C", _DERIVED, "3.74", sine, "um"),
        Row("rms of the fit", _DERIVED, "0.13", rms, "um"),
        Row("stiffest displacement", _DERIVED, "38.2", mean - swing, "um", Tolerance(0.1)),
        Row("softest displacement", _DERIVED, "45.6", mean + swing, "um"),
        Row("its direction", _DERIVED, "44", 0.5 * float(np.rad2deg(np.arctan2(sine, cosine))), "deg"),
        Row("isotropic part", _DERIVED, "2.387", LOAD / mean, "N/um"),
    )
    text = (
        "A linear stage obeys d = A + B cos 2t + C sin 2t; three equal units 120 degrees apart have B = C = 0. A fit of the table itself:"
    )
    return Section("The tensor that Table 1 fits", text, rows)


def _hypothesis() -> Section:
    neck = 2.0 / (1.0 / AXIAL - 1.0 / 17.0)
    unit = 1.0 / (1.0 / 1.7 + 2.0 / neck)
    rows = (
        Row("axial stiffness of one neck", "derived from K_a,h and 17 N/um", "52.27", neck, "N/um"),
        Row("unit with a stack of 1.7 N/um", _DERIVED, "1.5962", unit, "N/um", Tolerance(2e-4)),
        Row("motion under 100 N", _DERIVED, "41.74", LOAD / (1.5 * (unit + LATERAL)), "um"),
    )
    text = "A stack ten times too soft in that FEA run would give its level, not its direction. Circumstantial."
    return Section("One hypothesis", text, rows)
