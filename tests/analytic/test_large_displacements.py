"""Large displacements against closed forms and published values: the elastica, columns, strips, cross pivots, beams in space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy
from numpy.polynomial import Legendre, legendre
from scipy.optimize import brentq
from scipy.special import ellipk

from flexstage.analysis.linear_statics.drift import drift
from flexstage.analysis.loaded.strained import strain_warnings
from flexstage.base.finding import DesignError
from flexstage.base.number import Number
from flexstage.base.units.scale import Z
from flexstage.beams.flexure.law import DEFAULT, Resolution
from flexstage.beams.flexure.strip import stiffness
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.models.lumped import lumped
from flexstage.models.nonlinear import linearise as linearised
from flexstage.models.nonlinear import summed
from flexstage.models.nonlinear.elements.strain import strains
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.paths.critical_load import Kind, critical_load, unstable_motions
from flexstage.models.nonlinear.paths.load_path import continuation, load_path, post_buckling_path
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.models.nonlinear.state import SolverOptions
from flexstage.parts.body import Body, Inertia
from flexstage.parts.leaf import Leaf, LeafEnds, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod
from flexstage.parts.section import Rectangle, cowper_rectangle
from tests.analytic.shooting import cross_pivot
from tests.analytic.strips import secant

SOFT = Material(young=1.0, poisson=0.3, density=0.0)
THIN = Leaf("soft", length=1.0, thickness=3e-5, width=1e-2, section=LeafSection.BEAM)
RIGIDITY = 1e-2 * 3e-5**3 / 12.0
"""E I of `THIN`."""


def body(x: Number, y: Number, z: Number) -> Body:
    return Body(mass=1.0, inertia=Inertia(1.0, 1.0, 1.0), centre=(x, y, z), reference=(x, y, z))


def stage(leaf: Leaf, bodies: dict[str, Body], links: dict[str, Link], material: Material = SOFT) -> Mechanism:
    return Mechanism("", materials={"soft": material}, parts={"leaf": leaf}, bodies=bodies, links=links, gravity=(0.0, 0.0, 0.0))


def cantilever(leaf: Leaf = THIN, material: Material = SOFT, resolution: Resolution = DEFAULT) -> Nonlinear:
    link = Link(("ground", "platform"), "leaf", at=(0.5 * leaf.length, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
    return nonlinear(stage(leaf, {"platform": body(leaf.length, 0.0, 0.0)}, {"leaf": link}, material), resolution=resolution)


def with_law(model: Nonlinear, **tables: np.ndarray) -> Nonlinear:
    (group,) = model.flexures
    return replace(model, flexures=(replace(group, law=replace(group.law, **tables)),))


def test_the_elastica_of_a_cantilever():
    """Exact by elliptic integrals (shooting), F L^2 / (E I) = 1, 2, 5, 10."""
    found = equilibrium(cantilever(), {"platform.fy": np.array([1.0, 2.0, 5.0, 10.0]) * RIGIDITY})
    across, along = [0.30172077, 0.49345748, 0.71379152, 0.81060902], [0.94356676, 0.83935828, 0.61237164, 0.44500440]
    assert found.displacement()[:, 1] == pytest.approx(across, abs=1e-7)
    assert 1.0 + found.displacement()[:, 0] == pytest.approx(along, abs=1e-7)
    assert found.rotation()[:, 2] == pytest.approx([0.46135195, 0.78174983, 1.21536812, 1.43028554], abs=1e-7)


@pytest.mark.parametrize(("ratio", "error"), [(0.2, 0.0), (0.1, -0.01), (0.04, -0.08), (0.02, -0.19)])
def test_the_strain_of_a_notch_is_that_of_its_throat(ratio: float, error: float):
    """A small moment M bends a notch: the strain at its throat is 6 M / (E b t^2), less the error that docs/nonlinear.md states."""
    link = Link(("ground", "platform"), "leaf", at=(0.5, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
    thickness = 0.5 * ratio
    model = nonlinear(stage(Notch("soft", thickness, 1.0, Circular(0.5)), {"platform": body(1.0, 0.0, 0.0)}, {"leaf": link}))
    moment = 1e-6 * thickness**2 / 6.0
    assert strains(equilibrium(model, {"platform.mz": moment})).largest == pytest.approx([1e-6 * (1.0 + error)], abs=6e-9)


def test_a_twisted_rod_has_the_stress_of_its_torque():
    """16 T / (pi d^3) at its surface, times sqrt(3)."""
    rod = Rod("soft", 1.0, 0.02)
    found = strains(equilibrium(cantilever(rod), {"platform.mx": 1e-10}))
    assert found.stress == pytest.approx([np.sqrt(3.0) * 16e-10 / (np.pi * 0.02**3)], rel=1e-6)


def test_a_hanging_flexure_bears_its_own_weight():
    """At its root (m + rho A L) g / A, with rho A L equal to the mass m of its body."""
    leaf = replace(THIN, thickness=1e-3, width=0.2)
    link = Link(("ground", "platform"), "leaf", at=(0.5, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
    drawn = stage(leaf, {"platform": body(1.0, 0.0, 0.0)}, {"leaf": link}, replace(SOFT, density=1.0 / 2e-4))
    found = strains(equilibrium(nonlinear(replace(drawn, gravity=(1e-9, 0.0, 0.0)))))
    assert found.stress == pytest.approx([2e-9 / 2e-4], rel=1e-3)
    assert found.largest == pytest.approx([2e-9 / 2e-4], rel=0.02)


def test_a_notch_has_no_shapes_across_its_width():
    """A wide notch turned by 0.05 rad at its end: b^2 k / t is above 100, but its law has no plate bending that could be too coarse."""
    notch = Notch("soft", 0.0002, 0.02, Circular(0.003))
    link = Link(("ground", "platform"), "leaf", at=(0.003, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
    found = strains(equilibrium(nonlinear(stage(notch, {"platform": body(0.006, 0.0, 0.0)}, {"leaf": link})), hold={"platform.rz": 0.05}))
    assert np.isnan(found.curving).all()
    assert not list(strain_warnings(found))


def test_the_strain_of_a_reinforced_leaf_is_that_of_its_thin_ends():
    """A cantilever under a small moment M at its end: the strain 6 M / (E b t^2), with the thickness t of the ends, not of the middle."""
    leaf = ReinforcedLeaf("soft", 1.0, 0.01, 0.1, LeafSection.BEAM, flexure_length=0.2, reinforced_thickness=0.04)
    moment = 1e-3 * 0.1 * 0.01**2 / 6.0
    assert strains(equilibrium(cantilever(leaf), {"platform.mz": moment})).largest == pytest.approx([1e-3], rel=0.05)


def chain(count: int, whole: Leaf = THIN, *, density: float = 0.0, gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Nonlinear:
    """A cantilever of many leaves and bodies without size, every third leaf drawn from its far end."""
    leaf = replace(whole, length=whole.length / count)
    names = ["ground", *(f"body{number}" for number in range(1, count)), "platform"]
    bodies = {name: Body(mass=0.0, reference=(leaf.length * number, 0.0, 0.0)) for number, name in enumerate(names) if number}
    links = {}
    for number in range(count):
        ends, along = (names[number], names[number + 1]), 1.0
        if number % 3 == 2:
            ends, along = ends[::-1], -1.0
        links[f"leaf{number}"] = Link(ends, "leaf", at=(leaf.length * (number + 0.5), 0.0, 0.0), along=(along, 0.0, 0.0), bends=Z)
    soft = replace(SOFT, density=density)
    return nonlinear(Mechanism("", materials={"soft": soft}, parts={"leaf": leaf}, bodies=bodies, links=links, gravity=gravity))


def follow_chain(count: int) -> None:
    """It is the elastica, found from one step, and stable; pressed beyond Euler's load it is not, and a held end holds it."""
    model = chain(count)
    found = equilibrium(model, {"platform.fy": np.array([1.0, 2.0]) * RIGIDITY}, options=SolverOptions(halvings=0, arcs=0))
    assert found.converged.all()
    assert found.displacement()[:, 1] == pytest.approx([0.30172077, 0.49345748], rel=1e-7)
    assert found.displacement()[:, 0] + 1.0 == pytest.approx([0.94356676, 0.83935828], rel=1e-7)
    assert unstable_motions(found).tolist() == [0, 0]
    pressed = {"platform.fx": np.array([-2.46, -2.475]) * RIGIDITY}
    assert unstable_motions(equilibrium(model, pressed)).tolist() == [0, 1]
    held = equilibrium(model, hold={"platform.y": float(found.displacement()[0, 1])})
    assert held.reactions[0] == pytest.approx(RIGIDITY, rel=1e-7)
    assert unstable_motions(held) == 0


