"""Print the weight of the source by package: `python -m tools.weight [--all]`.

Code tokens leave out docstrings, comments and import statements, so that line length and layout do not matter.
"""

from __future__ import annotations

import ast
import re
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

from flexstage.apps.cli.commands import COMMANDS, LazyCommand

ROOT = Path(__file__).resolve().parents[1]
SRC = ROOT / "src" / "flexstage"
COLUMNS = ("tokens", "docstrings", "files", "lines")
COUNTS = ("C", "tests", "caches", "options", "public", "isinstance", "Any", "suppressions")
_CACHES = {"lru_cache", "cache", "cached_property"}
_DICTIONARIES = {"dict", "OrderedDict", "WeakKeyDictionary", "WeakValueDictionary"}
_SUPPRESSION = re.compile(r"#.*\b(noqa|type: ignore|pyright:)")
_TOKEN = re.compile(
    r"""(?:[rbfuRBFU]{1,2})?(?:\"{3}(?:\\.|[^\\])*?\"{3}|'{3}(?:\\.|[^\\])*?'{3}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')
    |(?P<comment>\#[^\n]*|\\\n)
    |0[xXoObB]\w+|(?:\d[\d_]*\.?[\d_]*|\.\d[\d_]*)(?:[eE][-+]?\d+)?[jJ]?|\w+
    |\*\*=|//=|>>=|<<=|\.\.\.|[-+*/%&|^@=!<>:]=|->|\*\*|//|<<|>>|[^\s\w]""",
    re.DOTALL | re.VERBOSE,
)


def main() -> None:
    """Print one row a package, the heaviest first."""
    columns = COLUMNS + COUNTS * ("--all" in sys.argv)
    rows = weights()
    if "--all" in sys.argv:
        for package, counts in companions().items():
            rows[package].update(counts)
    print(f"{'':12}" + "".join(f"{name:>13}" for name in columns))
    for package, counts in sorted(rows.items(), key=lambda row: -row[1]["tokens"]):
        print(f"{package:12}" + "".join(f"{counts[name]:13,}" for name in columns))


def weights() -> dict[str, Counter[str]]:
    """Count code tokens, docstring lines, files and lines of each package, and of `all`."""
    rows = {}
    for package, path in _files(SRC, "*.py"):
        text = path.read_text(encoding="utf-8")
        tokens, documented = weigh(text)
        _add(rows, package, {"tokens": tokens, "docstrings": documented, "files": 1, "lines": text.count("\n")})
    return rows


def weigh(text: str) -> tuple[int, int]:
    """Return the code tokens and the docstring lines of a module."""
    lines, documented = text.encode().splitlines(keepends=True), 0
    for node in _blocks(ast.parse(text)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            for number in range(node.lineno - 1, node.end_lineno or 0):
                lines[number] = b"\n"
        for each in getattr(node, "body", []):
            if isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant) and isinstance(each.value.value, str):
                first, last = each.lineno - 1, (each.end_lineno or each.lineno) - 1
                lines[last] = lines[last][each.end_col_offset :]
                lines[first:last] = [b"\n"] * (last - first)
                documented += last - first + 1
    code = b"".join(lines).decode()
    return sum(found["comment"] is None for found in _TOKEN.finditer(code)), documented


def _blocks(node: ast.AST) -> Iterator[ast.AST]:
    """A module, all statements within it, and what else has statements."""
    yield node
    for name in ("body", "handlers", "orelse", "finalbody", "cases"):
        for each in getattr(node, name, []):
            yield from _blocks(each)


def companions() -> dict[str, Counter[str]]:
    """Count, for each package and for `all`, the columns of `COUNTS`.

    A test counts for every package that its file imports by name, an option for every command that has it. Caches are memoising decorators
    and empty dictionaries of a module; public names are functions, classes and constants of a module without leading underscore.
    """
    rows = {}
    for package, path in _files(SRC, "*.py"):
        _add(rows, package, _companions(path.read_text(encoding="utf-8")))
    for package, path in (*_files(SRC, "*.c"), *_files(SRC, "*.h")):
        _add(rows, package, {"C": len(path.read_text(encoding="utf-8").splitlines())})
    for path in (ROOT / "tests").rglob("test_*.py"):
        text = path.read_text(encoding="utf-8")
        tests = {"tests": len(re.findall(r"^\s*(?:async )?def test_", text, re.MULTILINE))}
        for package in {*re.findall(r"\bflexstage\.(\w+)", text)} & rows.keys():
            rows[package].update(tests)
        rows["all"].update(tests)
    for command in COMMANDS:
        options = sum(each.param_type_name == "option" for each in LazyCommand(command).load().params)
        _add(rows, command.home.split(".")[1], {"options": options})
    return rows


def _companions(text: str) -> Counter[str]:
    tree, counts = ast.parse(text), Counter(suppressions=sum(bool(_SUPPRESSION.search(line)) for line in text.splitlines()))
    for node in ast.walk(tree):
        called = _name(node.func) if isinstance(node, ast.Call) else ""
        counts["isinstance"] += called == "isinstance"
        counts["Any"] += isinstance(node, ast.Name) and node.id == "Any"
        counts["caches"] += isinstance(node, ast.Name | ast.Attribute) and _name(node) in _CACHES
    for node in tree.body:
        names = [node.name] if isinstance(node, ast.FunctionDef | ast.ClassDef) else [_name(each) for each in _targets(node)]
        counts["public"] += sum(not name.startswith("_") for name in names)
        value = getattr(node, "value", None)
        counts["caches"] += isinstance(value, ast.Dict) and not value.keys
        counts["caches"] += isinstance(value, ast.Call) and not value.args and _name(value.func) in _DICTIONARIES
    return counts


def _targets(node: ast.stmt) -> list[ast.expr]:
    return node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []


def _name(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else "_"


def _files(folder: Path, pattern: str) -> Iterator[tuple[str, Path]]:
    for path in sorted(folder.rglob(pattern)):
        parts = path.relative_to(folder).parts
        yield parts[0] if len(parts) > 1 else ".", path


def _add(rows: dict[str, Counter[str]], package: str, counts: Mapping[str, int]) -> None:
    for key in (package, "all"):
        rows.setdefault(key, Counter()).update(counts)


if __name__ == "__main__":
    main()
