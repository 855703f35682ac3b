"""Pieces of C text: numbers, tables, comments, identifiers."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

import numpy as np

from flexstage.base.number import Array

_WIDTH = 110


def number(value: float) -> str:
    """A constant of the type double, to the bit.

    >>> number(0.1), number(-3.0), number(float("inf")), number(1e-300)
    ('0.1', '-3.0', 'HUGE_VAL', '1e-300')
    """
    if np.isinf(value):
        return "HUGE_VAL" if value > 0.0 else "-HUGE_VAL"
    return repr(float(value))


def table(name: str, values: Array) -> list[str]:
    """A constant table of one or two axes.

    >>> table("low", np.array([1.0, 2.0]))
    ['static const double low[2] = {1.0, 2.0};']
    """
    values = np.asarray(values, dtype=float)
    sizes = "".join(f"[{size}]" for size in values.shape)
    if values.ndim == 1:
        return wrapped(f"static const double {name}{sizes} = {{{', '.join(map(number, values))}}};")
    lines = [f"    {{{', '.join(map(number, row))}}}," for row in values]
    return [f"static const double {name}{sizes} = {{", *(part for line in lines for part in wrapped(line, "     ")), "};"]


def indented(lines: Iterable[str], depth: int = 1) -> list[str]:
    """Lines moved in.

    >>> indented(["a;", ""])
    ['    a;', '']
    """
    return [f"{'    ' * depth}{line}" if line else "" for line in lines]


def comment(text: str) -> list[str]:
    """A comment of one line or several, wrapped; what would end it early is taken apart.

    >>> comment("low is */ fine")
    ['/* low is * / fine */']
    """
    parts = textwrap.wrap(text.replace("*/", "* /").replace("/*", "/ *"), _WIDTH - 6, break_long_words=False) or [""]
    if len(parts) == 1:
        return [f"/* {parts[0]} */"]
    return [f"/* {parts[0]}", *(f" * {part}" for part in parts[1:-1]), f" * {parts[-1]} */"]


def wrapped(line: str, further: str = "    ") -> list[str]:
    """Long statements over several lines, broken at blanks.

    >>> wrapped("a;")
    ['a;']
    """
    if len(line) <= _WIDTH:
        return [line]
    start = line[: len(line) - len(line.lstrip())]
    way = textwrap.TextWrapper(_WIDTH, initial_indent=start, subsequent_indent=start + further)
    way.break_long_words = way.break_on_hyphens = False
    return way.wrap(line)


def identifier(text: str) -> str:
    """A name as an identifier of C.

    >>> identifier("double triangle"), identifier("2nd"), identifier("int")
    ('double_triangle', '_2nd', 'int_')
    """
    name = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in text) or "_"
    name = f"_{name}" if name[0].isdigit() else name
    return f"{name}_" if name in _WORDS else name


_WORDS = frozenset(
    (
        *(
            "auto",
            "break",
            "case",
            "char",
            "const",
            "continue",
            "default",
            "do",
            "double",
            "else",
            "enum",
            "extern",
            "float",
            "for",
            "goto",
        ),
        *("if", "inline", "int", "long", "register", "restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch"),
        *("typedef", "union", "unsigned", "void", "volatile", "while", "main"),
    )
)
