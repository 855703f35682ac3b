"""A shipped case: its parameters, the description drawn from them, and the design file that a user starts from."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from flexstage.base.number import Table, stack
from flexstage.cases.parameters import Stated, with_parameters
from flexstage.mechanism.addresses.address import get
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import dumps, round_to_digits


class Shipped(ABC):
    """What every shipped case can do."""

    @property
    @abstractmethod
    def summary(self) -> str:
        """What it is, in one line."""

    @property
    @abstractmethod
    def parameters(self) -> Any:
        """A dataclass of its parameters."""

    @abstractmethod
    def draw(self, parameters: Any) -> Mechanism:
        """The description from these parameters."""

    @abstractmethod
    def text(self, stated: Mapping[str, Stated], heading: str) -> str:
        """The design file with some parameters `stated` otherwise, under a `heading`."""

    def build(self, stated: Mapping[str, Stated] | None = None) -> Mechanism:
        """The description with some parameters `stated` otherwise: texts with units, or SI numbers; arrays make it a batch.

        Tags of numbers that come out otherwise are dropped: their source no longer says them.

        >>> from flexstage.cases.registry import CASES
        >>> CASES["hexapod"].build({"slope": "50 deg"}).name
        'hexapod'
        """
        own = self.draw(self.parameters)
        return own if not stated else _honest(self.draw(with_parameters(self.parameters, stated)), own)


@dataclass(frozen=True)
class Case(Shipped):
    """A case that a function draws from the dataclass of its parameters."""

    function: Callable[[Any], Mechanism]
    own: Any
    line: str

    @property
    def summary(self) -> str:
        """What it is, in one line."""
        return self.line

    @property
    def parameters(self) -> Any:
        """A dataclass of its parameters."""
        return self.own

    def draw(self, parameters: Any) -> Mechanism:
        """The description from these parameters."""
        return self.function(parameters)

    def text(self, stated: Mapping[str, Stated], heading: str) -> str:
        """The design file with some parameters `stated` otherwise, under a `heading`."""
        return dumps(round_to_digits(self.build(stated)), {"": heading})


def _honest(mechanism: Mechanism, own: Mechanism) -> Mechanism:
    """The description without tags of numbers that are not those of the case's `own`."""
    tags = {key: tag for key, tag in mechanism.tags.items() if key in own.tags and _same(get(mechanism, key), get(own, key))}
    return mechanism if len(tags) == len(mechanism.tags) else replace(mechanism, tags=Table(tags))


def _same(first: Any, second: Any) -> bool:
    return bool(np.all(stack(first) == stack(second)))
