"""Hinges and leaves against finite elements and closed forms of the literature; the tables stand in tests/analytic."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

import flexstage as fs
from flexstage.base.number import Array
from flexstage.beams.profiled import concentration
from flexstage.parts.part import Elastic
from flexstage.spatial.frame import transport
from tests.analytic import closed_forms, test_leaf_plate, test_notch_profiles, test_paros_weisbord, test_smith_toroid
from tests.analytic.hinges import STEEL, UNIT, circular, diagonal, error
from tests.elsewhere import test_notch_elements
from tools.validation.row import Row, Section, Tolerance, beam_error, relative, table

_PLANE = "plane finite elements"
_NAMES = ("C_x", "C_y", "C_z", "C_rx", "C_ry", "C_rz")
_UNITS = ("mm/N",) * 3 + ("rad/(N mm)",) * 3


def sections() -> list[Section]:
    """The sections on single hinges."""
    notches = [_circular(), _worked(), _notch_solid(), _rigid_ends(), _filleted(), _elliptic(), _contours()]
    return [*notches, _concentration(), _toroid(), _leaf(), _reinforced(), _transport()]


def _diagonal(part: Elastic) -> Array:
    return np.asarray(diagonal(part, UNIT))


def _circular() -> Section:
    rows: list[Row] = []
    for ratio, rz, full, simplified, schotborgh, x, x_error, y, y_error in test_paros_weisbord.TABLE:
        found, size = _diagonal(circular(ratio)), (1.0, 1.0, ratio, 1.0)
        compared = (
            ("C_rz", rz, float(found[5]), "1/(E b R^2)", full),
            ("C_rz, Paros-Weisbord simplified", rz, _simplified(size), "1/(E b R^2)", simplified),
            ("C_rz, Schotborgh", rz, _schotborgh(size), "1/(E b R^2)", schotborgh),
            ("C_x", x, float(found[0]), "1/(E b)", x_error),
            ("C_y", y, float(found[1]), "1/(E b)", y_error),
        )
        rows += [
            Row(f"t/R = {ratio}: {name}", _PLANE, f"{true:g}", ours, unit, beam_error(error)) for name, true, ours, unit, error in compared
        ]
    text = (
        "Compliance about the centre of the notch alone, nu = 0.3, against converged 2-D finite elements (Q9, plane stress, blocks "
        "subtracted as beams). The tolerance is the error of beam theory itself, known from closed forms, to its last digit: ours must "
        "be *as wrong as beam theory*. C_rz by quadrature equals Paros & Weisbord (1965, full) and Wu & Zhou (2002)."
    )
    return Section("Circular notch", text, tuple(rows))


def _simplified(size: tuple[float, float, float, float]) -> float:
    return float(closed_forms.paros_weisbord_rotation_simplified(*size))


def _schotborgh(size: tuple[float, float, float, float]) -> float:
    return float(1.0 / closed_forms.schotborgh_rotation_stiffness(*size))


def _worked() -> Section:
    size = test_paros_weisbord.WORKED
    found = np.asarray(diagonal(circular(0.2, radius=5.0, width=10.0)))
    rows = (
        Row("C_rz", "Paros & Weisbord 1965, full", "1.539997e-5", float(found[5]), "rad/(N mm)"),
        Row("C_rz, simplified", "Paros & Weisbord 1965", "1.580583e-5", _simplified(size), "rad/(N mm)"),
        Row("K_rz", "Schotborgh et al. 2005", "61251", float(closed_forms.schotborgh_rotation_stiffness(*size)), "N mm/rad"),
        Row("C_x", "Wu & Zhou 2002", "2.46941e-6", float(found[0]), "mm/N"),
        Row("C_y, centre", "Wu & Zhou 2002 and shear", "2.81554e-5", float(found[1]), "mm/N"),
        Row("C_z, centre", "bending integral and shear", "8.97693e-6", float(found[2]), "mm/N"),
        Row("C_ry", "Wu & Zhou 2002", "2.96329e-7", float(found[4]), "rad/(N mm)"),
    )
    return Section("Circular notch, worked", "E = 200 GPa, nu = 0.3, R = 5, t = 1, b = 10 mm: closed forms to the digits printed.", rows)


def _notch_solid() -> Section:
    found = np.asarray(diagonal(fs.Notch("m", thickness=1.54, width=10.0, profile=fs.Circular(3.0))))
    source = "3-D finite elements, p = 5"
    rows = (
        Row("C_x", source, "1.586e-6", float(found[0]), "mm/N", beam_error(-20.0, 0.6)),
        Row("C_y", source, "7.06e-6", float(found[1]), "mm/N", beam_error(9.0, 0.6)),
        Row("C_rz", source, "4.306e-6", float(found[5]), "rad/(N mm)", beam_error(-9.7, 0.06)),
    )
    text = "t = 1.54, R = 3, b = 10 mm: hinge and root, full-height blocks subtracted as Timoshenko beams; beam theory's errors as known."
    return Section("Circular notch in 3-D", text, rows)


def _rigid_ends() -> Section:
    lines, rows = [], []
    for size, elements, stated in test_notch_elements.HINGES:
        found = np.asarray(error(diagonal(test_notch_elements.notch(size)), np.array(elements)))
        name = " x ".join(f"{value:g}" for value in size)
        lines.append((name, *(f"{value:+.1f}" for value in found)))
        worst = float(np.max(np.abs(found - np.array(stated))))
        rows.append(Row(f"t, R, b = {name}: departure from the errors stated", "3-D finite elements", "0", worst, "%", Tolerance(0.75)))
    heads = ("t x R x b [mm]", *(f"{part} [%]" for part in ("C_x", "C_y", "C_z", "C_rx", "C_ry", "C_rz")))
    text = (
        "Rigid bodies at the ends of the arcs, as beam theory assumes them: what is left is the error of the theory without root "
        "compliance, for all six freedoms. Elements: NGSolve, order 4 and 6, converged to 0.2 % and better; stored with the script "
        "that made them (`tests/elsewhere/notch_elements.py`). Below: error of our compliance in percent."
    )
    return Section("Circular notch in 3-D, rigid arc ends", text, tuple(rows), (table(heads, lines),))


def _concentration() -> Section:
    lines = []
    for name, stored, shape in (
        ("circle", test_notch_elements.CIRCLES, lambda: fs.Circular(1.0)),
        ("fillet", test_notch_elements.FILLETS, lambda: fs.Filleted(10.0, 1.0)),
    ):
        for ratio, tension, bending in stored:
            factor = float(concentration(shape(), ratio))
            errors = (f"{error(factor, true):+.1f} %" for true in (bending, tension))
            lines.append((name, f"{ratio:g}", f"{bending:.3f}", f"{tension:.3f}", f"{factor:.3f}", *errors))
    heads = ("notch", "t/R", "elements, bending", "elements, tension", "ours", "off in bending", "off in tension")
    text = "K_t = (1 + t/2R)^(9/20) (Smith, Flexures, 2000) against plane finite elements with full-height blocks: low in tension."
    return Section("Stress concentration", text, (), (table(heads, lines),))


def _errors(part: Elastic, label: str, numbers: Iterable[float], source: str = _PLANE, digit: float = 0.006) -> list[Row]:
    values = tuple(numbers)
    found = np.asarray(diagonal(part, STEEL))
    units = (("C_rz", 5, "rad/(N mm)"), ("C_x", 0, "mm/N"), ("C_y", 1, "mm/N"))
    return [
        Row(f"{label}: {name}", source, f"{true:.6e}", float(found[index]), unit, beam_error(error, 0.06 if error == -13.0 else digit))
        for (name, index, unit), true, error in zip(units, values[::2], values[1::2], strict=True)
    ]


def _filleted() -> Section:
    rows: list[Row] = []
    for each in test_notch_profiles.FILLETED:
        notch = fs.Notch("m", thickness=each[2], width=10.0, profile=fs.Filleted(each[0], each[1]))
        rows += _errors(notch, f"l, r, t = {each[0]:g}, {each[1]:g}, {each[2]:g} mm", each[3:9])
    return Section("Corner-filleted notch", "After Lobontiu (2003); b = 10 mm.", tuple(rows))


def _elliptic() -> Section:
    rows: list[Row] = []
    for each in test_notch_profiles.ELLIPTIC:
        notch = fs.Notch("m", thickness=each[2], width=10.0, profile=fs.Elliptic(each[0], each[1]))
        rows += _errors(notch, f"a, c, t = {each[0]:g}, {each[1]:g}, {each[2]:g} mm", each[3:9])
    return Section("Elliptic notch", "After Smith and Lobontiu; b = 10 mm.", tuple(rows))


def _contours() -> Section:
    rows: list[Row] = []
    for name, (_, *numbers) in test_notch_profiles.CONTOURS.items():
        rows += _errors(test_notch_profiles.contour(name), name, numbers, "3-D finite elements, ours", 0.012)
    text = (
        "t = 1, b = 5 mm, 10 mm long, cuts 3 mm high (the V: 4.17 mm), with blocks of full height, by `flexstage solid --scope hinge "
        "--accuracy 0.3%`. No law of these errors was fitted. Closed forms of Lobontiu et al. (2002) are met to rounding."
    )
    return Section("Parabolic, hyperbolic, power, V and free notches", text, tuple(rows))


def _toroid() -> Section:
    rows: list[Row] = []
    source = "axisymmetric finite elements"
    for ratio, rz, rz_error, smith, x, x_error in test_smith_toroid.TABLE:
        found = _diagonal(fs.Neck("m", thickness=ratio, profile=fs.Circular(1.0)))
        by_smith = float(1.0 / closed_forms.smith_toroid_rotation_stiffness(1.0, ratio, 1.0))
        rows += [
            Row(f"t/R = {ratio}: C_rz", source, f"{rz:g}", float(found[5]), "1/(E R^3)", beam_error(rz_error)),
            Row(f"t/R = {ratio}: C_rz, Smith", source, f"{rz:g}", by_smith, "1/(E R^3)", beam_error(smith)),
            Row(f"t/R = {ratio}: C_x", source, f"{x:g}", float(found[0]), "1/(E R)", beam_error(x_error)),
        ]
    return Section("Toroidal neck", "Two-axis round necks, nu = 0.3; Smith (2000): K = E t^7/2 / (20 R^1/2).", tuple(rows))


def _leaf() -> Section:
    rows: list[Row] = []
    thin = test_leaf_plate.THIN
    for width, guided, tip, moment, elements, closed in test_leaf_plate.TABLE:
        found = _diagonal(fs.Leaf("m", length=1.0, thickness=thin, width=width))
        rigidity = width * thin**3 / 12.0
        compared = (
            ("guided, on 12 EI/L^3", guided, 1.0 / (12.0 * rigidity * found[1])),
            ("tip force, on 3 EI/L^3", tip, 1.0 / (3.0 * rigidity * (found[1] + 0.25 * found[5]))),
            ("moment, on EI/L", moment, 1.0 / (rigidity * found[5])),
        )
        source, at = "plate finite elements", f"b/L = {width:g}"
        rows += [Row(f"{at}: {name}", source, f"{value:.4f}", float(ours), "1", Tolerance(8e-4)) for name, value, ours in compared]
        twist = float(1.0 / found[3] / (UNIT.shear * width * thin**3 / 3.0))
        rows.append(Row(f"{at}: torsion, on G b t^3/3L", "closed form, warping held", f"{closed:.4f}", twist, "1", Tolerance(6e-5)))
        rows.append(
            Row(f"{at}: torsion, on G b t^3/3L", source, f"{elements:.4f}", twist, "1", beam_error(100.0 * (closed / elements - 1.0)))
        )
    text = "Factors on beam stiffness, nu = 0.3. In torsion the closed form itself is softer than plate elements, by a known error."
    return Section("Leaf spring", text, tuple(rows))


def _reinforced() -> Section:
    rows: list[Row] = []
    for (width, thick), elements, errors in test_leaf_plate.REINFORCED:
        found = np.asarray(diagonal(test_leaf_plate.reinforced_in_mm(width, thick), STEEL))
        for name, unit, true, ours, percent in zip(_NAMES, _UNITS, elements, found, errors, strict=True):
            what = f"b = {width:g} mm, {thick:g} mm thick: {name}"
            rows.append(Row(what, "3-D finite elements, ours", f"{true:.5e}", float(ours), unit, beam_error(percent, 0.012)))
    text = (
        "40 mm long, 0.3 mm thin over 8 mm at both ends, between rigid faces, by `flexstage solid --scope hinge --accuracy 0.2%`. Three "
        "beams in series, the thin ones as plates between ends that cannot curve across them."
    )
    return Section("Reinforced leaf", text, tuple(rows))


def _transport() -> Section:
    hinge = circular(0.2, radius=5.0, width=10.0)
    about, end = np.diag(np.asarray(diagonal(hinge))), transport(np.array([5.0, 0.0, 0.0]))
    moved = end @ about @ end.T
    strips = 2000.0
    wide = np.asarray(diagonal(fs.Notch("m", thickness=1.0, width=strips, profile=fs.Circular(5.0))))
    ratio = wide[3] * strips**2 / (12.0 * wide[1])
    size = test_paros_weisbord.WORKED
    deflection = float(closed_forms.wu_zhou_end_deflection(*size) + closed_forms.wu_zhou_shear(STEEL.shear, *size[1:]))
    rows = (
        Row("C_y about the end", "Wu & Zhou 2002, bending and shear", f"{deflection:.9e}", float(moved[1, 1]), "mm/N", relative(1e-9)),
        Row("(y, rz) coupling over R C_rz", "Koseki et al. 2002", "1", float(moved[1, 5] / (5.0 * moved[5, 5])), "1", relative(1e-12)),
        Row("torsion of a wide notch (b = 400 R) over 12 C_y/b^2", "strips bending", "1", float(ratio), "1", relative(2e-5)),
    )
    return Section("6x6 about the end", "C about the end = X C X^T; torsion of a wide notch is the bending of its strips.", rows)
