"""The parameter sets SM-REF-A and SM-REF-B: springs, mappings, stiffness, frequencies and strokes derived from the paper's numbers."""

from __future__ import annotations

import numpy as np

import flexstage as fs
from flexstage.analysis.workspace.gauging import gauge_range
from flexstage.analysis.workspace.stroke import single_axis, stroke_limits
from flexstage.beams.stress import stress
from flexstage.cases.double_triangle import EQUATION_3, SM_REF_A, TABLE_2_FEA, double_triangle
from flexstage.models.lumped import Masses
from flexstage.parts.mass import mass_properties
from tools.validation.row import Row, Section, Tolerance, relative
from tools.validation.stages import Known, gain, known, with_plate

MM, UM, URAD = fs.mm, fs.um, fs.urad
SPRINGS = {
    "A": ("400.1", "47390", "50.79", "54757", "389611", "29.788", "3.1819", "28.637", "0.97503", "0.96869"),
    "B": ("541.9", "64192", "70.659", "74151", "537548", "30.996", "3.3642", "30.2776", "0.97499", "0.96875"),
}
UNITS = {
    "A": (("each 2-D hinge", "52.27"), ("K_a,h", "10.300"), ("K_l,h in plane", "0.00120"), ("K_l of a vertical unit", "0.0302")),
    "B": (("each 2-D hinge", "52.268"), ("K_a,h", "10.300"), ("K_l,h in plane", "0.00120"), ("K_l,h out of plane", "0.00056")),
}
PLATFORM = {"A": ("13.9965", "0.13402", "0.26710"), "B": ("13.9965", "0.134016", "0.267100")}
STIFFNESS = {
    "A": ("15.4501e6", "15.4501e6", "9.54559e6", "80660.3", "80660.3", "223254"),
    "B": ("15.4499e6", "15.4499e6", "10.09255e6", "82322.5", "82322.5", "223250"),
}
FREQUENCIES = {
    "A": ("123.473", "123.473", "131.435", "145.507", "167.215", "167.215"),
    "B": ("110.910", "110.910", "135.148", "145.505", "176.690", "176.690"),
}
DETERMINANTS = {"A": ("-3.59125e-4", "-0.02278125"), "B": ("-3.0600e-4", "-0.01482975")}
NAMES = ("x", "y", "z", "rx", "ry", "rz")


def sections() -> list[Section]:
    """The sections on both sets."""
    both = [section for letter in "AB" for section in (_springs(known(letter)), _stage(known(letter)))]
    return [*both, _variants(), _strokes(), _bounds()]


def _springs(case: Known) -> Section:
    foot, pivot, neck = case.part("foot_notch"), case.part("lever_notch"), case.part("pole_neck")
    found = (
        ("K_a1, front and back hinge", 1e-6 / foot[0], "N/um"),
        ("K_theta1", 1e3 / foot[5], "N mm/rad"),
        ("K_3, both pole hinges in series", 1e-6 * case.lever.pole, "N/um"),
        ("K_theta3", 1e3 / neck[5], "N mm/rad"),
        ("K_theta2, lever hinge", 1e3 / pivot[5], "N mm/rad"),
        ("K_1, Eq. 5", 1e-6 * case.lever.drive, "N/um"),
        ("K_tip", 1e-6 / case.lever.tip_compliance, "N/um"),
        ("K_v in actuator coordinates", 1e-6 * case.lever.stiffness, "N/um"),
        ("gain with what Eq. 3 knows", gain(case.restricted(EQUATION_3)) / 3.0, "1"),
        ("gain with K_theta1 and K_theta3", gain(case.restricted(TABLE_2_FEA)) / 3.0, "1"),
    )
    source = f"derived, set {case.letter}"
    rows = [
        Row(what, source, value, float(ours), unit, None if len(value) < 6 else relative(2e-5))
        for value, (what, ours, unit) in zip(SPRINGS[case.letter], found, strict=True)
    ]
    return Section(f"Set {case.letter}: springs", _SPRINGS_TEXT[case.letter], (*_single_units(case), *rows))


