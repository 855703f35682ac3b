"""Verification: comparison of theory with finite elements for hinges, units and the whole stage, with the errors of both, and verdicts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from flexstage.analysis.assessment.judge import Estimate
from flexstage.analysis.assessment.judge import required_values as judged
from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.pairing import RELIABLE, Moving, Pair, pair_modes
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.linear_statics.units import UnitResult, driven_units, unit_alone, units
from flexstage.analysis.trust import TheoryCheck
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.base.notebook import InNotebook
from flexstage.base.record import INNER, VIEW, Heading, Layout, Mark, UnitIn
from flexstage.base.units.quantity import RATIO
from flexstage.beams.compliance import compliance
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.drawn import calibrated_parts, with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.restrict import isolate
from flexstage.models.linear.model import LinearModel
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped
from flexstage.solid.fea.jobs.remote import Pool
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.ties import stated_links
from flexstage.solid.results.calibration import substitute_parts
from flexstage.solid.results.hinges import STANDARD_HINGES, Hinges, SolidHinge, hinges, solid_hinges
from flexstage.solid.results.plan import verification_plan, work_ahead
from flexstage.solid.results.read import STANDARD_SOLIDS, STANDARD_WAYS, Solids, read_solid, remember, solids
from flexstage.solid.results.resolution import DEFAULT, NOT_ESTIMATED, Converged, Resolution, converge
from flexstage.solid.results.stage import SolidStage, solid_stage, stage_figures, stiffness_figures
from flexstage.solid.results.units import SolidUnit, solid_units
from flexstage.spatial.frame import COMPONENTS

_CLOSE = 0.02
_GRADES = {
    TheoryCheck.DEPENDENT: Mark.FAINT,
    TheoryCheck.EITHER: Mark.PASS,
    TheoryCheck.THEORY: Mark.PASS,
    TheoryCheck.CALIBRATED: Mark.WARN,
    TheoryCheck.UNCLEAR: Mark.WARN,
    TheoryCheck.FEA: Mark.FAIL,
}
_TIMES = 1.5
"""Smallest ratio of theory and FEA for which differences are printed as factors."""
_WORDS = {
    "Hz": ("high", "low"),
    "N/m": ("stiff", "soft"),
    "N m/rad": ("stiff", "soft"),
    "m/N": ("soft", "stiff"),
    "rad/(N m)": ("soft", "stiff"),
}
"""Adjectives for theory by unit of the figure, if the figure of theory is too large and if it is too small."""
_SHOWN = UnitIn("shown_unit")


@dataclass(frozen=True)
class Row:
    """One quantity by theory and by FEA, in SI units.

    `theory` is the value of the lumped model, or of beam theory for a hinge. `mapped` is the value of the axial-spring model of Shin &
    Moon, if this model applies. `calibrated` is the value of the lumped model with compliance matrices of hinges from FEA. `fea_error` is
    the estimated relative error of FEA. `calibration` names the parts for which theory uses data from FEA. `modal_assurance` is the modal
    assurance criterion (MAC) of paired modes. Unknown values are `None`, and `reason` explains them. If `calibration` is empty, a verdict
    requires `theory` and `fea_error`.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Theory and finite elements: {self.group}",
        "figure mapped theory calibrated fea fea_error difference calibrated_difference modal_assurance trust",
    )

    group: str
    figure: str
    unit: str
    theory: Annotated[float | None, _SHOWN]
    fea: Annotated[float, _SHOWN, Heading("FEA")]
    fea_error: Annotated[float | None, RATIO, Heading("FEA error", digits=2, unit="%")]
    mapped: Annotated[float | None, _SHOWN] = None
    calibrated: Annotated[float | None, _SHOWN] = None
    calibration: tuple[str, ...] = ()
    modal_assurance: Annotated[float | None, Heading("MAC", digits=3)] = None
    reason: str | None = None

    @property
    def shown_unit(self) -> str:
        """Unit for tables: per cent for lost motion, else the SI unit."""
        return "%" if self.figure == "loss" else self.unit

    @property
    def difference(self) -> Annotated[float | None, RATIO, Heading("theory error", digits=3, unit="%")]:
        """Relative difference between theory and FEA: theory / FEA - 1."""
        return None if self.theory is None else _relative(self.theory, self.fea)

    @property
    def calibrated_difference(self) -> Annotated[float | None, RATIO, Heading("calibrated error", digits=3, unit="%")]:
        """Relative difference between calibrated theory and FEA: calibrated theory / FEA - 1."""
        return None if self.calibrated is None else _relative(self.calibrated, self.fea)

    @property
    def independent(self) -> Annotated[bool, VIEW]:
        """Whether theory contains no data from FEA."""
        return not self.calibration

    @property
    def trust(self) -> Annotated[TheoryCheck | None, VIEW, Heading(absent="no verdict", mark=_GRADES.__getitem__)]:
        """Verdict: the model that is reliable for this quantity; null without a verdict."""
        if self.calibration:
            return TheoryCheck.DEPENDENT
        if self.difference is None or self.fea_error is None:
            return None
        away = abs(self.difference)
        if self.fea_error > max(0.5 * away, _CLOSE):
            return TheoryCheck.UNCLEAR
        if away <= self.fea_error:
            return TheoryCheck.EITHER
        if away <= _CLOSE:
            return TheoryCheck.THEORY
        better = self.calibrated_difference
        if better is not None and abs(better) <= _CLOSE + self.fea_error:
            return TheoryCheck.CALIBRATED
        return TheoryCheck.FEA


