"""Commands about reach and quality: `workspace`, `drift`, `sensitivities`, `budget`."""

from __future__ import annotations

from typing import Annotated

import typer

from flexstage.apps.cli.answer import Asked, answer, tell_missing
from flexstage.apps.cli.grouped import drift_tables, workspace_tables
from flexstage.apps.cli.opening import opened
from flexstage.apps.cli.options import Changes, Design, Json, Theory
from flexstage.studies.reading import Reading

Commands = Annotated[
    list[str] | None,
    typer.Option(
        "--command",
        metavar="AXIS=VALUE",
        help="Motion both ways that is asked of the platform, all at once, e.g. x=50um, rz=244urad. Default: the required strokes.",
        show_default=False,
    ),
]


def workspace(
    design: Design, *, reading: Theory = Reading.LUMPED, command: Commands = None, changes: Changes = None, json: Json = None
) -> None:
    """What the stage reaches and bears.

    Strokes, forces, volts, gauges, room, error of the linear map, stress, buckling, loads.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.analysis.lost_motion import lost_motion
    from flexstage.present.documents.reach import workspace_body
    from flexstage.readings.ideal import ideal
    from flexstage.studies.complete import read, required_command
    from flexstage.studies.workspace import workspace as reached

    kinematics, model = ideal(mechanism), read(mechanism, reading)
    lost = None if model is None or not kinematics.actuated else lost_motion(kinematics, model)
    asked = motions_from(command) or required_command(mechanism)
    found = reached(mechanism, kinematics, model, lost=lost, command=asked)
    answer(Asked("workspace", mechanism, reading, json), lambda: workspace_body(found), lambda: workspace_tables(found))


def motions_from(command: list[str] | None) -> dict[str, float]:
    """The box of commands that `--command` options say; all mistakes are told together."""
    from flexstage.base.finding import DesignError, Finding, nearest, require
    from flexstage.base.quantity import ANGLE, DISPLACEMENT
    from flexstage.base.unit import parse
    from flexstage.spatial.frame import COMPONENTS

    found: dict[str, float] = {}
    findings: list[Finding] = []
    for text in command or ():
        name, _, value = (part.strip() for part in text.partition("="))
        if name not in COMPONENTS or not value:
            findings.append(
                Finding(f"--command {text}", "this names no motion and value", f"Write for example z=150um; {nearest(name, COMPONENTS)}")
            )
            continue
        try:
            found[name] = abs(parse(value, ANGLE if name.startswith("r") else DISPLACEMENT, where=f"--command {text}"))
        except DesignError as error:
            findings += error.findings
    require(findings)
    return found


def drift(
    design: Design,
    *,
    ground: Annotated[
        str | None,
        typer.Option(
            metavar="MATERIAL",
            help="Material of the ground, or none if it does not grow. Default: the design's, else that of all links on it.",
            show_default=False,
        ),
    ] = None,
    changes: Changes = None,
    json: Json = None,
) -> None:
    """Thermal drift of platform, named points and gauges.

    Per kelvin and per kelvin per metre, by the lumped reading.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.analysis.drift import drift as drifted
    from flexstage.present.documents.results import drift_body
    from flexstage.studies.standing import standing

    found = drifted(mechanism, standing(mechanism), ground=ground)
    answer(Asked("drift", mechanism, Reading.LUMPED, json), lambda: drift_body(found), lambda: drift_tables(found))


def sensitivities(
    design: Design,
    *,
    parameters: Annotated[
        list[str] | None,
        typer.Option("--parameter", metavar="ADDRESS", help="Value to vary; several times. Default: every number.", show_default=False),
    ] = None,
    count: Annotated[int, typer.Option("--modes", min=1, help="Number of lowest modes.")] = 12,
    changes: Changes = None,
    json: Json = None,
) -> None:
    """Exact derivatives with respect to every number.

    Of frequencies, gains and losses, by the lumped reading; of frequencies alone where the strokes do not determine the platform.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.present.documents.reach import sensitivities_body
    from flexstage.present.tables.sensitivities import frequency_sensitivity_table, loss_sensitivity_table
    from flexstage.studies.sensitivities import sensitivities as derived

    found = derived(mechanism, tuple(parameters) if parameters else None, modes=count)
    answer(
        Asked("sensitivities", mechanism, Reading.LUMPED, json),
        lambda: sensitivities_body(found),
        lambda: [frequency_sensitivity_table(found), loss_sensitivity_table(found)],
    )
    tell_missing(found.missing)


def budget(
    design: Design,
    *,
    command: Commands = None,
    temperature: Annotated[str, typer.Option(metavar="VALUE", help="Uniform change of temperature.")] = "1 K",
    at: Annotated[str, typer.Option(metavar="POINT", help="Point of the platform: platform, or a named point.")] = "platform",
    changes: Changes = None,
    json: Json = None,
) -> None:
    """Error budget in nm and nrad, one line an axis.

    Lost motion, crosstalk, linear map, gauge noise, quantisation and drift, by the lumped reading.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.base.quantity import TEMPERATURE
    from flexstage.base.unit import parse
    from flexstage.present.documents.reach import budget_body
    from flexstage.present.tables.errors import error_budget_tables
    from flexstage.studies.budget import budget as drawn
    from flexstage.studies.complete import required_command
    from flexstage.studies.workspace import all_strokes

    asked = motions_from(command) or required_command(mechanism) or all_strokes(mechanism)
    found = drawn(mechanism, asked, at=at, temperature=parse(temperature, TEMPERATURE, where="--temperature"))
    answer(Asked("budget", mechanism, Reading.LUMPED, json), lambda: budget_body(found), lambda: error_budget_tables(found))
