"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

import typer

from flexstage.apps.cli.choice import choice, choices
from flexstage.studies.reading import Reading

_OTHERWISE = {"solid": "Solids have commands of their own: flexstage solid, flexstage verify"}

Design: TypeAlias = Annotated[Path, typer.Argument(help="Design file (TOML).", metavar="STAGE.TOML", show_default=False)]

Theory: TypeAlias = Annotated[
    Reading,
    typer.Option(
        "--reading",
        parser=choice("--reading", Reading, _OTHERWISE),
        metavar=choices(Reading),
        autocompletion=lambda: [each.value for each in Reading],
        help="Theory to read the stage by: rigid bodies, the paper's axial springs, or lumped 6x6 hinges.",
    ),
]

Changes: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="ADDRESS=VALUE",
        help="Change a value before the analysis, e.g. horizontal/front.thickness=1.4mm. May be given several times.",
        show_default=False,
    ),
]

Json: TypeAlias = Annotated[
    str | None,
    typer.Option("--json", metavar="-|FILE", help="Write the result as JSON: to stdout (-) or a file.", show_default=False),
]
