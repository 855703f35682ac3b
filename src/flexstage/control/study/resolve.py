"""Complete set-up with defaults from the stage: rate, delay, hardware, plant, floor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexstage.analysis.complete import loaded_model, platform_modes
from flexstage.analysis.dynamics.random_response import Spectrum
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.analysis.loaded.load_effect import LoadEffect, load_effect
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array, Table
from flexstage.control.damping.charge import ChargedStacks, at_constant_charge, describe_charge, leak_charge
from flexstage.control.damping.damped_plant import ActiveDamping
from flexstage.control.damping.legs import Leg, legs
from flexstage.control.plant_models.electronics import ChargeDrive, GaugeSettings, Hardware, sampling_chain
from flexstage.control.plant_models.measured_plant import measured_plant
from flexstage.control.plant_models.plants import Plant, plant
from flexstage.control.plant_models.reduction import reduce_modes, resonances
from flexstage.control.study.checks import setup_findings
from flexstage.control.study.choices import Compensation, ControllerKind
from flexstage.control.study.damping import damp
from flexstage.control.study.hardware.floor import floor_spectra
from flexstage.control.study.setup import GaugeSetup, LoopSetup
from flexstage.experiment.identification.identified import Identified
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.theory import Model

if TYPE_CHECKING:
    from flexstage.analysis.loaded.operating_point import OperatingPoint

_USUAL = 10e3
_OVER_HIGHEST = 10.0
_LEAST_OVER_HIGHEST = 4.0
_MOST_LATE = 50
_RESONANCE = 0.01
"""Modes with at least this resonance, relative to a static stroke, are retained initially; others by the controller's loop gain."""


@dataclass(frozen=True, eq=False)
class ResolvedSetup:
    """Set-up completed for a stage: its kinematics, linear model, plant, and the floor's spectra by input.

    `plant` has the retained modes, or the specified number of modes. `whole` has all modes of the model; `stage` has all modes too, but no
    inner loops. `highest` [Hz] is the frequency of the n-th lowest platform mode, where n is the number of coordinates of the loop. If
    `displaced` is true, the model is linearised at an operating point, including its deflection. `loaded` is the effect of permanent load
    on the nominal stage; if it is significant, the model is the loaded stage. With a measured plant, `predicted` is the model's plant.
    `damping` describes the force feedback, `charge` the charge amplifiers. `plant` and `whole` include both, if specified. In `model`,
    stacks have the stiffness at constant voltage, which is correct for statics. `solid` is the finite-element stage, if that is the model.
    `carried` (n,) [m] are the strokes of load feedforward.
    """

    mechanism: Mechanism
    setup: LoopSetup
    kinematics: Kinematics
    model: LinearModel
    plant: Plant
    whole: Plant
    floor: Mapping[str, Spectrum]
    highest: float
    displaced: bool = False
    predicted: Plant | None = None
    damping: ActiveDamping | None = None
    loaded: LoadEffect | None = None
    charge: ChargedStacks | None = None
    solid: FeaModes | None = None
    stage: StagePlant | None = None
    carried: Array | float = 0.0

    @property
    def model_name(self) -> str:
        """Name of the plant's model."""
        return self.setup.model.value if self.solid is None else f"solid, elements of order {self.solid.order}"

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return self.plant.hardware.rate or np.inf

    @property
    def step(self) -> float:
        """Time between samples [s]."""
        return 1.0 / self.rate