def _relative(value: float, reference: float) -> float:
    return value / reference - 1.0 if reference else float("inf") if value else 0.0


@dataclass(frozen=True, eq=False)
class Verification(InNotebook):
    """Result of a verification: rows with the compared quantities, the results of the solid model, and `reasons` for missing groups."""

    mechanism: Mechanism
    rows: tuple[Row, ...]
    hinges: Annotated[Mapping[str, SolidHinge], INNER]
    units: Annotated[Converged[dict[str, SolidUnit]] | None, INNER]
    stage: Annotated[Converged[SolidStage] | None, INNER]
    reasons: Mapping[str, str]

    @property
    def groups(self) -> dict[str, tuple[Row, ...]]:
        """Rows by group: hinges, units, stage."""
        return groups(self.rows)

    @property
    def headline(self) -> str:
        """Summary of the last group (the stage): largest differences between theory and finite elements, number of agreeing quantities."""
        name, rows = list(self.groups.items())[-1]
        good = sum(row.trust in {TheoryCheck.EITHER, TheoryCheck.THEORY} for row in rows)
        words = departures(rows)
        return f"{words[:1].upper()}{words[1:]}{'. ' if words else ''}Theory suffices for {good} of {len(rows)} figures of the {name}."

    @property
    def as_stated(self) -> Annotated[Mapping[str, str], VIEW]:
        """Links without a shape, with the kind of their part; theory and FEA both use the specified stiffness and mass."""
        return stated_links(expand(with_drawn_parts(self.mechanism)))

    @property
    def verdicts(self) -> Annotated[Mapping[str, str], VIEW]:
        """Verdict on the models, in words, for each group of quantities."""
        return {name: verdict(rows) for name, rows in self.groups.items()}


def groups(rows: Iterable[Row]) -> dict[str, tuple[Row, ...]]:
    """Collect rows by group, in order of their first occurrence.

    >>> groups(())
    {}
    """
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row.group, []).append(row)
    return {name: tuple(each) for name, each in found.items()}


