"""Kinds of controllers made of single loops: families of laws, of which tuning takes the best. Other packages offer theirs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flexstage.base.register import Register
from flexstage.control.controllers.law import Law


@dataclass(frozen=True)
class Place:
    """Where a law shall pass: the loop's complex `gain` at `frequency` [Hz] with notches; its `static` gain, first `resonance` [Hz]."""

    frequency: float
    gain: complex
    static: float
    resonance: float | None


@dataclass(frozen=True)
class Family:
    """A kind of controller by its `name` in words: its `laws` with |C g| = 1 at a place, sampled every so many seconds (None: not).

    Of them tuning takes, loop by loop, the one with the lowest peak of S. `notched`: notches behind it are placed on modes that need them.
    `others`: what to try where it does not reach what is wanted.
    """

    name: str
    laws: Callable[[Place, float | None], Sequence[Law]]
    notched: bool = True
    others: str = "PID or LQG"

    @property
    def value(self) -> str:
        """Its name in words."""
        return self.name


CONTROLLERS: Register[Family] = Register("flexstage.controllers", {})
"""Kinds of controllers that are families of laws of single loops, besides PI, PID and integral resonant control."""
