"""Inputs that nobody means: design texts with characters, values, keys and lines altered, and plain noise."""

from __future__ import annotations

import random
import re

STRANGE = (
    "", "0", "-0.0", "nan", "inf", "-inf", "1e999", "9" * 400, "0x" + "f" * 80, "true", "[]", "{}", "[[]]", '""', '" "', '"mm"', '"1"',
    '"1 mm"', '"-1 mm"', '"0 mm"', '"1e308 m"', '"1e-320 m"', '"1e400 m"', '"1 deg"', '"1 %"', '"1 K"', '"20 degC"', '"1 N m/rad"',
    '"1 m^9"', '"1 (("', '"1 1"', '"ground"', '"platform"', '"x"', '"-z"', '"tags"', '"like"', '"PSt 1000/10/150 VS18"', '"neck"',
    '"piezo"', '"restricted"', '"\\u0000"', '"\\U0010FFFF"', "2026-11-20", "12:00:00", '["1 mm"]', '["1 mm", "1 mm", "1 mm"]',
    "[0, 0, 0]", "[1, 2, 3]", "[nan, 0, 0]", '{ x = "1 mm" }', '{ kind = "given" }', '{ like = "C36" }', "{ polar = {} }",
    "{ tags = 1 }", '["ground", "ground"]', "'''\n'''", "# comment", "\\", '"',
)  # fmt: skip
"""Values that stand where others are expected."""

KEYS = (
    "tags", "like", "kind", "shape", "at", "x", "free", "part", "polar", "pose", "change", "require", "format", "name", "B1-B3", "B3-B1",
    "B1-B999999999", '"B2/front.thickness"', '"horizontal/front.at.x"', '"parts.neck"', '"/"', '""', "a.b.c", "материал", "ground",
    "platform", "bends", "along", "1",
)  # fmt: skip
SIGNS = "\"'[]{}=.,#\\\n\t -+_/^%()0123456789eEmNxyzµ°²\x00\x7f\u2028\ud800é\U0010ffff"
_VALUE = re.compile(r"(?<== )[^\n]+|\"[^\"\n]*\"|(?<=[ \[])-?\d[\d.e+-]*")
_KEY = re.compile(r"^[^\s=\[#]+(?= =)|(?<=[{,] )[\w-]+(?= =)|(?<=^\[)[^\]\n]+", re.MULTILINE)


def mutated(text: str, chance: random.Random) -> str:
    """The text after one to four alterations."""
    for _ in range(chance.choice((1, 1, 1, 2, 2, 3, 4))):
        text = chance.choice((_value, _value, _value, _key, _sign, _line, _swap, _shear))(text, chance)
    return text


def noise(chance: random.Random) -> bytes:
    """Random bytes, or signs that TOML knows in random order."""
    length = chance.choice((0, 1, 8, 64, 512))
    if chance.random() < 0.3:
        return chance.randbytes(length)
    return "".join(chance.choice(SIGNS) for _ in range(length)).encode("utf-8", "surrogatepass")


def _replace(text: str, pattern: re.Pattern[str], new: str, chance: random.Random) -> str:
    found = list(pattern.finditer(text))
    if not found:
        return text + new
    match = chance.choice(found)
    return text[: match.start()] + new + text[match.end() :]


def _value(text: str, chance: random.Random) -> str:
    return _replace(text, _VALUE, chance.choice(STRANGE), chance)


def _key(text: str, chance: random.Random) -> str:
    return _replace(text, _KEY, chance.choice(KEYS), chance)


def _sign(text: str, chance: random.Random) -> str:
    place = chance.randrange(len(text) + 1)
    return text[:place] + chance.choice(SIGNS) + text[place + chance.choice((0, 1)) :]


def _line(text: str, chance: random.Random) -> str:
    """A line left out, doubled, or carried elsewhere."""
    lines = text.split("\n")
    line = chance.choice(lines)
    if chance.random() < 0.4:
        lines.remove(line)
    else:
        lines.insert(chance.randrange(len(lines) + 1), line)
    return "\n".join(lines)


def _swap(text: str, chance: random.Random) -> str:
    """Two values exchanged."""
    found = list(_VALUE.finditer(text))
    if len(found) < 2:
        return text
    one, other = sorted(chance.sample(found, 2), key=lambda match: match.start())
    if one.end() > other.start():
        return text
    return text[: one.start()] + other[0] + text[one.end() : other.start()] + one[0] + text[other.end() :]


def _shear(text: str, chance: random.Random) -> str:
    """The text cut off."""
    return text[: chance.randrange(len(text) + 1)]
