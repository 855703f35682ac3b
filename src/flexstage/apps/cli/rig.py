"""The command `rig`: a virtual test of a stage, written as a record."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexstage.apps.cli.choice import choice, choices
from flexstage.apps.cli.options import Changes, Design, Theory
from flexstage.studies.reading import Reading
from flexstage.studies.rig.setup import Recorded, Tap

if TYPE_CHECKING:
    from flexstage.base.quantity import Quantity
    from flexstage.studies.rig.setup import Amplifier, NoiseDrive, RigSetup


def _text(name: str, metavar: str, about: str) -> Any:
    return typer.Option(name, metavar=metavar, help=about, show_default=False)


def rig(  # noqa: PLR0913  a test has that many knobs
    design: Design,
    *,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="RECORD", help="File to write: .uff, .mat, .h5 or .csv.", show_default=False)
    ],
    seconds: Annotated[float, typer.Option("--seconds", help="Length of the record.", show_default=False)],
    seed: Annotated[int, typer.Option("--seed", help="Seed of all random numbers: same seed, same record.")] = 0,
    rate: Annotated[
        str | None, _text("--rate", "VALUE", "Sampling rate. Default: a power of two, at least ten times the highest platform mode.")
    ] = None,
    noise: Annotated[
        str | None,
        _text("--noise", "VALUE", "Rms of the driving noise, as a free stroke (1um) or a voltage (5V). Default: 1 % of each stroke."),
    ] = None,
    band: Annotated[
        tuple[str, str] | None, _text("--band", "LOW HIGH", "Band of the driving noise. Default: from 0 to 0.4 times the rate.")
    ] = None,
    actuators: Annotated[list[str] | None, _text("--actuator", "NAME", "Drive this actuator only; several times. Default: all.")] = None,
    amplifier: Annotated[
        list[str] | None,
        _text("--amplifier", "VALUE", "Bandwidth (500Hz) or output resistance (50ohm); largest current (0.2A). Default: ideal."),
    ] = None,
    filter_order: Annotated[int, typer.Option("--filter-order", help="Order of the anti-alias filter (Butterworth); 0: none.")] = 8,
    filter_corner: Annotated[str | None, _text("--filter-corner", "VALUE", "Its corner. Default: 0.4 times the rate.")] = None,
    gauge_noise: Annotated[
        str | None, _text("--gauge-noise", "DENSITY", 'Noise of the gauges, e.g. "0.1 nm/Hz^0.5". Default: what the design states.')
    ] = None,
    resolution: Annotated[str | None, _text("--resolution", "VALUE", "Steps of the gauges; 0nm: none. Default: the design's.")] = None,
    drift: Annotated[
        str, typer.Option("--drift", metavar="VALUE", help="Random walk of each gauge: standard deviation after a minute.")
    ] = "0 nm",
    tap: Annotated[
        Tap,
        typer.Option(
            "--tap",
            parser=choice("--tap", Tap),
            metavar=choices(Tap),
            help="Record inputs behind the amplifier and filtered as the gauges are, or as commanded.",
        ),
    ] = Tap.MONITOR,
    inputs: Annotated[
        Recorded,
        typer.Option("--inputs", parser=choice("--inputs", Recorded), metavar=choices(Recorded), help="Inputs as strokes in um or volts."),
    ] = Recorded.STROKE,
    reading: Theory = Reading.LUMPED,
    changes: Changes = None,
) -> None:
    """Test a stage on a virtual rig; write the record.

    White noise in the actuators, through amplifier, stage, gauges with noise, drift and steps, anti-alias filter and sampling.

    Same seed, same file. `flexstage identify` finds the modes in it as in any record.
    """
    from flexstage.apps.cli.answer import elastic_model
    from flexstage.apps.cli.opening import opened
    from flexstage.studies.rig.setup import AntiAlias, RigSetup, Sensing

    mechanism = opened(design, changes, [("--output", output)])
    values = _Values()
    setup = RigSetup(
        seconds=seconds,
        rate=values.frequency("--rate", rate),
        seed=seed,
        drive=_drive(values, noise, band, actuators),
        amplifier=_amplifier(values, amplifier),
        filter=AntiAlias(filter_order, values.frequency("--filter-corner", filter_corner)),
        sensing=Sensing(values.density(gauge_noise), values.length("--resolution", resolution), values.length("--drift", drift) or 0.0),
        tap=tap,
        recorded=inputs,
    )
    values.require()
    _run(mechanism, elastic_model(mechanism, reading), setup, output)


def _run(mechanism: Any, model: Any, setup: RigSetup, output: Path) -> None:
    from flexstage.apps.cli.answer import caveat_lines
    from flexstage.apps.cli.bar import bar
    from flexstage.apps.cli.opening import announce
    from flexstage.apps.cli.show import show
    from flexstage.present.tables.rig import rig_table
    from flexstage.readings.measured.write import write
    from flexstage.studies.rig.rig import as_record, simulated

    with bar() as shown:
        test = simulated(mechanism, model, setup, tell=lambda share: shown.share("testing", share))
        write(output, as_record(test))
    show((*caveat_lines("rig", mechanism), rig_table(test)))
    announce(output)


class _Values:
    """Reads texts with units; what is wrong is told of all of them together."""

    def __init__(self) -> None:
        from flexstage.base.finding import Finding

        self._findings: list[Finding] = []

    def of(self, where: str, text: str | None, *quantities: Quantity) -> tuple[Quantity, float] | None:
        """The first of the quantities the text is of, with its value; nothing where the text is absent or wrong."""
        from flexstage.base.finding import DesignError, Finding
        from flexstage.base.unit import parse

        found: list[Finding] = []
        for quantity in quantities if text is not None else ():
            try:
                return quantity, parse(text or "", quantity, where=where)
            except DesignError as error:
                found = [*found, *error.findings]
        if len(found) > 1:
            examples = " or ".join(f'"{quantity.example}"' for quantity in quantities)
            nouns = ", ".join(quantity.noun for quantity in quantities)
            found = [Finding(where, f'found "{text}", which is none of: {nouns}', f"Write for example {examples}")]
        self._findings += found
        return None

    def frequency(self, where: str, text: str | None) -> float | None:
        """A frequency in Hz."""
        from flexstage.base.quantity import FREQUENCY

        found = self.of(where, text, FREQUENCY)
        return None if found is None else found[1]

    def length(self, where: str, text: str | None) -> float | None:
        """A displacement in m."""
        from flexstage.base.quantity import DISPLACEMENT

        found = self.of(where, text, DISPLACEMENT)
        return None if found is None else found[1]

    def density(self, text: str | None) -> float | None:
        """A noise density in m/Hz^0.5."""
        from flexstage.base.quantity import NOISE_DENSITY

        found = self.of("--gauge-noise", text, NOISE_DENSITY)
        return None if found is None else found[1]

    def require(self) -> None:
        """Raise a `DesignError` of all that was wrong."""
        from flexstage.base.finding import require

        require(self._findings)


def _drive(values: _Values, noise: str | None, band: tuple[str, str] | None, actuators: list[str] | None) -> NoiseDrive:
    from flexstage.base.quantity import DISPLACEMENT, VOLTAGE
    from flexstage.studies.rig.setup import NoiseDrive

    found = values.of("--noise", noise, DISPLACEMENT, VOLTAGE)
    ends = None if band is None else [values.frequency("--band", text) for text in band]
    return NoiseDrive(
        stroke=found[1] if found is not None and found[0] is DISPLACEMENT else None,
        voltage=found[1] if found is not None and found[0] is VOLTAGE else None,
        band=None if ends is None or ends[0] is None or ends[1] is None else (ends[0], ends[1]),
        actuators=tuple(actuators) if actuators else None,
    )


def _amplifier(values: _Values, texts: list[str] | None) -> Amplifier:
    from flexstage.base.quantity import CURRENT, FREQUENCY, RESISTANCE
    from flexstage.studies.rig.setup import Amplifier

    found = [each for text in texts or () if (each := values.of("--amplifier", text, FREQUENCY, RESISTANCE, CURRENT)) is not None]
    known = {quantity.name: value for quantity, value in found}
    return Amplifier(bandwidth=known.get("frequency"), resistance=known.get("resistance"), current=known.get("current"))
