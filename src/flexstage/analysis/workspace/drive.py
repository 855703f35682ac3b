"""Electrical drive: conversion between strokes and voltages, and charging currents of the stacks."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.workspace.stroke import stacks
from flexstage.base.finding import Finding, require
from flexstage.base.notebook import Result
from flexstage.base.number import Array, stack
from flexstage.base.record import Along, Heading, Layout
from flexstage.base.units.quantity import CAPACITANCE, PIEZO_GAIN, VOLTAGE
from flexstage.mechanism.mechanism import Mechanism


class Drive(Result):
    """Electrical data of the actuators: `gain` (..., n) [m/V], `low`, `high`, `bias` [V], `capacitance` [F] (NaN if not specified).

    The model is linear: the free stroke is proportional to the voltage, without hysteresis or creep.
    """

    TABLE: ClassVar[Layout] = Layout("Drive")

    actuators: tuple[str, ...]
    gain: Annotated[Array, PIEZO_GAIN, Along("actuators"), Heading(digits=5, unit="um/V")]
    low: Annotated[Array, VOLTAGE, Along("actuators"), Heading(digits=5)]
    high: Annotated[Array, VOLTAGE, Along("actuators"), Heading(digits=5)]
    bias: Annotated[Array, VOLTAGE, Along("actuators"), Heading(digits=5)]
    capacitance: Annotated[Array, CAPACITANCE, Along("actuators"), Heading(digits=5)]


def drive(mechanism: Mechanism) -> Drive:
    """Return the electrical data of a stage's actuators. The default bias is the middle of the voltage range.

    Raises `DesignError` for stacks without a voltage range.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> electric = drive(double_triangle())
    >>> (1e6 * electric.gain).round(3).tolist(), electric.bias.tolist()[0]
    ([0.15, 0.15, 0.15, 0.2, 0.2, 0.2], 500.0)
    """
    piezos = stacks(mechanism)
    require(
        Finding(name, "voltage range of the stack missing", 'Add e.g. voltage_low = "0 V" and voltage_high = "1000 V"')
        for name, piezo in piezos.items()
        if piezo.voltage_low is None or piezo.voltage_high is None
    )
    low = stack([piezo.voltage_low for piezo in piezos.values()])
    high = stack([piezo.voltage_high for piezo in piezos.values()])
    stroke = stack([piezo.stroke for piezo in piezos.values()])
    middle = [np.nan if piezo.bias is None else piezo.bias for piezo in piezos.values()]
    bias = stack(middle)
    return Drive(
        actuators=tuple(piezos),
        gain=stroke / (high - low),
        low=low,
        high=high,
        bias=np.where(np.isnan(np.real(bias)), 0.5 * (low + high), bias),
        capacitance=stack([np.nan if piezo.capacitance is None else piezo.capacitance for piezo in piezos.values()]),
    )