def test_a_body_that_has_turned_has_its_inertia_turned():
    """About z by half a radian: J_xx = c^2 J_1 + s^2 J_2, J_xy = c s (J_1 - J_2), in small motions about the bent state."""
    inertia = Inertia(1.0, 2.0, 4.0)
    turning = Body(mass=1.0, inertia=inertia, centre=(1.0, 0.0, 0.0), reference=(1.0, 0.0, 0.0))
    link = Link(("ground", "platform"), "leaf", at=(0.5, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
    state = equilibrium(nonlinear(stage(THIN, {"platform": turning}, {"leaf": link})), hold={"platform.rz": 0.5})
    found = np.asarray(linearise(state).inertia["platform"].law).reshape(6, 6)[3:, 3:]
    cos, sin = np.cos(0.5), np.sin(0.5)
    xx, yy, xy = cos**2 + 2.0 * sin**2, sin**2 + 2.0 * cos**2, -cos * sin
    np.testing.assert_allclose(found, [[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, 4.0]], atol=1e-9)


def test_a_chain_of_flexures_is_one_flexure(monkeypatch: pytest.MonkeyPatch):
    """Without the zeros of its matrices; its own weight bends it as that of one flexure does.

    Leaves that stretch are 12 n (L/t)^2 times as stiff as the chain that bends: rounding of positions must not add up along it.
    """
    monkeypatch.setattr(summed, "MANY", 100)
    heavy = {"density": 4.0, "gravity": (0.0, -RIGIDITY / (THIN.width * THIN.thickness), 0.0)}
    one, found = (equilibrium(chain(count, **heavy)) for count in (1, 26))
    assert found.displacement() == pytest.approx(one.displacement(), rel=1e-6)
    assert found.displacement()[1] < -0.3
    follow_chain(26)
    pressed = critical_load(chain(26), {"platform.fx": -RIGIDITY})
    assert pressed.factor == pytest.approx(np.pi**2 / 4.0, rel=1e-6)
    along = pressed.state.model.reference[:-1, 0]
    assert pressed.shape[:, 1] / pressed.shape[np.argmax(along), 1] == pytest.approx(1.0 - np.cos(0.5 * np.pi * along), abs=1e-6)
    monkeypatch.setattr(linearised, "MEMORY", 1e6)
    with pytest.raises(DesignError, match="598 coordinates; its dense matrices need"):
        linearise(found)


@pytest.mark.full
def test_a_chain_of_a_thousand_flexures_is_one_flexure():
    """Its stiffness too, without the memory of dense matrices; what needs these says how much before it begins."""
    follow_chain(1000)
    assert critical_load(chain(1000), {"platform.fx": -RIGIDITY}).factor == pytest.approx(np.pi**2 / 4.0, rel=3e-5)
    with pytest.raises(DesignError, match=r"dense matrices need \d+ GB \(expected at most 8 GB\)"):
        linearise(equilibrium(chain(1000)))


def test_modes_converge_as_a_series_does():
    """Each two modes more take nine tenths or more of what is missing of place and rotation: F L^2 / (E I) = 10, by 4, 6, 8 of 12 modes."""
    found = [
        equilibrium(cantilever(resolution=Resolution(2, 2, count, points=16)), {"platform.fy": 10.0 * RIGIDITY}).twist()
        for count in (4, 6, 8, 12)
    ]
    missing = [np.max(np.abs(each - found[-1])) for each in found[:-1]]
    assert missing[2] < 0.1 * missing[1] < 0.01 * missing[0]


def shearing() -> Nonlinear:
    """A cantilever of G A = 200 E I / L^2."""
    model = cantilever()
    (group,) = model.flexures
    sheared = np.array(group.law.compliance)
    sheared[..., 1] = 1.0 / 200.0
    return with_law(model, compliance=sheared)


def test_a_column_that_shears_buckles_as_haringx_has_it():
    """P (1 + P / GA) = pi^2 E I / (4 L^2) (J. A. Haringx, Philips Research Reports 3, 1948); Euler's load without shear."""
    euler = np.pi**2 / 4.0
    found = critical_load(shearing(), {"platform.fx": -RIGIDITY})
    assert found.factor == pytest.approx(100.0 * (np.sqrt(1.0 + 4.0 * euler / 200.0) - 1.0), rel=1e-7)
    assert found.kind is Kind.BIFURCATION
    assert np.argmax(np.abs(found.shape[0])) in {1, 5}
    assert critical_load(cantilever(), {"platform.fx": -RIGIDITY}).factor == pytest.approx(euler, rel=1e-7)


def test_bodies_one_by_one_warm_the_stage_as_all_of_it_together():
    """Small temperatures add up, parts at the mean of their ends; of all bodies alike they are a uniform change, to the bit."""
    stage = replace(parallelogram(), ground="aluminium", gravity=(0.0, 0.0, 0.0))
    bodies = ("ground", *nonlinear(stage).bodies)

    def moved(temperatures: dict[str, float]) -> np.ndarray:
        return equilibrium(nonlinear(replace(stage, temperatures=temperatures))).twist()

    together = moved({"all": 1e-3})
    np.testing.assert_array_equal(together, equilibrium(nonlinear(stage, temperature=1e-3)).twist())
    alone = sum(moved({name: 1e-3}) for name in bodies)
    np.testing.assert_allclose(alone, together, rtol=1e-4, atol=1e-4 * np.max(np.abs(together)))
    assert [str(each.where) for each in check(replace(stage, temperatures={"platfrom": 1.0}))] == ["temperatures.platfrom"]


@pytest.mark.parametrize("ends", [("ground", "platform"), ("platform", "ground")])
def test_a_leaf_between_bodies_of_two_temperatures_grows_with_their_mean(ends):
    """Clamped at the cold ground, 100 mm to the platform: alpha L T / 2, whichever end is called the first."""
    link = Link(ends, "leaf", at=(0.05, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
    leaf, warm = replace(THIN, length=0.1), replace(SOFT, expansion=1e-5)
    whole = replace(stage(leaf, {"platform": body(0.1, 0.0, 0.0)}, {"leaf": link}, warm), ground="none", temperatures={"platform": 3.0})
    moved = equilibrium(nonlinear(whole), weight=0.0).twist()
    np.testing.assert_allclose(moved, [1e-5 * 0.1 * 1.5, 0.0, 0.0, 0.0, 0.0, 0.0], rtol=1e-6, atol=1e-12)


def test_a_heated_column_buckles_at_its_temperature():
    """Clamped, its other end free to go sideways but not along: alpha dT = pi^2 I / (A L^2), 1/12 of (pi t / L)^2."""
    warm = replace(SOFT, expansion=1e-6)
    leaf = replace(THIN, thickness=1e-3)
    link = Link(("ground", "platform"), "leaf", at=(0.5, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
    whole = replace(stage(leaf, {"platform": body(1.0, 0.0, 0.0)}, {"leaf": link}, warm), ground="none")
    critical_temperature = (np.pi * 1e-3) ** 2 / 12.0 / 1e-6
    counts = [
        int(
            unstable_motions(
                equilibrium(nonlinear(whole, temperature=share * critical_temperature), hold={"platform.x": 0.0, "platform.rz": 0.0})
            )
        )
        for share in (0.9999, 1.0001)
    ]
    assert counts == [0, 1]


@pytest.mark.parametrize("name", ["parallelogram", "double-triangle", "tilt-stage"])
def test_small_temperatures_move_as_drift_says(name: str):
    whole = case(name)
    expected = drift(whole, lumped(whole), ground="none").of().values[:, 0]
    found = equilibrium(nonlinear(whole, temperature=0.01, ground="none"), weight=0.0, stated=0.0).twist() / 0.01
    assert found == pytest.approx(expected, abs=1e-4 * np.max(np.abs(expected)))


def test_what_grows_alike_has_no_forces():
    leaf = replace(THIN, thickness=1e-3, width=0.1)
    rising = [Link(("ground", "platform"), "leaf", at=(0.5, y, 0.0), along=(1.0, 0.0, 0.0), bends=Z) for y in (-0.2, 0.2)]
    warm = replace(SOFT, expansion=1e-3)
    bodies = {"platform": body(1.0, 0.1, 0.3)}
    whole = stage(leaf, bodies, {"left": rising[0], "right": rising[1]}, warm)
    found = equilibrium(nonlinear(whole, temperature=10.0, ground="soft"))
    assert found.twist() == pytest.approx([0.01, 0.001, 0.003, 0.0, 0.0, 0.0], abs=1e-12)


def upright_strip() -> tuple[Nonlinear, dict[str, float], float]:
    """A strip that does not bend in its own plane, a load on its tip, and sqrt(E I G J) / L^2 over that load."""
    model = cantilever()
    (group,) = model.flexures
    form = np.array(group.law.form)
    form[..., 6:12, 6:12] *= 1e3  # no bending in its own plane
    twisting = RIGIDITY / 1e-2 / 3e-5**3 * 12.0 / form[0, 0, 0]
    return with_law(model, form=form), {"platform.fz": RIGIDITY}, float(np.sqrt(twisting))


def test_a_strip_bent_upright_buckles_sideways():
    """4.0126 sqrt(E I G J) / L^2 at its tip (L. Prandtl, Kipp-Erscheinungen, 1899); 4.01259934 with more digits."""
    model, load, unit = upright_strip()
    assert critical_load(model, load).factor == pytest.approx(4.01259934 * unit, rel=1e-6)


@pytest.mark.parametrize(("beta", "factor"), [(1, 1.0029), (3, 1.0208), (5, 1.0402), (7, 1.0533), (10, 1.0634), (20, 1.0735)])
def test_a_strip_stiffens_as_it_bends(beta: float, factor: float):
    """Ashwell's strip (J. Roy. Aero. Soc. 54, 1950), nu = 0.3, by 14 functions across its width."""
    assert secant(beta, 0.3) == pytest.approx(factor, abs=5e-4)


def test_a_strip_of_elements_stiffens_so_too():
    """Rotation by a moment of leaves 4 and 8 widths long, one less the other: what their clamps take falls out."""
    beta, factor = np.array([1, 3, 5, 7, 10, 20]), np.array([1.0029, 1.0208, 1.0402, 1.0533, 1.0634, 1.0735])
    thin = Leaf("soft", length=0.4, thickness=1e-4, width=0.1)
    moment = 0.1 * 1e-12 / 12.0 * factor * beta * 1e-4 / 0.1**2
    fine = Resolution(fields=(10, 8), points=14)
    turns = [
        equilibrium(cantilever(replace(thin, length=length), resolution=fine), {"platform.mz": moment}).rotation()[:, 2]
        for length in (0.4, 0.8)
    ]
    assert 0.4 * beta * 1e-4 / 0.1**2 / (turns[1] - turns[0]) == pytest.approx(1.0, abs=5e-4)


@pytest.mark.parametrize("kind", [{"section": LeafSection.BEAM}, {"ends": LeafEnds.FREE}], ids=["beam", "plate"])
def test_a_twisted_strip_stiffens_and_shortens(kind: dict[str, LeafSection | LeafEnds]):
    """M = (G J + N I_p / A) k + E t b^5 k^3 / 360 (H. Wagner, 25 Jahre TH Danzig, 1929), and k^2 I_p / (2 A) shorter."""
    strip = Leaf("soft", length=1.0, thickness=2e-4, width=0.05, **kind)
    section, polar = Rectangle(2e-4, 0.05), (0.05**2 + 4e-8) / 12.0
    twist, pull = np.array([0.05, 0.5, 0.5]), np.array([0.0, 0.0, 1e-10])
    found = equilibrium(cantilever(strip), {"platform.fx": pull}, hold={"platform.rx": twist})
    saint_venant, wagner = section.torsion / 2.6 * twist, 2e-4 * 0.05**5 * twist**3 / 360.0
    assert wagner[1] > 0.5 * saint_venant[1]
    assert found.reactions[:, 0] == pytest.approx(saint_venant + pull * polar * twist + wagner, rel=1e-9, abs=0.0)
    assert found.displacement()[:, 0] == pytest.approx(pull / 1e-5 - 0.5 * polar * twist**2, rel=1e-9)
    assert strains(found).largest[:2, 0] == pytest.approx(twist[:2] ** 2 * 0.05**2 / 12.0, rel=1e-9)


def test_the_form_of_a_strip_is_the_energy_of_its_plate():
    """Mindlin's, by quadrature over the plate: curvatures psi' phi and a phi'', the twist (a' + psi) phi' / 2, the shear (a' - psi) phi."""
    width, thickness, poisson, amplitudes = 0.3, 0.02, 0.27, np.random.default_rng(3).normal(size=(4, 30))
    nodes, weights = legendre.leggauss(40)
    ends = Legendre([2.0 / 3.0, 0.0, -2.0 / 3.0], domain=[0.0, 1.0])  # 1 - u^2
    fields = [ends * Legendre(row, domain=[0.0, 1.0]) for row in amplitudes]
    across = [width**2 / 12.0 * Legendre.basis(degree, domain=[-0.5 * width, 0.5 * width]) for degree in (2, 4)]
    (a, slope), (psi, turned) = (
        [np.array([each.deriv(order)(0.5 * (nodes + 1.0)) for each in pair]) for order in (0, 1)] for pair in (fields[:2], fields[2:])
    )
    phi, tilt, curve = (np.array([each.deriv(order)(0.5 * width * nodes) for each in across]) for order in (0, 1, 2))
    along, over, twist, shear = turned.T @ phi, a.T @ curve, (slope + psi).T @ tilt, (slope - psi).T @ phi
    bending = along**2 + over**2 + 2.0 * poisson * along * over + 0.5 * (1.0 - poisson) * twist**2
    density = bending + 5.0 / 6.0 * 12.0 * (1.0 - poisson**2) / (2.0 * (1.0 + poisson)) / thickness**2 * shear**2
    energy = 0.25 * weights @ density @ weights
    row = amplitudes.ravel()
    assert row @ stiffness(width, thickness, poisson) @ row == pytest.approx(energy, rel=1e-10)


def pivot(crossing: float) -> Nonlinear:
    leaf = replace(THIN, thickness=1e-4)
    along = {"left": np.array([np.sqrt(0.5), np.sqrt(0.5), 0.0]), "right": np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0])}
    links = {
        name: Link(("ground", "platform"), "leaf", at=tuple((0.5 - crossing) * each), along=tuple(each), bends=Z)
        for name, each in along.items()
    }
    return nonlinear(stage(leaf, {"platform": body(0.0, 0.0, 0.0)}, links))


@pytest.mark.parametrize(
    ("crossing", "moment", "shift"),
    [
        (0.5, [2.000033, 2.000833, 2.003328, 2.013241, 2.029538], [1.1785e-5, 2.9456e-4, 1.1774e-3, 4.6968e-3, 1.0520e-2]),
        (0.0, [7.999918, 7.997963, 7.991870, 7.967756, 7.928472], None),
    ],
)
def test_a_cross_pivot_turns(crossing: float, moment: list[float], shift: list[float] | None):
    """Leaves at 90 degrees that cross at 0.5 and 0 of their length (W. H. Wittrick 1951; S. Zelenika and F. De Bona 2002), by shooting."""
    angle = np.array([0.01, 0.05, 0.1, 0.2, 0.3])
    found = equilibrium(pivot(crossing), hold={"platform.rz": angle})
    rigidity = 1e-2 * 1e-4**3 / 12.0
    assert found.reactions[:, 0] / angle / rigidity == pytest.approx(moment, rel=2e-6)
    if shift is not None:
        assert np.hypot(*found.displacement()[:, :2].T) == pytest.approx(shift, rel=1e-4)


@pytest.mark.parametrize(
    ("crossing", "angle", "load"), [(0.5, 0.3, (0.0, 0.0)), (0.5, 0.2, (2.0, 0.0)), (0.5, 0.1, (-1.0, 0.3)), (0.0, 0.3, (0.0, 0.0))]
)
def test_a_cross_pivot_is_where_shooting_finds_it(crossing: float, angle: float, load: tuple[float, float]):
    """Moment and place, its leaves stretched and sheared as much as ours; literature's last digits depend on what stretches there."""
    section = Rectangle(1e-4, 1e-2, cowper_rectangle(0.3))
    rigidity = section.inertia_z
    moment, place = cross_pivot(angle, crossing, np.array(load), rigidity / section.area, 2.6 * rigidity * section.shear / section.area)
    pushed = {"platform.fx": load[0] * rigidity, "platform.fy": load[1] * rigidity}
    found = equilibrium(pivot(crossing), pushed, hold={"platform.rz": angle})
    assert found.reactions[0] / rigidity == pytest.approx(moment, rel=1e-9)
    assert found.displacement()[:2] == pytest.approx(place, rel=1e-7)


def test_tension_softens_a_cross_pivot():
    """Crossing at the middle, loads -1, 1, 2 E I / L^2 along its symmetry axis, by shooting."""
    rigidity = 1e-2 * 1e-4**3 / 12.0
    found = equilibrium(pivot(0.5), {"platform.fx": np.array([-1.0, 1.0, 2.0]) * rigidity}, hold={"platform.rz": 1e-4})
    assert found.reactions[:, 0] / 1e-4 / rigidity == pytest.approx([2.23438, 1.76311, 1.52344], rel=2e-4)


def princeton(force: float, angle: np.ndarray) -> np.ndarray:
    """Displacements (n, 3) of its end under a force [N] at angles to its edge."""
    leaf = Leaf("soft", length=0.508, thickness=3.2024e-3, width=12.3777e-3, section=LeafSection.BEAM)
    model = cantilever(leaf, Material(young=71.7e9, poisson=0.31, density=0.0))
    return equilibrium(model, {"platform.fz": force * np.cos(angle), "platform.fy": force * np.sin(angle)}).displacement()


def test_the_princeton_beam():
    """Beam elements of ANSYS stored in EXUDYN (TestModels/ANCFBeamTest.py): 8.896 N at 0, 15, ... 90 degrees; its J is not said."""
    found = princeton(8.896, np.deg2rad(np.arange(0.0, 91.0, 15.0)))
    edge = [0.010714176, 0.010613287, 0.010111696, 0.008837226, 0.006604665, 0.003538889, 0.0]
    flat = [0.0, 0.042082321, 0.079394829, 0.108987937, 0.129887616, 0.142194370, 0.146245978]
    assert found[:, 2] == pytest.approx(edge, rel=0.015, abs=1e-9)
    assert found[:, 1] == pytest.approx(flat, rel=0.015, abs=1e-9)


def misalignment() -> tuple[Nonlinear, Callable[[Number], dict[str, Number]]]:
    """A guide of two leaves on the ground and on a foot, and what turns the foot by a share of what the guide bears.

    About the normal of its leaf's width, in the middle of the leaf: 4 pi sqrt(E I G J) / (E I_y), whatever the length.
    """
    length, spacing, thickness, width = 0.1, 0.05, 0.37e-3, 0.05
    leaf = Leaf("soft", length, thickness, width, section=LeafSection.BEAM)
    bodies = {"platform": body(length, 0.0, 0.0), "foot": body(0.5 * length, 0.5 * spacing, 0.0)}
    links = {
        name: Link((name, "platform"), "leaf", at=(0.5 * length, side * spacing, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
        for name, side in (("ground", -0.5), ("foot", 0.5))
    }
    section = Rectangle(thickness, width)
    expected = 4.0 * np.pi * np.sqrt(section.inertia_z * section.torsion / 2.6) / section.inertia_y
    fixed: dict[str, Number] = {f"foot.{name}": 0.0 for name in ("x", "y", "z", "rx", "rz")}
    return nonlinear(stage(leaf, bodies, links)), lambda share: {**fixed, "foot.ry": expected * share}


def test_a_guide_bears_so_much_misalignment():
    guide, turned = misalignment()
    found = unstable_motions(equilibrium(guide, hold=turned(np.array([1.0 - 1e-4, 1.0 + 1e-4])), options=SolverOptions(past=True)))
    assert (found > 0).tolist() == [False, True]


def vee() -> Nonlinear:
    """A platform between two pairs of leaves that rise towards it by 2 degrees."""
    length, slope = 0.05, np.deg2rad(2.0)
    leaf = Leaf("soft", length, 0.5e-3, 0.02)
    links = {}
    for name, side, height in (("a", -1.0, 0.01), ("b", 1.0, 0.01), ("c", -1.0, -0.01), ("d", 1.0, -0.01)):
        along = np.array([-side * np.cos(slope), np.sin(slope), 0.0])
        middle = np.array([side * (0.005 + length * np.cos(slope)), height, 0.0]) + 0.5 * length * along
        links[name] = Link(("ground", "platform"), "leaf", tuple(middle), tuple(along), bends=Z)
    place = body(0.0, float(length * np.sin(slope)), 0.0)
    return nonlinear(stage(leaf, {"platform": place}, links, Material(young=200e9, poisson=0.3, density=0.0)))


def test_a_shallow_vee_snaps_through():
    """By arc length the load rises to a limit, where the count of unstable motions has it too, and turns negative: it is bistable."""
    model, push = vee(), {"platform.fy": -1.0}
    found = continuation(model, push, step=0.002, points=24)
    top = next(event for event in found.events if event.kind is Kind.LIMIT)
    curve = np.polyfit([-1.0, 0.0, 1.0], found.values[top.before - 1 : top.before + 2], 2)
    limit = curve[2] - curve[1] ** 2 / (4.0 * curve[0])
    known = critical_load(model, push)
    assert known.kind is Kind.LIMIT
    assert known.factor == pytest.approx(limit, rel=1e-3)
    assert found.values.min() < 0.0 < found.values[-1]
    assert found.motions[-1] == 0
    assert found.state.displacement()[-1, 1] < -1.1 * 0.05 * np.sin(np.deg2rad(2.0))


def test_a_drive_is_followed_where_no_load_could_go():
    """The same states by holding the platform instead: beyond the limit its force falls."""
    traced = continuation(vee(), {"platform.fy": -1.0}, step=0.004, points=5)
    found = load_path(vee(), "platform.y", traced.state.displacement()[:, 1])
    assert found.state.converged.all()
    assert -found.state.reactions[:, 0] == pytest.approx(traced.values, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_buckled_column_is_an_elastica(side: float):
    """P L^2 / (E I) = K(k)^2 and y / L = 2 k / K(k), k the sine of half the angle at its end, to 76 degrees both ways."""
    found = post_buckling_path(cantilever(), {"platform.fx": -RIGIDITY}, side=side, step=0.2, points=8)
    angle, across = found.state.rotation()[1:, 2], found.state.displacement()[1:, 1]
    sine = np.sin(0.5 * angle)
    assert found.values[1:] == pytest.approx(ellipk(sine**2) ** 2, rel=1e-6)
    assert across == pytest.approx(2.0 * sine / ellipk(sine**2), rel=1e-6)
    assert found.motions.tolist()[1:] == [0] * 8
    assert np.sign(angle[0]) == np.sign(angle[-1]) == side
    assert abs(angle[-1]) > 1.3


def heavy_elastica(angle: float) -> float:
    """w L^3 / (E I) of an upright column that its own weight w a length bends so far at its top: th'' = - w s sin(th), s from there."""

    def foot(weight: float) -> float:
        course = scipy.integrate.solve_ivp(
            lambda s, y: [y[1], -weight * s * np.sin(y[0])], (0.0, 1.0), [angle, 0.0], rtol=1e-11, atol=1e-12
        )
        return float(course.y[0, -1])

    return float(brentq(foot, 7.5, 9.0, xtol=1e-11))


def test_a_column_buckles_under_its_own_weight():
    """Greenhill's 7.8373 (1881), and on along the branch by shooting."""
    link = Link(("ground", "platform"), "leaf", at=(0.5, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=Z)
    top = Body(mass=0.0, reference=(1.0, 0.0, 0.0))
    unit = (-RIGIDITY / (THIN.width * THIN.thickness), 0.0, 0.0)
    heavy = {"soft": replace(SOFT, density=1.0)}
    column = nonlinear(Mechanism("", heavy, {"leaf": THIN}, {"platform": top}, {"leaf": link}, gravity=unit))
    found = post_buckling_path(column, {"weight": 1.0}, weight=0.0, step=0.2, points=3)
    angles = found.state.rotation()[:, 2]
    assert found.values[0] == pytest.approx(7.83735, rel=1e-6)
    assert found.values[1:] == pytest.approx([heavy_elastica(each) for each in angles[1:]], rel=1e-6)
    assert np.abs(np.diff(angles)) == pytest.approx(0.16, rel=0.05)


def pressed_guide() -> Nonlinear:
    """Two leaves of `THIN` side by side, so far apart that the couple which their forces exert takes no difference between them."""
    sides = {"left": -200.0, "right": 200.0}
    links = {
        name: Link(("ground", "platform"), "leaf", at=(0.5, side, 0.0), along=(1.0, 0.0, 0.0), bends=Z) for name, side in sides.items()
    }
    return nonlinear(stage(THIN, {"platform": body(1.0, 0.0, 0.0)}, links))


def test_a_pressed_guide_buckles_aside():
    """Each leaf is four quarters of an elastica: P L^2 / (E I) = 4 K(k)^2 a leaf, aside by 2 k / K(k) of its length."""
    found = post_buckling_path(pressed_guide(), {"platform.fx": -2.0 * RIGIDITY}, step=0.05, points=6)
    aside = np.abs(found.state.displacement()[1:, 1])
    modulus = np.array([brentq(lambda k, u=each: 2.0 * k / ellipk(k * k) - u, 0.0, 0.9, xtol=1e-14) for each in aside])
    assert found.values[0] == pytest.approx(np.pi**2, rel=1e-7)
    assert found.values[1:] == pytest.approx(4.0 * ellipk(modulus**2) ** 2, rel=1e-6)
    assert aside[-1] > 0.2


def test_what_turns_does_not_branch():
    with pytest.raises(DesignError, match="limit point without a branch"):
        post_buckling_path(vee(), {"platform.fy": -1.0})


def test_past_a_limit_the_load_is_found_again():
    """Asked for, a load beyond the limit is followed by arc length to where it is whole; else its case ends at the limit, and says so."""
    model, push = vee(), {"platform.fy": np.array([-40.0, -70.0])}
    stopped, snapped = equilibrium(model, push), equilibrium(model, push, options=SolverOptions(past=True))
    assert stopped.converged.tolist() == [True, False]
    assert stopped.reached[1] == pytest.approx(critical_load(model, {"platform.fy": -70.0}).factor, rel=5e-3)
    assert snapped.converged.all()
    assert unstable_motions(snapped).tolist() == [0, 0]
    assert snapped.displacement()[:, 1] == pytest.approx([stopped.displacement()[0, 1], -3.028e-3], rel=1e-3)


@pytest.mark.parametrize(("section", "share"), [(LeafSection.BEAM, 1.0), (LeafSection.PLATE, np.sqrt(1.0 - 0.3 + 0.09))])
def test_stress_at_a_root_is_that_of_its_moment(section: LeafSection, share: float):
    """M t / (2 I) along; at a clamped root, which cannot contract, nu times that across: E k t / (2 (1 - nu^2)) at the curvature there."""
    leaf = replace(THIN, thickness=1e-3, width=0.2, section=section)
    held = equilibrium(cantilever(leaf), hold={"platform.y": 1e-7, "platform.rz": 0.0})
    moment = 0.5 * held.reactions[0]
    assert strains(held).stress[0] == pytest.approx(share * moment * 6.0 / (0.2 * 1e-6), rel=3e-3)
    pulled = strains(equilibrium(cantilever(leaf), {"platform.fx": 1e-9}))
    assert pulled.stress[0] == pytest.approx(1e-9 / (0.2 * 1e-3), rel=1e-6)
    assert np.isnan(pulled.limit).all()


def test_a_bent_strip_is_stretched_across_its_width():
    """In the middle of a long one k, a_2 and a_4 are uniform, of least energy: stress of the plate's bending and of its stretch there."""
    thickness, width, beta = 1e-4, 0.1, 12.0
    curvature = beta * thickness / width**2
    leaf = Leaf("soft", length=0.8, thickness=thickness, width=width)
    moment = float(secant(beta, 0.3)) * width * thickness**3 / 12.0 * curvature
    found = strains(equilibrium(cantilever(leaf), {"platform.mz": moment}))
    assert found.curving[0] == pytest.approx(beta, rel=0.03)
    w = width * np.array([-0.5, -0.25, 0.0, 0.25, 0.5])
    shapes = [width**2 / 12.0 * Legendre.basis(degree, domain=[-0.5 * width, 0.5 * width]) for degree in (2, 4)]
    nodes, weights = legendre.leggauss(12)
    curved = np.array([shape.deriv(2)(0.5 * width * nodes) for shape in shapes])
    plain = np.array([shape(0.5 * width * nodes) for shape in shapes])
    plate, stretch = thickness**2 / 12.0 / 0.91, curvature**2
    form = plate * (curved * weights @ curved.T) + stretch * (plain * weights @ plain.T)
    fields = np.linalg.solve(form, -0.3 * curvature * plate * (curved @ weights))
    across, along = (sum(a * each(w) for a, each in zip(fields, kind, strict=True)) for kind in ([s.deriv(2) for s in shapes], shapes))
    bent = [face * 0.5 * thickness / 0.91 * np.array([curvature + 0.3 * across, across + 0.3 * curvature]) for face in (1.0, -1.0)]
    pairs = [(one - curvature * along, other) for one, other in bent]
    expected = max(float(np.max(np.sqrt(one**2 + other**2 - one * other))) for one, other in pairs)
    assert found.stress[0] == pytest.approx(expected, rel=0.02)


def test_twist_is_sheared_at_its_faces():
    """T t / J of Saint-Venant's torsion, times sqrt(3) by von Mises."""
    leaf = replace(THIN, thickness=1e-3, width=0.1)
    torsion = float(Rectangle(1e-3, 0.1).torsion)
    found = strains(equilibrium(cantilever(leaf), {"platform.mx": 1e-6 * torsion}))
    assert found.stress[0] == pytest.approx(np.sqrt(3.0) * 1e-9, rel=1e-3)
