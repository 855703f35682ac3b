"""A bar reduced to one interface against closed forms: statics whatever is kept, frequencies with few modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from flexstage.solid.fea.geometry.piece import Medium
from flexstage.solid.fea.meshing.bar import bar
from flexstage.solid.fea.meshing.fineness import WARPS, Fineness, Hold, Reduction
from flexstage.solid.fea.meshing.mesh import mesh_component
from flexstage.solid.fea.solver.component import with_yielding_ends
from flexstage.solid.fea.solver.reduce import reduce_mesh
from flexstage.solid.fea.solver.superelement import Superelement, hold_faces

AXIAL = 100e6
"""E A / L of the bar [N/m]."""
WAVE = np.sqrt(100e9 / 1000.0)
"""Speed of sound sqrt(E / rho) [m/s]."""
LENGTH = 0.1
MESH = mesh_component(bar(), Fineness(order=2))


def element(modes: int, hold: Hold = Hold.RIGID) -> Superelement:
    return reduce_mesh(bar(), MESH, Reduction(Fineness(order=2), modes=modes, hold=hold))


@pytest.mark.parametrize("modes", [0, 6])
def test_own_weight_along_the_bar(modes: int) -> None:
    """Spread over the mass, F moves the free end by F L / 2 E A and the mean by F L / 3 E A, without any mode kept too."""
    found = element(modes)
    mean = found.bodies["bar"][0]
    motion = np.linalg.solve(found.stiffness["bar"], mean)
    assert motion[0] * AXIAL == pytest.approx(1.0 / 2.0, rel=1e-6)
    assert mean @ motion * AXIAL == pytest.approx(1.0 / 3.0, rel=1e-6)


def test_frequencies_of_the_cantilever() -> None:
    """Along, c / 4 L; bending, that of Euler's beam (1.8751^2) less what shear and turning sections take at L = 10 h."""
    found = element(12)
    values, shapes = eigh(found.stiffness["bar"], found.inertia["bar"])
    frequencies = np.sqrt(values) / (2.0 * np.pi)
    along = shapes[0] ** 2 * AXIAL / values > 0.05
    np.testing.assert_allclose(frequencies[along][:1], WAVE / (4.0 * LENGTH), rtol=1e-3)
    euler = 1.8751041**2 * WAVE * np.sqrt(0.01**2 / 12.0) / LENGTH**2 / (2.0 * np.pi)
    np.testing.assert_allclose(frequencies[:2], euler, rtol=0.01)
    assert np.all(frequencies[:2] < euler)


def test_a_face_held_by_its_mean_is_the_softer_bound() -> None:
    """Rigid faces stiffen, faces that only follow in the mean soften: no load moves the end less; along the bar both are exact."""
    stiff, soft = (np.linalg.inv(element(0, hold).stiffness["bar"])[:6, :6] for hold in (Hold.RIGID, Hold.AVERAGED))
    more = (soft - stiff) / np.sqrt(np.outer(np.diag(stiff), np.diag(stiff)))
    assert np.linalg.eigvalsh(more)[0] > -1e-9
    assert more[3, 3] > 1e-4  # in torsion a free square end warps
    assert soft[0, 0] * AXIAL == pytest.approx(1.0, rel=1e-6)


def test_a_face_that_yields_lies_between() -> None:
    """Pulled evenly, an end that may warp as quadratic functions contracts; one that stays plane does not, and is stiffer."""
    part = bar()
    solid = replace(part.pieces[0], medium=Medium(young=100e9, poisson=0.3, density=1000.0))
    free = replace(part, pieces=(solid,), interfaces=(replace(part.interfaces[0], yields=True),))
    plan = Reduction(Fineness(order=2), modes=0)
    mesh = mesh_component(free, plan.fineness)
    found = reduce_mesh(free, mesh, plan)
    assert found.warps == WARPS
    stiff = np.linalg.inv(reduce_mesh(replace(free, interfaces=part.interfaces), mesh, plan).stiffness["bar"])[0, 0] * AXIAL
    pull = np.zeros(found.size)
    pull[0] = 1.0
    pull[[6 + 3, 6 + 5]] = 1.0 / 12.0  # the mean of (y / h)^2 and of (z / h)^2 over the end: what spreads the pull evenly
    yielding = pull @ np.linalg.solve(found.stiffness["bar"], pull) * AXIAL
    assert stiff < yielding < 1.0
    # The foot is held plane; so was the end, which is now free to contract: half of what was lost is back.
    assert 1.0 - yielding == pytest.approx(0.5 * (1.0 - stiff), rel=0.1)


def test_a_face_that_yields_and_is_held_stays_plane() -> None:
    """One reduction serves a unit in its stage and alone: with the warps nought it is that of the component whose end stays plane."""
    plan = Reduction(Fineness(order=2), modes=4)
    whole = reduce_mesh(with_yielding_ends(bar()), MESH, plan)
    held, own = hold_faces(whole, [True]), reduce_mesh(bar(), MESH, plan)
    assert (held.warps, held.size) == (0, own.size)
    for name in ("stiffness", "inertia"):
        mine, other = (_condensed(each, name) for each in (held, own))
        np.testing.assert_allclose(mine, other, rtol=0, atol=1e-9 * np.abs(other).max())


def _condensed(element: Superelement, name: str) -> np.ndarray:
    """The end's stiffness, or the inertia of its static motions: what does not depend on the choice of internal coordinates."""
    law = getattr(element, name)["bar"]
    inner = np.linalg.solve(element.stiffness["bar"][6:, 6:], element.stiffness["bar"][6:, :6])
    motion = np.vstack([np.eye(6), -inner])
    return motion.T @ law @ motion