@check_arguments
def verify(
    mechanism: Mechanism,
    asked: Resolution = DEFAULT,
    reduce: Solids = STANDARD_SOLIDS,
    compute: Hinges = STANDARD_HINGES,
    tell: Callable[[tuple[Row, ...]], None] | None = None,
) -> Verification:
    """Compare theory with finite elements for every distinct hinge and unit and for the whole stage.

    Theory uses the design as it is, including calibrated hinges; FEA uses the drawn shapes of all hinges. Hinges are computed first, then
    the stage, then units. After each of these three groups, the function `tell` is called with the results of the group, one `Row` per
    quantity. `reduce` and `compute` are the functions that compute solids and hinges by FEA. If neither of these functions is specified,
    all FEA jobs run in one queue. Raises `DesignError` if the stage cannot be modelled as a solid.
    """
    if reduce is STANDARD_SOLIDS and compute is STANDARD_HINGES:
        with Pool() as pool:
            ways = replace(STANDARD_WAYS, pool=pool)
            work_ahead(verification_plan(mechanism, asked, ways, Accuracy()), ways)
            return verify(mechanism, asked, solids(ways), hinges(ways=ways), tell)
    missing = dict[str, str]()
    notify = tell or (lambda _rows: None)
    found = solid_hinges(mechanism, compute)
    of_hinges = tuple(hinge_rows(mechanism, found))
    notify(of_hinges)
    stage = stage_solid(mechanism, asked, reduce)
    of_stage = tuple(stage_rows(mechanism, substitute_parts(mechanism, found), stage))
    notify(of_stage)
    try:
        alone = units_solid(mechanism, asked, reduce) if driven_units(mechanism) else None
    except DesignError as error:
        alone, missing["units"] = None, str(error)
    if alone is None:
        missing.setdefault("units", "no unit of the stage drives its own output by one actuator")
    of_units = () if alone is None else tuple(unit_rows(mechanism, units_with_calibrated_hinges(mechanism, compute), alone))
    notify(of_units)
    return Verification(mechanism, (*of_hinges, *of_units, *of_stage), found, alone, stage, missing)


def stage_solid(mechanism: Mechanism, asked: Resolution = DEFAULT, reduce: Solids = STANDARD_SOLIDS) -> Converged[SolidStage]:
    """Compute the results of the whole stage as a solid, to the accuracy required by `asked`."""
    again = remember(reduce)
    return converge(
        lambda way: solid_stage(mechanism, way, again),
        lambda found: found.figures,
        asked,
        lambda found: found.read.sizes,
        lambda way: stage_figures(mechanism, way, again),
    )


@check_arguments
def required_values(mechanism: Mechanism, asked: Resolution = DEFAULT, reduce: Solids = STANDARD_SOLIDS) -> Estimate:
    """Compute by FEA the quantities that are limited by a stage's requirements, with estimated errors. Unknown values are left out.

    Strokes, stresses and frequencies are computed from the reduced solid model in the same way as from the lumped model. Stress at fillets
    includes the stress concentration factors of hinges.
    """
    again = remember(reduce)
    found = converge(
        lambda way: read_solid(mechanism, way, again), lambda read: judged(mechanism, read.model), asked, lambda read: read.sizes
    )
    return Estimate(judged(mechanism, found.result.model), {key: error for key, error in found.errors.items() if np.isfinite(error)})


def units_solid(
    mechanism: Mechanism, asked: Resolution = DEFAULT, reduce: Solids = STANDARD_SOLIDS, *, bare: bool = False
) -> Converged[dict[str, SolidUnit]]:
    """Compute every distinct isolated unit as a solid, to the accuracy required by `asked`.

    Keys of the errors have the form `unit: figure`. Components are reduced with modes, so that equal components of the stage need no
    further computation. With `bare`, components are reduced without modes; this does not change static results.
    """

    def figures(found: dict[str, SolidUnit]) -> dict[str, float]:
        return {f"{name}: {figure}": value for name, unit in found.items() for figure, value in unit.figures.items()}

    def sizes(found: dict[str, SolidUnit]) -> dict[str, int]:
        return {part: size for unit in found.values() for part, size in unit.read.sizes.items()}

    again = remember(reduce)

    def work(way: Reduction) -> dict[str, SolidUnit]:
        return solid_units(mechanism, replace(way, modes=0 if bare else way.modes, static=True), again)

    return converge(work, figures, asked, sizes)


