"""A shipped case: its parameters, the description drawn from them, and the design file that a user starts from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, make_dataclass, replace
from functools import cache, reduce
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from flexstage.base.number import Number, Table, stack
from flexstage.base.units.unit import quantity_of_unit
from flexstage.cases.parameters import Stated, parameter, with_parameters
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.grammar.formulas import NUMBERS
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import dumps, loads, patch, round_to_digits

FILES = Path(__file__).parent / "files"


@dataclass(frozen=True)
class Case:
    """A shipped case in the design file of its `name`, and what it is, in one line."""

    name: str
    summary: str

    @property
    def parameters(self) -> Any:
        """Its parameters as a dataclass with their quantities: the named numbers of the file that are no formulas."""
        return _parameters(self.name)

    def draw(self, parameters: Any) -> Mechanism:
        """The description from these parameters; what the file works out of them follows."""
        stated = {each.name: getattr(parameters, each.name) for each in fields(parameters)}
        changed = [name for name, value in stated.items() if value is not getattr(self.parameters, name)]
        return reduce(lambda stage, name: set_value(stage, f"{NUMBERS}.{name}", stated[name]), changed, _description(self.name))

    def build(self, stated: Mapping[str, Stated] | None = None) -> Mechanism:
        """The description with some parameters `stated` otherwise: texts with units, or SI numbers; arrays make it a batch.

        Tags of numbers that come out otherwise are dropped: their source no longer says them.

        >>> from flexstage.cases.registry import CASES
        >>> CASES["hexapod"].build({"slope": "50 deg"}).name
        'hexapod'
        """
        return self.draw(with_parameters(self.parameters, stated or {}))

    def text(self, stated: Mapping[str, Stated], heading: str) -> str:
        """The design file, its comments included, with some parameters `stated` otherwise, under a `heading` of its own."""
        own = {f"{NUMBERS}.{parameter(self.parameters, name).name}": value for name, value in stated.items()}
        text = file_text(self.name)
        head = "".join(f"# {line}".rstrip() + "\n" for line in heading.splitlines())
        return f"{head}\n{patch(text, own) if own else text}"


@dataclass(frozen=True)
class FunctionCase(Case):
    """A case that a `function` draws from the dataclass of its parameters."""

    function: Callable[[Any], Mechanism]
    own: Any

    @property
    def parameters(self) -> Any:
        """A dataclass of its parameters."""
        return self.own

    def draw(self, parameters: Any) -> Mechanism:
        """The description from these parameters."""
        return self.function(parameters)

    def build(self, stated: Mapping[str, Stated] | None = None) -> Mechanism:
        """The description with some parameters `stated` otherwise, without tags of numbers that are not those of the case."""
        own, found = self.draw(self.own), super().build(stated)
        tags = {key: tag for key, tag in found.tags.items() if key in own.tags and np.all(stack(get(found, key)) == stack(get(own, key)))}
        return replace(found, tags=Table(tags))

    def text(self, stated: Mapping[str, Stated], heading: str) -> str:
        """The design file with some parameters `stated` otherwise, under a `heading`."""
        return dumps(round_to_digits(self.build(stated)), {"": heading})


def file_text(name: str) -> str:
    """The design file of a case as it is shipped.

    >>> file_text("leaf-guide").splitlines()[0][:9]
    '# A guide'
    """
    return (FILES / f"{name}.toml").read_text(encoding="utf-8")


@cache
def _description(name: str) -> Mechanism:
    return loads(file_text(name), where=f"{name}.toml")


@cache
def _parameters(name: str) -> Any:
    stage = _description(name)
    own = {key: number for key, number in stage.numbers.items() if f"{NUMBERS}.{key}" not in stage.formulas}
    slots = [(key, Annotated[Number, quantity_of_unit(number.unit)], number.value) for key, number in own.items()]
    return make_dataclass(
        "Numbers", slots, frozen=True, namespace={"__doc__": f"Numbers of {name}, SI.\n\nThe named numbers of its file."}
    )()
