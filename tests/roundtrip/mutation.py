"""Inputs that nobody means: design texts with characters, values, keys and lines altered, and plain noise."""

from __future__ import annotations

import copy
import random
import re
from collections.abc import Iterator
from typing import Any

STRANGE = (
    "", "0", "-0.0", "nan", "inf", "-inf", "1e999", "9" * 400, "0x" + "f" * 80, "true", "[]", "{}", "[[]]", '""', '" "', '"mm"', '"1"',
    '"1 mm"', '"-1 mm"', '"0 mm"', '"1e308 m"', '"1e-320 m"', '"1e400 m"', '"1 deg"', '"1 %"', '"1 K"', '"20 degC"', '"1 N m/rad"',
    '"1 m^9"', '"1 (("', '"1 1"', '"ground"', '"platform"', '"x"', '"-z"', '"tags"', '"like"', '"PSt 1000/10/150 VS18"', '"neck"',
    '"piezo"', '"restricted"', '"\\u0000"', '"\\U0010FFFF"', "2026-11-20", "12:00:00", '["1 mm"]', '["1 mm", "1 mm", "1 mm"]',
    "[0, 0, 0]", "[1, 2, 3]", "[nan, 0, 0]", '{ x = "1 mm" }', '{ kind = "compliance_matrix" }', '{ like = "C36" }', "{ polar = {} }",
    "{ tags = 1 }", '["ground", "ground"]', "'''\n'''", "# comment", "\\", '"',
)  # fmt: skip
"""Values that stand where others are expected."""

