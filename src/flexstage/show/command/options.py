"""Arguments and options shared by several commands, and functions that define options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, TypeAlias

import typer

from flexstage.base.finding import list_choices
from flexstage.models.theory import Model
from flexstage.show.command.failure import BAD_INPUT
from flexstage.show.command.output import check_folder
from flexstage.show.command.terminal import print_note

_NOTHING: Mapping[str, str] = MappingProxyType({})


def text_option(name: str, metavar: str, about: str, default: str = "") -> Any:
    """Define a text option. The help text is `about`, followed by a sentence with the default value if `default` is not empty."""
    return typer.Option(name, metavar=metavar, help=f"{about} Default: {default}." if default else about, show_default=False)


def output_option(metavar: str, about: str) -> Any:
    """Define the option `--output` for the output file of a command."""
    return typer.Option("--output", "-o", metavar=metavar, help=about, show_default=False)


def word_option(
    name: str,
    kind: type[Enum],
    about: str,
    *,
    words: Sequence[str] = (),
    otherwise: Mapping[str, str] = _NOTHING,
    show_default: bool = True,
) -> Any:
    """Define an option with a choice of `words`, by default all values of the `kind`. `otherwise` maps likely mistakes to hints."""
    words = words or [str(each.value) for each in kind]

    def read(word: str | Enum) -> Enum:
        for each in kind:
            if word in (each, each.value):  # the member: a default
                return each
        advice = f" {otherwise[str(word)]}." if word in otherwise else ""
        print_note(f"error: {name}: must be {list_choices([str(each.value) for each in kind])} (got {word}).{advice}")
        raise typer.Exit(BAD_INPUT)

    return typer.Option(
        name,
        parser=read,
        metavar=f"<{'|'.join(words)}>",
        autocompletion=lambda: words,
        help=about,
        show_default=show_default,
    )


Design: TypeAlias = Annotated[Path, typer.Argument(help="Design file (TOML).", metavar="STAGE.TOML", show_default=False)]


_model_option = partial(
    word_option,
    "--model",
    Model,
    "Model of the stage; the simplest model is listed first.",
    otherwise={"solid": "For solids, use flexstage solid or flexstage verify"},
)
ELASTIC_MODEL = _model_option(words=("mapped", "lumped"))
ModelName: TypeAlias = Annotated[Model, _model_option()]
ElasticModelName: TypeAlias = Annotated[Model, ELASTIC_MODEL]

Changes: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--set",
        "ADDRESS=VALUE",
        "Value to change in the design, e.g. horizontal/front.thickness=1.4mm or numbers.arm=+10%. Repeatable.",
    ),
]

ElasticBodies: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--elastic-bodies", help="Use elastic bodies in the lumped model; the flexibility of a body is estimated from its outlines."
    ),
]

Json: TypeAlias = Annotated[str | None, text_option("--json", "-|FILE", "JSON file of the result, or - for stdout.")]

Csv: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        "--csv",
        metavar="FOLDER",
        callback=check_folder,
        help="Folder for CSV files of all tables, in SI units.",
        show_default=False,
    ),
]

Xlsx: TypeAlias = Annotated[Path | None, text_option("--xlsx", "FILE", "Excel workbook of all tables, in SI units.")]


Port: TypeAlias = Annotated[int, typer.Option("--port", min=0, max=65535, help="Port on this computer; 0 selects a free port.")]

InputDensities: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--input-asd",
        "INPUT=DENSITY",
        "White noise at an input, as an amplitude spectral density. The unit of the density shows whether the input, its velocity or its "
        'acceleration is white, e.g. "ground.z=1 nm/Hz^0.5" or "ground.z=1e-5 m/s^2/Hz^0.5". Repeatable.',
    ),
]

GaugeNoise: TypeAlias = Annotated[
    str | None,
    text_option("--gauge-noise", "DENSITY", 'Noise density of the gauges, e.g. "0.1 nm/Hz^0.5". Default: the value of the design.'),
]

GaugeResolution: TypeAlias = Annotated[
    str | None, text_option("--resolution", "VALUE", "Resolution of the gauges; 0nm for no quantisation. Default: the value of the design.")
]

AmplifierValues: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--amplifier",
        "VALUE",
        "Bandwidth, output resistance or maximum current of the amplifier, e.g. 500Hz, 50ohm or 0.2A. Default: ideal. Repeatable.",
    ),
]

rate_option = partial(text_option, "--rate", "FREQUENCY", 'Sampling rate, e.g. "2 kHz".')
band_option = partial(text_option, "--band", "LOW HIGH", 'Frequency band, e.g. "50 Hz" "400 Hz".')
temperature_option = partial(text_option, "--temperature", "VALUE", 'Uniform temperature change, e.g. "5 K".')
parameters_option = partial(
    text_option, "--parameters", "ADDRESSES", 'Addresses of parameters, e.g. "neck.thickness, steel.density". Repeatable.'
)
order_option = partial(typer.Option, "--order", max=5, help="Polynomial order of the elements.")
modes_option = partial(typer.Option, "--modes", help="Number of modes, starting with the lowest.")
STEPS = typer.Option(
    "--steps",
    metavar="N",
    min=2,
    help="Number of equilibria, including the first and the last. Default: 11, unless a load path of the design specifies another number.",
    show_default=False,
)

Seed: TypeAlias = Annotated[int | None, text_option("--seed", "NUMBER", "Seed of all random numbers. Default: 0.")]

Full: TypeAlias = Annotated[bool, typer.Option("--full", help="Print all tables and notes instead of a summary.")]

FEA = typer.Option("--fea", help="Use finite-element results, which are read from the cache or computed.")

Point: TypeAlias = Annotated[
    str, typer.Option("--point", metavar="POINT", help="Point whose displacement is computed: the platform or a named point.")
]

Report: TypeAlias = Annotated[Path | None, text_option("--report", "FILE", "HTML report with pictures.")]

Study: TypeAlias = Annotated[Path, typer.Argument(help="File of the study (TOML).", metavar="STUDY.TOML", show_default=False)]

Resume: TypeAlias = Annotated[bool, typer.Option("--resume", help="Continue an interrupted computation from its stored results.")]

Workers: TypeAlias = Annotated[int | None, text_option("--workers", "N", "Number of processes. Default: one per core.")]
