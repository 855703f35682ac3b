"""Differences of outputs: documents path by path, texts line by line, and what of them is meant."""

from __future__ import annotations

import csv
import difflib
import hashlib
import json
import os
import re
import zipfile
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html.parser import HTMLParser
from itertools import pairwise, zip_longest
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import h5py
import numpy as np
from scipy.io import loadmat

# What is left out, by reason: paths of documents, words of texts, and files inside of others.
LEFT_PATHS = {"version": r"(^|[._@])version$", "date": r"^@?made(\[\])?$"}
LEFT_WORDS = {
    "date": r"\d{4}-\d\d-\d\dT[\d:.]+\S*",
    "version": r"(?<=flexstage )\d+\.\d+\.\d+\S*|^\d+\.\d+\.\d+$",
    "digest": r"(?<= of )[0-9a-f]{10,16}$|^[0-9a-f]{16}$|^[0-9a-f]+·10[⁰-⁹¹²³]+$",  # cut off, as number, or of a document
    "folder of a run": r"(?<=kept in )\S+",
    "free port": r"(?<=127\.0\.0\.1:)\d+",
    "time of a computation": r"(?<=ran for )\S+ s|(?<=; about ).+(?= by the first)|(?<=a design takes ).+(?=, usually)",
}
NUMBER = r"[-−]?\d+(\.\d+)?(e[-+]?\d+)?(·10[⁻⁰-⁹¹²³]+)?"
LEFT_MEMBERS = r"\.(so|dll|dylib)$"


@dataclass(frozen=True)
class Rule:
    """How far numbers may lie apart where a regular expression finds "run/file:path", and because of what; the first that does, counts.

    `within`: relative to the geometric mean of the largest entries in row and column; infinite: not compared. `frequencies`: the path of
    modes' frequencies in the same document; columns are then shapes, compared by P P^T: of repeated modes the space counts.
    """

    where: str
    because: str
    within: float = 1e-12
    frequencies: str = ""


@dataclass(frozen=True)
class Meant:
    """Stated differences: regular expressions of words in texts and of paths in documents, each with its replacement, and rules.

    `alone`: paths of one side only, each with the reason.
    """

    texts: Mapping[str, str] = field(default_factory=dict)
    paths: Mapping[str, str] = field(default_factory=dict)
    rules: tuple[Rule, ...] = ()
    alone: Mapping[str, str] = field(default_factory=dict)


Document = Mapping[str, list[Any]]
"""What stands at each path; the entries of a list share one, as in modes[].name."""


def document(value: Any) -> Document:
    """The leaves of nested mappings and lists: words, numbers, and lists of these."""
    found: dict[str, list[Any]] = defaultdict(list)
    for path, leaf in _leaves(value, ""):
        found[path].append(leaf)
    return found


def _leaves(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping) and value:
        for key, each in value.items():
            yield from _leaves(each, f"{path}.{key}".lstrip("."))
    elif isinstance(value, list) and any(isinstance(each, Mapping) for each in value):
        for each in value:
            yield from _leaves(each, f"{path}[]")
    else:
        yield path, value


def read(path: Path) -> Document | list[str]:
    """A file as a document, or as lines of text."""
    data = path.read_bytes()
    match path.suffix:
        case ".json":
            return document(json.loads(data))
        case ".mat":
            return document({name: each for name, each in loadmat(path, simplify_cells=True).items() if not name.startswith("__")})
        case ".h5":
            return document(_hdf(path))
        case ".fmu":
            with zipfile.ZipFile(path) as members:
                return document({each: members.read(each) for each in members.namelist() if not re.search(LEFT_MEMBERS, each)})
        case ".npz":
            with np.load(path) as arrays:
                return document(dict(arrays))
        case ".csv":
            columns = zip_longest(*csv.reader(data.decode().splitlines()), fillvalue="")
            return document({f"{place} {name}": _column(cells) for place, (name, *cells) in enumerate(columns, 1)})
        case ".xlsx":
            return document(_workbook(path))
        case ".html":
            page = _Page()
            page.feed(data.decode())
            return page.words
        case _ if b"\0" in data:
            lines = [(line.decode("latin-1"), hashlib.sha256(line).hexdigest()) for line in data.split(b"\n")]
            return [line if line.isprintable() else digest for line, digest in lines]
        case _:
            return data.decode(errors="replace").splitlines()


