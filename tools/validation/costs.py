"""What simpler theories omit, freedom by freedom: gain and load term of a lever unit, frequencies of the stage, units alone."""

from __future__ import annotations

import numpy as np

import flexstage as fs
from flexstage.analysis.linear_statics.omitted import Omitted, omitted
from flexstage.cases.double_triangle import EQUATION_3, EQUATION_18
from flexstage.mechanism.restrict import restrict
from flexstage.models.lumped import Masses
from tools.validation.row import Row, Section, Tolerance, table
from tools.validation.stages import Known, known

_CHANNELS = {"gain": ("platform.z", "B4"), "load term": ("platform.z", "platform.fz")}


def sections() -> list[Section]:
    """The sections on costs."""
    return [*(_omitted(quantity) for quantity in _CHANNELS), _units(), *(_frequencies(known(letter)) for letter in "BA")]


def _omitted(quantity: str) -> Section:
    costs = {letter: omitted(known(letter).vertical(), EQUATION_3, _CHANNELS[quantity]) for letter in "BA"}
    freedoms = [name for name in costs["B"].changes if any(_share(each, name) > 5e-9 for each in costs.values())]
    lines = [("**what Eq. 3 knows**", *(_value(each, each.simple) for each in costs.values()))]
    lines += [(f"`{name}`", *(f"{100.0 * each.changes[name] / each.simple:+.4f} %" for each in costs.values())) for name in freedoms]
    lines += [
        ("combinations of them", *(f"{100.0 * each.interaction / each.simple:+.4f} %" for each in costs.values())),
        ("**full 6x6**", *(_value(each, each.full) for each in costs.values())),
    ]
    rows = tuple(
        Row(f"unexplained by single freedoms, set {letter}", "sum of costs", "0", each.unexplained, "1", Tolerance(1e-3))
        for letter, each in costs.items()
    )
    text = (
        f"The {quantity} of one vertical unit alone, its output guided. Each freedom that Eq. 3 locks or frees gets its elasticity back "
        "*alone*; listed is the change relative to the simple theory. Freedoms that change nothing are left out."
    )
    return Section(f"The {quantity} of a lever unit", text, rows, (table(("freedom", "set B, shipped", "set A"), lines),))


def _share(costs: Omitted, name: str) -> float:
    return abs(costs.changes[name] / costs.simple)


def _value(costs: Omitted, value: float) -> str:
    return f"{value:.6f}" if costs.input == "B4" else f"{1e6 * value:.6f} um/N"


def _units() -> Section:
    lines = []
    for letter in "BA":
        for name, unit in known(letter).units.items():
            series = "refused" if unit.series is None else f"{1e-6 * unit.series:.4f}"
            lateral = " to ".join(f"{1e-6 * value:.6f}" for value in unit.lateral)
            gains = (f"{unit.ideal_gain:.6g}", f"{unit.gain:.6f}", f"{100.0 * round(unit.loss, 9) + 0.0:.4f} %")
            lines.append((letter, name, f"{1e-6 * unit.axial:.4f}", lateral, series, *gains))
    heads = ("set", "unit", "K_a [N/um]", "K_l, soft to stiff [N/um]", "K_h or K_v [N/um]", "ideal gain", "gain", "loss")
    text = (
        "By the lumped model, the output free of rotation: K_a along its direction and K_l across. K_h or K_v is the unit in actuator "
        "coordinates, as the mapped model takes it. A lever's K_a is at its output; its gain is that of the guided unit."
    )
    return Section("Each unit alone", text, (), (table(heads, lines),))


def _frequencies(case: Known) -> Section:
    mapped = _six(fs.mapped(case.stage))
    steps = {
        "mapped (Eq. 28)": mapped,
        "lumped, restricted to Eq. 18, massless units": _six(_lumped(case, tuple(EQUATION_18))),
        **{f"... and `{name}` in full": _six(_lumped(case, tuple(part for part in EQUATION_18 if part != name))) for name in EQUATION_18},
        "lumped in full, massless units": _six(_lumped(case, ())),
        "lumped in full, with the masses of the units": _six(fs.lumped(case.stage)),
    }
    lines = [(step, *(f"{value:.3f}" for value in values), *_change(values, mapped)) for step, values in steps.items()]
    restricted = steps["lumped, restricted to Eq. 18, massless units"]
    worst = float(np.max(np.abs(restricted / mapped - 1.0)))
    rows = (Row("restricted lumped against mapped, worst of six", "mapped model", "0", worst, "1", Tolerance(1e-4)),)
    heads = ("model", *(f"{number} [Hz]" for number in range(1, 7)), "change against mapped")
    text = (
        f"Set {case.letter}: from the mapped model to the full lumped one. Each part alone is given its whole 6x6, the others staying "
        "as Eq. 18 has them; then all; then the bodies and links of the units get their masses."
    )
    return Section(f"Frequencies part by part, set {case.letter}", text, rows, (table(heads, lines),))


def _lumped(case: Known, simple: tuple[str, ...]) -> fs.LinearModel:
    return fs.lumped(restrict(case.stage, {name: EQUATION_18[name] for name in simple}), Masses.PLATFORM)


def _six(model: fs.LinearModel) -> np.ndarray:
    return fs.modes(model).platform_frequencies


def _change(values: np.ndarray, against: np.ndarray) -> tuple[str]:
    change = np.round(100.0 * (values / against - 1.0), 2) + 0.0
    low, high = float(np.min(change)), float(np.max(change))
    if low == high:
        return (f"{low:+.2f} %" if low else "none",)
    return (f"{low:+.2f} to {high:+.2f} %",)