KEYS = (
    "tags", "like", "kind", "shape", "at", "x", "free", "part", "polar", "pose", "overrides", "requirements", "format", "name", "B1-B3",
    "B3-B1", "B1-B999999999", '"B2/front.thickness"', '"horizontal/front.at.x"', '"parts.neck"', '"/"', '""', "a.b.c", "материал", "ground",
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


# --- trees ---

ODD: tuple[Any, ...] = (
    *(None, True, 0, -1, 1, 2**63, 10**400, 0.0, -0.0, 1.0, 1e308, float("nan"), float("inf"), "", " ", "\x00", "x", "ground", "platform"),
    *([], {}, [[]], [0], [{}], {"": 0}, {"kind": "given"}, {"like": "C36"}, ["ground", "ground"], ["1 mm", "1 mm", "1 mm"]),
    *("1 mm", "-1 mm", "0 mm", "1e308 m", "1e-320 m", "1 deg", "1 K", "1 %", "-5 %", "1e99 %", "nan mm", "1 m^9", "1 ((", "2*arm", "arm/0"),
    *("x" * 5000, "\u202e\x1b[2J", "\U0010ffff", "a/b", "a.b", "B1-B3", "B1-B999999999", "../../x", "/dev/zero", "~"),
)  # fmt: skip
"""Values of any type that stand where others are expected."""


def reshaped(tree: Any, chance: random.Random) -> Any:
    """A tree of tables, lists and values after one to four alterations of its nodes: replaced, left out, renamed, doubled, exchanged."""
    for _ in range(chance.choice((1, 1, 1, 2, 2, 3, 4))):
        places = list(_places(tree))
        if places:
            _altered_at(*chance.choice(places), places, chance)
    return tree


def _places(node: Any) -> Iterator[tuple[Any, Any]]:
    """Every node but the first, as what holds it and its key or index."""
    inner = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, each in inner:
        yield node, key
        yield from _places(each)


def _altered_at(holder: Any, key: Any, places: list[tuple[Any, Any]], chance: random.Random) -> None:
    change, old = chance.randrange(8), holder[key]
    if change <= 2:
        holder[key] = copy.deepcopy(chance.choice(ODD))
    elif change == 3:
        del holder[key]
    elif change == 4:
        other, place = chance.choice(places)
        if isinstance(place, str) or place < len(other):
            holder[key] = copy.deepcopy(other.get(place, old) if isinstance(other, dict) else other[place])
    elif change == 5 and isinstance(holder, dict):
        holder[chance.choice((*KEYS, *map(str, holder), "\x00", "a" * 300))] = holder.pop(key)
    elif change == 5:
        holder.insert(0, copy.deepcopy(old))
    elif change == 6 and isinstance(old, str):
        holder[key] = mutated(old, chance) if old else "0"
    else:
        holder[key] = [old] if chance.random() < 0.5 else {"x": old}


# --- bytes ---

NUMBERS = (
    *(b"0", b"-1", b"1e999", b"nan", b"inf", b"1e-320", b"9" * 30, b"1_0", b"0x1", b"1,5", b"1.2.3", b"--1", b"\xb5m", b"\x00"),
    *(b"2147483647", b"-2147483648", b"4294967296", b"99999999999", b"\xef\xbb\xbf", b"\xff\xfe", b"\r", b"\n", b"\x1b[2J"),
    *(b'"', b",", b";", b"    -1\n"),
)  # fmt: skip
"""What stands in a record where a number or a word is expected."""
_WORD = re.compile(rb"[^\s,;]+")


def altered(whole: bytes, chance: random.Random) -> bytes:
    """A file after one to four alterations: bytes, stretches, words, lines, fields of numbers, or cut off; more often near its head."""
    content = bytearray(whole)
    for _ in range(chance.choice((1, 1, 1, 2, 2, 3, 4))):
        place = chance.randrange(min(len(content), 1200) if chance.random() < 0.6 else len(content))
        _altered_bytes(content, place, chance)
        content = content or bytearray(b"x")
    return bytes(content)


def _altered_bytes(content: bytearray, place: int, chance: random.Random) -> None:
    ways = (_a_byte, _a_stretch, _a_word, _a_line, _a_field, _an_exchange, _an_end)
    chance.choice(ways)(content, place, chance)


def _a_byte(content: bytearray, place: int, chance: random.Random) -> None:
    content[place] = chance.choice((chance.randrange(256), content[place] ^ 1 << chance.randrange(8)))


def _a_stretch(content: bytearray, place: int, chance: random.Random) -> None:
    """Left out, doubled or blanked."""
    length = chance.randrange(1, 30)
    old = bytes(content[place : place + length])
    content[place : place + length] = chance.choice((b"", old + old, bytes(len(old))))


def _a_word(content: bytearray, place: int, chance: random.Random) -> None:
    found = _WORD.search(content, place)
    start, end = found.span() if found else (place, place)
    content[start : min(end, start + 40)] = chance.choice(NUMBERS)


def _a_line(content: bytearray, place: int, chance: random.Random) -> None:
    """Left out, or carried elsewhere."""
    end = content.find(b"\n", place) + 1 or len(content)
    line = bytes(content[place : min(end, place + 400)])
    del content[place : place + len(line)]
    target = chance.randrange(len(content) + 1)
    content[target:target] = line if chance.random() < 0.6 else b""


def _a_field(content: bytearray, place: int, chance: random.Random) -> None:
    """A whole number of some bytes: 0, 1, the largest, any."""
    size = chance.choice((2, 4, 8))
    number = chance.choice((0, 1, 2 ** (8 * size) - 1, 2 ** (8 * size - 1), chance.getrandbits(8 * size)))
    content[place : place + size] = number.to_bytes(size, chance.choice(("little", "big")))


def _an_exchange(content: bytearray, place: int, chance: random.Random) -> None:
    length, other = chance.randrange(1, 30), chance.randrange(len(content))
    one, two = bytes(content[place : place + length]), bytes(content[other : other + length])
    if len(one) == len(two) and abs(place - other) >= length:
        content[place : place + length], content[other : other + length] = two, one


def _an_end(content: bytearray, place: int, chance: random.Random) -> None:
    """Cut off there, seldom; else as it is."""
    if chance.random() < 0.3:
        del content[place:]
