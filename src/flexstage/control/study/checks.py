"""Checks of a set-up that do not require a stage."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from flexstage.base.finding import Finding
from flexstage.control.study.choices import SEARCHED, Compensation, ControllerKind, Following, Notching
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
    SpiralMotion,
    StepMotion,
    TrajectorySetup,
    VibrationSetup,
)
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import number_findings

_TUNED = ("bandwidth", "sensitivity", "goal")


def setup_findings(setup: LoopSetup) -> Iterator[Finding]:
    """Check the numbers of a set-up for bounds and contradictions; each finding has its key.

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
        yield Finding(found.file, "file not found", "Check the path: a CSV table of times and poses")
    pair = (found.fast, found.slow) if isinstance(found, RasterMotion) else None
    pair = (found.first, found.second) if isinstance(found, SpiralMotion) else pair
    if pair is not None and pair[0] is pair[1]:
        yield Finding("trajectory", f"both its axes are {pair[0].value}", "Use two different ones")
    limits = {} if not isinstance(found, StepMotion) else {name: getattr(found, name) for name in ("speed", "acceleration", "jerk")}
    missing = [name for name, value in limits.items() if value is None]
    if missing and len(missing) < len(limits):
        yield Finding(
            "trajectory", f"it has no {' and no '.join(missing)}", "Specify speed, acceleration and jerk, or none of them for a step"
        )


def _gauges(found: GaugeSetup) -> Iterator[Finding]:
    if found.filter_order and found.filter_corner is None:
        yield Finding("gauges.filter_order", f"a filter of order {found.filter_order} has no corner", "Add filter_corner, or use order 0")
    elif found.filter_corner is not None and not found.filter_order:
        yield Finding("gauges.filter_corner", "a corner is given, but order 0 is no filter", "Add filter_order, e.g. 4")


def _floor(floor: Floor) -> Iterator[Finding]:
    for axis in ("x", "y", "z"):
        shaking: VibrationSetup | None = getattr(floor, axis)
        if shaking is not None:
            yield from _shaking(f"floor.{axis}", shaking)


def _shaking(where: str, found: VibrationSetup) -> Iterator[Finding]:
    tables = {name: getattr(found, name) for name in ("acceleration", "velocity", "displacement") if getattr(found, name)}
    given = [*(["criterion"] if found.criterion is not None else []), *tables]
    if len(given) != 1:
        what = f"it is given by {' and '.join(given)}" if given else "no amplitude is specified"
        yield Finding(where, what, "Use one of criterion, acceleration, velocity, displacement")
        return
    if found.criterion is not None:
        if found.frequencies:
            yield Finding(f"{where}.frequencies", "a criterion has its own frequencies", "Omit them")
        return
    ((name, table),) = tables.items()
    wanted = len(found.frequencies) or 1
    if len(table) != wanted:
        yield Finding(f"{where}.{name}", f"found {len(table)} densities for {wanted} frequencies", "Use one density for each frequency")
    if found.frequencies and (len(found.frequencies) < 2 or any(low >= high for low, high in pairwise(found.frequencies))):
        yield Finding(f"{where}.frequencies", "they do not ascend", "Use at least two, ascending")
    if found.frequencies and 0.0 in table:
        yield Finding(f"{where}.{name}", "a density of a table is 0", "Use positive ones: the table is interpolated in log-log")


def _controller(found: ControllerSetup) -> Iterator[Finding]:
    tuned = [name for name in _TUNED if getattr(found, name) is not None]
    gains = list(found.stated)
    if found.law not in (ControllerKind.PI, ControllerKind.PID) and gains:
        yield Finding(f"controller.{gains[0]}", f"a controller of kind {found.law.value} does not have it", "Leave it out, or take kind pi")
    elif tuned and gains:
        what = f"{tuned[0]} requests tuning, and {', '.join(gains)} is given" if len(gains) == 1 else _contradiction(tuned, gains)
        yield Finding("controller", what, "Specify either the requirements or the gains")
    yield from _goal(found)
    yield from _loops(found)
    if "derivative" in gains and found.law is not ControllerKind.PID:
        yield Finding("controller.derivative", f"a controller of kind {found.law.value} has none", "Take kind pid, or leave it out")
    unfiltered = any(each.derivative and each.filter is None for each in (found, *found.loops))
    if found.law is ControllerKind.PID and unfiltered and found.filter is None:
        yield Finding("controller.filter", "the derivative has no filter", "Add its corner, e.g. ten times the bandwidth")
    if found.law is ControllerKind.NONE and tuned:
        yield Finding(f"controller.{tuned[0]}", "there is no loop to be tuned", "Take another kind, or leave it out")


