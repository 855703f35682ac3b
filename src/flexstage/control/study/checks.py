"""Checks of a set-up that do not require a stage."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from flexstage.base.finding import Finding
from flexstage.control.study.choices import SEARCHED, Axis, Compensation, ControllerKind, Following, Notching
from flexstage.control.study.setup import (
    ControllerSetup,
    DampingSetup,
    FileMotion,
    Floor,
    FollowSetup,
    GaugeSetup,
    HystereticStacks,
    LoopSetup,
    RasterMotion,
    SineMotion,
    StepMotion,
    TrajectorySetup,
    VibrationSetup,
)
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import number_findings

_TUNED = ("bandwidth", "sensitivity", "goal")


def setup_findings(setup: LoopSetup) -> Iterator[Finding]:
    """Check a set-up for values out of bounds and for contradictory keys. Each finding names its key.

    >>> from flexstage.control.study.setup import GaugeSetup
    >>> [str(each) for each in setup_findings(LoopSetup(gauges=GaugeSetup(filter_order=4)))]
    ['gauges.filter_order: a filter of order 4 has no corner. Add filter_corner, or use order 0.']
    """
    for address, value, node in node_of(LoopSetup).numbers(setup):
        yield from number_findings(address, value, node)
    yield from setup.amplifier.faults
    yield from _gauges(setup.gauges)
    yield from _floor(setup.floor)
    yield from _controller(setup.controller)
    yield from _follow(setup.follow, setup.trajectory) if setup.follow is not None else ()
    yield from _damping(setup.damping) if setup.damping is not None else ()
    yield from _compensation(setup)
    yield from _hysteresis(setup.hysteresis) if setup.hysteresis is not None else ()
    yield from _trajectory(setup.trajectory)


def _trajectory(found: TrajectorySetup) -> Iterator[Finding]:
    if isinstance(found, FileMotion) and not Path(found.file).is_file():
        yield Finding(found.file, "file not found", "Use the name of a CSV file with times and poses")
    axes = [each for each in vars(found).values() if isinstance(each, Axis)]
    if len({*axes}) < len(axes):
        yield Finding("trajectory", f"both axes are {axes[0].value}", "Use two different axes")
    limits = {} if not isinstance(found, StepMotion) else {name: getattr(found, name) for name in ("speed", "acceleration", "jerk")}
    missing = [name for name, value in limits.items() if value is None]
    if missing and len(missing) < len(limits):
        yield Finding(
            "trajectory",
            f"the limits of the motion are incomplete ({' and '.join(missing)} missing)",
            "Specify speed, acceleration and jerk, or none of these keys for a step",
        )


def _gauges(found: GaugeSetup) -> Iterator[Finding]:
    if found.filter_order and found.filter_corner is None:
        yield Finding("gauges.filter_order", f"a filter of order {found.filter_order} has no corner", "Add filter_corner, or use order 0")
    elif found.filter_corner is not None and not found.filter_order:
        yield Finding("gauges.filter_corner", "a corner is specified, but filter_order 0 means no filter", "Add filter_order, e.g. 4")


def _floor(floor: Floor) -> Iterator[Finding]:
    for axis in ("x", "y", "z"):
        shaking: VibrationSetup | None = getattr(floor, axis)
        if shaking is not None:
            yield from _shaking(f"floor.{axis}", shaking)


def _shaking(where: str, found: VibrationSetup) -> Iterator[Finding]:
    tables = {name: getattr(found, name) for name in ("acceleration", "velocity", "displacement") if getattr(found, name)}
    given = [*(["criterion"] if found.criterion is not None else []), *tables]
    if len(given) != 1:
        what = f"{' and '.join(given)} exclude each other" if given else "no amplitude is specified"
        yield Finding(where, what, "Specify exactly one of criterion, acceleration, velocity, displacement")
        return
    if found.criterion is not None:
        if found.frequencies:
            yield Finding(f"{where}.frequencies", "a criterion already determines the frequencies", "Remove frequencies")
        return
    ((name, table),) = tables.items()
    wanted = len(found.frequencies) or 1
    if len(table) != wanted:
        yield Finding(
            f"{where}.{name}", f"wrong number of densities (got {len(table)}, expected {wanted})", "Use one density for each frequency"
        )
    if found.frequencies and (len(found.frequencies) < 2 or any(low >= high for low, high in pairwise(found.frequencies))):
        yield Finding(f"{where}.frequencies", "frequencies must increase", "Use at least two frequencies, in increasing order")
    if found.frequencies and 0.0 in table:
        yield Finding(f"{where}.{name}", "a density is zero", "Use positive densities: they are interpolated in log-log")


def _controller(found: ControllerSetup) -> Iterator[Finding]:
    tuned = [name for name in _TUNED if getattr(found, name) is not None]
    gains = list(found.stated)
    if found.law not in (ControllerKind.PI, ControllerKind.PID) and gains:
        yield Finding(
            f"controller.{gains[0]}",
            f"a controller of kind {found.law.value} has no {gains[0]} gain",
            f"Remove {gains[0]}, or use kind pi or pid",
        )
    elif tuned and gains:
        what = f"gains ({', '.join(gains)}) and tuning requirements ({', '.join(tuned)}) exclude each other"
        yield Finding("controller", what, "Specify either the gains or the requirements")
    yield from _goal(found)
    yield from _loops(found)
    if "derivative" in gains and found.law is not ControllerKind.PID:
        yield Finding(
            "controller.derivative", f"a controller of kind {found.law.value} has no derivative gain", "Use kind pid, or remove derivative"
        )
    unfiltered = any(each.derivative and each.filter is None for each in (found, *found.loops))
    if found.law is ControllerKind.PID and unfiltered and found.filter is None:
        yield Finding(
            "controller.filter", "the derivative needs a low-pass filter", "Specify its corner frequency, e.g. ten times the bandwidth"
        )
    if found.law is ControllerKind.NONE and tuned:
        yield Finding(
            f"controller.{tuned[0]}", "an open loop (kind none) is not tuned", f"Remove {tuned[0]}, or use another kind of controller"
        )


def _follow(found: FollowSetup, path: TrajectorySetup) -> Iterator[Finding]:
    if found.method is Following.REPETITIVE and not isinstance(path, RasterMotion | SineMotion):
        what = f"repetitive control needs a periodic trajectory (got {path.TOLD_BY[1]}, expected raster or sine)"
        yield Finding("follow.method", what, "Use a raster or a sine, or method learning or inverse")
    shaped = found.method in (Following.ZV, Following.ZVD)
    if shaped and found.frequency is None:
        yield Finding("follow.frequency", "a shaper needs the frequency of the mode that it suppresses", 'Use e.g. frequency = "106 Hz"')
    if not shaped and found.frequency is not None:
        yield Finding(
            "follow.frequency", f"method {found.method.value} does not use a frequency", "Remove frequency, or use method zv or zvd"
        )


def _damping(found: DampingSetup) -> Iterator[Finding]:
    if found.ratio is not None and found.gain is not None:
        yield Finding("damping", "ratio and gain are both specified", "Remove ratio or gain: each determines the other")
    if found.gauges and found.noise is not None:
        yield Finding(
            "damping.noise",
            "noise applies to force sensors, but strain gauges measure the tension of the legs",
            "Remove this key: the design contains the noise of the strain gauges",
        )


def _goal(found: ControllerSetup) -> Iterator[Finding]:
    """Findings for keys that contradict an objective."""
    if found.goal is None:
        return
    if found.quick:
        yield Finding("controller.goal", "quick tuning does not use a goal", "Remove quick or goal (--quick or --tune-for)")
    if found.law not in (*SEARCHED, ControllerKind.NONE):
        advice = "Use kind pi, pid or lqg, or remove goal"
        yield Finding("controller.goal", f"optimisation is not supported for kind {found.law.value}", advice)
    if found.bandwidth is not None:
        yield Finding(
            "controller.goal", "a bandwidth is also specified, but optimisation determines the bandwidth", "Remove bandwidth or goal"
        )
    if found.notches or found.notching is Notching.NONE:
        yield Finding(
            "controller.goal",
            "notch filters are also specified, but optimisation places the notch filters",
            "Remove notches and notching, or goal",
        )


def _loops(found: ControllerSetup) -> Iterator[Finding]:
    """Findings for loops specified twice or unnamed, for loops without gains, and for a prefilter without gains."""
    names = [name for each in found.loops for name in each.axes]
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            yield Finding("controller.loops", f"{name} occurs {names.count(name)} times", "Name each axis in one entry only")
    if not all(each.axes for each in found.loops):
        yield Finding("controller.loops", "an entry has no axes", 'Use e.g. axes = ["x", "y"]')
    if found.loops and not found.stated and found.law in (ControllerKind.PI, ControllerKind.PID):
        yield Finding("controller.loops", "loops are specified without gains", "Add proportional or integral, or remove loops")
    if found.prefilter is not None and not found.stated:
        yield Finding(
            "controller.prefilter", "a prefilter needs specified gains", "Specify gains, or use goal.prefilter for an optimised prefilter"
        )


def _hysteresis(found: HystereticStacks) -> Iterator[Finding]:
    if (found.file is None) == (found.width is None):
        what = "both a file and a width are specified" if found.file is not None else "neither a file nor a width is specified"
        yield Finding("hysteresis", what, "Use either a file or a width")


def _compensation(setup: LoopSetup) -> Iterator[Finding]:
    if Compensation.HYSTERESIS in setup.compensate and setup.amplifier.settings.charge is not None:
        what = "the inverse model applies to voltage drive, but the stacks have charge drive"
        yield Finding("compensate", what, 'Remove "hysteresis" from compensate: with charge drive, the hysteresis is different')
    if Compensation.HYSTERESIS in setup.compensate and setup.hysteresis is None:
        yield Finding("compensate", "the inverse model needs a hysteresis of the stacks", "Add [hysteresis] with a file or a width")
    for each in dict.fromkeys(setup.compensate):
        if setup.compensate.count(each) > 1:
            yield Finding("compensate", f"{each.value} occurs {setup.compensate.count(each)} times", f"Use {each.value} only once")