def hinge_rows(mechanism: Mechanism, found: Mapping[str, SolidHinge]) -> Iterator[Row]:
    """Yield the rows of hinges: each separable direct compliance by FEA, and by beam theory or from the design file.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> list(hinge_rows(double_triangle(), {}))
    []
    """
    given = calibrated_parts(mechanism)
    links = {link.drawn: link for link in expand(mechanism).links.values()}
    for name, hinge in found.items():
        link = links.get(hinge.links[0]) or links[hinge.links[0].removeprefix("links.")]
        theory = np.diag(compliance(link.part, link.material))  # pyright: ignore[reportArgumentType]
        touched = (link.link.part,) if link.link.part in given else ()
        for index, axis in enumerate(COMPONENTS):
            if not hinge.separable[index]:
                continue
            unit = "m/N" if index < 3 else "rad/(N m)"
            value = float(np.real(theory[index]))
            fea = float(hinge.found.compliance[index, index])
            error = None if hinge.errors is None else float(hinge.errors[index])
            yield Row(f"hinge {name}", f"compliance {axis}", unit, value, fea, error, calibration=touched, reason=_why_unestimated(error))


def units_with_calibrated_hinges(mechanism: Mechanism, compute: Hinges = STANDARD_HINGES) -> dict[str, UnitResult]:
    """Compute isolated units by theory, with hinge compliances from FEA. Each hinge has the ends that it has in the isolated unit.

    If the output body of the isolated unit has no outlines, the hinge at the output has a rigid end there.
    """
    found: dict[str, UnitResult] = {}
    for unit, (copy, direction) in driven_units(mechanism).items():
        alone = isolate(mechanism, copy)
        found[unit] = unit_alone(substitute_parts(alone, solid_hinges(alone, compute)), copy, unit, direction, omissions=False)
    return found


def unit_rows(mechanism: Mechanism, better: Mapping[str, UnitResult], found: Converged[dict[str, SolidUnit]]) -> Iterator[Row]:
    """Yield the rows of isolated units: axial and lateral stiffness, gain and lost motion; `better` has the units with calibrated hinges.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> list(unit_rows(double_triangle(), {}, Converged({}, {}, 3)))
    []
    """
    theory = units(mechanism, omissions=False)
    for name, unit in found.result.items():
        touched = _calibrated_parts(mechanism, name)
        first, second = theory[name].figures, better[name].figures
        simple = _mapped_unit(theory[name])
        for figure, value in unit.figures.items():
            dimension = "1" if figure == "gain" else "N/m"
            error = _finite(found.errors.get(f"{name}: {figure}"))
            yield Row(
                group=f"unit {name}",
                figure=figure,
                unit=dimension,
                theory=first[figure],
                fea=value,
                fea_error=error,
                mapped=simple.get(figure),
                calibrated=second[figure],
                calibration=touched,
                reason=_why_unestimated(error, f"{name}: {figure}", found),
            )
        if unit.loss > 1e-4:
            gain = _finite(found.errors.get(f"{name}: gain"))
            error = None if gain is None else gain * (1.0 - unit.loss) / unit.loss
            values = (theory[name].loss, unit.loss, error)
            yield Row(
                f"unit {name}",
                "loss",
                "1",
                *values,
                None,
                better[name].loss,
                touched,
                reason=_why_unestimated(error, f"{name}: gain", found),
            )


def _mapped_unit(unit: UnitResult) -> dict[str, float]:
    """Figures of a unit from the paper's springs: Eq. 11 for levers, the series of axial springs for direct ones."""
    if unit.lever is not None:
        return {"axial stiffness": float(1.0 / unit.lever.tip_compliance), "gain": float(unit.lever.gain)}
    return {} if unit.series is None else {"axial stiffness": unit.series}


