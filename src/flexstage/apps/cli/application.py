"""The application: all commands by name, each with an example."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import typer

from flexstage.apps.cli import (
    about,
    analyses,
    design,
    hysteresis,
    identify,
    loop,
    optimise,
    reach,
    rig,
    solid,
    solid_files,
    study,
    tolerance,
    update,
    whole,
)

app = typer.Typer(
    help="Design and proof of flexure-based ultra-precision positioning stages.",
    epilog="Start with: flexstage new stage.toml, then flexstage analyse stage.toml --report report.html",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120},
)

_FILES = "Design files"
_WHOLE = "The whole stage"
_SINGLE = "One analysis"
_TESTS = "Tests of a stage"
_CONTROL = "Control"
_STUDIES = "Many designs"
_INSTALLATION = "Installation"

COMMANDS: tuple[tuple[str, str, Callable[..., Any], str], ...] = (
    (_FILES, "new", design.new, "flexstage new stage.toml --case hexapod"),
    (_FILES, "check", design.check, "flexstage check stage.toml"),
    (_FILES, "schema", design.schema, "flexstage schema > flexstage.schema.json"),
    (_FILES, "plan", design.plan, "flexstage plan stage.toml -o plan.svg"),
    (_FILES, "import", solid_files.state, "flexstage import part.step stage.toml --material steel"),
    (_FILES, "catalogue", design.catalogue, "flexstage catalogue stacks"),
    (_WHOLE, "analyse", whole.analyse, "flexstage analyse stage.toml --report report.html --set horizontal/front.thickness=1.4mm"),
    (_WHOLE, "solid", solid.solid, "flexstage solid stage.toml --what unit --report units.html"),
    (_WHOLE, "verify", solid.verify, "flexstage verify stage.toml --report verified.html"),
    (_WHOLE, "calibrate", solid.calibrate, "flexstage calibrate stage.toml -o stage-calibrated.toml"),
    (_WHOLE, "cad", solid_files.cad, "flexstage cad stage.toml -o stage.step"),
    (_SINGLE, "mapping", analyses.mapping, "flexstage mapping stage.toml --json -"),
    (_SINGLE, "stiffness", analyses.stiffness, "flexstage stiffness stage.toml --reading mapped"),
    (_SINGLE, "lost-motion", analyses.lost_motion, "flexstage lost-motion stage.toml --set vertical/pivot.thickness=0.9mm"),
    (_SINGLE, "modes", analyses.modes, "flexstage modes stage.toml --reading mapped --json modes.json"),
    (_SINGLE, "response", analyses.response, 'flexstage response stage.toml --input ground.z --output platform.z --band "1 Hz" "1 kHz"'),
    (_SINGLE, "workspace", reach.workspace, "flexstage workspace stage.toml --command x=50um --command rz=244urad"),
    (_SINGLE, "drift", reach.drift, "flexstage drift stage.toml --ground none"),
    (_SINGLE, "sensitivities", reach.sensitivities, "flexstage sensitivities stage.toml --parameter parts.neck.thickness"),
    (_SINGLE, "budget", reach.budget, "flexstage budget stage.toml --command z=150um --temperature 0.1K"),
    (_TESTS, "rig", rig.rig, "flexstage rig stage.toml --seconds 10 --noise 1um --drift 5nm -o record.uff"),
    (_TESTS, "identify", identify.identify, "flexstage identify record.uff --stage stage.toml --report modes.html"),
    (_TESTS, "compare", identify.compare, "flexstage compare stage.toml --record record.uff --report compared.html"),
    (
        _TESTS,
        "update",
        update.update,
        'flexstage update stage.toml --record record.uff --free "neck.thickness, steel.density" -o updated.toml',
    ),
    (_TESTS, "hysteresis", hysteresis.hysteresis, 'flexstage hysteresis stack.csv --limits "0 V" "1000 V" -o stack.toml'),
    (_STUDIES, "sweep", study.sweep, "flexstage sweep study.toml -o results.h5 --report sweep.html"),
    (_STUDIES, "optimise", optimise.optimise, "flexstage optimise study.toml -o better.toml --report optimum.html"),
    (_STUDIES, "tolerance", tolerance.tolerance, "flexstage tolerance study.toml --report tolerance.html"),
    (_CONTROL, "loop", loop.loop, "flexstage loop stage.toml --floor VC-D --report loop.html"),
    (_INSTALLATION, "doctor", about.doctor, "flexstage doctor --mend"),
    (_INSTALLATION, "version", about.version, "flexstage version"),
)
"""Section of the help, name, function and example of every command."""

for _section, _name, _function, _example in COMMANDS:
    app.command(_name, epilog=f"Example: {_example}", rich_help_panel=_section)(_function)
