"""Help of a command with its options in groups; the default value of an option is the last sentence of its help."""

from __future__ import annotations

import re
from typing import Any

from typer.core import TyperCommand

_MOST = 12
"""Largest number of options in a help without groups."""
_GROUPS = {
    "Model and operating point": "set model at load fixed temperature fea point load-point order accuracy memory",
    "Controller": "setup controller coordinates bandwidth tune-for quick max-sensitivity force-feedback tracking feedforward compare",
    "Sampling, noise and disturbances": (
        "rate delay seconds seed amplifier gauge-noise resolution drift filter-order filter-corner floor hysteresis"
    ),
    "Excitation and trajectory": "drive-rms band actuator input-signal input-quantity excitation trajectory amplitude",
    "Records of a test": ("record stage inputs outputs channels units array kind accept-fault frequency-resolution temperature-channel"),
    "Parameters": "parameters prior model-error gain gain-error",
    "Output": "output json csv xlsx report mat view export hardware float32 example full strict",
}
_GROUP_OF = {f"--{name}": group for group, names in _GROUPS.items() for name in names.split()}


class GroupedOptionsCommand(TyperCommand):
    """A command whose help lists many options by subject."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments, then options in the order of the groups."""
        parameters: list[Any] = self.get_params(ctx)
        options = [each for each in parameters if each.param_type_name == "option"]
        sections: dict[str, list[tuple[str, str]]] = {name: [] for name in ("Arguments", *_GROUPS, "Options")}
        for each in parameters:
            group = "Arguments" if each not in options else _GROUP_OF.get(each.opts[0], "Options") if len(options) > _MOST else "Options"
            if record := each.get_help_record(ctx):
                sections[group].append((record[0], default_last(record[1])))
        for name, rows in sections.items():
            if rows:
                with formatter.section(name):
                    formatter.write_dl(rows)


def default_last(text: str) -> str:
    """Format the help of an option: the marks of a default value and of a required option become sentences at the end.

    >>> default_last("Model.  [default: lumped]"), default_last("Design file (TOML).  [required]")
    ('Model. Default: lumped.', 'Design file (TOML). Required.')
    """
    text = re.sub(r"\s*\[required\]", " Required.", text)
    return re.sub(r"\s*\[default: ([^\]]*?)(?:; ([^\]]*))?\]", lambda found: f" Default: {found[1]}.", text)
