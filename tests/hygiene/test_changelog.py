"""CHANGELOG.md keeps the form of Keep a Changelog 1.1, with one kind more: "Numbers changed"."""

from __future__ import annotations

import re

import flexstage
from tests.hygiene.source import ROOT, expect_none

KINDS = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security", "Numbers changed"}
RELEASE = re.compile(r"\[Unreleased\]|\[(\d+\.\d+\.\d+)\] - (?:unreleased|\d{4}-\d{2}-\d{2})")


def headings(level: int) -> list[str]:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    return re.findall(rf"^{'#' * level} (.*)$", text, re.MULTILINE)


def test_title() -> None:
    assert headings(1) == ["Changelog"]


def test_releases_have_a_version_and_a_date() -> None:
    releases = headings(2)
    expect_none((release for release in releases if not RELEASE.fullmatch(release)), "write [1.2.3] - 2026-01-31")
    assert not any(release.endswith("unreleased") for release in releases[1:])


def test_a_release_has_eighty_lines_at_most() -> None:
    releases = re.split(r"^## ", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    expect_none((each.splitlines()[0] for each in releases if len(each.splitlines()) > 80), "shorten it: one line for each change")


def test_releases_descend() -> None:
    versions = [tuple(map(int, found[1].split("."))) for release in headings(2) if (found := RELEASE.fullmatch(release)) and found[1]]
    assert versions == sorted(set(versions), reverse=True)


def test_kinds_are_known() -> None:
    assert set(headings(3)) <= KINDS


def test_the_package_is_not_behind() -> None:
    released = [found[1] for release in headings(2) if (found := RELEASE.fullmatch(release)) and found[1]]
    current = tuple(map(int, flexstage.__version__.split(".")[:3]))
    assert all(tuple(map(int, version.split("."))) <= current for version in released)


def test_the_citation_names_the_version() -> None:
    cited = re.search(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    assert cited
    assert cited[1] == flexstage.__version__


def test_readme_has_no_links_that_an_index_page_breaks() -> None:
    # The index shows it without the files beside it: links name whole addresses; pictures, which it leaves out, are files of the project.
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    expect_none(re.findall(r"(?<!!)\[[^]]*\]\((?!https://|#)[^)]*\)", text), "name the file in backticks, or give the whole address")
    expect_none(
        (each for each in re.findall(r"!\[[^]]*\]\(([^)]*)\)", text) if not (ROOT / each).is_file()), "name a picture that there is"
    )
