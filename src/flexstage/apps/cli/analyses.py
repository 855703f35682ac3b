"""Commands of one analysis each: `mapping`, `stiffness`, `lost-motion`, `modes`, `response`."""

from __future__ import annotations

from typing import Annotated

import typer

from flexstage.apps.cli.answer import Asked, answer, elastic_model, known_point
from flexstage.apps.cli.grouped import lost_motion_tables, mapping_tables, stiffness_tables
from flexstage.apps.cli.noise import spectra_from
from flexstage.apps.cli.opening import opened
from flexstage.apps.cli.options import Changes, Design, Json, Theory
from flexstage.studies.reading import Reading

Band = Annotated[
    tuple[str, str] | None,
    typer.Option("--band", metavar="LOW HIGH", help='Frequencies, e.g. --band "1 Hz" "1 kHz".', show_default=False),
]


def mapping(design: Design, *, reading: Theory = Reading.IDEAL, changes: Changes = None, json: Json = None) -> None:
    """Mappings R_a and R_s, mobility, redundancy.

    R_a: strokes per platform motion. R_s: gauge readings per platform motion.

    With an elastic reading, the elastic motion per stroke T too.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.present.documents.results import elastic_jacobian, mapping_body
    from flexstage.readings.ideal import ideal
    from flexstage.studies.complete import read

    kinematics, model = ideal(mechanism), read(mechanism, reading)
    answer(
        Asked("mapping", mechanism, reading, json),
        lambda: mapping_body(kinematics) | ({} if model is None else {"elastic_jacobian": elastic_jacobian(kinematics, model)}),
        lambda: mapping_tables(kinematics),
    )


def stiffness(
    design: Design,
    *,
    reading: Theory = Reading.LUMPED,
    at: Annotated[str, typer.Option(metavar="POINT", help="Point whose motion is read: platform, or a named point.")] = "platform",
    load_at: Annotated[str, typer.Option(metavar="POINT", help="Point that is loaded. Default: the one that is read.")] = "",
    changes: Changes = None,
    json: Json = None,
) -> None:
    """Compliance and stiffness of the platform.

    6x6, by direction in the plane, and the centre of stiffness; strokes held.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.analysis.deflection import deflection
    from flexstage.analysis.statics import statics
    from flexstage.present.documents.results import stiffness_body

    model = elastic_model(mechanism, reading)
    found = statics(model, load_point=known_point(model, load_at or at), read_point=known_point(model, at))
    sagging = deflection(mechanism, model, point=at) if reading is Reading.LUMPED else None
    answer(Asked("stiffness", mechanism, reading, json), lambda: stiffness_body(found, sagging), lambda: stiffness_tables(found, sagging))


def lost_motion(design: Design, *, reading: Theory = Reading.LUMPED, changes: Changes = None, json: Json = None) -> None:
    """Gain, loss and its budget by part, crosstalk, correction.

    What elasticity takes from the ideal motion, what it stirs besides, and the gains that make up for it.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.analysis.lost_motion import lost_motion as compared
    from flexstage.present.documents.results import lost_motion_body
    from flexstage.readings.ideal import ideal

    found = compared(ideal(mechanism), elastic_model(mechanism, reading))
    answer(Asked("lost-motion", mechanism, reading, json), lambda: lost_motion_body(found), lambda: lost_motion_tables(found))


def modes(design: Design, *, reading: Theory = Reading.LUMPED, changes: Changes = None, json: Json = None) -> None:
    """Natural frequencies, names and shapes.

    Which modes are the platform's, which are local, and by what margin.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.present.documents.results import modes_body
    from flexstage.present.tables.modes import mode_table
    from flexstage.studies.complete import platform_modes

    found = platform_modes(mechanism, elastic_model(mechanism, reading))
    answer(Asked("modes", mechanism, reading, json), lambda: modes_body(found), lambda: [mode_table(found)])


def response(
    design: Design,
    *,
    reading: Theory = Reading.LUMPED,
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input", metavar="NAME", help="Stroke (B1), force (platform.fx), ground motion (ground); several times.", show_default=False
        ),
    ] = None,
    outputs: Annotated[
        list[str] | None,
        typer.Option(
            "--output",
            metavar="NAME",
            help="Motion (platform, chuck.x), gauge (S1), resultant (B4/pivot.mz); several times.",
            show_default=False,
        ),
    ] = None,
    band: Band = None,
    noise: Annotated[
        list[str] | None,
        typer.Option(
            "--noise",
            metavar="INPUT=DENSITY",
            help='White random input: its amplitude density, e.g. "ground.z=1 nm/Hz^0.5", or that of a rate, "ground.z=1e-5 m/s^2/Hz^0.5".',
            show_default=False,
        ),
    ] = None,
    changes: Changes = None,
    json: Json = None,
) -> None:
    """Frequency response of outputs to inputs.

    Strokes to the platform's motion and the gauges, unless others are named. --input ground gives the transmissibility: absolute motion
    over absolute motion of the ground. With --noise, the rms values of the outputs too.
    """
    mechanism = opened(design, changes, [("--json", json)])
    from flexstage.analysis.random_response import random_response
    from flexstage.analysis.response import default_frequencies
    from flexstage.analysis.response import response as responded
    from flexstage.present.documents.results import response_body
    from flexstage.present.tables.random_response import random_table
    from flexstage.present.tables.response import response_table
    from flexstage.readings.linear.damping import damping_law

    model = elastic_model(mechanism, reading)
    law = damping_law(model)
    grid = default_frequencies(model, _hertz(band), damping=law)
    chosen = outputs or ["platform", *(channel.name for channel in model.outputs if "." not in channel.name)]
    found = responded(model, chosen, inputs or model.strokes, grid, damping=law)
    limits = (float(grid[0]), float(grid[-1]))
    shaken = random_response(model, chosen, spectra_from(model, noise), limits, damping=law) if noise else None
    answer(
        Asked("response", mechanism, reading, json),
        lambda: response_body(found, law) | ({} if shaken is None else {"random": shaken.to_json()}),
        lambda: [response_table(found), None if shaken is None else random_table(shaken)],
    )


def _hertz(band: tuple[str, str] | None) -> tuple[float, float] | None:
    from flexstage.base.finding import refuse
    from flexstage.base.quantity import FREQUENCY
    from flexstage.base.unit import parse

    if band is None:
        return None
    low, high = (parse(text, FREQUENCY, where="--band") for text in band)
    if not 0.0 < low < high:
        raise refuse("--band", f"{band[0]} to {band[1]} is no band", "Give a low frequency above zero and a higher one")
    return low, high
