"""The command `rig`: a virtual test of a stage, written as a record."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexstage.base.finding import Finding, require
from flexstage.base.units.quantity import CURRENT, DISPLACEMENT, FORCE, FREQUENCY, MOMENT, NOISE_DENSITY, TIME, VOLTAGE
from flexstage.experiment.formats.write import write
from flexstage.experiment.records.record import report_reading
from flexstage.experiment.virtual_rig.inputs import InputQuantity, InputSignal
from flexstage.experiment.virtual_rig.rig import as_record, simulate_test
from flexstage.experiment.virtual_rig.setup import AntiAlias, NoiseDrive, RigSetup, Sensing
from flexstage.experiment.virtual_rig.tables import rig_table
from flexstage.models.theory import Model
from flexstage.parts.amplifier import Amplifier
from flexstage.show.command.answer import list_caveats, show
from flexstage.show.command.design import elastic_model, load_notes, open_design, with_elastic_bodies
from flexstage.show.command.options import (
    AmplifierValues,
    Changes,
    Design,
    ElasticBodies,
    ElasticModelName,
    GaugeNoise,
    GaugeResolution,
    Seed,
    band_option,
    output_option,
    rate_option,
    text_option,
    word_option,
)
from flexstage.show.command.output import announce
from flexstage.show.command.progress import progress_bar
from flexstage.show.command.values import Values, amplifier_values, first_that_parses


def rig(  # noqa: PLR0913  a test has that many knobs
    design: Design,
    *,
    output: Annotated[Path, output_option("RECORD", "File to write: .uff, .mat, .h5 or .csv.")],
    seconds: Annotated[float, text_option("--seconds", "NUMBER", "Duration in seconds.")],
    seed: Seed = None,
    rate: Annotated[
        str | None, rate_option("the lowest power of two that is at least ten times the frequency of the highest platform mode")
    ] = None,
    drive_rms: Annotated[
        str | None,
        text_option("--drive-rms", "VALUE", "Rms of the noise drive, e.g. 1um, 5V, 0.1A or 1N. Default: 1 % of each actuator's range."),
    ] = None,
    band: Annotated[tuple[str, str] | None, band_option("0 to 0.4 times the rate")] = None,
    actuators: Annotated[list[str] | None, text_option("--actuator", "NAME", "Driven actuator. Default: all. Repeatable.")] = None,
    amplifier: AmplifierValues = None,
    filter_order: Annotated[int, typer.Option("--filter-order", help="Order of the anti-alias filter (Butterworth); 0: no filter.")] = 8,
    filter_corner: Annotated[
        str | None, text_option("--filter-corner", "VALUE", "Corner frequency of the anti-alias filter. Default: 0.4 times the rate.")
    ] = None,
    gauge_noise: GaugeNoise = None,
    resolution: GaugeResolution = None,
    drift: Annotated[
        str, typer.Option("--drift", metavar="VALUE", help="Drift of each gauge: standard deviation of a random walk after one minute.")
    ] = "0 nm",
    input_signal: Annotated[
        InputSignal,
        word_option(
            "--input-signal",
            InputSignal,
            "Recorded input signal: monitor (amplifier output, filtered) or command (amplifier input, unfiltered).",
        ),
    ] = InputSignal.MONITOR,
    delay: Annotated[str, typer.Option("--delay", metavar="VALUE", help="Delay of the recorded gauge readings, e.g. 1ms.")] = "0 s",
    input_quantity: Annotated[
        InputQuantity | None,
        word_option(
            "--input-quantity",
            InputQuantity,
            "Quantity of the recorded inputs. Default: the input of each actuator, e.g. stroke or current.",
        ),
    ] = None,
    model: ElasticModelName = Model.LUMPED,
    changes: Changes = None,
    elastic_bodies: ElasticBodies = False,
) -> None:
    """Simulate a test of a stage, and write the record.

    On the virtual rig, noise drives the actuators through amplifiers. The gauges of the stage have noise, drift and quantisation. Their
    readings are filtered and sampled.

    Two runs with the same seed write identical files.
    """
    mechanism = with_elastic_bodies(open_design(design, changes, [("--output", output)]), chosen=elastic_bodies)
    values = Values()
    setup = RigSetup(
        seconds=seconds,
        rate=values.value("--rate", rate, FREQUENCY),
        seed=seed or 0,
        drive=_drive(values, drive_rms, band, actuators),
        amplifier=Amplifier(**amplifier_values(values, amplifier or ())),
        filter=AntiAlias(filter_order, values.value("--filter-corner", filter_corner, FREQUENCY)),
        sensing=Sensing(
            values.value("--gauge-noise", gauge_noise, NOISE_DENSITY),
            values.value("--resolution", resolution, DISPLACEMENT),
            values.value("--drift", drift, DISPLACEMENT) or 0.0,
        ),
        input_signal=input_signal,
        input_quantity=input_quantity,
        delay=values.value("--delay", delay, TIME) or 0.0,
    )
    require(values.findings)
    linear = elastic_model(mechanism, model, loaded=True)
    with progress_bar() as shown:
        test = simulate_test(mechanism, linear, setup)
        write(output, report_reading(as_record(test), lambda stop: shown.share("testing", stop / test.length)))
    show((*load_notes(mechanism, model), *list_caveats("rig", mechanism), rig_table(test)))
    announce(f"Wrote {output}")


def _drive(values: Values, drive_rms: str | None, band: tuple[str, str] | None, actuators: list[str] | None) -> NoiseDrive:
    amount = (
        None
        if drive_rms is None
        else first_that_parses(
            drive_rms, {"stroke": DISPLACEMENT, "voltage": VOLTAGE, "current": CURRENT, "force": FORCE, "torque": MOMENT}
        )
    )
    if drive_rms is not None and amount is None:
        what = f'not a displacement, voltage, current, force or torque (got "{drive_rms}")'
        values.findings.append(Finding("--drive-rms", what, 'Use e.g. "1 um", "5 V" or "0.1 A"'))
    low, high = (values.value("--band", text, FREQUENCY) for text in band or (None, None))
    return NoiseDrive(
        **dict([amount] if amount else []),
        band=None if low is None or high is None else (low, high),
        actuators=tuple(actuators) if actuators else None,
    )
