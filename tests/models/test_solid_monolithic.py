"""Substructures against the same stage in one mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modes
from flexstage.cases.registry import case
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.static import static_gain
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.fea.solver.assemble import linear_model
from flexstage.solid.fea.solver.component import Component, Cut, components, groups
from flexstage.solid.fea.solver.superelement import Skin, Superelement
from flexstage.solid.results.read import model as solid
from flexstage.spatial.frame import COMPONENTS
from tests.models.monolithic import monolithic
from tests.models.small_solids import COARSE as SMALL
from tests.models.small_solids import propped
from tests.models.solids import COARSE, read

TWIST = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)


@pytest.fixture(scope="module")
def whole():
    stage, parts = read("parallelogram")
    return parts.model, monolithic(stage, replace(COARSE, modes=18))


@pytest.mark.full
def test_props_are_the_same_in_one_mesh():
    """Rods between rigid bodies have nothing to cut: the lowest modes agree to 1e-6, the others to the modes left out."""
    stage = propped(6e-3, 7e-3, 8e-3)
    parts = solid(stage, replace(SMALL, modes=6), cache=None)
    one = monolithic(stage, replace(SMALL, modes=18))
    np.testing.assert_allclose(modes(parts).frequencies[:4], modes(one).frequencies[:4], rtol=1e-6)
    np.testing.assert_allclose(modes(parts).frequencies[4:6], modes(one).frequencies[4:6], rtol=1e-4)


@pytest.mark.full
def test_modes_agree_and_the_cut_stiffens(whole):
    """Frequencies of the guide within 0.7 %, from two meshes of order two."""
    cut, one = (modes(model).frequencies[:6] for model in whole)
    np.testing.assert_allclose(cut, one, rtol=0.007)
    assert cut[0] == pytest.approx(one[0], rel=1e-3)


@pytest.mark.full
def test_gain_of_the_stroke_agrees(whole):
    """The stroke's static gain does not care where the stage was cut, to 1e-3."""
    cut, one = (static_gain(model, TWIST, model.strokes).values[0, 0] for model in whole)
    assert cut == pytest.approx(one, rel=1e-3)


@pytest.mark.full
def test_platform_modes_of_the_shipped_stage_agree():
    """All six within 0.5 %, from two meshes of order two."""
    stage = case("double-triangle")
    plan = Fineness(order=2)
    cut, one = solid(stage, Reduction(plan), cache=None), monolithic(stage, Reduction(plan, modes=18))
    first, second = (found.frequencies[list(found.platform[:6])] for found in (modes(cut), modes(one)))
    np.testing.assert_allclose(first, second, rtol=0.005)


def on_its_joints(component: Component) -> Superelement:
    """A superelement without inner coordinates whose interfaces stand on springs: for what does not depend on elements."""
    size = 6 * len(component.interfaces)
    names = groups(component)
    links = [piece for piece in component.pieces if piece.body is None]
    stacks = [piece.name for piece in links if isinstance(piece.form, Piezo)]
    none = np.zeros(0)
    return Superelement(
        interfaces=len(component.interfaces),
        warps=0,
        stiffness=dict.fromkeys(names, np.eye(size)),
        inertia=dict.fromkeys(names, np.zeros((size, size))),
        bodies=dict.fromkeys(component.bodies, np.zeros((6, size))),
        body_inertia=dict.fromkeys(component.bodies, np.eye(6)),
        resultants={piece.name: np.zeros((6, size)) for piece in links},
        strokes=dict.fromkeys(stacks, np.zeros(size)),
        free_strokes=dict.fromkeys(stacks, np.zeros(size)),
        rigid=np.zeros((size, 6)),
        carried=np.zeros((size, 6)),
        skin=Skin(*[none] * 5),
        freedoms=size,
        elements=1,
    )


def test_every_casing_couples_its_own_end_faces_and_no_others():
    """Six stacks with casings in one mesh: none of them resists the whole stage's rigid motion, or feels another stack's ends."""
    stage = case("double-triangle")
    (whole,) = components(stage, Cut.NONE)
    model = linear_model(stage, expand(stage), ((whole, on_its_joints(whole)),), "on its joints")
    casings = {name: item for name, item in model.stiffness.items() if name.endswith("(casing)")}
    assert len(casings) == 6
    for name, item in casings.items():
        felt = {model.coordinates[index].rpartition(".")[0].partition(":")[0] for index in np.flatnonzero(np.any(item.operator, axis=0))}
        assert felt == {name.removesuffix(" (casing)")}
        assert np.abs(item.operator @ model.rigid).max() < 1e-9, name