def _follow(found: FollowSetup, path: TrajectorySetup) -> Iterator[Finding]:
    if found.method is Following.REPETITIVE and not isinstance(path, RasterMotion | SineMotion):
        what = f"a {path.TOLD_BY[1]} is not periodic"
        yield Finding("follow.method", what, "Use a raster or a sine as trajectory, or tracking by learning or the inverse")
    shaped = found.method in (Following.ZV, Following.ZVD)
    if shaped and found.frequency is None:
        yield Finding("follow.frequency", "a shaper needs the frequency of its mode", 'Use e.g. frequency = "106 Hz"')
    if not shaped and found.frequency is not None:
        yield Finding(
            "follow.frequency", f"{found.method.value} has no natural frequency as a parameter", "Leave it out, or take zv or zvd"
        )


def _damping(found: DampingSetup) -> Iterator[Finding]:
    if found.ratio is not None and found.gain is not None:
        yield Finding("damping", "both a damping ratio and a gain are given", "Remove one of them: the other follows")
    if found.gauges and found.noise is not None:
        yield Finding(
            "damping.noise",
            "it applies to force sensors, but strain gauges measure the tension of the legs",
            "Omit it: the design contains the strain gauges' noise",
        )


def _goal(found: ControllerSetup) -> Iterator[Finding]:
    """Findings for keys that contradict an objective."""
    if found.goal is None:
        return
    if found.quick:
        yield Finding("controller.goal", "quick tuning has no goal", "Leave one of them out (--quick, --tune-for)")
    if found.law not in (*SEARCHED, ControllerKind.NONE):
        advice = "Take kind pi, pid or lqg, or leave it out"
        yield Finding("controller.goal", f"a controller of kind {found.law.value} has no optimisation", advice)
    if found.bandwidth is not None:
        yield Finding("controller.goal", "a bandwidth is given too, and a search finds its own", "Leave one of them out")
    if found.notches or found.notching is Notching.NONE:
        yield Finding("controller.goal", "notches are stated, and a search places its own", "Leave notches and notching out")


def _loops(found: ControllerSetup) -> Iterator[Finding]:
    """Findings for loops stated twice or unnamed, numbers without gains, and prefilters without a reference input."""
    names = [name for each in found.loops for name in each.axes]
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            yield Finding("controller.loops", f"{name} occurs {names.count(name)} times", "Name each axis in one entry only")
    if not all(each.axes for each in found.loops):
        yield Finding("controller.loops", "an entry has no axes", 'Use e.g. axes = ["x", "y"]')
    if found.loops and not found.stated and found.law in (ControllerKind.PI, ControllerKind.PID):
        yield Finding("controller.loops", "loops are stated without gains", "Add proportional or integral, or leave loops out")
    if found.prefilter is not None and not found.stated:
        yield Finding("controller.prefilter", "it has no gains", "State the gains, or leave it out")


def _contradiction(tuned: list[str], gains: list[str]) -> str:
    return f"{' and '.join(tuned)} ask for tuning, and {', '.join(gains)} are given"


def _hysteresis(found: HystereticStacks) -> Iterator[Finding]:
    if (found.file is None) == (found.width is None):
        what = "both a file and a width are given" if found.file is not None else "neither a file nor a width is given"
        yield Finding("hysteresis", what, "Use either a file or a width")


def _compensation(setup: LoopSetup) -> Iterator[Finding]:
    if Compensation.HYSTERESIS in setup.compensate and setup.amplifier.settings.charge is not None:
        what = "the inverse applies to voltage drive, but the stacks have charge drive"
        yield Finding("compensate", what, "Omit hysteresis: its remainder under charge drive differs")
    if Compensation.HYSTERESIS in setup.compensate and setup.hysteresis is None:
        yield Finding("compensate", "hysteresis is to be compensated, and the stacks have none", "Add [hysteresis] with a file or a width")
    for each in dict.fromkeys(setup.compensate):
        if setup.compensate.count(each) > 1:
            yield Finding("compensate", f"{each.value} occurs {setup.compensate.count(each)} times", "Write it once")
