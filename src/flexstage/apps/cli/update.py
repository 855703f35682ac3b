"""The command `update`: a stage's numbers brought to agree with a test, in a design file of their own."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexstage.apps.cli.answer import Asked, answer
from flexstage.apps.cli.identify import identified, writable
from flexstage.apps.cli.options import Design, Json
from flexstage.apps.cli.output import STDOUT, announced, write
from flexstage.apps.cli.record import Allow, Band, Inputs, Kind, Only, Outputs, Rate, Resolution, Said, Units
from flexstage.apps.cli.speech import warn
from flexstage.studies.reading import Reading

if TYPE_CHECKING:
    from flexstage.studies.update_free import Known


def update(  # noqa: PLR0913 (its options)
    design: Design,
    *,
    record: Annotated[
        list[Path],
        typer.Option("--record", metavar="RECORD", help="File of the test. May be given several times.", show_default=False),
    ],
    free: Annotated[
        list[str],
        typer.Option(
            "--free", metavar="ADDRESSES", help='Numbers that may change, e.g. "neck.thickness, steel.density".', show_default=False
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", metavar="STAGE.TOML", help="Design file to write.", show_default=False)],
    prior: Annotated[
        list[str] | None,
        typer.Option(
            "--prior",
            metavar="[ADDRESS=]SHARE",
            help='Relative standard deviation known before, of all or of one: "5 %", "neck.thickness=2 %". Default: 10 %, assumed.',
            show_default=False,
        ),
    ] = None,
    model_error: Annotated[
        str, typer.Option("--model-error", metavar="SHARE", help="Relative standard deviation of theory's frequencies.")
    ] = "0.1 %",
    gain: Annotated[bool, typer.Option("--gain", help="Compare the static gains of gauges to strokes too.")] = False,
    gain_error: Annotated[
        str, typer.Option("--gain-error", metavar="SHARE", help="Relative standard deviation of gains: theory, gauges and drives.")
    ] = "0.1 %",
    inputs: Inputs = None,
    outputs: Outputs = None,
    only: Only = None,
    units: Units = None,
    rate: Rate = None,
    kind: Kind = None,
    allow: Allow = None,
    band: Band = None,
    resolution: Resolution = None,
    json: Json = None,
) -> None:
    """Bring a stage's numbers to agree with a test.

    Bayesian least squares: values, standard deviations, correlations, and how well the test tells each number.

    Writes a new design file with the values tagged; comments stay, and the file that was read stays as it is.
    """
    said = Said(inputs, outputs, only, units, rate, kind, allow, band, resolution)
    writable(record, design, [("--output", output), ("--json", json)])
    known = _known(prior or [], model_error, gain_error, gain=gain)
    from flexstage.mechanism.store import loads
    from flexstage.mechanism.store.file import read_text
    from flexstage.present.documents.update import update_body
    from flexstage.present.tables.update import update_tables
    from flexstage.studies.rig.plan import highest_mode
    from flexstage.studies.standing import standing
    from flexstage.studies.update import update as updated
    from flexstage.studies.update_free import free as freed
    from flexstage.studies.update_text import updated_text

    text = read_text(design)
    mechanism = loads(text, where=str(design))
    names = _names(free)
    freed(mechanism, names, known)  # refused before the records are read
    model = standing(mechanism)
    seen = identified(said, record, model, highest=highest_mode(mechanism, model))
    found = updated(mechanism, seen.found, names, known)
    write(output, updated_text(text, found, ", ".join(path.name for path in record), where=str(design)), "--output")
    for caution in found.warnings[len(seen.found.warnings) :]:
        warn(caution)
    if str(output) != STDOUT:
        announced(f"Wrote {output}")
        answer(Asked("update", mechanism, Reading.LUMPED, json), lambda: update_body(found), lambda: update_tables(found))


def _names(texts: Sequence[str]) -> tuple[str, ...]:
    return tuple(name.strip() for text in texts for name in text.split(",") if name.strip())


def _known(priors: Sequence[str], model_error: str, gain_error: str, *, gain: bool) -> Known:
    from flexstage.studies.update_free import DEFAULT, Known

    shares: dict[str, float] = {}
    for text in priors:
        name, _, share = (part.strip() for part in text.rpartition("="))
        shares[name] = _share(f"--prior {name}".strip(), share)
    gains = _share("--gain-error", gain_error)  # looked at even where it is not used: a slip is told
    return Known(
        prior=shares.pop("", DEFAULT.prior),
        priors=shares,
        model_error=_share("--model-error", model_error),
        gain_error=gains if gain else None,
    )


def _share(option: str, text: str) -> float:
    from flexstage.base.finding import refuse
    from flexstage.base.quantity import RATIO
    from flexstage.base.unit import parse

    value = parse(text, RATIO, where=option)
    if not 1e-6 <= value <= 1.0:
        raise refuse(
            option, f"{text.strip()} is no relative standard deviation to work with", 'Give one from 0.0001 % to 100 %, e.g. "5 %"'
        )
    return value
