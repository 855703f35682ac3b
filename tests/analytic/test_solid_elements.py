"""The elements: patch test on an irregular mesh with two media, convergence at the expected order to a smooth solution."""

from __future__ import annotations

from dataclasses import replace

import ngsolve
import numpy as np
import pytest
from netgen import occ

from flexstage.parts.body import Block
from flexstage.solid.fea.geometry.piece import Medium, Piece
from flexstage.solid.fea.meshing.fineness import Fineness
from flexstage.solid.fea.meshing.mesh import PieceMesh, mesh_component
from flexstage.solid.fea.solver import skin
from flexstage.solid.fea.solver.component import Component, Joint
from flexstage.solid.fea.solver.field import apply_form, field, stiffness
from flexstage.spatial.frame import Frame, identity
from tests.models.solids import solver

SOFT, STIFF = Medium(young=100e9, poisson=0.15, density=1.0), Medium(young=200e9, poisson=0.3, density=1.0)
"""Alike in nu/E: pulled in series both contract alike sideways, so that uniform strain in each is the exact solution."""
STRESS = 1e9
TURNED = np.diag([-1.0, -1.0, 1.0])


def bar():
    """Two blocks of unlike media end to end along x, 10 and 6 mm long, held at both ends."""
    frames = [Frame(np.eye(3), np.array([x, 0.0, 0.0])) for x in (5e-3, 13e-3)]
    forms = [Block("m", (size, 4e-3, 3e-3)) for size in (10e-3, 6e-3)]
    pieces = tuple(
        Piece(f"block {number}", form, medium, frame)
        for number, (form, medium, frame) in enumerate(zip(forms, (SOFT, STIFF), frames, strict=True))
    )
    joints = (
        Joint("start", "block 0", "ground", Frame(TURNED, np.zeros(3)), 12e-6),
        Joint("end", "block 1", "ground", identity_at(16e-3), 12e-6),
    )
    return Component("bar", pieces, (), joints, {}, identity())


def identity_at(x):
    return Frame(np.eye(3), np.array([x, 0.0, 0.0]))


def pulled():
    """Exact displacement [m] over coordinates [mm] under a uniform stress along x: pulled at x = 16 mm, centred sideways."""
    contraction = -STRESS * SOFT.poisson / SOFT.young
    x, y, z = (1e-3 * coordinate for coordinate in (ngsolve.x, ngsolve.y, ngsolve.z))
    along = ngsolve.IfPos(x - 10e-3, 10e-3 / SOFT.young + (x - 10e-3) / STIFF.young, x / SOFT.young)
    return ngsolve.CoefficientFunction((STRESS * along, contraction * y, contraction * z))


def continued(space, given):
    """The displacement that is given on the held faces and has no forces anywhere else."""
    function = ngsolve.GridFunction(space.space)
    function.Set(given, definedon=space.meshed.mesh.Boundaries("start|end|held"))
    start = function.vec.FV().NumPy().copy()
    correction = solver(space, stiffness(space))(apply_form(stiffness(space, assemble=False), start[:, None]))[:, 0]
    function.vec.FV().NumPy()[:] = start - correction
    return function


@pytest.mark.parametrize("order", [1, 2, 3])
def test_patch_of_two_media(order):
    space = field(mesh_component(bar(), Fineness(neck=0.6, block=0.6, order=order)), ["start", "end"], order)
    found, exact = continued(space, pulled()), pulled()
    mesh = space.meshed.mesh
    points = mesh.MapToAllElements(ngsolve.IntegrationRule(ngsolve.TET, 4), ngsolve.VOL)
    assert mesh.ne > 100
    assert len(space.meshed.media) == 2
    size = np.max(np.abs(exact(points)))
    assert np.max(np.abs((found - exact)(points))) < 1e-10 * size
    gradient = 1e3 * ngsolve.Grad(found)
    stress = space.stress(0.5 * (gradient + gradient.trans))(points)
    expected = np.zeros(9)
    expected[0] = STRESS
    assert np.max(np.abs(stress - expected)) < 1e-10 * STRESS


RATE = 0.7
"""Of the smooth solution's growth, per mm."""


def smooth():
    """u = grad phi of a harmonic phi = exp(sqrt(2) k x) cos(k y) cos(k z): in equilibrium without forces, for any medium."""
    k, root = RATE, np.sqrt(2.0)
    (cy, sy), (cz, sz) = ((ngsolve.cos(k * c), ngsolve.sin(k * c)) for c in (ngsolve.y, ngsolve.z))
    growth = ngsolve.exp(root * k * ngsolve.x)
    return ngsolve.CoefficientFunction((root * growth * cy * cz, -growth * sy * cz, -growth * cy * sz))


def energy_error(mesh, order):
    """Energy norm of the error of the finite elements' solution, relative to the solution's."""
    space = field(PieceMesh(mesh, (STIFF,), ("held",), np.zeros(mesh.ne, dtype=int), np.zeros(mesh.ne, dtype=bool)), ["held"], order)
    exact = smooth()
    found = continued(space, exact)
    coordinates = (ngsolve.x, ngsolve.y, ngsolve.z)
    jacobian = ngsolve.CoefficientFunction(tuple(exact[i].Diff(c) for i in range(3) for c in coordinates), dims=(3, 3))
    true, missing = (0.5 * (each + each.trans) for each in (jacobian, ngsolve.Grad(found) - jacobian))
    energies = [ngsolve.Integrate(ngsolve.InnerProduct(space.stress(each), each), mesh, order=10) for each in (missing, true)]
    return float(np.sqrt(energies[0] / energies[1]))


@pytest.mark.parametrize("order", [1, 2, 3])
def test_energy_error_falls_with_the_order(order):
    """Halving all elements divides the error in the energy norm by 2^p, that of energies and compliances by 4^p."""
    box = occ.Box(occ.Pnt(0, 0, 0), occ.Pnt(1.0, 1.2, 0.9))
    box.mat("medium 0")
    for face in box.faces:
        face.name = "held"
    mesh = ngsolve.Mesh(occ.OCCGeometry(box).GenerateMesh(maxh=0.6, parallel_meshing=False))
    errors = []
    for _ in range(3):
        errors.append(energy_error(mesh, order))
        mesh.Refine()
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(rates, order, atol=0.25)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_behind_a_surface_are_those_of_the_field(order):
    """Of any function, in elements of two orders and between them."""
    mesh = mesh_component(bar(), Fineness(neck=0.6, block=0.6, order=order))
    finer = np.random.default_rng(order).random(mesh.mesh.ne) < 0.3
    space = field(replace(mesh, finer=finer), [], order)
    function = ngsolve.GridFunction(space.space.components[0])
    function.vec.FV().NumPy()[:] = np.random.default_rng(9).standard_normal(space.size // 3)
    elements = list(mesh.mesh.Elements(ngsolve.BND))
    corners = np.array([[vertex.nr for vertex in element.vertices] for element in elements])
    behind = np.array([mesh.mesh[element.faces[0]].elements[0].nr for element in elements])
    points = mesh.mesh.MapToAllElements(ngsolve.IntegrationRule(skin._WITHIN, [0.0, 0.0, 0.0]), ngsolve.BND)
    found = skin._gradient(space, corners, behind, points) @ np.array(function.vec.FV().NumPy())[:, None]
    expected = 1e3 * ngsolve.BoundaryFromVolumeCF(ngsolve.Grad(function))(points)
    np.testing.assert_allclose(found.reshape(-1, 3), expected, rtol=0, atol=1e-12 * np.abs(expected).max())