def _calibrated_parts(mechanism: Mechanism, unit: str | None) -> tuple[str, ...]:
    """The calibrated parts of a unit, or with `None` of the stage."""
    given = calibrated_parts(mechanism)
    links = [link.link for link in expand(mechanism).links.values() if unit is None or link.drawn.startswith(f"{unit}/")]
    return tuple(name for name in given if any(link.part == name for link in links))


def stage_rows(mechanism: Mechanism, matched: Mechanism, found: Converged[SolidStage]) -> Iterator[Row]:
    """Yield the rows of the stage: stiffness of the platform by direction, and platform modes paired by shape.

    `matched` is the stage with calibrated hinges.
    """
    touched = _calibrated_parts(mechanism, None)
    theories = {"theory": lumped(mechanism), "calibrated": lumped(matched), "mapped": _mapped_model(mechanism)}
    known = {name: model for name, model in theories.items() if model is not None}
    fea = found.result
    tables = {name: stiffness_figures(statics(model)) for name, model in known.items()}
    for figure, value in stiffness_figures(fea.statics).items():
        unit = "N m/rad" if figure.endswith(("rx", "ry", "rz")) else "N/m"
        extra = {name: table[figure] for name, table in tables.items() if np.isfinite(table[figure])}
        error = _finite(found.errors.get(figure))
        values = (extra.get("theory"), value, error, extra.get("mapped"), extra.get("calibrated"))
        reason = _why_unestimated(error, figure, found) if "theory" in extra else "the value of theory is not finite"
        yield Row("stage", figure, unit, *values, touched, reason=reason)
    own = Moving(fea.modes, fea.read.model)
    pairs = {name: pair_modes(own, Moving(platform_modes(mechanism, model), model)) for name, model in known.items()}
    for number, index in enumerate(fea.modes.platform):
        figure = f"platform mode {number + 1}"
        best = {name: pair[index] for name, pair in pairs.items() if index in pair}
        alike = {name: pair.frequency for name, pair in best.items() if pair.reliable}
        error = _finite(found.errors.get(figure))
        unestimated = _why_unestimated(error, figure, found)
        yield Row(
            group="stage",
            figure=f"{figure} ({fea.modes.names[index]})",
            unit="Hz",
            theory=alike.get("theory"),
            fea=float(fea.modes.frequencies[index]),
            fea_error=error,
            mapped=alike.get("mapped"),
            calibrated=alike.get("calibrated"),
            calibration=touched,
            modal_assurance=best["theory"].assurance if "theory" in best else None,
            reason=unestimated if "theory" in alike else _why_unpaired(best.get("theory")),
        )


def _why_unpaired(best: Pair | None) -> str:
    if best is None:
        return "theory has fewer modes than FEA"
    return f"no mode of theory matches: the best modal assurance is {best.assurance:.2f}, at {best.frequency:.4g} Hz ({RELIABLE} required)"


def _finite(error: float | None) -> float | None:
    """An error, if it is finite."""
    return error if error is not None and np.isfinite(error) else None


def _why_unestimated(error: float | None, figure: str = "", found: Converged[Any] | None = None) -> str | None:
    if error is not None:
        return None
    is_locked = found is not None and figure in found.unestimated
    return NOT_ESTIMATED if is_locked else "the error of FEA is unknown: no coarser result contains this value"


def _mapped_model(mechanism: Mechanism) -> LinearModel | None:
    try:
        return mapped(mechanism)
    except DesignError:
        return None


def verdict(rows: tuple[Row, ...]) -> str:
    """Format the verdict on theory from the rows of one group.

    >>> verdict((Row("stage", "mode 1", "Hz", 105.0, 100.0, 0.001, calibrated=100.5),))
    'Lumped theory is up to 5 % off (mode 1); with calibrated hinges, up to 0.5 %. Calibrate, then trust the lumped model.'
    """
    open_rows = [row for row in rows if row.difference is None or (row.fea_error is None and not row.calibration)]
    judged = [row for row in rows if row not in open_rows]
    if not judged:
        return f"No verdict. {_reasons(open_rows)}"
    text = _verdict_of_known(tuple(judged))
    return f"{text} No verdict on {len(open_rows)} of {len(rows)} figures. {_reasons(open_rows)}" if open_rows else text