def _single_units(case: Known) -> list[Row]:
    horizontal, vertical = case.units["horizontal"], case.units["vertical"]
    found = {
        "each 2-D hinge": 1.0 / case.part("neck")[0],
        "K_a,h": horizontal.axial,
        "K_l,h in plane": horizontal.lateral[1],
        "K_l,h out of plane": horizontal.lateral[0],
        "K_l of a vertical unit": vertical.lateral[1],
    }
    rounded = {"K_l of a vertical unit": Tolerance(1e-4)}
    return [
        Row(what, f"derived, set {case.letter}", value, 1e-6 * float(found[what]), "N/um", rounded.get(what))
        for what, value in UNITS[case.letter]
    ]


_SPRINGS_TEXT = {
    "A": "SM-REF-A, for formulas: it cannot be built. Springs of single hinges by beam theory, then of the lever unit.",
    "B": "SM-REF-B, buildable, the shipped case.",
}


def _stage(case: Known) -> Section:
    source = f"derived, set {case.letter}"
    mapped = fs.mapped(case.stage)
    diagonal = np.diag(mapped.stiffness_matrix)
    modes = fs.modes(mapped)
    sets = zip(DETERMINANTS[case.letter], (case.ideal.mapping.values, case.ideal.gauge_mapping.values), ("det R_a", "det R_s"), strict=True)
    rows = [*_platform(case)]
    rows += [Row(name, source, value, float(np.linalg.det(matrix)), "", relative(1e-5)) for value, matrix, name in sets]
    rows += [
        Row(f"K_{name}{name}, Eq. 23", source, value, float(ours), "N/m" if number < 3 else "N m/rad", relative(1e-5))
        for number, (value, ours, name) in enumerate(zip(STIFFNESS[case.letter], diagonal, NAMES, strict=True))
    ]
    if case.letter == "B":
        rows.append(Row("K_x,ry", source, "-386246", float(mapped.stiffness_matrix[0, 4]), "N", relative(1e-5)))
    rows += [
        Row(f"frequency {number}, {name}", f"Eq. 28, set {case.letter}", value, float(ours), "Hz", relative(1e-5))
        for number, (value, ours, name) in enumerate(zip(FREQUENCIES[case.letter], modes.frequencies, modes.names, strict=True), start=1)
    ]
    text = "Ideal and mapped model (Eqs. 13, 14, 17-28). The order, out of plane first, is that of the paper's Fig. 10."
    return Section(f"Set {case.letter}: mappings, stiffness, frequencies", text, tuple(rows))


def _platform(case: Known) -> list[Row]:
    matrix = fs.mapped(case.stage).inertia_matrix
    found = ((0, "mass", "kg"), (3, "I_xx", "kg m^2"), (5, "I_zz", "kg m^2"))
    return [
        Row(f"platform, {name}", f"derived, set {case.letter}", value, float(matrix[index, index]), unit)
        for value, (index, name, unit) in zip(PLATFORM[case.letter], found, strict=True)
    ]


def _variants() -> Section:
    rows: list[Row] = []
    arms = {"short_arm": "15 mm", "long_arm": "45 mm", "lever_notch_width": "30 mm", "foot_notch_width": "30 mm"}
    lever = Known("simple", double_triangle(SM_REF_A, arms)).lever
    rows += [
        Row("r_1 = 15, r_2 = 45 mm: K_theta2", "derived", "194806", 1e3 * float(lever.pivot), "N mm/rad"),
        Row("K_1", "derived", "32.89", 1e-6 * float(lever.drive), "N/um"),
        Row("gain", "derived", "0.97435", float(lever.gain) / 3.0),
    ]
    for name, radii, plate, frequencies in _LAYOUTS:
        wide = double_triangle(SM_REF_A, {"horizontal_radius": radii[0] * MM, "pole_radius": radii[1] * MM})
        modes = fs.modes(fs.mapped(with_plate(wide, *(size * MM for size in plate))))
        rows += [
            Row(f"{name}: {modes.names[index]}", "derived", value, float(modes.frequencies[index]), "Hz", Tolerance(0.011))
            for value, index in zip(frequencies, (0, 2, 3, 4), strict=True)
        ]
    full = fs.modes(fs.lumped(known("A").stage, Masses.PLATFORM)).frequencies
    rows.append(Row("set A with all hinges' bending: x, y", "derived", "167.715", float(full[5]), "Hz", relative(1e-5)))
    return Section("Variants of set A", "The same formulas with other arms, radii and plates (edge, thickness, hole in mm).", tuple(rows))


