"""Layout of a CSV file: column separator, header, and start of the numbers.

A header is one line `time [s], u1 [V], S1 [um]`, with brackets or parentheses, or two lines: names, then units. It may be a comment.
Columns are separated by semicolons, tabs, commas or blanks. Decimal commas are supported unless commas separate the columns.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.storage.files import require_regular
from flexstage.experiment.records.options import number_names
from flexstage.experiment.records.unit import plain_unit, unit_problem

_HEAD = 1 << 18
_QUOTED = 60
_LOOKED_AT = 6
NUMBER = re.compile(r"[-+]?(\d+([.,]\d*)?|[.,]\d+)([eEdD][-+]?\d+)?", re.ASCII)
"""Pattern of a number in a file."""
MISSING = frozenset({"", "nan", "-nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "inf", "-inf", "+inf"})
"""Fields for a missing number, in lower case."""
_COMMENT = re.compile(r"^\s*(#|%|//|\*)+\s?")
_LETTER = re.compile(r"[^\W\d_]")
_WITH_UNIT = re.compile(r"(?P<name>.*?)\s*[\[(](?P<unit>[^\[\]]*)[\])]")
_WORD = re.compile(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?")
_EXAMPLE = 'Write a header such as "time [s], u1 [V], S1 [um]" as its first line'
_NAMES = ("time [s]", "u1 [V]", "S1 [um]")


@dataclass(frozen=True)
class Layout:
    """Layout of a CSV file: names and units of columns, separator (None: blanks), decimal sign, byte and line at which numbers start.

    `comments` are the comment lines before the numbers, without comment signs.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    delimiter: str | None
    decimal: str
    start: int
    line: int
    encoding: str
    comments: tuple[str, ...]

    def fields(self, line: str) -> list[str]:
        """Split a line into its fields, without surrounding blanks and without an empty field after a trailing separator.

        >>> Layout(("a", "b"), ("", ""), ",", ".", 0, 1, "utf-8", ()).fields("1.0, 2.0")
        ['1.0', '2.0']
        """
        return _without_last_empty(split_fields(line, self.delimiter), len(self.names))

    def fits(self, line: str) -> bool:
        """Return whether a line has as many fields as columns; a trailing separator is allowed.

        >>> two = Layout(("a", "b"), ("", ""), ",", ".", 0, 1, "utf-8", ())
        >>> two.fits("1,2"), two.fits("1,2,"), two.fits("1,2,3"), two.fits("1")
        (True, True, False, False)
        """
        expected = len(self.names)
        if self.delimiter is None or '"' in line:
            return len(self.fields(line)) == expected
        count = line.count(self.delimiter) + 1
        return count == expected or (count == expected + 1 and line.rstrip("\r ").endswith(self.delimiter))


def read_layout(path: Path) -> Layout:
    r"""Determine the layout of a CSV file; raises `DesignError` if it is not text, or has no numbers or no header.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "a.csv"
    ...     _ = path.write_text("time [s]; u1 [V]\n0; 0,5\n0,1; 0,25\n")
    ...     found = read_layout(path)
    >>> found.names, found.units, found.delimiter, found.decimal, found.line
    (('time', 'u1'), ('s', 'V'), ';', ',', 2)
    """
    require_regular(path)
    with path.open("rb") as stream:
        raw = stream.read(_HEAD)
    where = str(path)
    lines, encoding = _lines(raw, where)
    for number, line in enumerate(lines):
        form = _form(lines[number : number + _LOOKED_AT]) if _may_be_numbers(line) else None
        if form is not None:
            delimiter, decimal, columns = form
            require(_broken_row(where, lines[:number], form))
            head = [_COMMENT.sub("", each) for each in lines[:number]]
            names, units = _header(head, delimiter, columns, where)
            start = sum(len(each.encode(encoding)) for each in lines[:number]) + (3 if raw.startswith(b"\xef\xbb\xbf") else 0)
            return Layout(names, units, delimiter, decimal, start, number + 1, encoding, tuple(each.strip() for each in head))
    raise refuse(where, f"no line of numbers was found in its first {len(lines)} lines", _EXAMPLE)


def _broken_row(where: str, above: list[str], form: tuple[str | None, str, int]) -> Iterator[Finding]:
    """Line that separates rows of numbers above from those below, which would make all of them a header."""
    rows = [number for number, line in enumerate(above) if _is_row(line)]
    if rows:
        columns = form[2]
        broken = (at for at in range(rows[0], len(above)) if at not in rows or len(split_fields(above[at], form[0])) != columns)
        at = next(broken, rows[-1])
        line, count = above[at].strip()[:60], len(split_fields(above[at], form[0]))
        wrong = "a field is not a number" if count == columns else f"wrong number of fields (got {count}, expected {columns})"
        what = f'{wrong} in a line between rows of numbers: "{line}"'
        yield Finding(
            f"{where}:{at + 1}", what, f'Correct this line; if line {rows[0] + 1} is not a row of numbers, start that line with "#"'
        )


