"""Large displacements: what literature and other codes find of beams, strips, hinges and leaves, and ours."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable

import numpy as np

from flexstage.base.number import Array
from flexstage.models.nonlinear.equilibrium import State, equilibrium
from flexstage.models.nonlinear.paths.critical_load import critical_load, unstable_motions
from flexstage.models.nonlinear.state import SolverOptions
from flexstage.parts.section import Rectangle
from tests.analytic.strips import secant
from tests.analytic.test_large_displacements import (
    RIGIDITY,
    cantilever,
    misalignment,
    pivot,
    princeton,
    shearing,
    upright_strip,
)
from tools.validation.row import Row, Section, relative

_TEST = ".venv/bin/python -m pytest tests/analytic/test_large_displacements.py -k"


def sections() -> list[Section]:
    """What literature prints."""
    return [_beams(), _buckling(), _strip(), _pivot(), _princeton()]


def codes() -> list[Section]:
    """What other codes find."""
    return [_solids(), *([_hinge()] if importlib.util.find_spec("exudyn") else [])]


def _beams() -> Section:
    load = np.array([1.0, 10.0])
    found = equilibrium(cantilever(), {"platform.fy": load * RIGIDITY})
    values = {"y / L": found.displacement()[:, 1], "x / L": 1.0 + found.displacement()[:, 0], "rotation": found.rotation()[:, 2]}
    printed = {"y / L": ("0.30172077", "0.81060902"), "x / L": ("0.94356676", "0.44500440"), "rotation": ("0.46135195", "1.43028554")}
    rows = tuple(
        Row(f"{what} under F L^2 / (E I) = {load[place]:.0f}", "elliptic integrals", printed[what][place], float(each[place]), "1")
        for what, each in values.items()
        for place in range(2)
    )
    return Section("The elastica", "A cantilever without stretch and shear, pushed across at its end.", rows, repeat=f"{_TEST} elastica")


def _buckling() -> Section:
    strip, load, unit = upright_strip()
    guide, turned = misalignment()
    rows = (
        Row(
            "cantilever, G A = 200 E I / L^2",
            "Haringx 1948",
            "2.4376895",
            critical_load(shearing(), {"platform.fx": -RIGIDITY}).factor,
            "1",
            relative(1e-7),
        ),
        Row(
            "tip load of a strip, / sqrt(E I G J)",
            "Prandtl 1899",
            "4.01259934",
            critical_load(strip, load).factor / unit,
            "1",
            relative(1e-6),
        ),
        Row(
            "misalignment of a guide's foot, E I_y / sqrt(E I G J)",
            "4 pi",
            "12.566371",
            4.0 * np.pi * _first_unstable(lambda share: equilibrium(guide, hold=turned(share), options=SolverOptions(past=True))),
            "1",
            relative(1e-4),
        ),
    )
    text = (
        "Loads of columns over E I / L^2. Prandtl's strip does not bend in its own plane. A guide of two leaves, the foot of "
        "one turned about the normal of its width, gives way sideways, whatever its length."
    )
    return Section("What buckles", text, rows, repeat=f'{_TEST} "haringx or sideways or misalignment"')


def _first_unstable(state: Callable[[float], State]) -> float:
    """The share between 0.9 and 1.1 at which a motion becomes unstable."""
    low, high = 0.9, 1.1
    while high - low > 1e-7:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if int(unstable_motions(state(middle))) > 0 else (middle, high)
    return high


def _strip() -> Section:
    printed = {1: "1.0029", 3: "1.0208", 5: "1.0402", 7: "1.0533", 10: "1.0634", 20: "1.0735"}
    rows = tuple(
        Row(f"M / (E I k) at b^2 k / t = {beta}", "14 functions across", each, float(secant(beta, 0.3)), "1", relative(5e-4))
        for beta, each in printed.items()
    )
    text = "Ashwell's strip (J. Roy. Aero. Soc. 54, 1950), nu = 0.3: two shapes across its width, beside fourteen."
    return Section("A strip that stiffens as it bends", text, rows, repeat=f"{_TEST} stiffens")


def _pivot() -> Section:
    angle, rigidity = np.array([0.1, 0.3]), Rectangle(1e-4, 1e-2).inertia_z
    found = equilibrium(pivot(0.5), hold={"platform.rz": angle})
    pulled = equilibrium(pivot(0.5), {"platform.fx": np.array([-1.0, 1.0, 2.0]) * rigidity}, hold={"platform.rz": 1e-4})
    shift = np.hypot(*found.displacement()[:, :2].T)
    rows = [
        Row(
            f"moment / angle at {angle[place]} rad", "shooting", each, float(found.reactions[place, 0] / angle[place] / rigidity), "E I / L"
        )
        for place, each in enumerate(("2.003328", "2.029538"))
    ]
    rows += [
        Row(f"shift at {angle[place]} rad", "shooting", each, float(shift[place]), "L", relative(1e-4))
        for place, each in enumerate(("1.1774e-3", "1.0520e-2"))
    ]
    rows += [
        Row(f"moment / angle under {force:+d} E I / L^2", "shooting", each, float(value / 1e-4 / rigidity), "E I / L", relative(2e-4))
        for force, each, value in zip((-1, 1, 2), ("2.23438", "1.76311", "1.52344"), pulled.reactions[:, 0], strict=True)
    ]
    text = (
        "Leaves at 90 degrees that cross in the middle (W. H. Wittrick 1951; S. Zelenika and F. De Bona 2002). The references "
        "under force do not say how much the leaves stretch; those of `tests/analytic/shooting.py`, stretched as ours, agree to"
        " 1e-9."
    )
    return Section("A cross pivot", text, tuple(rows), repeat=f"{_TEST} pivot")


def _princeton() -> Section:
    found = princeton(8.896, np.deg2rad([0.0, 45.0, 90.0]))
    rows = (
        Row("across the edge, 0 degrees", "ANSYS beam", "0.010714176", float(found[0, 2]), "m", relative(0.015)),
        Row("across the edge, 45 degrees", "ANSYS beam", "0.008837226", float(found[1, 2]), "m", relative(0.015)),
        Row("across the flat, 45 degrees", "ANSYS beam", "0.108987937", float(found[1, 1]), "m", relative(0.015)),
        Row("across the flat, 90 degrees", "ANSYS beam", "0.146245978", float(found[2, 1]), "m", relative(0.015)),
    )
    text = (
        "A slender strip, loaded by 8.896 N at its end under angles to its flat; the values are those of beam elements that "
        "EXUDYN keeps (TestModels/ANCFBeamTest.py), not the measurements of E. H. Dowell and J. J. Traybar. Their torsional "
        "constant is not said."
    )
    return Section("The Princeton beam", text, rows, repeat=f"{_TEST} princeton")


def _solids() -> Section:
    from tests.elsewhere.calculix.bent_leaves import COMPONENTS
    from tests.elsewhere.test_calculix_bent_leaves import AGREED, SOLID, ours, printed

    rows: list[Row] = []
    for name, wanted in AGREED.items():
        theirs, found = printed(name)[-1], ours(SOLID[name])
        for component, allowed in wanted.items():
            place = COMPONENTS.index(component)
            scale, unit = (1e3, "mm") if place < 3 else (1.0, "rad")
            what = f"{name}: {component}"
            rows.append(Row(what, "ccx 2.20", f"{scale * theirs[place]:.6g}", float(scale * found[place]), unit, relative(allowed)))
    text = (
        "Bricks of twenty nodes on three meshes each; the finest is compared. Guides of two leaves 250 x 50 x 5 mm, 150 mm "
        "apart, pushed across by 1, 5 and 20 E I / L^2; two upright leaves 60 x 20 x 0.3 mm under 2.5 kg, pushed by 0.5 N; a "
        "leaf 80 x 30 x 1 mm, twisted by 3 N m, and bent by 3 N m under 20 N in its plane. Far ends are rigid. By CalculiX's "
        "Debian package; `tests/elsewhere/calculix/bent_leaves.py` makes the decks and says more. As beams, the leaves of the "
        "second guide move 3 % further."
    )
    return Section(
        "CalculiX: leaves far bent", text, tuple(rows), repeat=".venv/bin/python -m pytest tests/elsewhere/test_calculix_bent_leaves.py"
    )


def _hinge() -> Section:
    from tests.elsewhere.test_exudyn_cross_hinge import ours, theirs

    def row(what: str, wrench: Array) -> list[Row]:
        coarse, fine = (theirs(wrench, count) for count in (16, 32))
        expected, found = fine + (fine - coarse) / 3.0, ours(wrench)
        return [
            Row(f"{what}: {name}", "Exudyn", f"{scale * expected[place]:.9g}", float(scale * found[place]), unit, relative(1e-6))
            for name, place, scale, unit in (("x", 0, 1e3, "mm"), ("rz", 5, 1.0, "rad"))
        ]

    rows = [*row("turned", np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.2])), *row("in space", np.array([1.0, 2.0, 5.0, 0.05, -0.1, 0.18]))]
    text = (
        "Two leaves 80 x 30 x 0.35 mm as beams, without what twist stretches, which Exudyn's geometrically exact beams do not "
        "know: 16 and 32 elements a leaf, extrapolated by Richardson."
    )
    return Section(
        "Exudyn: a cross hinge far turned",
        text,
        tuple(rows),
        repeat=".venv/bin/python -m pytest tests/elsewhere/test_exudyn_cross_hinge.py",
    )
