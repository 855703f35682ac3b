"""Load paths of a design in SI units: each path varies a drive from the static equilibrium, under constant loads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.lazy import LazyModule
from flexstage.base.number import Array
from flexstage.base.units.quantity import ANGLE, LENGTH, Quantity
from flexstage.base.units.unit import parse, quantity_of_unit
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import Mechanism, StrokePath
from flexstage.models.linear.channels import input_channels, wrench_places
from flexstage.models.nonlinear.state import Status
from flexstage.spatial.frame import COMPONENTS, FORCES

if TYPE_CHECKING:
    from flexstage.analysis.loaded import operating_point
    from flexstage.analysis.loaded import stroke as strokes
    from flexstage.models.nonlinear import equilibrium
    from flexstage.models.nonlinear import stage as nonlinear
    from flexstage.models.nonlinear.paths import load_path as paths
else:
    operating_point = LazyModule("flexstage.analysis.loaded.operating_point")
    strokes = LazyModule("flexstage.analysis.loaded.stroke")
    equilibrium = LazyModule("flexstage.models.nonlinear.equilibrium")
    paths = LazyModule("flexstage.models.nonlinear.paths.load_path")
    nonlinear = LazyModule("flexstage.models.nonlinear.stage")

_SWITCH = {"on": 1.0, "off": 0.0}


@dataclass(frozen=True, eq=False)
class DrivePath:
    """Load path: `values` (k,) [SI] of the `drive`, measured from the static equilibrium under `loads` and a fraction `weight` of gravity.

    `locked` coordinates are fixed at their static equilibrium values.
    """

    drive: str
    values: Array
    loads: dict[str, float]
    locked: tuple[str, ...]
    weight: float

    def rest(self, model: nonlinear.Nonlinear) -> equilibrium.State:
        """Return the static equilibrium. Raises `DesignError` if the stage has no static equilibrium."""
        return _resting(equilibrium.equilibrium(model, self.loads, weight=self.weight))

    def path(self, model: nonlinear.Nonlinear, rest: equilibrium.State) -> paths.LoadPath:
        """Return the equilibria along the path from the static equilibrium `rest`."""
        target, hold = self._wanted(model, rest, None)
        result = paths.load_path(model, self.drive, target, loads=self.loads, hold=hold, weight=self.weight)
        _require_continuation(result.state)
        return result

    def _wanted(self, model: nonlinear.Nonlinear, rest: equilibrium.State, values: Array | None) -> tuple[Array, dict[str, float]]:
        """Values of the drive relative to the nominal position, and of the fixed coordinates."""
        target = self.values if values is None else values
        driven = self.drive in {channel.name for channel in model.inputs}
        start = 0.0 if driven else float(operating_point.coordinate(rest, self.drive))
        return start + target, {name: float(operating_point.coordinate(rest, name)) for name in self.locked}

    def points(self, model: nonlinear.Nonlinear, values: Array | None = None) -> strokes.Points:
        """Return the points of the path. `Points.column` computes a single characteristic of these points."""
        (result,) = self.points_of_designs((model,), values)
        return result

    def points_of_designs(self, models: Sequence[nonlinear.Nonlinear], values: Array | None = None) -> list[strokes.Points]:
        """Return the points of the path for several designs of the same structure, solved together."""
        rests = [_resting(each) for each in equilibrium.equilibria(models, self.loads, weight=self.weight)]
        requested = [self._wanted(model, rest, values) for model, rest in zip(models, rests, strict=True)]
        target, hold = [each for each, _ in requested], [each for _, each in requested]
        result = paths.equilibria_of_designs(models, self.drive, target, loads=self.loads, hold=hold, weight=self.weight)
        states = []
        for state, rest, locked, each in zip(result, rests, hold, target, strict=True):
            begin, start = paths.begin_along(rest, self.drive, self.loads, locked, self.weight)
            states.append(paths.continue_along(begin, state, each - start))
        for each in states:
            _require_continuation(each)
        return [strokes.Points(self.drive, each, state, self.locked, rest) for each, state, rest in zip(target, states, rests, strict=True)]


def _resting(result: equilibrium.State) -> equilibrium.State:
    equilibrium.require_equilibrium(result)
    return result


def _require_continuation(result: equilibrium.State) -> None:
    """Refuse states that do not continue the static equilibrium, with the reason of the first."""
    beyond = np.flatnonzero(result.status > Status.SINGULAR)
    if beyond.size:
        equilibrium.require_equilibrium(result.case(int(beyond[0])))


def drive_quantity(assembly: Assembly, drive: str, where: str) -> Quantity:
    """Return the physical quantity of a drive. Raises `DesignError` (location `where`) if the drive is neither a coordinate nor a load.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> drive_quantity(expand(parallelogram()), "platform.rz", "here").noun
    'an angle'
    """
    units = {channel.name: channel.unit for channel in input_channels(assembly)}
    if drive in units:
        return quantity_of_unit(units[drive])
    owner, _, component = drive.rpartition(".")
    places = [*assembly.bodies, *wrench_places(assembly)]
    if owner not in places or component not in COMPONENTS:
        known = [*units, *(f"{place}.{each}" for place in places for each in COMPONENTS)]
        raise refuse(where, f'unknown drive (got "{drive}", expected a coordinate or a load of this stage)', suggest_nearest(drive, known))
    return ANGLE if component.startswith("r") else LENGTH


def course(mechanism: Mechanism, name: str) -> DrivePath:
    """Read the load path `name` in `[paths]`. Raises `DesignError` with all errors of the path.

    >>> import flexstage as fs
    >>> stage = fs.case("parallelogram")
    >>> from dataclasses import replace
    >>> stage = replace(stage, paths={"out": fs.StrokePath("platform.x", ("0 mm", "0.1 mm"), points=3)})
    >>> course(stage, "out").values.tolist()
    [0.0, 5e-05, 0.0001]
    """
    stated, where = mechanism.paths[name], f"paths.{name}"
    assembly = expand(mechanism)
    require(_findings(stated, where))
    quantity = drive_quantity(assembly, stated.drive, f"{where}.drive")
    low, high = (parse(text, quantity, where=f"{where}.to") for text in stated.to)
    if low == high:
        raise refuse(f"{where}.to", f"start and end are equal (got {stated.to[0]} and {stated.to[1]})", "Use two different values")
    loads, locked, weight = dict[str, float](), list[str](), 1.0
    for key, text in stated.hold.items():
        at = f"{where}.hold.{key}"
        if key == "gravity":
            weight = _SWITCH[text]
        elif text.strip() == "0":
            drive_quantity(assembly, key, at)
            locked.append(key)
        else:
            load = _load(assembly, key, at)
            loads[load] = parse(text, drive_quantity(assembly, load, at), where=at)
    require(_contradictions(stated, loads, locked, where))
    return DrivePath(stated.drive, np.linspace(low, high, stated.points), loads, tuple(locked), weight)


def _load(assembly: Assembly, key: str, where: str) -> str:
    """Load conjugate to a coordinate; a load's own name unchanged."""
    owner, _, component = key.rpartition(".")
    if component in COMPONENTS:
        return f"{owner}.{FORCES[COMPONENTS.index(component)]}"
    drive_quantity(assembly, key, where)
    return key


