"""The examination of the installation. It uses plain Python, so that it runs even if typer is missing."""

from __future__ import annotations

from pathlib import Path

from flexstage.apps import doctor
from flexstage.apps.doctor import Row, Verdict
from flexstage.show.command.failure import BAD_INPUT, DONE
from flexstage.show.command.terminal import print_result

FREQUENCIES = (110.910, 110.910, 135.148, 145.505, 176.690, 176.690)
"""Eq. 28 of Shin & Moon for the shipped stage [Hz]."""
_TOLERANCE = 1e-5


def consult() -> int:
    """Examine the installation and print the rows; the exit code is the verdict."""
    rows = doctor.examine(Path.cwd(), self_test)
    for row in rows:
        print_result(f"{row.verdict.value:5} {row.what:18} {row.found}{f' (required: {row.wanted})' if row.wanted else ''}")
        if row.remedy:
            print_result(f"      {'':18} {row.remedy}")
    bad = [row for row in rows if row.verdict is Verdict.BAD]
    print_result("The installation is sound." if not bad else f"{len(bad)} problem{'s' * (len(bad) > 1)} found.")
    return BAD_INPUT if bad else DONE


def self_test() -> Row:
    """Compute the frequencies of the shipped stage and compare them with the values of Shin & Moon."""
    # Imported here: a missing or broken package is a row of the examination.
    from flexstage.analysis.dynamics.modes import modes
    from flexstage.cases.double_triangle import double_triangle
    from flexstage.models.mapped import mapped

    found = modes(mapped(double_triangle())).frequencies
    worst = max(abs(have / want - 1.0) for have, want in zip(found, FREQUENCIES, strict=True))
    verdict = Verdict.GOOD if worst < _TOLERANCE else Verdict.BAD
    remedy = "" if verdict is Verdict.GOOD else "reinstall numpy and scipy; if this does not help, report it as a bug"
    return Row("self-test", f"largest relative error of the frequencies {worst:.1e}", f"{_TOLERANCE:.0e}", verdict, remedy)