def resolve(mechanism: Mechanism, setup: LoopSetup, there: OperatingPoint | None = None, solid: FeaModes | None = None) -> ResolvedSetup:
    """Complete a set-up for the nominal stage, an operating point, or the loaded stage if its permanent load is significant.

    With a `solid`, the model is the nominal finite-element stage, with the kinematics of the ideal stage.

    Raises `DesignError` for errors of the set-up, for gauges that cannot observe the pose, and for actuators that cannot produce it. The
    error is also raised for missing stack data that amplifiers need, for a sampling rate too low for the platform's modes, and for a model
    without stiffness.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = resolve(double_triangle(), LoopSetup())
    >>> found.rate, found.plant.coordinates.names, round(found.highest, 1)
    (10000.0, ('x', 'y', 'z', 'rx', 'ry', 'rz'), 173.1)
    """
    require(setup_findings(setup))
    asked = solid is None and there is None and setup.model is Model.LUMPED
    kinematics, loaded = ideal(mechanism), load_effect(mechanism) if asked else None
    drives = len(kinematics.actuators) + len(kinematics.thrusts)
    if not kinematics.coordinates or not drives:
        what = f"the platform has {len(kinematics.coordinates)} ideal motions and {drives} actuators"
        raise refuse("loop", f"{what}: no motion to control", "Release a motion in the design, and add an actuator for it")
    model = solid.model if solid is not None else there.linear if there is not None else loaded_model(mechanism, setup.model)
    if model is None:
        raise refuse("model", "rigid bodies have no stiffness and no modes", "Use model lumped or mapped")
    require(_force_findings(kinematics, setup))
    setup = _settle(setup, forced=bool(kinematics.thrusts))
    charged, drives = _charges(mechanism, model, setup)
    moving = at_constant_charge(model, charged, drives) if drives else model
    highest = highest_platform_mode(mechanism, moving, len(kinematics.coordinates))
    rate = setup.rate if setup.rate is not None else default_rate(highest)
    delay = setup.delay if setup.delay is not None else 1.0 / rate
    require(_timing_findings(rate, highest, delay * rate))
    given = _hardware(mechanism, setup, rate, delay)
    sensed = () if setup.damping is None else legs(mechanism, moving, setup.damping.gauges)
    links = tuple(dict.fromkeys((*(each.sensed for each in sensed), *(each.link for each in charged))))
    stage = StagePlant(plant(moving, kinematics, given, modes=len(moving.stiffness_matrix), links=links), moving, charged, drives, sensed)
    if setup.modes is None:
        slow = stage.plant.frequencies < 0.5 * rate
        found = reduce_modes(stage.plant, slow & (resonances(stage.plant) >= _RESONANCE))
    else:
        found = plant(moving, kinematics, given, modes=setup.modes, links=links)
    base = ResolvedSetup(
        mechanism=mechanism,
        setup=setup,
        kinematics=kinematics,
        model=model,
        plant=found,
        whole=stage.plant,
        floor=Table(floor_spectra(setup.floor)),
        highest=highest,
        displaced=there is not None,
        loaded=loaded,
        solid=solid,
        stage=stage,
    )
    return _with_inner_loops(base, found, stage)


def retain_modes(given: ResolvedSetup, wanted: Array) -> ResolvedSetup:
    """Return the same set-up with the `wanted` modes (k,) of the whole plant; inner loops are designed with these modes.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> found = resolve(parallelogram(), LoopSetup())
    >>> more = retain_modes(found, found.whole.frequencies < 5e3)
    >>> len(found.plant.frequencies), len(more.plant.frequencies)
    (1, 7)
    """
    if given.stage is None:
        return given
    return _with_inner_loops(given, reduce_modes(given.stage.plant, wanted), given.stage)


def _with_inner_loops(given: ResolvedSetup, found: Plant, stage: StagePlant) -> ResolvedSetup:
    """Set-up with this plant of the stage, behind charge amplifiers and with force feedback, if specified."""
    whole, charge, damping = stage.plant, None, None
    if stage.drives:
        charge = describe_charge(found, given.model, stage.moving, stage.drives)
        kept = tuple(each.sensed for each in stage.sensed)
        found, whole = (leak_charge(each, stage.charged, stage.drives, kept) for each in (found, whole))
    if given.setup.damping is not None:
        found, whole, damping = damp(found, whole, stage.moving, stage.sensed, given.setup.damping)
    return replace(given, plant=found, whole=whole, damping=damping, charge=charge)


@dataclass(frozen=True, eq=False)
class StagePlant:
    """Stage with all modes of its model and without inner loops, from which reduced plants are derived.

    In the model `moving`, the legs `charged` have constant charge; `drives` are the charge drives of these legs. `sensed` are the legs with
    force feedback.
    """

    plant: Plant
    moving: LinearModel
    charged: tuple[Leg, ...]
    drives: Mapping[str, ChargeDrive]
    sensed: tuple[Leg, ...]


def _charges(mechanism: Mechanism, model: LinearModel, setup: LoopSetup) -> tuple[tuple[Leg, ...], Mapping[str, ChargeDrive]]:
    """Legs with charge drive, and their drives; empty without any."""
    if setup.amplifier.settings.charge is None:
        return (), {}
    powers = sampling_chain(mechanism, amplifiers=setup.amplifier.settings).amplifiers
    drives = Table({name: each.charge for name, each in powers.items() if each.charge is not None})
    return tuple(each for each in legs(mechanism, model, asked="amplifier") if each.actuator in drives), drives


