"""The shipped stage optimised: our search beside scipy's derivative-free methods and pymoo, on one core, one problem, one run.

The problem is the study of docs/optimise.md: the lowest platform frequency as high as possible by seven numbers, within envelope, strokes,
lost motion and a safety factor of two. Ours: evaluations come with all derivatives. The others minimise the same objective with the same
limits from the same evaluation, without derivatives and without batches: as constraints where a method takes them (differential
evolution, COBYQA, pymoo), as an exact penalty where it takes none (Nelder-Mead). Each stops by its own tolerance, at MOST evaluations at
the latest. Seconds are those of the processor. Targets: 20 % more than as it stands, under 10 s, three starts that
agree, gradients within 1e-6 of differences.
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.optimize import NonlinearConstraint, differential_evolution, minimize

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.optimisation.search.optimum import optimise
from flexstage.studies.optimisation.search.problem import SPARE
from flexstage.studies.optimisation.setting import Setting, setting
from flexstage.studies.optimisation.values import Point
from flexstage.studies.sweeps.file import loads_study
from tests.docs.pages import blocks

GRADIENT, GAIN, SECONDS = 1e-6, 1.2, 10.0
MOST = int(sys.argv[1]) if len(sys.argv) > 1 else 600
PENALTY = 10.0
DIFFERENCE = 1e-4


class EnoughError(Exception):
    """The evaluations are used up."""


@dataclass
class Counted:
    """The problem for methods without derivatives: one design at a time, the last one remembered."""

    set_up: Setting
    count: int = 0
    best: float = -np.inf
    last: tuple[bytes, np.ndarray] | None = field(default=None)

    def at(self, shares: np.ndarray) -> np.ndarray:
        """The objective's c, then those of all limits; ten where there is no design."""
        key = np.asarray(shares, dtype=float).tobytes()
        if self.last is None or self.last[0] != key:
            if self.count >= MOST:
                raise EnoughError
            self.count += 1
            found = self.set_up.values.evaluate(np.clip(shares, 0.0, 1.0)[None])[0]
            problem = self.set_up.problem
            sides = (*problem.objective, *problem.limits)
            row = np.array([side.at(found) for side in sides]) if isinstance(found, Point) else np.full(len(sides), 10.0)
            if isinstance(found, Point) and problem.excess(found) <= SPARE:
                self.best = max(self.best, float(found.values[0]))
            self.last = (key, row)
        return self.last[1]

    def objective(self, shares: np.ndarray) -> float:
        """What is made least."""
        return float(self.at(shares)[0])

    def limits(self, shares: np.ndarray) -> np.ndarray:
        """What is not to be above nought."""
        return self.at(shares)[1:]

    def penalised(self, shares: np.ndarray) -> float:
        """Both in one, outside of the ranges too."""
        row = self.at(shares)
        outside = float(np.sum(np.maximum(0.0, np.abs(shares - 0.5) - 0.5)))
        return float(row[0] + PENALTY * (max(0.0, np.max(row[1:])) + outside))


def main() -> None:
    """Print the table."""
    study = loads_study(next(block.text for block in blocks("docs/optimise.md") if block.word("file") == "study.toml"))
    wanted = load_optimisation(study)
    set_up = setting(study, wanted)
    apart = gradient_error(set_up)
    print(f"gradients against differences: {apart:.1e} (relative, all measures and variables)")
    begun = time.process_time()
    found = optimise(study, wanted)
    seconds = time.process_time() - begun
    before, after = found.value(found.before), found.value(found.point) if found.point is not None else np.nan
    print(f"as it stands {before:.2f} Hz, optimum {after:.3f} Hz ({100.0 * (after / before - 1.0):+.1f} %),", end=" ")
    print(f"rounded {100.0 * found.improvement:+.1f} %; {found.agreeing} of {len(found.starts)} starts agree")
    met = apart < GRADIENT and after > GAIN * before and seconds < SECONDS and found.agreeing == len(found.starts)
    print(f"targets: {'met' if met else 'MISSED'}")
    print(f"\n{'method':46}{'evaluations':>12}{'time [s]':>10}{'feasible best [Hz]':>20}")
    tell("flexstage, three starts, with derivatives", sum(each.evaluated for each in found.starts), seconds, after)
    for title, run in RIVALS.items():
        counted = Counted(set_up)
        begun, said = time.process_time(), title
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                run(counted)
        except EnoughError:
            said = f"{title}, stopped at {MOST}"
        except ImportError:
            print(f"{title:46} not installed: make setup-oracles")
            continue
        tell(said, counted.count, time.process_time() - begun, counted.best)


