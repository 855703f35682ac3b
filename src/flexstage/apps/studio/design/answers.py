"""Values that tasks of the studio return, except the messages to the page."""

from __future__ import annotations

from dataclasses import dataclass, field

from flexstage.apps.studio.protocol import Amount, Channel, Problem


@dataclass(frozen=True)
class Reading:
    """Contents of a text: problems, or a design with its numbers, channels and links. `values` are the numbers by address."""

    problems: tuple[Problem, ...]
    name: str = ""
    amounts: tuple[Amount, ...] = ()
    actuators: tuple[Channel, ...] = ()
    axes: tuple[Channel, ...] = ()
    gauges: tuple[Channel, ...] = ()
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    links: dict[str, int | None] = field(default_factory=dict[str, int | None])
    paths: tuple[str, ...] = ()
