"""Cases that are design files: what they say is read in `cases/files`, and their named numbers are their parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, make_dataclass
from functools import cache, reduce
from pathlib import Path
from typing import Annotated, Any

from flexstage.base.number import Number
from flexstage.base.units.unit import quantity_of_unit
from flexstage.cases.case import Shipped
from flexstage.cases.parameters import Stated, parameter
from flexstage.mechanism.addresses.address import set_value
from flexstage.mechanism.grammar.formulas import NUMBERS
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import loads, patch

FILES = Path(__file__).parent / "files"


@dataclass(frozen=True)
class FileCase(Shipped):
    """A case in the design file of its `name`."""

    name: str
    line: str

    @property
    def summary(self) -> str:
        """What it is, in one line."""
        return self.line

    @property
    def parameters(self) -> Any:
        """Its named numbers that are no formulas, as a dataclass with their quantities."""
        return _parameters(self.name)

    def draw(self, parameters: Any) -> Mechanism:
        """The description with these numbers; what the file works out of them follows."""
        stated = {each.name: getattr(parameters, each.name) for each in fields(parameters)}
        changed = [name for name, value in stated.items() if value is not getattr(self.parameters, name)]
        return reduce(lambda stage, name: set_value(stage, f"{NUMBERS}.{name}", stated[name]), changed, _description(self.name))

    def text(self, stated: Mapping[str, Stated], heading: str) -> str:
        """The design file, its comments included, with some numbers `stated` otherwise, under a `heading` of its own."""
        own = {f"{NUMBERS}.{parameter(self.parameters, name).name}": value for name, value in stated.items()}
        text = file_text(self.name)
        head = "".join(f"# {line}".rstrip() + "\n" for line in heading.splitlines())
        return f"{head}\n{patch(text, own) if own else text}"


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
