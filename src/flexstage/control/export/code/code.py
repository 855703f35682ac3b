"""Code in two places: tables at the file's level, statements in the body."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Code:
    """Tables and functions at the file's level, and statements of the body that use them."""

    tables: tuple[str, ...] = ()
    body: tuple[str, ...] = ()

    def __add__(self, other: Code) -> Code:
        """One after the other."""
        return Code(self.tables + other.tables, self.body + other.body)


def statements(*lines: str) -> Code:
    """Statements without tables.

    >>> (statements("a;") + statements("b;")).body
    ('a;', 'b;')
    """
    return Code(body=lines)
