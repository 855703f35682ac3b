"""Force feedback in the legs as C for a processor of its own: a function beside the step, and tensions that a test replays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.control.damping.sampled import SampledLegs
from flexstage.control.export.code.controller import clamp, has_volts
from flexstage.control.export.code.legs import law_lines
from flexstage.control.export.code.text import comment, indent, number, table
from flexstage.control.simulation.machine import Machine

_SWEPT, _LARGEST = 200, 1e-6


@dataclass(frozen=True)
class LegWriter:
    """What inner loops add to a controller of a `name`, whose numbers are at most `largest`."""

    given: Machine
    legs: SampledLegs
    name: str
    largest: str

    @property
    def states(self) -> tuple[tuple[str, int], ...]:
        """Arrays that are kept."""
        return (*((each, len(self.legs.actuators)) for each in ("tension", "slow", "slower")), ("total", len(self.given.actuators)))

    @property
    def settings(self) -> tuple[tuple[str, Array, str], ...]:
        """Arrays that may be changed at run time."""
        quick = self.given.amplifiers.slew * self.legs.step
        named = ", ".join(self.legs.actuators)
        return (
            ("leg", self.legs.gains, f"g / (a k) of the legs {named} [m/N]"),
            ("quick", quick, "largest change of both loops together in a sample of the legs"),
        )

    @property
    def flops(self) -> int:
        """Additions and multiplications of a call."""
        return (6 if self.legs.order == 1 else 12) * len(self.legs.actuators) + 5 * len(self.given.actuators)

    @property
    def _call(self) -> str:
        actuators = len(self.given.actuators)
        volts = f", double volts[{actuators}]" if has_volts(self.given) else ""
        sizes = f"const double tension[{len(self.legs.actuators)}], double total[{actuators}]{volts}"
        return f"void {self.name}_damp({self.name}_state *state, const {self.name}_parameters *set, {sizes})"

    def header(self) -> list[str]:
        """Lines of the header."""
        legs = self.legs
        notes = (
            f"Force feedback in the legs of {', '.join(legs.actuators)}. Call it every {legs.step:.12g} s, {legs.turns} times to one of",
            f"the step: {self.flops} additions and multiplications from tensions [N] to the strokes of both loops within what",
            "the amplifiers give. These go to them, not what the step gives.",
        )
        return [*comment(" ".join(notes)), f"#define {self.name.upper()}_LEG_PERIOD {number(legs.step)}", f"{self._call};"]

    def source(self) -> list[str]:
        """Lines of the function."""
        places, actuators = self._places, len(self.given.actuators)
        return [
            "",
            self._call,
            "{",
            f"    double added[{actuators}] = {{0.0}}, gives[{len(places)}] = {{0.0}};",
            "    int i;",
            f"    for (i = 0; i < {len(places)} && set->enable; i++) {{",
            "        double entry, slow;",
            f"        if (tension[i] <= {self.largest} && tension[i] >= -{self.largest}) state->tension[i] = tension[i];",
            *indent(law_lines(self.legs, "gives[i]", "set->leg[i]", "i"), 2),
            "    }",
            *(f"    added[{place}] = gives[{leg}];" for leg, place in enumerate(places)),
            f"    for (i = 0; i < {actuators}; i++) {{",
            *indent(self._total(), 2),
            "    }",
            "}",
        ]

    @property
    def _places(self) -> list[int]:
        return [self.given.actuators.index(name) for name in self.legs.actuators]

    def _total(self) -> list[str]:
        return [
            "double stroke = state->last[i] + added[i];",
            f"if (!(stroke <= {self.largest} && stroke >= -{self.largest}) || !set->enable) stroke = state->total[i];",
            *clamp("set->high[i]", "set->low[i]"),
            *clamp("state->total[i] + set->quick[i]", "state->total[i] - set->quick[i]"),
            "total[i] = state->total[i] = stroke;",
            *(["volts[i] = stroke * per_metre[i] + bias[i];"] if has_volts(self.given) else []),
        ]

    def test(self) -> list[str]:
        """A function that replays tensions, which sweep up to a tenth of the rate: how far strokes are from what they shall be."""
        actuators, name = len(self.given.actuators), self.name
        tensions, wanted = self._swept()
        volts = has_volts(self.given)
        return [
            *table("tension", tensions),
            *table("both", wanted),
            "",
            f"double {name}_legs_worst(void);",
            f"double {name}_legs_worst(void)",
            "{",
            f"    static {name}_state state;",
            f"    static {name}_parameters set;",
            f"    static double total[{actuators}]{f', volts[{actuators}]' if volts else ''};",
            "    double worst = 0.0;",
            "    int k, i;",
            f"    {name}_init(&state, &set);",
            "    set.enable = 1;",
            f"    for (i = 0; i < {actuators}; i++) set.quick[i] = set.high[i] = 1.0, set.low[i] = -1.0;",
            f"    for (k = 0; k < {_SWEPT}; k++) {{",
            f"        {name}_damp(&state, &set, tension[k], total{', volts' if volts else ''});",
            f"        for (i = 0; i < {actuators}; i++) {{",
            "            const double off = total[i] - both[k][i];",
            "            if (!(off <= worst && off >= -worst)) worst = off < 0.0 ? -off : off;",
            "        }",
            "    }",
            f"    return worst / {number(float(np.max(np.abs(wanted))))};",
            "}",
            "",
        ]

    def _swept(self) -> tuple[Array, Array]:
        """Tensions (n, legs), and the strokes (n, actuators) of them, a micrometre at most."""
        times = np.arange(_SWEPT)[:, None]
        turned = 0.1 * np.pi * times**2 / _SWEPT + np.arange(len(self.legs.gains))
        tensions = np.sin(turned) / self.legs.gains
        wanted = np.zeros((_SWEPT, len(self.given.actuators)))
        wanted[:, self._places] = self.legs.strokes(tensions)
        size = _LARGEST / float(np.max(np.abs(wanted)))
        return size * tensions, size * wanted
