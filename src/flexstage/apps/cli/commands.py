"""The list of commands by purpose, and the application, which imports the module of a command only when it or its help is called."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from itertools import groupby
from typing import Annotated, Any, NamedTuple, cast

import typer
from typer.core import TyperCommand, TyperGroup
from typer.exceptions import TyperException
from typer.main import get_command

from flexstage.apps.cli.option_groups import GroupedOptionsCommand
from flexstage.apps.cli.usage import usage_error
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.renamed import new_name
from flexstage.show.command.models import Models


class Command(NamedTuple):
    """A command: its `name`, its `group`, one line of `help`, its function or `Typer` as module:name, and an `example`.

    The line of help equals the first line of the function's docstring. The list of commands therefore needs no import of the commands'
    modules.
    """

    name: str
    group: str
    help: str
    home: str
    example: str

    def load(self) -> Any:
        """Import the function or `Typer` from its module."""
        module, _, name = self.home.partition(":")
        return getattr(import_module(module), name)


_DESCRIBE, _ANALYSE, _PROVE, _TEST, _CONTROL, _IMPROVE, _INSTALLATION = (
    "Describe a stage",
    "Analyse it",
    "Verify it by finite elements",
    "Test it",
    "Control it",
    "Improve it",
    "Installation",
)
_APPS = "flexstage.apps.commands"
_SOLID = "flexstage.solid.commands"
_EXPERIMENT = "flexstage.experiment.commands"
_CONTROLLED = "flexstage.control.commands"
_STUDIES = "flexstage.studies.commands"

# fmt: off
COMMANDS: tuple[Command, ...] = (
    Command("new", _DESCRIBE, "Write a case (an example stage) as a commented design file.", f"{_APPS}.describe:new",
            "flexstage new stage.toml --case hexapod"),
    Command("check", _DESCRIBE, "Check a design file.", f"{_APPS}.describe:check",
            "flexstage check stage.toml"),
    Command("schema", _DESCRIBE, "Print the JSON Schema of a kind of file, for text editors.", f"{_APPS}.describe:schema",
            "flexstage schema > flexstage.schema.json"),
    Command("studio", _DESCRIBE, "Open a stage in the browser, and edit it.", "flexstage.apps.studio.command:studio",
            "flexstage studio stage.toml"),
    Command("plan", _DESCRIBE, "Draw the dimensioned plan of a stage.", f"{_APPS}.describe:plan",
            "flexstage plan stage.toml -o plan.svg"),
    Command("catalogue", _DESCRIBE, "List the shipped materials, actuators and sensors.", f"{_APPS}.describe:catalogue",
            "flexstage catalogue stacks"),
    Command("import", _DESCRIBE, "Import a STEP file as an outline (solid shape) of a body.", f"{_SOLID}.exchange:state",
            "flexstage import part.step stage.toml --material steel"),
    Command("cad", _DESCRIBE, "Write the solids, mesh or animated modes of a stage.", f"{_SOLID}.exchange:cad",
            "flexstage cad stage.toml -o stage.step"),
    Command("superelement", _DESCRIBE, "Reduce one solid of a stage to a superelement.", f"{_SOLID}.exchange:superelement",
            "flexstage superelement stage.toml platform -o frame.npz"),
    Command("analyse", _ANALYSE, "Run the main analyses of a stage.", f"{_APPS}.analyse:analyse",
            "flexstage analyse stage.toml --report report.html --set horizontal/front.thickness=1.4mm"),
    Command("mapping", _ANALYSE, "Compute mobility, redundancy and kinematic mappings.", f"{_APPS}.analyses:mapping",
            "flexstage mapping stage.toml --json -"),
    Command("stiffness", _ANALYSE, "Compute compliance and stiffness of the platform.", f"{_APPS}.analyses:stiffness",
            "flexstage stiffness stage.toml --model mapped"),
    Command("lost-motion", _ANALYSE, "Compute lost motion, crosstalk, and their correction.", f"{_APPS}.analyses:lost_motion",
            "flexstage lost-motion stage.toml --set vertical/pivot.thickness=0.9mm"),
    Command("modes", _ANALYSE, "Compute natural frequencies, mode names and shapes.", f"{_APPS}.analyses:modes",
            "flexstage modes stage.toml --model mapped --json modes.json"),
    Command("response", _ANALYSE, "Compute frequency responses of outputs to inputs.", f"{_APPS}.analyses:response",
            'flexstage response stage.toml --input ground.z --output platform.z --band "1 Hz" "1 kHz"'),
    Command("stroke", _ANALYSE, "Compute force, stiffness and frequencies over a stroke.", f"{_APPS}.displaced:stroke",
            'flexstage stroke stage.toml --drive platform.x --to "50 um" --steps 3'),
    Command("buckle", _ANALYSE, "Find the load at which the stage buckles.", f"{_APPS}.displaced:buckle",
            'flexstage buckle stage.toml --scale-load "platform.fz=-100 kN"'),
    Command("misalign", _ANALYSE, "Compute loads of a misaligned, over-constrained stage.", f"{_APPS}.displaced:misalign",
            "flexstage misalign stage.toml --instance B4 --rotation y --steps 3"),
    Command("workspace", _ANALYSE, "Compute strokes, forces, clearances and safety factors.", f"{_APPS}.accuracy:workspace",
            "flexstage workspace stage.toml --command x=50um --command rz=244urad"),
    Command("drift", _ANALYSE, "Compute thermal drift of platform, points and gauges.", f"{_APPS}.accuracy:drift",
            "flexstage drift stage.toml --ground none"),
    Command("sensitivities", _ANALYSE, "Compute sensitivities of frequencies and lost motion.", f"{_APPS}.accuracy:sensitivities",
            "flexstage sensitivities stage.toml --parameters parts.neck.thickness"),
    Command("budget", _ANALYSE, "Compute the error budget of each axis in nm and nrad.", f"{_APPS}.accuracy:budget",
            "flexstage budget stage.toml --command z=150um --temperature 0.1K"),
    Command("solid", _PROVE, "Analyse a stage as elastic solids by finite elements.", f"{_SOLID}.solid:solid",
            "flexstage solid stage.toml --scope unit --report units.html"),
    Command("verify", _PROVE, "Compare theory with finite elements.", f"{_SOLID}.solid:verify",
            "flexstage verify stage.toml --report verified.html"),
    Command("calibrate", _PROVE, "Compute the 6x6 compliance of hinges by finite elements.", f"{_SOLID}.solid:calibrate",
            "flexstage calibrate stage.toml -o stage-calibrated.toml"),
    Command("rig", _TEST, "Simulate a test of a stage, and write the record.", f"{_EXPERIMENT}.rig:rig",
            "flexstage rig stage.toml --seconds 10 --drive-rms 1um --drift 5nm -o record.uff"),
    Command("identify", _TEST, "Find the modes in records of a test.", f"{_EXPERIMENT}.identify:identify",
            "flexstage identify record.uff --stage stage.toml --report modes.html"),
    Command("compare", _TEST, "Compare theory, FEA and experiment.", f"{_EXPERIMENT}.compare:compare",
            "flexstage compare stage.toml --record record.uff --report compared.html"),
    Command("update", _TEST, "Update parameters of a stage from a test.", f"{_EXPERIMENT}.update:update",
            'flexstage update stage.toml --record record.uff --parameters "neck.thickness, steel.density" -o updated.toml'),
    Command("hysteresis", _TEST, "Identify the hysteresis of a stack.", f"{_CONTROLLED}.hysteresis:hysteresis",
            'flexstage hysteresis stack.csv --limits "0 V" "1000 V" -o stack.toml'),
    Command("loop", _CONTROL, "Close the control loop of a stage.", f"{_CONTROLLED}.loop:loop",
            "flexstage loop stage.toml --floor VC-D --report loop.html"),
    Command("serve", _CONTROL, "Serve a virtual controller of a stage over TCP.", f"{_CONTROLLED}.serve:serve",
            "flexstage serve stage.toml"),
    Command("design", _IMPROVE, "Design stages for a specification.", f"{_APPS}.design:design",
            "flexstage design spec.toml -o answers"),
    Command("sweep", _IMPROVE, "Analyse many designs with varied parameters.", f"{_STUDIES}.sweep:sweep",
            "flexstage sweep study.toml -o results.h5 --report sweep.html"),
    Command("optimise", _IMPROVE, "Find the best design within ranges and limits.", f"{_STUDIES}.optimise:optimise",
            "flexstage optimise study.toml -o better.toml --report optimum.html"),
    Command("tolerance", _IMPROVE, "Compute production yield and allowable tolerances.", f"{_STUDIES}.tolerance:tolerance",
            "flexstage tolerance study.toml --report tolerance.html"),
    Command("doctor", _INSTALLATION, "Examine the installation.", f"{_APPS}.about:doctor",
            "flexstage doctor"),
    Command("version", _INSTALLATION, "Print the version of flexstage.", f"{_APPS}.about:version",
            "flexstage version"),
)
# fmt: on

_SPELLINGS = {"analyze": "analyse", "optimize": "optimise"}

MODELS = Models({"solid": f"{_SOLID}.modes:fea_modes"})
"""Models for commands of other packages."""


class LazyCommand(TyperCommand):
    """Placeholder for a command, in the help and in completion, until the command is called."""

    def __init__(self, command: Command) -> None:
        super().__init__(command.name, help=command.help, rich_markup_mode=None)
        self.command = command

    def load(self) -> Any:
        """Import the command, or a group of commands."""
        home = self.command.load()
        if not isinstance(home, typer.Typer):
            function, home = home, typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
            home.command(self.command.name, cls=GroupedOptionsCommand, epilog=f"Example: {self.command.example}")(function)
        return get_command(home)


class GroupedCommands(TyperGroup):
    """A group that lists its commands by purpose, and imports only the command that is called."""

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return the command with this name, in British or American spelling."""
        return super().get_command(ctx, _SPELLINGS.get(cmd_name, cmd_name))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the name of the command, the command, and the arguments after it."""
        if not args[0].startswith("-") and self.get_command(ctx, args[0]) is None:
            listed = "Use 'flexstage --help' to list all commands"
            raise refuse(args[0], "unknown command", suggest_nearest(args[0], self.commands, otherwise=listed))
        name, found, rest = super().resolve_command(ctx, args)
        command = cast("LazyCommand", found).load() if found else None
        known = {word for each in getattr(command, "params", ()) for word in (*each.opts, *each.secondary_opts)}
        require(
            Finding(old, "unknown option", f"Use {new}" if new.startswith("--") else f"Use {name} {new.upper()}")
            for old in dict.fromkeys(word.partition("=")[0] for word in rest)
            if (new := new_name(old, known)) is not None
        )
        return name, command, rest

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002 (required by the framework)
        """Write one section for each purpose, with equal columns."""
        width = max(map(len, self.commands))
        for group, commands in groupby(cast("Iterable[LazyCommand]", self.commands.values()), lambda each: each.command.group):
            with formatter.section(group):
                formatter.write_dl([(each.command.name.ljust(width), each.command.help) for each in commands])


def application(commands: tuple[Command, ...] = COMMANDS) -> TyperGroup:
    """Build the command line: a group of commands, each imported at its first call."""
    app = typer.Typer(
        cls=GroupedCommands,
        help="Design and verification of flexure-based ultra-precision positioning stages.",
        epilog="Start with: flexstage new stage.toml, then flexstage analyse stage.toml --report report.html",
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
        context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120},
    )
    app.callback()(_options)
    group = cast("TyperGroup", get_command(app))
    for each in commands:
        group.add_command(LazyCommand(each))
    return group


def run_application(arguments: list[str]) -> int:
    """Run a command line, and return its exit code. A usage error is printed in the form of all messages."""
    group = application()
    try:
        code = group(arguments or ["--help"], prog_name="flexstage", obj=MODELS, standalone_mode=False)
    except TyperException as error:
        raise usage_error(error, arguments, {each.name: each.example for each in COMMANDS}) from None
    return code if isinstance(code, int) else 0


def _print_version(*, requested: bool) -> None:
    if requested:
        from flexstage.apps.commands.about import version  # when called, as the module of any command

        version()
        raise typer.Exit


def _options(
    *,
    version: Annotated[bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Version of flexstage.")] = False,
) -> None:
    pass