_LAYOUTS = (
    ("r_h 102.3, rho 136.4, plate 380/20/140", (102.3, 136.4), (380.0, 20.0, 140.0), ("92.13", "111.80", "124.47", "142.24")),
    ("r_h 95, rho 145, plate 360/15/120", (95.0, 145.0), (360.0, 15.0, 120.0), ("125.67", "134.37", "148.25", "170.95")),
)


def _strokes() -> Section:
    case = known("A")
    mapping = case.ideal.mapping
    limits = single_axis(mapping, stroke_limits(case.stage))
    rows = [
        Row(f"single-axis stroke {name}, both ways", "derived, set A", value, float(stroke / UM), "urad" if name[0] == "r" else "um")
        for name, value, stroke in zip(NAMES, ("75", "86.6", "300", "2308", "2665", "882"), limits.symmetric, strict=True)
    ]
    corner = np.array([50 * UM, 50 * UM, 0.0, 0.0, 0.0, 244.35 * URAD])
    needed = float(np.max(np.abs(mapping.values[:3]) @ corner))
    rows += [
        Row("rz 244 urad needs", "derived, set A", "20.8", float(mapping.at("B1", "rz")) * 244.35 * URAD / UM, "um"),
        Row("rx 733 urad needs", "derived, set A", "31.8", float(mapping.at("B4", "rx")) * 733.04 * URAD / UM, "um"),
        Row("corner x, y 50 um, rz 244 urad needs (of 75)", "derived, set A", "89", needed / UM, "um"),
        Row("gauges: z 150 um with one tilt, largest radius", "derived", "136.4", 1e3 * _gauge_radius(("rx",)), "mm"),
        Row("the same with both tilts", "derived", "96", 1e3 * _gauge_radius(("rx", "ry")), "mm"),
        *_stresses(case),
    ]
    text = "Around the middle of each stack's range; nominal stress at 600 um of tip travel."
    return Section("Strokes, gauges and stress", text, tuple(rows))


def _gauge_radius(tilts: tuple[str, ...]) -> float:
    command = {"z": 150 * UM, **dict.fromkeys(tilts, 733.04 * URAD)}
    return float(np.min(gauge_range(known("B").stage, known("B").ideal, command).largest_anywhere[3:]))


def _stresses(case: Known) -> list[Row]:
    turn = 600 * UM / float(case.lever.long_arm)
    rows = []
    for name, value, text in (("lever_notch", "345", "lever hinge"), ("foot_notch", "317", "front hinge")):
        moment = np.array([0.0, 0.0, 0.0, 0.0, 0.0, turn / case.part(name)[5]])
        found = stress(case.stage.parts[name], case.stage.materials["steel"], moment)
        rows.append(Row(f"nominal stress, {text}", "derived, set A", value, 1e-6 * float(found.nominal) if found else 0.0, "MPa"))
    return rows


def _bounds() -> Section:
    rows: list[Row] = []
    ratio = (3.18 / 10.30) ** 0.5
    for edge, hole, k_xx, k_zz, low, high, rho in _PLATES:
        thin = fs.Block("steel", (edge * MM, edge * MM, 1e-3 * MM), hole=(hole * MM, hole * MM))
        found = mass_properties(fs.Body(solids={"plate": thin}), known("A").stage.materials)
        if found is None:
            raise ValueError("the plate has no mass")
        across, about = (1e3 * float(np.sqrt(found.inertia[axis, axis] / found.mass)) for axis in (0, 2))
        plate, source = f"plate {edge:.0f} ({hole:.0f})", "derived from Fig. 10's order"
        rows += [
            Row(f"{plate}: radius of gyration k_xx", source, k_xx, across, "mm"),
            Row(f"{plate}: k_zz", source, k_zz, about, "mm"),
            Row(f"{plate}: least r_h", source, low, ratio * about, "mm"),
            Row(f"{plate}: largest r_h", source, high, about / 2**0.5, "mm"),
            Row(f"{plate}: largest rho", source, rho, across * 2**0.5, "mm"),
        ]
    text = "What the order of the modes in Fig. 10 demands of the radii, for square plates (edge, hole in mm): rho < 2^1/2 k_xx and so on."
    return Section("Geometry bounds", text, tuple(rows))


_PLATES = (
    (300.0, 100.0, "91.3", "129.1", "72", "91", "129"),
    (320.0, 110.0, "97.7", "138.1", "77", "98", "138"),
    (360.0, 120.0, "109.5", "154.9", "86", "110", "155"),
    (380.0, 140.0, "116.9", "165.3", "92", "117", "165"),
)
