"""Stability of a loop: its poles, the slowest pole and its source, and the stable range of gains."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, require
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.units.quantity import FREQUENCY, RATE
from flexstage.control.plant_models.reduction import mode_names
from flexstage.control.systems.closed import Loop, LoopBreak, open_at
from flexstage.control.systems.curves import rates_of
from flexstage.control.systems.system import System

_UP, _DOWN, _FARTHEST = 1.08, 0.6, 1000.0
_ROUNDING = 1e-12
_ALIKE = 1e-3


@dataclass(frozen=True)
class Pole:
    """Closed-loop pole with its source.

    The pole pair p has the `frequency` [Hz], the growth rate `growth` [1/s] (negative: decay) and the damping `ratio` -growth / |p|.
    `source` is the mode or device with the largest participation in the pole (`mode 3 at 126 Hz`, `controller`, `amplifier B1`, `gauge S1`,
    `delayed strokes`); `share` is this participation. `coordinate` is the coordinate with the largest error; errors in rotation are
    multiplied by the stage's length.
    """

    frequency: Annotated[float, FREQUENCY]
    growth: Annotated[float, RATE]
    ratio: float
    source: str
    share: float
    coordinate: str


@dataclass(frozen=True, eq=False)
class Verdict(InNotebook):
    """Stability of a loop, which is stable if all closed-loop poles decay. Hold and delay are modelled exactly.

    `slowest_pole` is the least stable pole. `poles` (k,) are all poles as rates [1/s], least stable first; a pole z of a loop with the
    sampling time T has the rate (ln z)/T. With all commands multiplied by one factor, the loop is stable for factors from `gain_low` to
    `gain_high`. For a stable loop, this interval contains 1 (0 and infinite: no limit within a factor of 1000). For an unstable loop, these
    limits belong to the nearest stable interval below 1 (NaN: no stable factor down to 1/1000). `sentence` summarises the verdict.
    """

    stable: bool
    slowest_pole: Pole
    poles: Array
    gain_low: float
    gain_high: float
    sentence: str


@check_arguments
def verdict(closed: Loop) -> Verdict:
    """Determine the stability of a loop from the eigenvalues of its closed system.

    A pole has a left eigenvector l and a right eigenvector r. The participation of a mode in the pole is the sum of |l_k r_k| over the
    states k of the mode (Perez-Arriaga, Verghese, Schweppe 1982). Modes with frequencies within 0.1 % of one another are treated as one
    mode. At a gain limit, the growth rate changes sign. The search for gain limits starts at a stable gain factor. It increases the factor
    in steps of 8 %, and decreases the factor in steps of 40 %.

    >>> from flexstage.control.example import integral_loop
    >>> verdict(integral_loop()).stable, verdict(integral_loop(gain=1e4)).slowest_pole.source
    (True, 'mode 2 at 1674 Hz')
    >>> found = verdict(integral_loop(gain=1e5))
    >>> found.stable, found.gain_high < 1.0
    (False, True)
    """
    least, rates = _least(closed)
    stable = _is_stable(closed, least)
    low, high = _interval(closed, stable=stable)
    return Verdict(stable, least, rates, low, high, f"{_sentence(closed, least)}; {_gain_words(low, high, stable=stable)}")


def _least(closed: Loop) -> tuple[Pole, Array]:
    poles, right = np.linalg.eig(closed.system.A)
    rates = rates_of(poles, closed.step, 1e-300)
    order = np.lexsort((np.imag(rates) < 0.0, -np.round(np.real(rates), 9)))
    worst = int(order[0])
    left = _left(closed.system.A, poles[worst])
    parts = np.abs(left.conj() * right[:, worst])
    source, share = max(_participation_by_owner(closed, parts / np.sum(parts)).items(), key=lambda item: item[1])
    least = Pole(
        frequency=float(abs(rates[worst].imag)) / (2.0 * np.pi),
        growth=float(rates[worst].real),
        ratio=float(-rates[worst].real / max(abs(rates[worst]), 1e-300)),
        source=source,
        share=float(share),
        coordinate=_coordinate(closed, right[:, worst]),
    )
    return least, rates[order]


def _is_stable(closed: Loop, least: Pole) -> bool:
    """A pole without decay beyond rounding is not stable."""
    fastest = 1.0 / closed.step if closed.step is not None else float(np.max(np.abs(closed.system.poles), initial=0.0))
    return least.growth < -_ROUNDING * fastest


def _interval(closed: Loop, *, stable: bool) -> tuple[float, float]:
    """Command factors between which the loop is stable."""
    open_loop = open_at(closed, LoopBreak.COMMAND)
    start, up, down = 1.0, round(np.log(_FARTHEST) / np.log(_UP)), round(-np.log(_FARTHEST) / np.log(_DOWN))
    if not stable:
        found = [factor for factor in _UP ** -np.arange(1.0, up + 1) if _growth(open_loop, factor) < 0.0][:1]
        if not found:
            return np.nan, np.nan
        start = float(found[0])
    high, low = _edge(open_loop, start, _UP, up if stable else 1), _edge(open_loop, start, _DOWN, down)
    return (0.0 if low is None else low), (np.inf if high is None else high)


def _edge(open_loop: System, start: float, ratio: float, steps: int) -> float | None:
    """First factor, from a stable one, at which the loop becomes unstable."""
    inside = start
    for _ in range(steps):
        outside = inside * ratio
        if _growth(open_loop, outside) >= 0.0:
            found: Any = scipy.optimize.brentq(lambda log: _growth(open_loop, np.exp(log)), np.log(inside), np.log(outside), xtol=1e-13)
            return float(np.exp(found))
        inside = outside
    return None


def _growth(open_loop: System, factor: float) -> float:
    """Growth rate [1/s] of the loop with its commands multiplied."""
    inverse = np.linalg.inv(np.eye(len(open_loop.D)) + factor * open_loop.D)
    return replace(open_loop, A=open_loop.A - factor * open_loop.B @ inverse @ open_loop.C).growth


def require_stable(closed: Loop, what: str) -> None:
    """Raise `DesignError` if a loop is unstable; `what` names quantities that an unstable loop does not have (margins, rms values).

    The message contains growth rate and source of the least stable pole.

    >>> from flexstage.control.example import integral_loop
    >>> require_stable(integral_loop(), "rms values")
    """
    if closed.system.growth < 0.0:
        return
    advice = "Reduce the gain, or filter or damp the source"
    require([Finding("loop", f"no {what} for an unstable loop: {_sentence(closed, _least(closed)[0])}", advice)])


def _left(A: Array, pole: complex) -> Array:
    """Left eigenvector of a pole by a separate solve: registers make A defective at 0, so that the full set does not exist."""
    values, vectors = np.linalg.eig(A.T)
    return vectors[:, int(np.argmin(np.abs(values - pole)))].conj()


def _participation_by_owner(closed: Loop, parts: Array) -> Counter[str]:
    """Participations summed by owner of the states."""
    result = Counter[str]()
    for name, part in zip(closed.states, parts.tolist(), strict=True):
        result[_owner(closed, name)] += part
    return result


def _owner(closed: Loop, state: str) -> str:
    kind, _, rest = state.partition(".")
    if kind.startswith("mode"):
        return _modes(closed, kind.rstrip("'"))
    if kind == "held":
        return "delayed strokes"
    return "controller" if kind == "controller" else f"{kind} {rest.partition('.')[0]}"


def _modes(closed: Loop, name: str) -> str:
    """A mode and those with nearly the same frequency; a plant may have retained others than the lowest."""
    kept = mode_names(closed.plant)
    frequencies = dict(zip(kept, closed.plant.frequencies.tolist(), strict=True))
    alike = [each for each in kept if abs(frequencies[each] - frequencies[name]) <= _ALIKE * frequencies[name]]
    shown = ", ".join(each.removeprefix("mode") for each in alike)
    return f"mode{'s' if len(alike) > 1 else ''} {shown} at {frequencies[name]:.4g} Hz"


def _coordinate(closed: Loop, vector: Array) -> str:
    names = closed.plant.coordinates.names
    rows = [closed.system.output_names.index(f"error.{name}") for name in names]
    size = np.abs(closed.system.C[rows] @ vector) * closed.plant.coordinates.scale
    return names[int(np.argmax(np.round(size / max(np.max(size), 1e-300), 6)))]


def _sentence(closed: Loop, least: Pole) -> str:
    where = f"{least.frequency:.4g} Hz" if least.frequency > 0.0 else "0 Hz (without oscillation)"
    comes = f"mainly due to {least.source} ({100.0 * least.share:.0f} % participation); its error is largest in {least.coordinate}"
    if _is_stable(closed, least):
        return f"stable; the slowest pole, at {where}, decays at {-least.growth:.4g} 1/s, {comes}"
    return f"a pole at {where} grows at {least.growth:.4g} 1/s, {comes}"


def _gain_words(low: float, high: float, *, stable: bool) -> str:
    if np.isnan(low):
        return "no smaller gain makes the loop stable"
    span = f"{'between' if low else 'below'} {f'{low:.4g} and ' if low else ''}{high:.4g}"
    if not stable:
        return f"the loop is stable with all commands multiplied by a factor {span}"
    return "no upper gain limit" if np.isinf(high) and not low else f"it remains stable with all commands multiplied by a factor {span}"
