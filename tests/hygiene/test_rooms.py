"""docs/rooms.md is the register of concepts: every file it names exists, and every module is in it exactly once."""

from __future__ import annotations

import re
from collections import Counter

from tests.hygiene.source import ROOT, SRC, expect_none, modules

ROW = re.compile(r"^\| *(?P<concept>[^|]+?) *\| *`(?P<room>[^`|]+)` *\|", re.MULTILINE)


def register() -> list[tuple[str, str]]:
    text = (ROOT / "docs" / "rooms.md").read_text(encoding="utf-8")
    return [(row["concept"], row["room"]) for row in ROW.finditer(text)]


def test_every_room_exists() -> None:
    expect_none((f"{concept}: {room}" for concept, room in register() if not (SRC / room).exists()), "mend docs/rooms.md")


def test_every_module_is_registered() -> None:
    rooms = {room for _, room in register()}
    names = (path.relative_to(SRC).as_posix() for path in modules() if path.name != "__init__.py")
    # A package of a concept's name may be registered as a whole: `readings/linear/`.
    missing = (name for name in names if name not in rooms and not any(room.endswith("/") and name.startswith(room) for room in rooms))
    expect_none((f"| ... | `{name}` |" for name in missing), "add the row to its floor in docs/rooms.md, with its concept")


def test_one_concept_one_room() -> None:
    counts = Counter(concept for concept, _ in register())
    expect_none((concept for concept, count in counts.items() if count > 1), "one concept has one room")