def _findings(stated: StrokePath, where: str) -> Iterator[Finding]:
    if stated.points < 2:
        yield Finding(f"{where}.points", f"too few points (got {stated.points}, expected 2 or more)", "Use e.g. points = 11")
    switch = stated.hold.get("gravity")
    if switch is not None and switch not in _SWITCH:
        yield Finding(f"{where}.hold.gravity", f'unknown value (got "{switch}", expected "on" or "off")', 'Use "on" or "off"')


def _contradictions(stated: StrokePath, loads: dict[str, float], locked: list[str], where: str) -> Iterator[Finding]:
    owner, _, component = stated.drive.rpartition(".")
    own = f"{owner}.{FORCES[COMPONENTS.index(component)]}" if component in COMPONENTS else stated.drive
    if own in loads:
        yield Finding(f"{where}.hold", f"{own} is both a constant load and the force that drives {stated.drive}", "Remove one of the two")
    if stated.drive in locked:
        yield Finding(f"{where}.hold.{stated.drive}", "the drive cannot be a fixed coordinate", "Remove this entry")


def path_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return the errors in the load paths of a design.

    >>> list(path_findings(Mechanism("stage")))
    []
    """
    for name in mechanism.paths:
        try:
            course(mechanism, name)
        except DesignError as error:
            yield from error.findings