def on_test(given: ResolvedSetup, found: Identified) -> ResolvedSetup:
    """Return the set-up with the identified plant of a test instead of its model. Raises `DesignError` as `measured_plant` does.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> on_test(resolve(parallelogram(), LoopSetup()), identify(one_mode_record()))
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: --record: B: no input channel in the record has this name. Use u; a loop needs ...
    --record: S: no output channel in the record has this name. Use y; a loop needs all actuators and gauges.
    """
    if given.setup.damping is not None:
        raise refuse(
            "damping",
            "the identified plant has no leg forces to feed back",
            "Record the stage with its inner loops closed, and remove damping",
        )
    seen = measured_plant(given.plant, given.model, found)
    return replace(given, plant=seen, whole=seen, predicted=given.plant, stage=None)


def _settle(setup: LoopSetup, *, forced: bool) -> LoopSetup:
    """Default controller: force-driven masses need phase lead above their resonance."""
    asked = setup.controller
    kind = ControllerKind.PID if forced and not asked.stated and asked.kind is None else asked.law
    fed = tuple(each for each in setup.compensate if not forced or each is not Compensation.LOST_MOTION)
    return replace(setup, controller=replace(asked, kind=kind), compensate=fed)


def _force_findings(kinematics: Kinematics, setup: LoopSetup) -> Iterator[Finding]:
    """Findings for stack options of a force-driven stage."""
    thrusts = f"but the stage has force actuators ({', '.join(kinematics.thrusts)})"
    if not kinematics.thrusts:
        return
    if setup.hysteresis is not None:
        yield Finding("hysteresis", f"hysteresis needs stacks, {thrusts}", "Remove hysteresis")
    if setup.amplifier.settings.charge is not None:
        advice = 'Remove kind = "charge": coil amplifiers control the current'
        yield Finding("amplifier.kind", f"charge drive needs stacks, {thrusts}", advice)
    if Compensation.LOAD in setup.compensate:
        what = "load compensation is not supported for force actuators"
        yield Finding("compensate", what, 'Remove "load" from compensate: the integrator of the controller supplies the forces')


def highest_platform_mode(mechanism: Mechanism, model: LinearModel, count: int) -> float:
    """Return the `count`-th lowest frequency [Hz] of the platform modes, which are along ideal motions.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> round(highest_platform_mode(parallelogram(), lumped(parallelogram()), 1), 1)
    875.4
    """
    return float(np.sort(platform_modes(mechanism, model).platform_frequencies)[:count][-1])


def default_rate(highest: float) -> float:
    """Choose the default sampling rate [Hz]: 10 kHz, or for fast stages ten times the highest platform mode, rounded up by `round_up`.

    >>> default_rate(173.0), default_rate(2853.9)
    (10000.0, 50000.0)
    """
    return round_up(max(_USUAL, _OVER_HIGHEST * highest))


def round_up(value: float) -> float:
    """Round up to 1, 2 or 5 times a power of ten.

    >>> round_up(0.03)
    0.05
    """
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= value * (1.0 - 1e-9)))


def _timing_findings(rate: float, highest: float, samples: float) -> Iterator[Finding]:
    if rate < _LEAST_OVER_HIGHEST * highest:
        what = f"sampling at {rate:g} Hz is only {rate / highest:.3g} times the highest platform mode of {highest:.4g} Hz"
        yield Finding("rate", what, f"Use at least {_LEAST_OVER_HIGHEST * highest:.4g} Hz, preferably {_OVER_HIGHEST * highest:.0f} Hz")

    if samples > _MOST_LATE:
        what = f"too long (got {samples:.4g} samples, expected {_MOST_LATE} or less)"
        yield Finding("delay", what, "Reduce delay, or use a lower sampling rate")


def _hardware(mechanism: Mechanism, setup: LoopSetup, rate: float, delay: float) -> Hardware:
    return sampling_chain(
        mechanism,
        rate=rate,
        delay=delay,
        amplifiers=setup.amplifier.settings,
        gauges={name: _sensing(setup.gauges, item.unit) for name, item in expand(mechanism).gauges.items() if not item.members},
    )


def _sensing(gauges: GaugeSetup, unit: str) -> GaugeSettings:
    """Gauge settings for that unit: noise and steps of a set-up belong to displacement gauges."""
    return GaugeSettings(
        bandwidth=gauges.bandwidth,
        noise_density=gauges.noise if unit == "m" else None,
        resolution=gauges.resolution if unit == "m" else None,
        filter_order=gauges.filter_order,
        filter_corner=gauges.filter_corner,
    )