def tell(title: str, count: int, seconds: float, value: float) -> None:
    """One line."""
    print(f"{title:46}{count:12d}{seconds:10.1f}{value:20.3f}", flush=True)


def gradient_error(set_up: Setting) -> float:
    """Largest difference from central differences over all measures and variables, relative to the measure or its largest slope."""
    shares = np.full(len(set_up.study.variables), 0.45) + 0.02 * np.arange(len(set_up.study.variables))
    exact = set_up.values(shares[None])[0]
    size = len(shares)
    around = set_up.values.evaluate(shares + DIFFERENCE * np.vstack([np.eye(size), -np.eye(size)]))
    values = np.array([point.values for point in around if isinstance(point, Point)])
    if isinstance(exact, str):
        raise RuntimeError(exact)
    differences = (values[:size] - values[size:]).T / (2.0 * DIFFERENCE)
    scale = np.maximum(np.max(np.abs(differences), axis=1), np.abs(exact.values))
    return float(np.max(np.abs(exact.gradient - differences) / scale[:, None]))


def evolution(counted: Counted) -> None:
    """Differential evolution, from a population of its own."""
    size = len(counted.set_up.study.variables)
    kept = NonlinearConstraint(counted.limits, -np.inf, 0.0)
    differential_evolution(counted.objective, [(0.0, 1.0)] * size, constraints=kept, rng=np.random.default_rng(0), polish=False, popsize=8)


def quadratic_models(counted: Counted) -> None:
    """COBYQA, from the design as it stands."""
    size = len(counted.set_up.study.variables)
    kept = NonlinearConstraint(counted.limits, -np.inf, 0.0)
    start = counted.set_up.before.shares
    minimize(counted.objective, start, method="COBYQA", bounds=[(0.0, 1.0)] * size, constraints=kept, options={"initial_tr_radius": 0.25})


def simplex(counted: Counted) -> None:
    """Nelder & Mead, from the design as it stands."""
    minimize(counted.penalised, counted.set_up.before.shares, method="Nelder-Mead", options={"maxfev": 10 * MOST})


def genetic(counted: Counted) -> None:
    """pymoo's NSGA-II with its own handling of constraints."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import ElementwiseProblem
    from pymoo.optimize import minimize as evolve

    size, kept = len(counted.set_up.study.variables), len(counted.set_up.problem.limits)

    class Stage(ElementwiseProblem):
        def __init__(self) -> None:
            super().__init__(n_var=size, n_obj=1, n_ieq_constr=kept, xl=0.0, xu=1.0)

        def _evaluate(self, x: np.ndarray, out: dict[str, object], *_: object, **__: object) -> None:
            row = counted.at(x)
            out["F"], out["G"] = row[0], row[1:]

    evolve(Stage(), NSGA2(pop_size=40), ("n_eval", MOST), seed=0, verbose=False)


RIVALS: dict[str, Callable[[Counted], None]] = {
    "scipy COBYQA": quadratic_models,
    "scipy Nelder-Mead with penalty": simplex,
    "scipy differential_evolution": evolution,
    "pymoo NSGA-II": genetic,
}

if __name__ == "__main__":
    main()
