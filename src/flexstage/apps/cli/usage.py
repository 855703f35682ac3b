"""Errors of the command line in the form of all messages: the option or argument, the problem and a hint."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from typer.exceptions import TyperException

from flexstage.base.finding import DesignError, refuse, suggest_nearest

_CONDITIONS = (
    (r"Input should be a valid integer.*", "must be an integer"),
    (r"Input should be a valid (number|float).*", "must be a number"),
    (r"Input should be greater than or equal to (.*)", r"must be at least \1"),
    (r"Input should be less than or equal to (.*)", r"must be at most \1"),
    (r"Input should be ((?:greater|less) than .*)", r"must be \1"),
    (r"(?:Value error, )?'.*' is not one of (.*?)\.?", r"must be one of \1"),
)
"""Conditions in the words of pydantic and of the command-line framework, and in those of flexstage."""


def usage_error(error: TyperException, arguments: Sequence[str], examples: Mapping[str, str]) -> DesignError:
    """Convert a usage error of the command line to a message. The hint is a similar option, or the example of the command.

    >>> print(usage_error(TyperException("Got unexpected extra argument (b)"), ["modes", "a", "b"], {"modes": "flexstage modes a"}))
    b: unexpected argument. Use e.g. 'flexstage modes a'.
    """
    given: Any = error
    command = getattr(getattr(given, "ctx", None), "command", None)
    example = examples.get(getattr(command, "name", None) or arguments[0], "flexstage --help")
    hint = f"Use e.g. '{example}'"
    option, parameter = getattr(given, "option_name", ""), getattr(given, "param", None)
    if option and "argument" not in error.message and "value" not in error.message:
        known = [word for each in getattr(command, "params", ()) for word in (*each.opts, *each.secondary_opts)]
        listed = f"Use '{given.ctx.command_path} --help' to list all options"
        return refuse(option, "unknown option", suggest_nearest(option, known, otherwise=listed))
    if option:
        return refuse(option, "takes no value" if "not take" in error.message else "value missing", hint)
    if parameter is None:
        extra = re.fullmatch(r"Got unexpected extra argument\w*(?:\(s\))? \((.*)\)", error.message)
        return refuse(extra[1] if extra else "command line", "unexpected argument" if extra else error.message.rstrip("."), hint)
    name = next((word for word in parameter.opts if word.startswith("--")), parameter.metavar or parameter.name)
    if not error.message:
        return refuse(name, "missing", hint)
    conditions = ((re.fullmatch(pattern, error.message), text) for pattern, text in _CONDITIONS)
    condition = next((found.expand(text).replace("'", "") for found, text in conditions if found), "")
    typed = zip(arguments, [*arguments[1:], ""], strict=True)
    value = next((word.partition("=")[2] or following for word, following in typed if word.partition("=")[0] == name), "")
    return refuse(name, (condition or error.message.rstrip(".")) + f" (got {value})" * bool(value), "" if condition else hint)
