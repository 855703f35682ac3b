"""Values that tasks of the studio return, apart from the messages to its page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flexstage.apps.studio.protocol import Amount, Channel, Problem


@dataclass(frozen=True)
class Reading:
    """What a text says: problems alone, or a design with its numbers, channels and links; `values` are its numbers by address."""

    problems: tuple[Problem, ...]
    name: str = ""
    amounts: tuple[Amount, ...] = ()
    actuators: tuple[Channel, ...] = ()
    axes: tuple[Channel, ...] = ()
    gauges: tuple[Channel, ...] = ()
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    links: Mapping[str, int | None] | None = None
    paths: tuple[str, ...] = ()


@dataclass(frozen=True)
class Written:
    """A text with a number set, and what was set; empty where the other text with that number is not quite this design."""

    text: str
    stated: str
