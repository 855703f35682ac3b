"""Lumped model against Exudyn, an independent multibody code: the same stage, assembled, linearised and solved there.

The numbers are made at test time by the pinned version of Exudyn; `exudyn_model` says what is shared and what is not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("exudyn", reason="Exudyn has no wheels for this interpreter")

import flexstage as fs
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import CASES
from flexstage.mechanism.assembly.expand import expand
from flexstage.models.linear.static import static_gain
from flexstage.parts.body import Inertia, Payload
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import Freedom
from flexstage.spatial.frame import COMPONENTS
from tests.elsewhere.exudyn_model import System, frequencies, matrices, stroked, system

ROUNDING = 1e-14
CANCELLED = {"pointing-stage": 1e-13}
"""Where stiffnesses cancel: the hub of a cartwheel turns as softly as its leaves bend, on arms along which they stretch."""


def _loaded() -> fs.Mechanism:
    load = Payload("platform", mass=3.0, at=(0.04, -0.02, 0.15), inertia=Inertia(xx=0.01, yy=0.02, zz=0.015, xy=0.002, xz=-0.001))
    return replace(double_triangle(), payloads={"sample": load})


def _changed() -> fs.Mechanism:
    return replace(double_triangle(), overrides={"B2/front.thickness": 1.2e-3, "B5/pivot.at": (0.08, 0.003, -0.061)})


def _jointed() -> fs.Mechanism:
    stage = double_triangle()
    return replace(stage, parts=dict(stage.parts) | {"foot_notch": Joint((Freedom.RZ,))})


FREE: dict[str, Callable[[], fs.Mechanism]] = {name: found.build for name, found in CASES.items() if name != "telescope-mount"}
"""The bodies of a telescope mount are not all: its struts have modes of their own."""

FREE |= {"payload": _loaded, "changed copies": _changed}
STAGES = FREE | {"ideal joints": _jointed}


def _both(name: str) -> tuple[fs.LinearModel, System]:
    stage = STAGES[name]()
    return fs.lumped(stage), system(stage, expand(stage))


@pytest.mark.parametrize("name", STAGES)
def test_frequencies(name: str) -> None:
    """All of them; what is found is the rounding of Exudyn's eigensolve, eigh(K, M): 3e-11 of the lowest of the double triangle's 114."""
    model, peer = _both(name)
    found, ours = frequencies(peer), fs.modes(model).frequencies
    assert len(found) == len(ours)
    np.testing.assert_allclose(ours, found, rtol=1e-8)


@pytest.mark.parametrize("name", FREE)
def test_matrices_agree_entry_by_entry(name: str) -> None:
    model, peer = _both(name)
    for found, ours in zip(matrices(peer), (model.inertia_matrix, model.stiffness_matrix), strict=True):
        scale = np.sqrt(np.diag(ours))
        assert np.max(np.abs(ours - found) / scale / scale[:, None]) < CANCELLED.get(name, ROUNDING)


@pytest.mark.parametrize("actuator", ["B1", "B4"])
def test_gain_of_a_stroke_is_the_slope_of_the_nonlinear_equilibrium(actuator: str) -> None:
    """Central difference over +-0.1 mm, itself off by the cubic term: 4e-7 of the gain (4e-9 at 0.01 mm, found for B1)."""
    model, peer = _both("double-triangle")
    gain = static_gain(model, tuple(f"platform.{name}" for name in COMPONENTS), (actuator,)).values[:, 0]
    forth, back = (stroked(peer, f"{actuator}/pzt", stroke) for stroke in (1e-4, -1e-4))
    np.testing.assert_allclose((forth - back) / 2e-4, gain, rtol=0.0, atol=1e-6 * np.max(np.abs(gain)))