def _column(cells: Sequence[Any]) -> np.ndarray | list[str]:
    """A column of a table: numbers, NaN where a cell is empty, or texts."""
    try:
        return np.array([float(each or "nan") for each in cells])
    except ValueError:
        return [*map(str, cells)]


def _workbook(path: Path) -> Mapping[str, Any]:
    """Columns of each sheet below its head of two rows, by letter."""
    space = {"": "http://schemas.openxmlformats.org/spreadsheetml/2006/main"}
    found: dict[str, dict[str, list[str]]] = {}
    with zipfile.ZipFile(path) as files:
        names, strings = (_xml(files, each) for each in ("workbook", "sharedStrings"))
        texts = ["".join(each.itertext()) for each in strings.iterfind("si", space)]
        for number, sheet in enumerate(names.iterfind("sheets/sheet", space), 1):
            cells = found.setdefault(sheet.get("name", ""), defaultdict(list))
            for cell in _xml(files, f"worksheets/sheet{number}").iterfind(".//c", space):
                value, place = cell.findtext("v", "", space), cell.get("r", "")
                column = place.rstrip("0123456789")
                place = f"{column}.head" if int(place.removeprefix(column)) < 3 else column
                cells[place].append(texts[int(value)] if cell.get("t") == "s" else value)
    return {name: {place: _column(each) for place, each in cells.items()} for name, cells in found.items()}


def _xml(files: zipfile.ZipFile, name: str) -> ElementTree.Element:
    return ElementTree.fromstring(files.read(f"xl/{name}.xml"))  # noqa: S314 (flexstage has written it)


def _hdf(path: Path) -> Mapping[str, Any]:
    found: dict[str, Any] = {}

    def add(name: str, item: Any) -> None:
        found.update({f"{name}@{key}": each for key, each in item.attrs.items()})
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]

    with h5py.File(path, "r") as file:
        add("", file)
        file.visititems(add)
    return found


