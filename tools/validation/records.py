"""Modes found in records against those that the records were made of."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import flexstage as fs
from flexstage.cases.registry import case
from flexstage.experiment import NoiseDrive, RigSetup, Search, Sensing
from tests.models.identification_study import CASES, Case, assurance, paired, subspace_degrees
from tests.models.synthetic_records import record, truth
from tools.validation.row import Row, Section, Tolerance, relative

_SEED = 0
_SETUP = RigSetup(seconds=60.0, seed=1, drive=NoiseDrive(stroke=0.5 * fs.um), sensing=Sensing(density=1.0 * fs.nm))


def sections() -> list[Section]:
    """One section a made-up case, and one of the shipped stage on the virtual rig."""
    return [*(_made_up(each) for each in CASES), _rig()]


def _made_up(study: Case) -> Section:
    text = (
        f"Six modes, six simultaneous inputs, {study.seconds:g} s at 2048 Hz, white noise of {100.0 * study.noise:g} % of each "
        "output's rms; one record. `benchmarks/identification.py` prints errors over many records beside the least that statistics allow."
    )
    return Section(f"Six modes, {study.name}", text, tuple(_rows(study)))


def _rows(study: Case) -> Iterator[Row]:
    known = truth(study.frequencies, seed=1000 + _SEED)
    found = fs.experiment.identify(record(known, _SEED, noise=study.noise, seconds=study.seconds))
    yield Row("modes found", "made of", "6", float(len(found.frequencies)), "1", Tolerance(0.0))
    order = paired(known, found)
    shapes = found.shapes[:, order]
    for mode, index in enumerate(order):
        source = f"made of, mode {mode + 1}"
        yield Row("natural frequency", source, f"{known.frequencies[mode]:.2f}", found.frequencies[index], "Hz", relative(5e-4))
        yield Row("damping ratio", source, f"{known.damping[mode]:.4f}", found.damping[index], "1", relative(0.03))
    yield Row("least MAC", "made of", "1", float(np.min(np.diagonal(assurance(known.shapes, shapes)))), "1", Tolerance(0.01))
    for pair in ([0, 1], [3, 4]):
        angle = subspace_degrees(known.shapes[:, pair], shapes[:, pair])
        yield Row(f"angle of the plane of modes {pair[0] + 1} and {pair[1] + 1}", "made of", "0", angle, "deg", Tolerance(5.0))


def _rig() -> Section:
    stage = case("double-triangle")
    model = fs.lumped(stage)
    known = fs.modes(model, limit=1000.0)
    found = fs.experiment.compare(stage, fs.experiment.identify(fs.experiment.rig(stage, model, _SETUP), Search(band=(80.0, 220.0))))
    rows = tuple(
        Row(f"{row.name}, frequency", "lumped model", f"{theory:.4f}", row.experiment.frequency, "Hz", relative(5e-4))
        for row, theory in zip(found.modes, known.platform_frequencies, strict=True)
        if row.experiment is not None
    )
    text = "The shipped stage with its threefold pairs: 60 s of white noise in all actuators, gauges of 1 nm/Hz^0.5 and steps of 10 nm."
    return Section("The paper's stage on the virtual rig", text, rows)
