"""By one side of what is symmetric, everything is as by the whole, to rounding: the whole is meshed by that side and its mirror images."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import ngsolve
import numpy as np
import pytest
from scipy.linalg import eigh

from flexstage.base.number import Array
from flexstage.cases.registry import case
from flexstage.parts.body import Block, Cylinder
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.profile import Straight
from flexstage.solid.fea.geometry.cad import cad
from flexstage.solid.fea.geometry.mirror import Mirrors
from flexstage.solid.fea.geometry.piece import Medium, Piece
from flexstage.solid.fea.hinges.hinge import hinge_compliance, hinge_mesh
from flexstage.solid.fea.hinges.specimen import END, START
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.fea.meshing.mesh import PieceMesh, mesh_component
from flexstage.solid.fea.solver.component import Component, Interface, Joint, components, groups
from flexstage.solid.fea.solver.field import apply_form, field, rigid, stiffness
from flexstage.solid.fea.solver.reduce import reduce_mesh
from flexstage.solid.fea.solver.superelement import Superelement
from flexstage.spatial.frame import Frame, identity
from tests.models.solids import solver
from tests.unfolded import unfold

PLAN = Reduction(Fineness(neck=2.0, order=2), modes=7)
STEEL = Medium(young=200e9, poisson=0.3, density=7750.0)
TURNED = np.diag([-1.0, -1.0, 1.0])


def at(x: float, y: float = 0.0, z: float = 0.0) -> Frame:
    return Frame(np.eye(3), np.array([x, y, z]))


def lever(shift: float = 0.0) -> Component:
    """Two blocks of one body, one left and one right of a third, a neck between it and the ground and one to another body.

    The upper neck may stand aside of the plane across z.
    """
    necks = [
        Piece(name, Neck("m", 4e-3, Straight(6e-3), 4e-3), STEEL, at(x, z=z), None)
        for name, x, z in (("in", -3e-3, 0.0), ("out", 23e-3, shift))
    ]
    sizes = {"middle": (20e-3, 10e-3, 12e-3), "left": (8e-3, 4e-3, 9e-3), "right": (8e-3, 4e-3, 9e-3)}
    places = {"middle": at(10e-3), "left": at(9e-3, 7e-3), "right": at(9e-3, -7e-3)}
    blocks = [Piece(f"lever.{name}", Block("m", sizes[name]), STEEL, places[name], "lever") for name in sizes]
    return Component(
        name="lever",
        pieces=(*blocks, *necks),
        interfaces=(Interface(Joint("out:arm", "out", "arm", at(26e-3, z=shift), 16e-6), yields=True),),
        fixed=(Joint("in:ground", "in", "ground", Frame(TURNED, np.array([-6e-3, 0.0, 0.0])), 16e-6),),
        bodies={"lever": np.array([10e-3, 0.0, 0.0])},
        place=identity(),
    )


def unfounded(part: Component) -> Component:
    """A component whose foot is held by a body that moves, not by the ground."""
    (foot,) = part.fixed
    return replace(part, interfaces=(*part.interfaces, Interface(foot, yields=True)), fixed=())


@pytest.mark.parametrize(
    ("part", "axes"), [(lever(), (1, 2)), (lever(1e-3), (1,)), (unfounded(lever()), (1, 2))], ids=["quarter", "half", "unfounded"]
)
def test_a_side_is_the_whole(part: Component, axes: tuple[int, ...]) -> None:
    """Stiffness and inertia group by group, resultants, mean twists, frequencies, and the surface with its motion and stress."""
    side = mesh_component(part, PLAN.fineness, by_symmetry=True)
    side.mesh.Curve(1)  # images of flat faces
    assert side.mirrors.axes == axes
    mine, whole = (reduce_mesh(part, mesh, PLAN) for mesh in (side, unfold(side)))
    assert (mine.freedoms, mine.elements, mine.size) == (whole.freedoms, whole.elements, whole.size)
    ours, theirs = (_statics(each) for each in (mine, whole))
    for name, law in theirs.items():
        np.testing.assert_allclose(ours[name], law, rtol=0, atol=1e-8 * np.abs(law).max(), err_msg=name)
    np.testing.assert_allclose(_eigenvalues(mine), _eigenvalues(whole), rtol=1e-6)
    np.testing.assert_array_equal(np.bincount(mine.skin.owner), np.bincount(whole.skin.owner))
    for here, there in zip(_by_place(mine), _by_place(whole), strict=True):
        np.testing.assert_allclose(here, there, rtol=0, atol=1e-5 * np.abs(there).max())


@pytest.mark.parametrize("diameter", [20e-3, 100e-3])
def test_round_bodies_weigh_no_less_by_symmetry(diameter: float) -> None:
    """A bar and a plate, at order two: arcs that are divided less finely than the circle would take a quarter of a percent."""
    middle = Cylinder("m", diameter, 20e-3, along=(1.0, 0.0, 0.0))
    part = lever()
    block, _, _, *necks = part.pieces
    part = replace(part, pieces=(replace(block, form=middle), *necks))
    side = mesh_component(part, Fineness(order=2), by_symmetry=True)
    assert side.mirrors.copies * ngsolve.Integrate(1, side.mesh) == pytest.approx(cad(part).shape.mass, rel=1.5e-3)


@pytest.mark.parametrize(("part", "axes"), [(Neck("m", 1e-3, Straight(3e-3), 1.5e-3), (1, 2)), (Leaf("m", 8e-3, 5e-4, 3e-3), (2,))])
def test_a_side_of_a_hinge_is_the_whole(part: Neck | Leaf, axes: tuple[int, ...]) -> None:
    """Its 6x6, by the energies of one outer face moved and the other held."""
    metal = Material(young=STEEL.young, poisson=STEEL.poisson, density=STEEL.density)
    side = hinge_mesh(part, order=2)
    side.Curve(1)
    none = np.zeros(side.ne, dtype=int)
    cut = PieceMesh(side, (STEEL,), (START, END), none, none > 0, Mirrors(axes), (none,) * (2 ** len(axes) - 1))
    space = field(unfold(cut), [START, END], 2)
    form, moved = stiffness(space), rigid(space, identity(), faces=END)
    law = stiffness(space, assemble=False)
    motion = moved - solver(space, form)(apply_form(law, moved))
    expected = motion.T @ apply_form(law, motion)
    scale = 1.0 / np.sqrt(np.diag(expected))
    found = np.linalg.inv(hinge_compliance(part, metal, Accuracy(error=0.0, orders=(2, 2), meshes=1)).whole)
    np.testing.assert_allclose(found * np.outer(scale, scale), expected * np.outer(scale, scale), rtol=0, atol=1e-8)


def _eigenvalues(element: Superelement) -> Array:
    """With faces held."""
    size = element.boundary_coordinates
    return eigh(_total(element.stiffness)[size:, size:], _total(element.inertia)[size:, size:], eigvals_only=True)


def test_every_body_has_its_own_mass_though_others_are_assembled_with_it() -> None:
    part = next(each for each in components(case("xy-stage")) if len(each.bodies) > 1)
    plan = Reduction(Fineness(neck=6.0, block=3.0, order=2), modes=0)
    meshed = mesh_component(part, plan.fineness)
    volumes = 1e-9 * np.array(ngsolve.Integrate(ngsolve.CoefficientFunction(1.0), meshed.mesh, element_wise=True, order=8))
    found = reduce_mesh(part, meshed, plan).body_inertia
    for name, pieces in groups(part).items():
        if name in part.bodies:
            mass = part.pieces[pieces[0]].medium.density * float(np.sum(volumes[np.isin(meshed.owner, pieces)]))
            np.testing.assert_allclose(np.diag(found[name])[:3], mass, rtol=1e-9)


def _total(laws: Mapping[str, Array]) -> Array:
    return np.sum(list(laws.values()), axis=0)


def _face_motions(element: Superelement) -> Array:
    """Coordinates (n, k) of the static motions of the faces: what they move does not depend on the choice of coordinates within."""
    size, whole = element.boundary_coordinates, _total(element.stiffness)
    return np.vstack([np.eye(size), -np.linalg.solve(whole[size:, size:], whole[size:, :size])])


def _statics(element: Superelement) -> dict[str, Array]:
    """All that a superelement tells of the faces' static motions, and of those under the loads within, faces held."""
    size, whole = element.boundary_coordinates, _total(element.stiffness)
    loads = np.vstack(list(element.bodies.values())).T
    response = np.vstack([np.zeros((size, loads.shape[1])), np.linalg.solve(whole[size:, size:], loads[size:])])
    motions = {"": _face_motions(element), ", loaded": response}
    found = {f"own {name}": law for name, law in element.body_inertia.items()}
    for kind, motion in motions.items():
        found[f"carried{kind}"] = motion.T @ element.carried
        for name in ("stiffness", "inertia"):
            found |= {f"{name} {group}{kind}": motion.T @ law @ motion for group, law in getattr(element, name).items()}
        for name in ("bodies", "resultants"):
            found |= {f"{name} {group}{kind}": rows @ motion for group, rows in getattr(element, name).items()}
    return found


def _by_place(element: Superelement) -> tuple[Array, ...]:
    """Vertices of the surface in the order of their coordinates, their motion and stress under the faces' static motions."""
    skin, motion = element.skin, _face_motions(element)
    order = np.lexsort(np.round(skin.vertices.T, 9) + 0.0)
    return skin.vertices[order], (skin.motion @ motion)[order], (skin.stress @ motion)[order]