def _is_row(line: str) -> bool:
    """Whether a line contains only two or more numbers, with any separator."""
    if not _may_be_numbers(line):
        return False
    divided = (split_fields(line, delimiter) for delimiter in (";", "\t", ",", None))
    return any(len(fields) > 1 and all(NUMBER.fullmatch(field) for field in fields) for fields in divided)


def _lines(raw: bytes, where: str) -> tuple[list[str], str]:
    """First lines with their ends, and the encoding; a truncated last line is omitted if others exist."""
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise refuse(where, "it is UTF-16 text", "Save it as UTF-8")
    if b"\x00" in raw:
        raise refuse(where, "it is neither text nor in a supported format of records", "Export UFF, MAT, HDF5 or CSV")
    raw = raw.removeprefix(b"\xef\xbb\xbf")
    if b"\r" in raw and b"\n" not in raw:
        raise refuse(where, "its lines end in carriage returns only", "Save it with line feeds")
    lines = io.BytesIO(raw).readlines()
    whole = lines[:-1] if len(lines) > 1 and len(raw) > _HEAD - 8 else lines
    try:
        return [line.decode("utf-8") for line in whole], "utf-8"
    except UnicodeDecodeError:
        return [line.decode("latin-1") for line in whole], "latin-1"


def _may_be_numbers(line: str) -> bool:
    return line.strip()[:1] in tuple('+-.,0123456789"') and not _COMMENT.match(line)


def _form(lines: list[str]) -> tuple[str | None, str, int] | None:
    """Delimiter, decimal sign and number of columns of number lines; None for other lines. The last line may be truncated."""
    sure = [line for line in lines[: max(1, len(lines) - 1)] if line.strip()]
    for delimiter in (";", "\t", ",", None):
        if delimiter is not None and delimiter not in lines[0]:
            continue
        split = [split_fields(line, delimiter) for line in sure]
        filled = [field for fields in split for field in fields if field.lower() not in MISSING]
        if len({len(fields) for fields in split}) != 1 or not filled or not all(NUMBER.fullmatch(field) for field in filled):
            continue
        commas = any("," in field for field in filled)
        if not (commas and any("." in field for field in filled)):
            trailing = delimiter is not None and all(not fields[-1] for fields in split)  # lines end with the delimiter
            return delimiter, "," if commas else ".", len(split[0]) - trailing
    return None


def split_fields(line: str, delimiter: str | None) -> list[str]:
    """Split a line at the delimiter (blanks without one), without surrounding blanks."""
    if delimiter is None:
        return line.split()
    try:
        return [field.strip() for field in next(csv.reader([line.strip("\r\n")], delimiter=delimiter, skipinitialspace=True), [])]
    except csv.Error:  # carriage returns within the line, too many fields
        return [line]


def _header(head: list[str], delimiter: str | None, columns: int, where: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units from the line above the numbers; a line of units belongs to the one above it. Preambles are ignored."""
    found = list(_candidates(head, delimiter, columns))
    if not found:
        last = next((line.strip() for line in reversed(head) if line.strip()), "")
        what = "have no header" if not last else f'are not named by the line above them: "{last[:_QUOTED]}"'
        example = (delimiter or " ").join((*_NAMES, *(f"S{number} [um]" for number in range(2, columns - 1)))[:columns])
        raise refuse(where, f"its {columns} columns {what}", f'Name each column in the line above the numbers, such as "{example}"')
    if len(found) > 1 and all(unit_problem(plain_unit(text)) is None or not plain_unit(text) for text in found[0]):
        return number_names(_name_and_unit(text)[0] for text in found[1]), tuple(plain_unit(text) for text in found[0])
    pairs = [_name_and_unit(text) for text in found[0]]
    return number_names(name for name, _ in pairs), tuple(unit for _, unit in pairs)


def _candidates(head: list[str], delimiter: str | None, columns: int) -> Iterator[list[str]]:
    """Fields of the lines above the numbers, upwards, if they name all columns; lines without letters are skipped."""
    signs: list[str | None] = [delimiter, ",", ";", "\t", *([None] if delimiter in (None, "\t") else [])]
    for line in reversed([each for each in head if _LETTER.search(each)]):
        divided = (
            [found[0] for found in _WORD.finditer(line)] if each is None else split_fields(line, each) for each in dict.fromkeys(signs)
        )
        named = next((each for fields in divided if _are_names(each := _without_last_empty(fields, columns), columns)), None)
        if named is None:
            return
        yield named


def _without_last_empty(fields: list[str], columns: int) -> list[str]:
    return fields[:-1] if len(fields) == columns + 1 and not fields[-1] else fields


def _are_names(fields: list[str], columns: int) -> bool:
    """Whether fields can name as many columns: words, not numbers, and not keys with a colon."""
    no_name = (NUMBER.fullmatch(field) or field.endswith(":") for field in fields)
    return len(fields) == columns and not any(no_name) and any(_LETTER.search(field) for field in fields)


def _name_and_unit(text: str) -> tuple[str, str]:
    found = _WITH_UNIT.fullmatch(text.strip())
    return (found["name"], plain_unit(found["unit"])) if found else (text.strip(), "")
