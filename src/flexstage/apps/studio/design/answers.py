"""Values that tasks of the studio return, except the messages to the page."""

from __future__ import annotations

from dataclasses import dataclass, field

from flexstage.apps.studio.protocol import Amount, Channel


@dataclass(frozen=True)
class Reading:
    """Contents of a text without errors: its numbers, channels and links."""

    name: str = ""
    amounts: tuple[Amount, ...] = ()
    actuators: tuple[Channel, ...] = ()
    axes: tuple[Channel, ...] = ()
    gauges: tuple[Channel, ...] = ()
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    links: dict[str, int | None] = field(default_factory=dict[str, int | None])
    paths: tuple[str, ...] = ()
