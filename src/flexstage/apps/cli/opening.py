"""Opening of a design for a command: outputs tried, file read and checked, `--set` applied."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from flexstage.apps.cli.output import announced, output_findings
from flexstage.base.finding import DesignError, Finding, require

if TYPE_CHECKING:
    from flexstage.mechanism.mechanism import Mechanism


def opened(design: Path, changes: Sequence[str] | None, outputs: Sequence[tuple[str, str | Path | None]]) -> Mechanism:
    """The description in a file, with changes, after the outputs (option and path) were found writable.

    Raises `DesignError` with all findings.
    """
    from flexstage.mechanism.store import load

    require(output_findings(outputs, design))
    return changed(load(design), changes or ())


def changed(mechanism: Mechanism, changes: Sequence[str]) -> Mechanism:
    """The description after all assignments, checked anew; each is told."""
    from flexstage.mechanism.address import assign
    from flexstage.mechanism.checks import checked

    findings: list[Finding] = []
    result = mechanism
    for change in changes:
        try:
            result = assign(result, change)
        except DesignError as error:
            findings += [Finding(_where(change, each.where), each.what, each.advice) for each in error.findings]
    require(findings)
    return checked(result) if changes else mechanism


def _where(change: str, inner: str) -> str:
    """The assignment, and the place a finding names where that says more than the assignment does."""
    said = {change.partition("=")[0].strip(), f'"{change}"'}
    return f"--set {change}" if inner in said else f"--set {change}: {inner}"


def announce(target: str | Path) -> None:
    """Say where an output went."""
    announced(f"Wrote {target}")
