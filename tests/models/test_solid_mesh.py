"""Meshes of components: no folded elements, few of them, and what straightening costs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("ngsolve", reason="the solid model needs flexstage[solid]")

import ngsolve

from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.parts.body import Body
from flexstage.solid.fea.geometry.cad import cad
from flexstage.solid.fea.meshing.fineness import Fineness
from flexstage.solid.fea.meshing.mesh import PieceMesh, mesh_component
from flexstage.solid.fea.meshing.straighten import jacobians, straighten
from flexstage.solid.fea.solver.component import Component, components
from flexstage.solid.fea.solver.field import field, rigid, stiffness
from flexstage.solid.fea.solver.skin import surface_owners
from flexstage.spatial.frame import identity
from tests.models.solids import solver

STAGE = double_triangle()


def alone(part: str) -> Component:
    """A hinge of the shipped stage between the ground and a rigid body."""
    link = Link(("ground", "platform"), part, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))
    stage = Mechanism("hinge", STAGE.materials, {part: STAGE.parts[part]}, {"platform": Body(mass=1.0)}, {"hinge": link})
    return components(stage)[0]


def compliance(component: Component, mesh: PieceMesh, order: int) -> np.ndarray:
    """Compliance (6, 6) of the second end face, rigid, against the first, about the middle."""
    moving = component.interfaces[0].joint.name
    space = field(mesh, [moving, *(joint.name for joint in component.fixed)], order)
    form = stiffness(space)
    motion = rigid(space, identity(), faces=moving)
    total = motion - solver(space, form)(_times(form, motion))
    return np.linalg.inv(total.T @ _times(form, total))


def _times(form: ngsolve.BilinearForm, columns: np.ndarray) -> np.ndarray:
    x, y = form.mat.CreateRowVector(), form.mat.CreateColVector()
    result = np.empty_like(columns)
    for number in range(columns.shape[1]):
        x.FV().NumPy()[:] = columns[:, number]
        y.data = form.mat * x
        result[:, number] = y.FV().NumPy()
    return result


@pytest.fixture(scope="module")
def lever() -> tuple[Component, PieceMesh]:
    """The heaviest component of the shipped stage: 19 pieces, a notch 50 times as wide as it is thick."""
    component = next(part for part in components(STAGE) if part.name == "B4/tip")
    return component, mesh_component(component, Fineness())


def test_the_element_behind_a_triangle_has_its_corners(lever: tuple[Component, PieceMesh]) -> None:
    mesh = lever[1].mesh
    corners = [{vertex.nr for vertex in element.vertices} for element in mesh.Elements(ngsolve.VOL)]
    behind = surface_owners(mesh, np.arange(mesh.ne))
    assert all({vertex.nr for vertex in face.vertices} <= corners[at] for face, at in zip(mesh.Elements(ngsolve.BND), behind, strict=True))


def test_no_element_is_folded_and_the_volume_is_that_drawn(lever: tuple[Component, PieceMesh]) -> None:
    component, mesh = lever
    lowest, highest = jacobians(mesh.mesh)
    assert np.all(lowest > 0.0)
    assert np.quantile(lowest / highest, 0.01) > 0.05
    volume = ngsolve.Integrate(ngsolve.CoefficientFunction(1.0), mesh.mesh)
    assert volume == pytest.approx(cad(component).shape.mass, rel=3e-5)


def test_few_elements_are_straightened(lever: tuple[Component, PieceMesh]) -> None:
    """Of the same mesh, all curved, at most one element in three hundred is folded; those that must stay curved are refused."""
    mesh = lever[1].mesh
    order = Fineness().order
    shape = mesh.deformation
    try:
        mesh.UnsetDeformation()
        mesh.Curve(order)
        lowest, _ = jacobians(mesh)
        folded = lowest <= 0.0
        assert np.mean(folded) < 3.3e-3
        assert (straighten(mesh, folded) is not None) == bool(np.any(folded))
    finally:
        if shape is not None:
            mesh.Curve(1)
            mesh.SetDeformation(shape)


def test_the_lever_needs_few_elements(lever: tuple[Component, PieceMesh]) -> None:
    """Walls around a hinge's end are meshed as the walls they are: 32 000 elements before."""
    assert lever[1].mesh.ne < 14_000


@pytest.mark.parametrize(("part", "most"), [("pole_neck", 1300), ("foot_notch", 1300)])
def test_elements_of_order_two_bend_a_hinge_with_arcs_within_a_hundredth(part: str, most: int) -> None:
    """The inside of a round neck is graded from the middle outwards: filled from its surface alone it was 2.7 % too stiff, of as many.

    Elements of notches take one order more: without it they are 8 % too stiff.
    """
    component = alone(part)
    mesh = mesh_component(component, Fineness(order=2))
    second, third = (np.diag(compliance(component, mesh, order)) for order in (2, 3))
    assert np.max(np.abs(second / third - 1.0)) < 0.01
    assert mesh.mesh.ne < most


@pytest.mark.parametrize("part", [*(pytest.param(part, marks=pytest.mark.full) for part in ("foot_notch", "pole_neck")), "neck"])
def test_bending_is_within_one_percent_of_a_higher_order(part: str) -> None:
    """Order three against order four; torsion of the straight neck, of few elements, within 1.5 %."""
    component = alone(part)
    third, fourth = (np.diag(compliance(component, mesh_component(component, Fineness(order=order)), order)) for order in (3, 4))
    np.testing.assert_allclose(third[[0, 1, 2, 4, 5]], fourth[[0, 1, 2, 4, 5]], rtol=1e-2)
    np.testing.assert_allclose(third[3], fourth[3], rtol=1.5e-2)
    assert np.all(third < fourth)


def test_a_neck_too_thin_to_follow_is_named_at_once() -> None:
    notch = replace(STAGE.parts["lever_notch"], thickness=1e-6)
    link = Link(("ground", "platform"), "notch", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))
    stage = Mechanism("hinge", STAGE.materials, {"notch": notch}, {"platform": Body(mass=1.0)}, {"hinge": link})
    with pytest.raises(DesignError, match=r"hinge: its thickness of 0\.001 mm is too small to mesh over 50\.3 x"):
        mesh_component(components(stage)[0], Fineness())
