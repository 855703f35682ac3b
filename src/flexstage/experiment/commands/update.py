"""The command `update`: update a stage's parameters from a test, in a new design file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.loaded.standing import standing
from flexstage.base.finding import refuse
from flexstage.base.units.quantity import RATIO
from flexstage.base.units.unit import parse
from flexstage.experiment.record_options import RECORD, RecordTexts, identify_records
from flexstage.experiment.updating import update as updating
from flexstage.experiment.updating.free import DEFAULT, Prior
from flexstage.experiment.updating.free import free as free_numbers
from flexstage.experiment.updating.tables import update_tables
from flexstage.experiment.updating.text import updated_text
from flexstage.mechanism.store import loads
from flexstage.mechanism.store.file import read_text
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.options import Design, output_option, parameters_option, text_option
from flexstage.show.command.output import save
from flexstage.show.command.terminal import print_warning
from flexstage.show.command.values import names


@command("output")
def update(  # noqa: PLR0913 (its options)
    design: Design,
    *,
    record: Annotated[list[Path], RECORD],
    parameters: Annotated[list[str], parameters_option()],
    output: Annotated[Path, output_option("STAGE.TOML", "Design file to write.")],
    prior: Annotated[
        list[str] | None,
        text_option(
            "--prior",
            "[ADDRESS=]SHARE",
            'Prior relative standard deviation of all parameters or of one, e.g. "5 %" or "neck.thickness=2 %". Default: 10 %. Repeatable.',
        ),
    ] = None,
    model_error: Annotated[
        str, typer.Option("--model-error", metavar="SHARE", help="Relative standard deviation of the theoretical frequencies.")
    ] = "0.1 %",
    gain: Annotated[bool, typer.Option("--gain", help="Also use the static gains from actuators to gauges as data.")] = False,
    gain_error: Annotated[
        str,
        typer.Option(
            "--gain-error",
            metavar="SHARE",
            help="Standard deviation of static gains due to scale errors of gauges and drives, relative to each actuator's largest gain.",
        ),
    ] = "0.1 %",
    texts: RecordTexts,
) -> CommandResult:
    """Update parameters of a stage from a test.

    Uses Bayesian least squares. Prints values, standard deviations, correlations and the combinations of parameters that the test
    identifies.

    Writes a new design file. Comments are kept, and a tag states the source of each updated value.
    """
    known = _known(prior or [], model_error, gain_error, gain=gain)
    text = read_text(design)
    mechanism = loads(text, where=str(design))
    chosen = names(parameters)
    free_numbers(mechanism, chosen, known)  # refuse before the records are read
    model = standing(mechanism)
    seen = identify_records(record, texts, model, platform_modes(mechanism, model).highest)
    found = updating.update(mechanism, seen.found, chosen, known)
    save(output, updated_text(text, found, ", ".join(path.name for path in record), where=str(design)), "--output")
    for warning in found.data_warnings[len(seen.found.data_warnings) :]:
        print_warning(warning)
    return CommandResult(mechanism, lambda: found, lambda: update_tables(found), model=Model.LUMPED)


def _known(priors: Sequence[str], model_error: str, gain_error: str, *, gain: bool) -> Prior:
    shares: dict[str, float] = {}
    for text in priors:
        name, _, share = (part.strip() for part in text.rpartition("="))
        shares[name] = _share(f"--prior {name}".strip(), share)
    gains = _share("--gain-error", gain_error)  # checked even if unused, to report mistakes
    return Prior(
        prior=shares.pop("", DEFAULT.prior),
        priors=shares,
        model_error=_share("--model-error", model_error),
        gain_error=gains if gain else None,
    )


def _share(option: str, text: str) -> float:
    value = parse(text, RATIO, where=option)
    if not 1e-6 <= value <= 1.0:
        raise refuse(option, f"not a valid relative standard deviation (got {text.strip()})", 'Use 0.0001 % to 100 %, e.g. "5 %"')
    return value
