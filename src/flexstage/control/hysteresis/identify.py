"""Hysteresis identification: from a record of voltage and stroke to an invertible Prandtl-Ishlinskii model."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.control.hysteresis.branches import MAJOR, branches_of, record_findings
from flexstage.control.hysteresis.fit import Fit, drift_of, fit_form, form_of, known_from, play_outputs
from flexstage.control.hysteresis.models.inverse import inverse_findings
from flexstage.control.hysteresis.models.shape import Range, major_loop
from flexstage.control.hysteresis.result import IdentifiedHysteresis, Trial

_PLAYS = (2, 4, 8, 16, 32)
_PIECES = (2, 4, 8)
_REACHES = (0.4, 0.5)
_WORTH = 1.05
_FARTHER = 0.8
_SAMPLES = 2500
_FOLDS = 3
_ROUNDS = 6
_DRIFT = 0.02
_POOR = 0.1
_LARGE = 0.02
_COVERED = 0.9


def identify_hysteresis(volts: Array, strokes: Array, *, limits: Range | None = None) -> IdentifiedHysteresis:
    """Identify the hysteresis of a stack from `volts` (k,) [V] and `strokes` (k,) [m], in recorded order.

    Thresholds are evenly spaced from 0 to below 0.4 of the voltage range. The thresholds extend to below 0.5 of the range only if this
    reduces the error by a fifth. The envelope before the plays has pieces of equal width. A least-squares fit (`fit_form`) gives weights of
    0 or more and slopes above 0, so that an inverse exists. Cross-validation selects the numbers of plays and pieces: the smallest model
    whose error is at most 1.05 times the smallest error found. Samples at which plays still depend on their initial state are not fitted.
    The model is rate independent: the record must be slow compared with the stage's first mode, and fast compared with creep. `limits` are
    the actuator's voltage limits: a record with a smaller voltage range causes a warning.

    Raises `DesignError` for a record without valid hysteresis (see `record_findings`), and for a drift above 2 % or an rms error above 10 %
    of the stroke.

    >>> from flexstage.control.hysteresis.models.bouc_wen import bouc_wen
    >>> legs = [np.linspace(a, b, 60) for a, b in ((0, 1e3), (1e3, 0), (0, 1e3), (1e3, 200), (200, 800), (800, 0), (0, 600), (600, 0))]
    >>> volts = np.concatenate(legs)
    >>> found = identify_hysteresis(volts, bouc_wen(150e-6, (0.0, 1000.0), 0.15).run(volts))
    >>> found.rms < 0.015, found.inner, round(found.width, 2)
    (True, 3, 0.15)
    """
    volts, strokes = np.asarray(volts, dtype=float), np.asarray(strokes, dtype=float)
    require(record_findings(volts, strokes))
    rows = _sample_rows(volts)
    search = _Search(volts[rows], strokes[rows])
    found = _assess(search, search.best(), limits)
    require(_result_findings(found))
    return found


def _sample_rows(volts: Array) -> Array:
    """Samples for the fit: evenly spaced ones, and all turning points."""
    even = np.linspace(0, len(volts) - 1, min(len(volts), _SAMPLES)).astype(int)
    turns = [place for branch in branches_of(volts, 0.01) for place in (branch.start, branch.stop)]
    return np.unique(np.concatenate([even, np.array(turns, dtype=int)]))


class _Search:
    """Model sizes tried on one record, each once."""

    def __init__(self, volts: Array, strokes: Array) -> None:
        self.volts, self.strokes = volts, strokes
        self.range = float(np.min(volts)), float(np.max(volts))
        self.branches = branches_of(volts)
        self.size = float(np.ptp(strokes[self.branches[0].stop :]))
        self.trials: list[Trial] = []

    def best(self) -> Trial:
        """Select plays with a straight envelope first, then pieces, plays again, and the largest threshold."""
        chosen = self._pick((plays, 1, _REACHES[0]) for plays in _PLAYS)
        bent = self._pick((chosen.plays, pieces, _REACHES[0]) for pieces in (1, *_PIECES))
        if bent.pieces > 1:
            bent = self._pick((plays, bent.pieces, _REACHES[0]) for plays in _PLAYS)
        near, far = (self._trial(bent.plays, bent.pieces, reach) for reach in _REACHES)
        return far if far.error < _FARTHER * near.error - 1e-9 else near

    def fit(self, trial: Trial) -> Fit:
        """Fit one size on the whole record."""
        form = form_of(self.range, trial.plays, trial.pieces, reach=trial.reach)
        return fit_form(self.volts, self.strokes, form, np.full(len(self.volts), fill_value=True))

    def _pick(self, sizes: Iterable[tuple[int, int, float]]) -> Trial:
        """First size, from the smallest, about as good as the best."""
        tried = [self._trial(*size) for size in sizes]
        least = min(trial.error for trial in tried)
        return next(trial for trial in tried if trial.error <= _WORTH * least + 1e-9)

    def _trial(self, plays: int, pieces: int, reach: float) -> Trial:
        for trial in self.trials:
            if (trial.plays, trial.pieces, trial.reach) == (plays, pieces, reach):
                return trial
        form = form_of(self.range, plays, pieces, reach=reach)
        known = np.arange(len(self.volts)) >= known_from(self.volts, form.thresholds)
        fold = self._folds(np.flatnonzero(known))
        squares = 0.0
        for number in range(_FOLDS):
            kept = fold == number
            fit = fit_form(self.volts, self.strokes, form, ~kept, rounds=_ROUNDS)
            error = fit.strokes(play_outputs(fit.effective(self.volts), fit.thresholds)) - self.strokes
            squares += np.sum(error[kept] ** 2)
        self.trials.append(Trial(plays, pieces, reach, float(np.sqrt(squares / np.sum(known))) / self.size))
        return self.trials[-1]

    def _folds(self, known: Array) -> Array:
        """Fold of each sample, -1 before the plays are known: pairs of branches in turns, or blocks for few branches."""
        fold = np.full(len(self.volts), -1)
        starts = np.array([branch.start for branch in self.branches])
        if len(starts) < 4 * _FOLDS:
            fold[known] = np.arange(len(known)) * 4 * _FOLDS // len(known) % _FOLDS
        else:
            fold[known] = (np.searchsorted(starts, known, side="right") - 1) // 2 % _FOLDS
        return fold


def _assess(search: _Search, best: Trial, limits: Range | None) -> IdentifiedHysteresis:
    fit = search.fit(best)
    effective = fit.effective(search.volts)
    plays = play_outputs(effective, fit.thresholds)
    modelled = fit.strokes(plays)
    known = known_from(effective, fit.thresholds)
    error = (modelled - search.strokes)[known:] / search.size
    model = fit.model()
    inner = int(np.sum([branch.swing < MAJOR * np.ptp(search.volts) for branch in search.branches]))
    rms = float(np.sqrt(np.mean(error**2)))
    return IdentifiedHysteresis(
        model=model,
        range=search.range,
        stroke=search.size,
        rms=rms,
        largest=float(np.max(np.abs(error))),
        validation=best.error,
        width=float(major_loop(model, search.range, count=201, cycles=1).width[0]),
        drift=drift_of(plays[known:], search.strokes[known:]) / search.size,
        branches=len(search.branches),
        inner=inner,
        known_from=known,
        trials=tuple(search.trials),
        warnings=tuple(_warnings(search, rms, inner, limits)),
        volts=search.volts,
        strokes=search.strokes,
        modelled=modelled,
    )


def _warnings(search: _Search, rms: float, inner: int, limits: Range | None) -> Iterator[Finding]:
    low, high = search.range
    if not inner:
        what = "no inner loops: the response after reversals within the range is extrapolated from the major loop"
        yield Finding("record", what, "Also record loops within the range")
    if rms > _LARGE:
        what = f"large rms error, {rms:.1%} of the stroke: the record may be too fast, or the hysteresis rate dependent"
        yield Finding("record", what, "Record more slowly, and compare the errors")
    if limits and high - low < _COVERED * (limits[1] - limits[0]):
        part = (high - low) / (limits[1] - limits[0])
        what = f"{low:g} V to {high:g} V is only {part:.0%} of the actuator's range: outside, the model is extrapolated linearly"
        yield Finding("record", what, "Record the whole range, or operate within the recorded range")


def _result_findings(found: IdentifiedHysteresis) -> Iterator[Finding]:
    if abs(found.drift) > _DRIFT:
        what = f"the stroke drifts by {found.drift:.1%} of its range ({1e6 * found.drift * found.stroke:.3g} um) over the record"
        yield Finding("stroke", what, "Let the stage settle before the test, record faster to reduce creep, or subtract the drift")
    elif found.rms > _POOR:
        what = f"the rms error of the best model is {found.rms:.1%} of the stroke: the hysteresis is probably rate dependent"
        yield Finding("record", what, "Record more slowly, and check that voltage and stroke belong to the same stack")
    yield from inverse_findings(found.model)
