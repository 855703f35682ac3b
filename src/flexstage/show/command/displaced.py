"""Options of stages away from their drawn position: loads that stay, and coordinates that are brought somewhere."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, TypeAlias

from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.quantity import ANGLE, LENGTH, Quantity
from flexstage.base.unit import parse, quantity_of_unit
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.show.command.options import text_option

Load: TypeAlias = Annotated[
    list[str] | None,
    text_option("--load", "NAME=VALUE", 'A load that stays: "platform.fx=-20 N", a stroke "B1=10 um". May be given several times.'),
]

At: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--at", "NAME=VALUE", 'Where the stage is: "platform.x=5 mm", under its weight and the force that it takes. Several times.'
    ),
]


def displaced(mechanism: Mechanism, at: Sequence[str], load: Sequence[str]) -> LinearModel:
    """Small motions about where the stage rests under its weight, loads, and the forces that bring coordinates where they are to be."""
    model = nonlinear(mechanism)
    found = equilibrium(model, loads_of(model, load), hold=coordinates_of(model, at))
    if not bool(found.converged):
        what = "no equilibrium was found there"
        raise refuse("--at" if at else "--load", what, "Ask for less, or see how far it gets: flexstage stroke")
    return linearise(found)


def loads_of(model: Nonlinear, texts: Sequence[str]) -> dict[str, float]:
    """Loads in SI units from texts NAME=VALUE."""
    units = {channel.name: channel.unit for channel in model.inputs}
    found: dict[str, float] = {}
    for text in texts:
        name, _, value = (part.strip() for part in text.partition("="))
        if name not in units:
            raise refuse(f"--load {text}", f'there is no load "{name}"', suggest_nearest(name, units))
        found[name] = parse(value, quantity_of_unit(units[name]), where=f"--load {name}")
    return found


def coordinates_of(model: Nonlinear, texts: Sequence[str]) -> dict[str, float]:
    """Coordinates in SI units from texts NAME=VALUE."""
    pairs = [[part.strip() for part in text.partition("=")] for text in texts]
    return {name: parse(value, quantity_of(model, name), where=f"--at {name}") for name, _, value in pairs}


def quantity_of(model: Nonlinear, drive: str) -> Quantity:
    """What a drive is measured in: an input's unit, or that of a coordinate."""
    units = {channel.name: channel.unit for channel in model.inputs}
    if drive in units:
        return quantity_of_unit(units[drive])
    return ANGLE if drive.rpartition(".")[2].startswith("r") else LENGTH
