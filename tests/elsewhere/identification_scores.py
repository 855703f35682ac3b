"""How near modes that anybody finds are to the true ones: flexstage's and those of `identification_peers`, from the same records."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

import flexstage
from flexstage.experiment.identification.identify import identify
from tests.elsewhere.identification_peers import PEERS, Modes, Way, handed_over
from tests.models.identification_study import Case, assurance
from tests.models.synthetic_records import Truth, record, truth

NEAR, FAR = 0.01, 1e3
OURS = ("flexstage", flexstage.__version__, Way("by itself", alone=True))
ERRORS = ("frequency, %", "damping, %", "1 - MAC", "real shapes")

Row = tuple[str, str, Way]


@dataclass(frozen=True)
class Score:
    """Of one record: worst errors (4,) in the order of ERRORS, true modes missed, modes that are not there, seconds of processor."""

    errors: np.ndarray
    missed: int
    wrong: int
    seconds: float


def scored(known: Truth, found: Modes, way: Way, seconds: float) -> Score:
    away = np.abs(found.frequencies[None, :] / known.frequencies[:, None] - 1.0)
    likeness = assurance(known.shapes, found.shapes)
    cost = np.where(away < NEAR, away / NEAR + 1.0 - likeness, FAR)
    pairs = linear_sum_assignment(cost)
    true, pick = (each[cost[pairs] < FAR] for each in pairs)
    wrong = len(found.frequencies) - len(true) if way.alone else 0
    if not len(true):
        return Score(np.full(4, np.inf), len(known.frequencies), wrong, seconds)
    frequency = 100.0 * np.max(away[true, pick])
    damping = 100.0 * np.max(np.abs(found.damping[pick] / known.damping[true] - 1.0))
    shape = 1.0 - np.min(likeness[true, pick])
    plain = 1.0 - np.min(assurance(known.shapes, real(found.shapes))[true, pick])
    return Score(np.array([frequency, damping, shape, plain]), len(known.frequencies) - len(true), wrong, seconds)


def real(shapes: np.ndarray) -> np.ndarray:
    """Shapes turned to their most real phase, without what is then left of an imaginary part."""
    return np.real(shapes * np.exp(-0.5j * np.angle(np.sum(shapes.astype(complex) ** 2, axis=0))))


def one_record(case: Case, seed: int) -> dict[Row, Score]:
    """What everybody finds in one record."""
    known = truth(case.frequencies, seed=1000 + seed)
    made = record(known, seed, noise=case.noise, seconds=case.seconds)
    start = time.process_time()
    found = identify(made)
    mine = Modes(found.frequencies, found.damping, found.shapes)
    scores = {OURS: scored(known, mine, OURS[2], time.process_time() - start)}
    data = handed_over(made, known.frequencies)
    for peer in PEERS:
        if peer.version is None:
            continue
        start = time.process_time()
        every = peer.modes(data)
        seconds = time.process_time() - start
        scores |= {(peer.package, peer.version, way): scored(known, each, way, seconds) for way, each in zip(peer.ways, every, strict=True)}
    return scores


def medians(records: list[dict[Row, Score]]) -> dict[Row, np.ndarray]:
    """Median errors (4,) of everybody over records."""
    return {row: np.median([each[row].errors for each in records], axis=0) for row in records[0]}
