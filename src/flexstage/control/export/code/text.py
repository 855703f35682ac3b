"""C text: numbers, tables, comments, identifiers."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable

import numpy as np

from flexstage.base.number import Array
from flexstage.base.text import printable

_WIDTH = 110


def number(value: float) -> str:
    """Format a constant of the type double, exact to the bit.

    >>> number(0.1), number(-3.0), number(float("inf")), number(1e-300)
    ('0.1', '-3.0', 'HUGE_VAL', '1e-300')
    """
    return repr(float(value)).replace("inf", "HUGE_VAL")


def table(name: str, values: Array) -> list[str]:
    """Format a constant table of one or two axes.

    >>> table("low", np.array([1.0, 2.0]))
    ['static const double low[2] = {1.0, 2.0};']
    """
    values = np.asarray(values, dtype=float)
    sizes = "".join(f"[{size}]" for size in values.shape)
    if values.ndim == 1:
        return wrap(f"static const double {name}{sizes} = {{{', '.join(map(number, values))}}};")
    lines = [f"    {{{', '.join(map(number, row))}}}," for row in values]
    return [f"static const double {name}{sizes} = {{", *(part for line in lines for part in wrap(line, "     ")), "};"]


def indent(lines: Iterable[str]) -> list[str]:
    """Indent lines.

    >>> indent(["a;", ""])
    ['    a;', '']
    """
    return [f"    {line}" if line else "" for line in lines]


def comment(text: str) -> list[str]:
    r"""Format a wrapped comment. `*/` inside the text is split, and invisible characters are escaped.

    >>> comment("low is */ fine"), comment("name \u202e")
    (['/* low is * / fine */'], ['/* name \\u202e */'])
    """
    apart = printable(text).replace("*/", "* /").replace("/*", "/ *")
    apart = re.sub(r"\?(?=\?)", "? ", apart)  # no trigraphs
    parts = textwrap.wrap(apart, _WIDTH - 6, break_long_words=False) or [""]
    return ("/* " + "\n * ".join(parts) + " */").split("\n")


def wrap(line: str, further: str = "    ") -> list[str]:
    """Wrap a long C statement at spaces; continuation lines start with `further`.

    >>> wrap("a;")
    ['a;']
    """
    if len(line) <= _WIDTH:
        return [line]
    start = line[: len(line) - len(line.lstrip())]
    way = textwrap.TextWrapper(_WIDTH, initial_indent=start, subsequent_indent=start + further)
    way.break_long_words = way.break_on_hyphens = False
    return way.wrap(line)


def identifier(text: str) -> str:
    """Convert a name to an identifier for functions, types, files and an FMU: letters, digits and underscores, beginning with a letter.

    Reserved names (C keywords, system headers, FMI names) get the prefix `stage_`.

    >>> identifier("double triangle"), identifier("2nd"), identifier("int"), identifier("math"), identifier("fmi2")
    ('double_triangle', 'stage_2nd', 'stage_int', 'stage_math', 'stage_fmi2')
    """
    name = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in text)
    taken = name.lower() in _TAKEN or name.lower().startswith("fmi")
    return f"stage_{name}" if taken or not name[:1].isalpha() else name


_WORDS = (
    "auto break case char const continue default do double else enum extern float for goto if inline int long register restrict "
    "return short signed sizeof static struct switch typedef union unsigned void volatile while main alignas alignof asm bool catch "
    "class concept constexpr delete decltype dynamic_cast explicit export false friend module mutable namespace new noexcept nullptr "
    "operator private protected public requires template this throw true try typeid typename using virtual import "
)
_HEADERS = (
    "assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic stdbit stdbool "
    "stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype aio alloca ar byteswap conio cpio "
    "crypt curses direct dirent dlfcn elf endian err execinfo fcntl features fmtmsg fnmatch fts ftw getopt glob grp iconv io langinfo "
    "libgen libintl limits link mach malloc memory monetary mqueue ncurses ndbm netdb nl_types paths poll process pthread pwd regex "
    "regexp resolv sched search semaphore spawn stab strings stropts syslog tar termio termios thread tchar trace ucontext ulimit "
    "unistd utime utmp utmpx values varargs wait windows winbase windef winsock winsock2 wordexp xlocale zlib "
)
_TAKEN = frozenset(f"{_WORDS} {_HEADERS} model".split())
