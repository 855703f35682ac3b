"""The palette: parts, units and gauges as texts of a design file, with fields to fill in."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib import resources

from flexstage.apps.studio.protocol import Snippet
from flexstage.base.finding import Finding, refuse, require, suggest_nearest


def snippets() -> tuple[Snippet, ...]:
    """Return all snippets of the palette."""
    found = tomllib.loads(resources.files("flexstage.apps.studio").joinpath("palette.toml").read_text(encoding="utf-8"))
    return tuple(
        Snippet(name, each["group"], each["title"], each["text"].strip("\n") + "\n", each["fields"]) for name, each in found.items()
    )


def insert(text: str, snippet: str, fields: Mapping[str, str]) -> str:
    """Return the text with a snippet inserted: new tables at the end, and entries of an existing table at the end of that table.

    Raises `DesignError` for an unknown snippet or field, for a text that is not TOML, and for names in use.
    """
    known = {each.name: each for each in snippets()}
    if snippet not in known:
        raise refuse(snippet, "unknown snippet", suggest_nearest(snippet, known))
    wanted = known[snippet]
    require(Finding(f"{snippet}.{name}", "unknown field", suggest_nearest(name, wanted.fields)) for name in fields.keys() - wanted.fields)
    filled = _fill(wanted.text, {**wanted.fields, **fields})
    _require_free(text, filled, snippet)
    result = text if text.endswith("\n") or not text else f"{text}\n"
    for head, body in _tables(filled):
        result = _with_table(result, head, body)
    return result


def gallery() -> Mapping[str, str]:
    """Return the summaries of the shipped cases."""
    from flexstage.cases.registry import CASES  # takes long to import

    return {name: each.summary for name, each in CASES.items()}


def shipped(case: str) -> str:
    """Return the design file of a shipped case. Raises `DesignError` for an unknown case."""
    from flexstage.cases.registry import shipped_case

    found = shipped_case(case)
    return found.text({}, f"{case}: {found.summary}.")


def _fill(text: str, fields: Mapping[str, str]) -> str:
    for name, value in fields.items():
        if any(not sign.isprintable() or sign in '"\\' for sign in value):
            raise refuse(name, "contains quotes, backslashes or control characters", "Use a name or a value with its unit, without quotes")
        text = text.replace("{" + name + "}", value)
    return text


def _require_free(text: str, filled: str, snippet: str) -> None:
    from flexstage.mechanism.store.lines import line_numbers  # takes long to import

    taken = line_numbers(text)
    heads = [head for head, _ in _tables(filled)]
    entries = [key for key in line_numbers(filled) if key not in heads]
    known = [key for key in (*entries, *(head for head in heads if head.count(".") >= 1)) if key in taken]
    require(Finding(key, f"exists already at line {taken[key]}", f"Give {snippet} another name") for key in known[:1])


def _tables(filled: str) -> list[tuple[str, list[str]]]:
    """Heads and lines of a snippet's tables."""
    found: list[tuple[str, list[str]]] = []
    for line in filled.splitlines():
        if line.startswith("["):
            found.append((line.strip("[] "), []))
        elif line.strip() and found:
            found[-1][1].append(line)
    return found


def _with_table(text: str, head: str, body: list[str]) -> str:
    """The text with lines at the end of a table, or with the table at its end."""
    rows = text.splitlines(keepends=True)
    starts = [number for number, row in enumerate(rows) if row.lstrip().startswith("[") and row.split("#")[0].strip() == f"[{head}]"]
    lines = [f"{line}\n" for line in body]
    if not starts:
        return "".join([*rows, "\n", f"[{head}]\n", *lines])
    end = next((number for number in range(starts[0] + 1, len(rows)) if rows[number].lstrip().startswith("[")), len(rows))
    while end > starts[0] + 1 and (not rows[end - 1].strip() or rows[end - 1].lstrip().startswith("#")):
        end -= 1
    return "".join([*rows[:end], *lines, *rows[end:]])
