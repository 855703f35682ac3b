"""Chapter 2 and 3 of the paper: strokes, single units, Eq. 2, Eq. 11 and both columns of Table 2."""

from __future__ import annotations

import numpy as np

import flexstage as fs
from flexstage.analysis.workspace.stroke import stacks
from flexstage.cases.double_triangle import EQUATION_3, TABLE_2_FEA
from tests.paper.test_disagreements import equivalent_stiffness
from tests.paper.test_lost_motion import COMMANDS, FEA, THEORY
from tools.validation.row import Row, Section, Tolerance, relative
from tools.validation.stages import gain, known, load_term

DIRECTIONS = np.deg2rad([0.0, 120.0, -120.0])


def sections() -> list[Section]:
    """The sections of this chapter."""
    return [_units(), _equation_2(), _equation_11(), _table_2()]


def _units() -> Section:
    rows = [Row("amplification of a lever unit", "paper 2.2", "3", known("B").units["vertical"].ideal_gain, "1", relative(1e-12))]
    for letter in "AB":
        horizontal = known(letter).units["horizontal"]
        rows += [
            Row(f"K_a,h, geometry of set {letter}", "paper 2.2", "10.30", 1e-6 * horizontal.axial, "N/um"),
            Row(f"K_l,h in plane, set {letter}", "paper 2.2", "0.0012", 1e-6 * horizontal.lateral[1], "N/um"),
        ]
    piezos = stacks(known("B").stage)
    rows += [
        Row(f"blocking force of {name}", "paper 2.1, stroke x stiffness", force, float(piezos[name].blocking_force), "N")
        for name, force in (("B1", "2550"), ("B4", "7000"))
    ]
    rows += [
        Row("0.042 deg", "paper 2.1", "733.04", 0.042 * fs.deg / fs.urad, "urad"),
        Row("0.014 deg", "paper 2.1", "244.35", 0.014 * fs.deg / fs.urad, "urad"),
    ]
    text = "Each unit alone, by the lumped model; its output free of rotation."
    return Section("Strokes and single units", text, tuple(rows))


def _equation_2() -> Section:
    tensor = equivalent_stiffness(10.30, 0.0012, DIRECTIONS)
    spread = float(np.ptp(np.linalg.eigvalsh(tensor)) / tensor[0, 0])
    rows = (
        Row("K_eq from K_a,h and K_l,h", "paper Eq. 2", "15.452", float(tensor[0, 0]), "N/um", Tolerance(5e-4)),
        Row("motion under 100 N", "paper Eq. 2", "6.47", 100.0 / float(tensor[0, 0]), "um"),
        Row("spread over directions", "Eq. 2: none", "0", spread, "1", Tolerance(1e-12)),
    )
    return Section("Equation 2", "Three equal units 120 degrees apart: K = 1.5 (K_a + K_l) in every direction.", rows)


def _equation_11() -> Section:
    rows = []
    for letter in "AB":
        case = known(letter)
        model = case.restricted(EQUATION_3)
        first, load = f"{case.lever.gain:.9g}", f"{1e6 * case.lever.tip_compliance:.9g}"
        rows += [
            Row(f"first term, set {letter}", "paper Eq. 11", first, gain(model), "1", relative(1e-6)),
            Row(f"load term, set {letter}", "paper Eq. 11", load, 1e6 * load_term(model), "um/N", relative(1e-6)),
        ]
    eps = float(known("B").lever.softness)
    rows.append(Row("eps = K_theta2 / (r_1^2 K_1), set B", "derived from Table 2: 1/39", "0.02564", eps, "1", Tolerance(5e-5)))
    text = (
        "The lumped model of one vertical unit, restricted to the freedoms that Eq. 3 knows (`EQUATION_3`), against the closed form "
        "with the springs of its own hinges: reference and ours share the springs, not the mechanics."
    )
    return Section("Equation 11", text, tuple(rows))


def _table_2() -> Section:
    rows = []
    for column, known_freedoms, values in (("theory", EQUATION_3, THEORY), ("FEA", TABLE_2_FEA, FEA)):
        for letter in "AB":
            found, source = gain(known(letter).restricted(known_freedoms)) / 3.0, "paper Table 2"
            rows += [
                Row(f"{column}, command {command:.0f} um, set {letter}", source, f"{value:.1f}", found * command, "um", Tolerance(0.1))
                for command, value in zip(COMMANDS, values, strict=True)
                if command > 0.0 and (letter == "B" or command == COMMANDS[-1])
            ]
    full = known("B").units["vertical"].gain / 3.0
    rows += [
        Row("gain, theory column", "paper Table 2, 585/600", "0.975", gain(known("B").restricted(EQUATION_3)) / 3.0),
        Row("gain, FEA column", "paper Table 2, 31/32", "0.96875", gain(known("B").restricted(TABLE_2_FEA)) / 3.0),
        Row("gain, all 6x6", "paper Table 2, 31/32", "0.96875", full, tolerance=Tolerance(5e-6), recorded=True),
    ]
    text = (
        "Theory column: what Eq. 3 knows. FEA column: the same with the bending of the front and pole hinges freed (`TABLE_2_FEA`). "
        "The full 6x6 model is off by a little more; what each freedom costs is on the page [costs](costs.md)."
    )
    return Section("Table 2", text, tuple(rows))