class _Page(HTMLParser):
    """The words of a page that people read."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []

    def handle_data(self, data: str) -> None:
        if self.lasttag not in ("script", "style"):
            self.words.append(data)


def _plain(lines: Iterable[str]) -> list[str]:
    """Lines without what is left out, without the widths of columns."""
    words = {pattern: f"<{name}>" for name, pattern in LEFT_WORDS.items()} | {r"[\s─]+": " "}
    return [found for line in lines if (found := respelled(line, words).strip())]


def respelled(text: str, words: Mapping[str, str]) -> str:
    """A text in other words."""
    for old, new in words.items():
        text = re.sub(old, new, text)
    return text


EQUAL, RENAMED, WITHIN, DIFFERENT, SKIPPED = "equal", "equal but for words", "within what is stated", "different", "left out"
Finding = tuple[str, str]
"""One of these words, and which path or what differs."""


def deviation(old: Any, new: Any) -> float:
    """Largest difference of numbers, vectors or matrices, relative to the geometric mean of the largest entries in its row and column.

    Infinite where they are no numbers of one shape, or unknown on one side only.
    """
    first, second = _numbers(old), _numbers(new)
    if first is None or second is None or first.shape != second.shape or (np.isnan(first) != np.isnan(second)).any():
        return np.inf
    first, second = (np.nan_to_num(each.reshape(each.shape if each.ndim > 1 else (-1, 1))) for each in (first, second))
    size = np.abs(first)
    scale = np.sqrt(size.max(-1, keepdims=True, initial=0.0) * size.max(-2, keepdims=True, initial=0.0))
    off = np.abs(first - second)
    return float(np.divide(off, scale, out=np.where(off > 0.0, np.inf, 0.0), where=scale > 0.0).max(initial=0.0))


def _numbers(value: Any) -> np.ndarray | None:
    try:
        array = np.asarray(value)
        array = array.astype(float) if array.dtype == object else array  # None is unknown
    except (ValueError, TypeError):
        return None
    return array if array.dtype.kind in "iufc" else None


def turned(old: Any, new: Any, frequencies: Sequence[float]) -> float:
    """The deviation of shapes P (columns) by P P^T, of modes whose frequencies agree to 1e-6 together: neither signs nor turns count."""
    first, second = np.asarray(old), np.asarray(new)
    if first.shape != second.shape or first.shape[-1] != len(frequencies):
        return np.inf
    starts = [number for number, each in enumerate(frequencies) if not number or each - frequencies[number - 1] > 1e-6 * each]
    groups = [slice(*each) for each in pairwise((*starts, len(frequencies)))]
    return max(deviation(*(each[:, group] @ each[:, group].conj().T for each in (first, second))) for group in groups)


def bits(value: Any) -> str:
    """What two values share that are equal bit by bit."""
    if isinstance(value, np.ndarray) and value.dtype != object:
        return f"{value.dtype.str} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()}"
    return repr(value.tolist() if isinstance(value, np.ndarray) else value)


def compared(where: str, old: Document, new: Document, meant: Meant) -> Iterator[Finding]:
    """Two documents, path by path; `where` is "run/file"."""
    renamed = {path: path if path in new else respelled(path, meant.paths) for path in old}
    said = {renamed[path]: [_said(each, meant.texts) for each in leaves] for path, leaves in old.items()}
    untouched = {now for path, now in renamed.items() if now == path and repr(said[now]) == repr(old[path])}
    old = said
    for path in (each for each in old if each in new):
        rule = next((each for each in meant.rules if re.search(each.where, f"{where}:{path}")), None)
        state, text = _judged(path, old, new, rule)
        yield RENAMED if state == EQUAL and path not in untouched else state, text
    stated = {path for path in old.keys() ^ new.keys() if any(re.search(each, path) for each in meant.alone)}
    yield from ((WITHIN, path) for path in sorted(stated))
    gone = {path: repr([*map(bits, each)]) for path, each in old.items() if path not in new and path not in stated}
    come = {path: repr([*map(bits, each)]) for path, each in new.items() if path not in old and path not in stated}
    moved = dict(_moves(gone, come))
    for text in dict.fromkeys(_short(*each) for each in moved.items()):
        yield DIFFERENT, text
    for path in dict.fromkeys(_top(each, new) for each in gone if each not in moved):
        yield DIFFERENT, f"{path}: only at BASE"
    for path in dict.fromkeys(_top(each, old) for each in come if each not in moved.values()):
        yield DIFFERENT, f"{path}: only at HEAD"


def _said(value: Any, words: Mapping[str, str]) -> Any:
    """A value whose texts are in other words."""
    if isinstance(value, list):
        return [_said(each, words) for each in value]
    return respelled(value, words) if isinstance(value, str) else value


def _judged(path: str, old: Document, new: Document, rule: Rule | None) -> Finding:
    reason = rule.because if rule is not None and np.isinf(rule.within) else ""
    reason = next((reason for reason, each in LEFT_PATHS.items() if re.search(each, path)), reason)
    if reason:
        return SKIPPED, f"{path} ({reason})"
    if len(old[path]) != len(new[path]):
        return DIFFERENT, f"{path}: {len(old[path])} of them -> {len(new[path])}"
    pairs = [each for each in zip(old[path], new[path], strict=True) if bits(each[0]) != bits(each[1])]
    if not pairs:
        return EQUAL, path
    shapes = rule is not None and rule.frequencies
    off = max(turned(*each, np.ravel(old[shapes]).tolist()) if shapes else deviation(*each) for each in pairs)
    if rule is not None and off <= rule.within:
        return WITHIN, path
    first = " -> ".join(" ".join(str(each).split()) for each in _first_entries(*pairs[0]))
    by = f", by {off:.2g} at most" if np.isfinite(off) else ""
    return DIFFERENT, f"{path}: {len(pairs)} of {len(old[path])} differ{by}{f': {first}' if len(first) < 120 else ''}"


def _first_entries(old: Any, new: Any) -> tuple[Any, Any]:
    """Of arrays of one shape the first entries that differ, of all else the values."""
    if not (isinstance(old, np.ndarray) and isinstance(new, np.ndarray) and old.shape == new.shape):
        return old, new
    differ = [(one, other) for one, other in zip(old.ravel().tolist(), new.ravel().tolist(), strict=True) if repr(one) != repr(other)]
    return differ[0] if differ else (old, new)


def _moves(gone: Mapping[str, str], come: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Paths whose values stand elsewhere now: of several such places, the one whose name ends most alike."""
    left = dict(come)
    for path, value in gone.items():
        alike = [(len(os.path.commonprefix([path[::-1], each[::-1]])), each) for each in left if left[each] == value]  # noqa: RUF071 (letters)
        if alike and (len(value) > 12 or max(alike)[0] > 3):
            yield path, max(alike)[1]
            del left[max(alike)[1]]


