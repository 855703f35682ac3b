"""Parameters are honest: none hidden in a dictionary, flags given by name."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from tests.hygiene.source import Defined, Function, defined, expect_none, modules


def functions() -> Iterator[Defined]:
    for path in modules():
        yield from (each for each in defined(path) if isinstance(each.node, Function))


def positional(each: Defined) -> list[ast.arg]:
    arguments = each.node.args
    found = [*arguments.posonlyargs, *arguments.args]
    bound = isinstance(each.owner, ast.ClassDef) and not any(ast.unparse(mark) == "staticmethod" for mark in each.node.decorator_list)
    return found[1:] if bound else found


def takes_a_flag(each: Defined) -> bool:
    arguments = each.node.args
    flags = [argument for argument in positional(each) if argument.annotation and ast.unparse(argument.annotation) == "bool"]
    defaults = [default for default in arguments.defaults if isinstance(default, ast.Constant) and isinstance(default.value, bool)]
    return bool(flags or defaults)


def hides(each: Defined) -> bool:
    """Whether it takes `**`; a wrapper typed `P.kwargs` has the parameters of what it wraps."""
    rest = each.node.args.kwarg
    return rest is not None and not (rest.annotation and ast.unparse(rest.annotation).endswith(".kwargs"))


def test_no_parameters_are_hidden_in_a_dictionary() -> None:
    expect_none((each.where for each in functions() if hides(each)), "name the parameters instead of **")


def test_flags_are_given_by_name() -> None:
    # `feed(state, value, True)` says nothing at the call. Private helpers are read, too.
    expect_none((each.where for each in functions() if takes_a_flag(each)), "put * before the flag")
