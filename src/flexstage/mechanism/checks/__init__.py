"""Checks of a description that collect all errors.

`check` returns errors, `require_valid` raises them. For a batch, a check reports the index of the first failing design. Errors that depend
on elasticity (a free internal mode) are reported by the models.
"""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, require
from flexstage.base.number import Table
from flexstage.mechanism.assembly.expand import compound_findings, place_findings
from flexstage.mechanism.checks.formula import formula_findings
from flexstage.mechanism.checks.geometry import geometry_findings, matrix_findings
from flexstage.mechanism.checks.graph import graph_findings
from flexstage.mechanism.checks.kind import kind_findings, package_findings
from flexstage.mechanism.checks.name import copy_findings, name_findings
from flexstage.mechanism.checks.orientation import orientation_findings
from flexstage.mechanism.checks.provenance import override_findings, tag_findings
from flexstage.mechanism.checks.value import value_findings
from flexstage.mechanism.mechanism import Mechanism

__all__ = ["check", "copy_findings", "package_findings", "require_valid"]


@check_arguments
def check(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Return all errors of a description; an empty tuple if the description is valid.

    A check is skipped if the data that it needs contain errors. Numbers are compared only if they are finite; orientations are checked only
    for valid parts. The graph is checked only if all names exist, and matrix files only if all other checks pass.

    >>> [str(finding) for finding in check(Mechanism("empty"))]
    ['bodies: unknown body "platform". Declare the moving platform under bodies.platform.']
    """
    for ground in (kind_findings, copy_findings, place_findings):
        if findings := tuple(ground(mechanism)):
            return findings
    if findings := tuple(package_findings(mechanism.packages)):
        return findings
    names = (*name_findings(mechanism), *compound_findings(mechanism))
    overrides = tuple(override_findings(mechanism))
    sound = mechanism if not overrides else replace(mechanism, overrides=Table({}))
    values = (*formula_findings(mechanism), *value_findings(sound))
    findings = (*names, *overrides, *tag_findings(mechanism), *values)
    if not values:
        geometry = tuple(geometry_findings(sound, overrides=not findings))
        findings += geometry or tuple(orientation_findings(sound))
    findings = findings if names else (*findings, *graph_findings(mechanism))
    return findings or tuple(matrix_findings(mechanism))


def require_valid(mechanism: Mechanism) -> Mechanism:
    """Return the description if it is valid; otherwise raise all errors as `DesignError`.

    >>> require_valid(Mechanism("empty"))
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: bodies: unknown body "platform". Declare the moving platform under bodies.platform.
    """
    require(check(mechanism))
    return mechanism
