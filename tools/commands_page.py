"""The reference of commands, docs/commands.md: `python -m tools.commands_page` writes it from the help of every command."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

from typer import Context

from flexstage.apps.cli.commands import COMMANDS, Command, LazyCommand
from flexstage.apps.cli.option_groups import default_last

PAGE = Path(__file__).resolve().parents[1] / "docs" / "commands.md"
_HEAD = """\
# Command reference

This page lists every command with its arguments and options. It is generated from the help texts of `flexstage COMMAND --help`.

Words in capital letters are values to fill in. Quantities have a [unit of measurement](design-file.md#values).
A repeatable option may occur several times.
"""


def page() -> str:
    """The whole page."""
    return "\n".join([_HEAD, *(_group(name, list(each)) for name, each in groupby(COMMANDS, lambda each: each.group))])


def _group(name: str, commands: list[Command]) -> str:
    return "\n".join([f"## {name}\n", *map(_section, commands)])


def _section(command: Command) -> str:
    """Purpose, usage, parameters and example of a command."""
    loaded = LazyCommand(command).load()
    context = Context(loaded, info_name=f"flexstage {command.name}")
    usage = " ".join(loaded.get_usage(context).removeprefix("Usage:").split())
    records = [each.get_help_record(context) for each in loaded.params]
    rows = [f"| `{_cell(name)}` | {_cell(default_last(meaning))} |" for name, meaning in filter(None, records)]
    table = "\n".join(["| argument or option | meaning |", "|---|---|", *rows])
    return f"### {command.name}\n\n{command.help}\n\n```text\n{usage}\n{command.example}\n```\n\n{table}\n"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