def _short(old: str, new: str) -> str:
    """A move without what both paths end with."""
    first, second = old.split("."), new.split(".")
    while min(len(first), len(second)) > 1 and first[-1] == second[-1]:
        del first[-1], second[-1]
    return f"{'.'.join(first)} -> {'.'.join(second)}"


def _top(path: str, other: Document) -> str:
    """The shortest beginning of a path that the other side does not have."""
    words = path.split(".")
    starts = (".".join(words[:count]) for count in range(1, len(words)))
    return next((start for start in starts if not any(each == start or each.startswith(f"{start}.") for each in other)), path)


def compared_texts(old: Sequence[str], new: Sequence[str], meant: Meant, rule: Rule | None = None) -> Iterator[Finding]:
    """Two texts; five differences of each are listed. With a rule only the words count: documents hold the numbers to full precision."""
    if rule is not None and np.isinf(rule.within):
        yield SKIPPED, rule.because
        return
    left = [reason for reason, each in LEFT_WORDS.items() if [*_found(each, old)] != [*_found(each, new)]]
    old, new = _plain(old), _plain(new)
    if old == new:
        yield (SKIPPED, ", ".join(left)) if left else (EQUAL, "")
        return
    old = [part for line in old for part in respelled(line, meant.texts).split("\n")]
    if " ".join(old) == " ".join(new):  # lines may break elsewhere
        yield RENAMED, ""
        return
    if rule is not None and [re.sub(NUMBER, "#", each) for each in old] == [re.sub(NUMBER, "#", each) for each in new]:
        yield WITHIN, ""
        return
    if len(old) * len(new) < 1e7:
        blocks = [each[1:] for each in difflib.SequenceMatcher(None, old, new, autojunk=False).get_opcodes() if each[0] != "equal"]
    else:  # line by line: what was put in or taken out of thousands of lines takes minutes to find
        blocks = [(at, at + 1, at, at + 1) for at in range(max(len(old), len(new))) if old[at : at + 1] != new[at : at + 1]]
    for start, stop, other, end in blocks[:5]:
        first, second = (" / ".join(lines)[:200] for lines in (old[start:stop], new[other:end]))
        yield DIFFERENT, f'line {other + 1}: "{first}" -> "{second}"'
    if len(blocks) > 5:
        yield DIFFERENT, f"and {len(blocks) - 5} more differences of this text"


def _found(pattern: str, lines: Sequence[str]) -> Iterator[str]:
    return (found for line in lines for found in re.findall(pattern, line))


def compared_folders(name: str, old: Path, new: Path, meant: Meant) -> Iterator[tuple[str, Finding]]:
    """All files that a task has on both sides: where, and what was found."""
    at_old, at_new = ({str(each.relative_to(folder)) for each in folder.rglob("*") if each.is_file()} for folder in (old, new))
    before = {each if each in at_new else respelled(each, meant.paths): each for each in at_old}
    for each in sorted(before.keys() | at_new):
        where = f"{name}/{each}"
        if each not in before.keys() & at_new:
            yield where, (DIFFERENT, f"only at {'BASE' if each in before else 'HEAD'}")
            continue
        first, second = read(old / before[each]), read(new / each)
        if each.endswith(".stderr") and isinstance(first, list) and first[0] != "exit code 0" and not name.startswith("refused"):
            yield where, (DIFFERENT, f"{first[0]} at BASE: {' / '.join(first[1:])[:200]}")
        if isinstance(first, list) and isinstance(second, list):
            rule = next((each for each in meant.rules if re.search(each.where, f"{where}:")), None)
            found = [*compared_texts(first, second, meant, rule)]
            if found == [(EQUAL, "")] and (old / before[each]).read_bytes() != (new / each).read_bytes():
                found = [(SKIPPED, "blanks, markup, scripts, shapes of pictures")]
        else:
            one, other = (document({"lines": each}) if isinstance(each, list) else each for each in (first, second))
            found = compared(where, one, other, meant)
        yield from ((where, finding) for finding in found)
