"""Seeded records of a stage: its lumped modes under white noise at the strokes, gauges read with noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexstage.analysis.complete import platform_modes
from flexstage.experiment.records.record import Channel, Record, Role
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.lumped import lumped
from tests.models.synthetic_records import Truth, record


def stage_truth(mechanism: Mechanism) -> Truth:
    """The platform's modes, damped by 1 to 1.5 %: shapes at the gauges in um, participations of the strokes."""
    model = lumped(mechanism)
    found = platform_modes(mechanism, model)
    chosen = list(found.platform)
    natural = 2 * np.pi * found.frequencies[chosen]
    seen = model.output[list(model.output_index(gauges(mechanism)))] @ found.shapes[:, chosen]
    driven = found.shapes[:, chosen].T @ model.input_matrix[:, list(model.input_index(model.strokes))]
    damping = np.linspace(0.01, 0.015, len(chosen))
    return Truth(found.frequencies[chosen], damping, 1e6 * seen, 1e-6 * driven / natural[:, None] ** 2)


def gauges(mechanism: Mechanism) -> tuple[str, ...]:
    return tuple(channel.name for channel in lumped(mechanism).outputs if "." not in channel.name)


def stage_record(
    mechanism: Mechanism, seed: int = 1, *, seconds: float = 20.0, noise: float = 0.02, active: tuple[int, ...] | None = None
) -> Record:
    """What the rig's amplifiers [V] and the gauges [um] record at 1024 Hz; only `active` actuators are there if stated."""
    made = record(stage_truth(mechanism), seed, seconds=seconds, rate=1024.0, noise=noise, active=active)
    names = [Channel(name, "V", Role.INPUT) for name in lumped(mechanism).strokes]
    names += [Channel(name, "um", Role.OUTPUT) for name in gauges(mechanism)]
    named = replace(made, channels=tuple(names))
    if active is None:
        return named
    driven = [each.name for index, each in enumerate(named.inputs) if index in active]
    return named.select([*driven, *(each.name for each in named.outputs)])