def _reasons(rows: Iterable[Row]) -> str:
    reasons: dict[str, list[str]] = {}
    for row in rows:
        reasons.setdefault(row.reason or "unknown", []).append(row.figure)
    return " ".join(f"{', '.join(figures)}: {reason}." for reason, figures in reasons.items())


def departures(rows: Iterable[Row]) -> str:
    """Describe the differences between theory and finite elements: the worst quantity of every kind, and the cause if it is known.

    >>> row = Row("stage", "in-plane stiffness (softest), others free", "N/m", 2.14e6, 0.48e6, 0.01, calibrated=2.1e6)
    >>> departures([row, Row("stage", "mode 1", "Hz", 99.0, 100.0, 0.001)])
    'in-plane stiffness (softest), others free: theory 4.5 times too stiff (its bodies are rigid)'
    """
    worst: dict[str, Row] = {}
    for row in rows:
        if row.trust in {TheoryCheck.FEA, TheoryCheck.CALIBRATED} and _factor(row) > _factor(worst.get(row.unit)):
            worst[row.unit] = row
    return "; ".join(f"{row.figure}: theory {_departure(row)}" for row in worst.values())


def _factor(row: Row | None) -> float:
    """Ratio of theory and FEA, 1 and more; without a row, 1."""
    ratio = 1.0 if row is None or row.difference is None else 1.0 + row.difference
    return max(ratio, 1.0 / ratio) if ratio > 0.0 else float("inf")


def _departure(row: Row) -> str:
    above, factor = (row.difference or 0.0) > 0.0, _factor(row)
    more, less = _WORDS.get(row.unit, ("large", "small"))
    size = f"{factor:.2g} times" if factor >= _TIMES else _percent(_size_of_difference(row))
    rigid = above and more in {"stiff", "high"} and row.trust is TheoryCheck.FEA and row.calibrated is not None
    return f"{size} too {more if above else less}{' (its bodies are rigid)' if rigid else ''}"


def _verdict_of_known(rows: tuple[Row, ...]) -> str:
    """The verdict from rows with known difference and, unless they are not independent, known error."""
    worst = max(rows, key=_size_of_difference)
    least = max((row.fea_error for row in rows if row.fea_error is not None), default=0.0)
    off = f"up to {_percent(_size_of_difference(worst))} off ({worst.figure})"
    if any(row.calibration for row in rows):
        names = ", ".join(dict.fromkeys(name for row in rows for name in row.calibration))
        return f"Not independent: the theory contains compliance matrices of {names} from FEA. It is {off}; these hinges are not the cause."
    name = "Beam theory" if worst.group.startswith("hinge") else "Lumped theory"
    if all(row.trust in {TheoryCheck.EITHER, TheoryCheck.THEORY} for row in rows):
        return f"{name} is {off}, with an FEA error up to {_percent(least)}: trust the theory."
    known = departures(rows)
    if any(row.trust is TheoryCheck.UNCLEAR for row in rows):
        text = f"{name} is {off}, but the error of FEA is up to {_percent(least)}: increase the accuracy."
        return f"{known[:1].upper()}{known[1:]}. {text}" if known else text
    better = [abs(row.calibrated_difference) for row in rows if row.calibrated_difference is not None]
    if not better:
        return f"{name} is {off}, with an FEA error up to {_percent(least)}: trust FEA, or calibrate."
    after = f"with calibrated hinges, up to {_percent(max(better))}"
    if all(row.trust is not TheoryCheck.FEA for row in rows):
        return f"{name} is {off}; {after}. Calibrate, then trust the lumped model."
    rest = "The remaining difference is due to the elasticity of bodies and joints, which only the solid model includes. Trust FEA."
    return f"{known[:1].upper()}{known[1:]}; {after}. {rest}"


def _size_of_difference(row: Row) -> float:
    return abs(row.difference or 0.0)


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %"
