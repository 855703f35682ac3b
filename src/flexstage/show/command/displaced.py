"""Options for operating points: constant loads, and prescribed or fixed coordinates."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from flexstage.analysis.loaded.load_effect import LoadEffect, load_effect
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.lazy import LazyModule
from flexstage.base.record import SideBySide
from flexstage.base.units.quantity import ANGLE, LENGTH, TEMPERATURE, Quantity
from flexstage.base.units.unit import parse, quantity_of_unit
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult
from flexstage.show.command.design import elastic_model
from flexstage.show.command.options import temperature_option, text_option
from flexstage.show.command.values import read_pairs
from flexstage.show.table import Table, matrix_table

if TYPE_CHECKING:
    from flexstage.analysis.loaded import operating_point as operating_points
    from flexstage.analysis.loaded.operating_point import OperatingPoint
    from flexstage.models.nonlinear import stage as displaced
    from flexstage.models.nonlinear.stage import Nonlinear
else:  # few commands have an operating point
    operating_points, displaced = LazyModule("flexstage.analysis.loaded.operating_point"), LazyModule("flexstage.models.nonlinear.stage")

Load: TypeAlias = Annotated[
    list[str] | None,
    text_option("--load", "NAME=VALUE", 'Constant load or stroke, e.g. "platform.fx=-20 N" or "B1=10 um". Repeatable.'),
]

At: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--at",
        "NAME=VALUE",
        'Prescribed coordinate or stroke, relative to static equilibrium, e.g. "platform.x=5 mm" or "B1=10 um". Repeatable.',
    ),
]

Fixed: TypeAlias = Annotated[list[str] | None, text_option("--fixed", "NAME", "Fixed coordinate, e.g. platform.rz. Repeatable.")]


Temperature: TypeAlias = Annotated[str | None, temperature_option("0 K")]


@dataclass(frozen=True)
class OperatingPointOptions:
    """Operating-point options of a command. The object is true if any option is used; otherwise, results are for the undeformed stage."""

    at: At = None
    load: Load = None
    fixed: Fixed = None
    temperature: Temperature = None

    def __bool__(self) -> bool:
        return bool(self.options)

    @property
    def warmth(self) -> float:
        """Temperature change [K]."""
        return 0.0 if self.temperature is None else parse(self.temperature, TEMPERATURE, where="--temperature")

    @property
    def locked(self) -> tuple[str, ...]:
        """Names of the fixed coordinates. Raises `DesignError` for a coordinate with a value, and for repeated coordinates."""
        fixed = tuple(name.strip() for name in self.fixed or ())
        require(
            Finding(f"--fixed {name}", "takes only the name of a coordinate", f'Use --at "{name}" --fixed {name.partition("=")[0]}')
            for name in fixed
            if "=" in name
        )
        require(Finding(f"--fixed {name}", "given twice", "Give it once") for name in dict.fromkeys(fixed) if fixed.count(name) > 1)
        return fixed

    def brought(self, model: Nonlinear) -> dict[str, float]:
        """Return the values of the coordinates prescribed with `--at` by name, in SI units."""
        return read_pairs(self.at or (), "--at", lambda name, value, where: parse(value, quantity_of(model, name), where=where))

    @property
    def options(self) -> str:
        """Names of the options in use, separated by commas."""
        given = {"--at": self.at, "--load": self.load, "--fixed": self.fixed, "--temperature": self.temperature}
        return ", ".join(option for option, value in given.items() if value)


@dataclass(frozen=True, eq=False)
class CommandStage:
    """The stage of a command: at an `operating_point`, or in the undeformed configuration with the `effect` of its permanent load.

    `model` is the kind of model. `point` is the operating point, or the loaded stage if its permanent load is significant.
    """

    mechanism: Mechanism
    model: Model
    operating_point: OperatingPoint | None = None
    effect: LoadEffect | None = None

    @property
    def point(self) -> OperatingPoint | None:
        """Operating point about which models are linearised; `None` for the undeformed stage."""
        return self.operating_point if self.effect is None else self.effect.point

    @property
    def linear(self) -> LinearModel:
        """Linear model about the point, or of the undeformed stage."""
        return elastic_model(self.mechanism, self.model) if self.point is None else self.point.linear

    @property
    def links(self) -> LinearModel:
        """Linear model for lost motion and drift. At an operating point, its flexures follow their ends quasi-statically."""
        return elastic_model(self.mechanism, self.model) if self.point is None else self.point.links

    def body(self, result: Any) -> Any:
        """Return the JSON body of a result, together with the operating point or the effect of the permanent load."""
        if self.operating_point is not None:
            return SideBySide((result, {"operating_point": self.operating_point}))
        return result if self.effect is None else SideBySide((result, {"loaded": self.effect}))

    def result(self, body: Any, tables: Callable[[], Iterable[Table | str | None]]) -> CommandResult:
        """Return the result of a command with a JSON `body` and its tables; those of the operating point are printed first."""
        return CommandResult(self.mechanism, lambda: body, lambda: [*self.tables(), *tables()], model=self.model, warnings=self.warnings)

    def tables(self) -> Iterator[Table | str]:
        """Yield the text on the permanent load, or the tables of the operating point. They are printed before the result."""
        if self.effect is not None and self.effect.model is not None:
            yield self.effect.text
        if self.operating_point is not None:
            yield from _operating_point_tables(self.operating_point)

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings about the operating point."""
        return () if self.operating_point is None else self.operating_point.warnings


def command_stage(mechanism: Mechanism, place: OperatingPointOptions, model: Model = Model.LUMPED) -> CommandStage:
    """Return the stage at the requested operating point. Raises `DesignError` if the model has no operating points."""
    if not place:
        return CommandStage(mechanism, model, effect=load_effect(mechanism) if model is Model.LUMPED else None)
    if model is not Model.LUMPED:
        raise refuse(place.options, f"the {model.value} model has no operating points", f"Remove --model, or remove {place.options}")
    known = displaced.nonlinear(mechanism)
    there = operating_points.operating_point(
        mechanism, place.brought(known), loads=loads_of(known, place.load or ()), fixed=place.locked, temperature=place.warmth
    )
    return CommandStage(mechanism, model, there)


def _operating_point_tables(found: OperatingPoint) -> Iterator[Table]:
    yield matrix_table("Static deflection under weight, loads and temperature change", found.sag)
    if found.moved is not None:
        yield matrix_table("Displacement from static equilibrium", found.moved)
    if found.held is not None:
        kept = f" ({', '.join(found.locked)} fixed)" if found.locked else ""
        yield matrix_table(f"Prescribed coordinates, relative to static equilibrium{kept}", found.held)


def loads_of(model: Nonlinear, texts: Sequence[str], option: str = "--load") -> dict[str, float]:
    """Read loads from the texts NAME=VALUE of an `option`. Returns the loads by name, in SI units."""
    units = {channel.name: channel.unit for channel in model.inputs}

    def read(name: str, value: str, where: str) -> float:
        if name not in units:
            raise refuse(f"{option} {name}", f'unknown load "{name}"', suggest_nearest(name, units))
        return parse(value, quantity_of_unit(units[name]), where=where)

    return read_pairs(texts, option, read)


def quantity_of(model: Nonlinear, drive: str) -> Quantity:
    """Return the physical quantity of the model's input or coordinate that `drive` names."""
    units = {channel.name: channel.unit for channel in model.inputs}
    if drive in units:
        return quantity_of_unit(units[drive])
    return ANGLE if drive.rpartition(".")[2].startswith("r") else LENGTH
