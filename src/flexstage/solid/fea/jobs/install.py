"""Check of the solid model's solver: NGSolve with netgen, in the tested version, with loadable libraries."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version

from flexstage.base.finding import Finding, require

SOLVER_VERSION = "6.2.2608"
"""Version of NGSolve and netgen with which results were tested. Meshes, and therefore last digits of results, differ between versions."""

_INSTALL = f"Install {SOLVER_VERSION} with: pip install 'flexstage[solid]' (Python 3.11 to 3.14; Linux on x86-64, macOS, Windows)"


def solver_findings() -> tuple[Finding, ...]:
    """Return the problems that prevent NGSolve and netgen from working. If the installed versions are correct, both packages are imported.

    >>> solver_findings()
    ()
    """
    return tuple(_versions()) or tuple(_loading())


def require_solver() -> None:
    """Raise a `DesignError` with the remedy if NGSolve or netgen is missing, has another version or does not load.

    >>> require_solver()
    """
    require(solver_findings())


def require_installed() -> None:
    """Raise a `DesignError` with the remedy if NGSolve or netgen is missing or has another version; the packages are not loaded.

    Separate processes load the packages later and report errors of loading.

    >>> require_installed()
    """
    require(_versions())


def _versions() -> Iterator[Finding]:
    for name in ("ngsolve", "netgen-mesher"):
        try:
            found = version(name)
        except PackageNotFoundError:
            yield Finding(f"the solid model's package {name}", "is not installed", _INSTALL)
            continue
        if found != SOLVER_VERSION:
            yield Finding(f"the solid model's package {name}", f"is version {found}, not {SOLVER_VERSION}", _INSTALL)


def _loading() -> Iterator[Finding]:
    try:
        import_module("ngsolve")
    except (ImportError, OSError) as error:  # the type depends on the loader
        advice = "Run flexstage doctor for the cause and its remedy"
        yield Finding("the solid model's package ngsolve", f"does not load ({error})", advice)
