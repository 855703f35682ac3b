"""Free parameters of an update, with their priors."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from flexstage.analysis.assessment.sensitivities import not_numbers, override_level
from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import DesignError, Finding, require, suggest_nearest
from flexstage.base.number import Array, Table
from flexstage.mechanism.addresses.address import get, quantity_of, set_value
from flexstage.mechanism.addresses.locate import canonical, locate
from flexstage.mechanism.grammar.node import NumberNode
from flexstage.mechanism.mechanism import Mechanism


@dataclass(frozen=True)
class Prior(CheckedFields):
    """Assumed relative standard deviations in an update: of the parameters before the test, the model's frequencies and the static gains.

    `prior` is the standard deviation of every free parameter, unless `priors` has a value for its address. `model_error` is the error of
    the model's frequencies that remains with the best parameters. `gain_error` is the error of static gains, due to the model and to the
    scales of gauges and drives. If `gain_error` is `None`, static gains are not used.
    """

    prior: float = 0.1
    priors: Mapping[str, float] = field(default_factory=lambda: Table({}))
    model_error: float = 1e-3
    gain_error: float | None = None


DEFAULT = Prior()


@dataclass(frozen=True, eq=False)
class Free:
    """Free parameters of an update: full addresses, units, initial values (P,), and prior standard deviations (P,) of the logarithms.

    `mechanism` is the stage's description, with the overrides that the addresses require.
    """

    mechanism: Mechanism
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    deviations: Array

    def multiply(self, logarithms: Array) -> Mechanism:
        """Return the description with each free parameter multiplied by exp(x), where x is its entry in `logarithms` (P,)."""
        result = self.mechanism
        for name, value in zip(self.names, self.values * np.exp(logarithms), strict=True):
            result = set_value(result, name, float(value))
        return result


def free(mechanism: Mechanism, names: Sequence[str], known: Prior = DEFAULT) -> Free:
    """Free the parameters at these addresses; raises `DesignError` unless every address is unique and its value is a nonzero number.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> free(double_triangle(), ["lever_notch.thickness"]).names
    ('parts.lever_notch.thickness',)
    """
    require([*_error_findings(known), *_address_findings(mechanism, names, tuple(known.priors))])
    full = tuple(locate(mechanism, name).address for name in names)
    own = {canonical(mechanism, name): share for name, share in known.priors.items()}
    require(
        Finding(f"prior of {name}", "it is not among the free parameters", suggest_nearest(name, full)) for name in own if name not in full
    )
    ordered = sorted(full, key=lambda name: override_level(mechanism, name))
    started = mechanism
    for name in ordered:
        started = set_value(started, name, get(mechanism, name))
    return Free(
        mechanism=replace(started, requirements={}),
        names=tuple(ordered),
        units=tuple(quantity_of(mechanism, name).si for name in ordered),
        values=np.array([float(np.real(get(mechanism, name))) for name in ordered]),
        deviations=np.array([own.get(name, known.prior) for name in ordered]),
    )


def _error_findings(known: Prior) -> list[Finding]:
    stated = {"prior": known.prior, "model error": known.model_error} | {f"prior of {name}": share for name, share in known.priors.items()}
    stated |= {} if known.gain_error is None else {"gain error": known.gain_error}
    advice = 'Use a relative standard deviation between 0.0001 % and 100 %, e.g. "5 %"'
    return [Finding(where, f"out of range (got {share:g})", advice) for where, share in stated.items() if not 1e-6 <= share <= 1.0]


def _address_findings(mechanism: Mechanism, names: Sequence[str], priors: Sequence[str]) -> Iterator[Finding]:
    if not names:
        yield Finding("free", "no parameter is free", "Specify at least one, e.g. parts.neck.thickness")
        return
    lost: set[str] = set()
    for name in (*names, *priors):
        try:
            locate(mechanism, name)
        except DesignError as error:
            yield from (_of_link(mechanism, finding) for finding in error.findings)
            lost.add(name)
    yield from _number_findings(mechanism, [name for name in names if name not in lost])


def _of_link(mechanism: Mechanism, finding: Finding) -> Finding:
    """Links of an address that starts with a link name."""
    link, _, rest = finding.where.strip().partition(".")
    units = [unit for unit, drawn in mechanism.units.items() if link in drawn.links]
    if not units or not rest:
        return finding
    what = f'"{link}" is a link of {len(units)} units' if len(units) > 1 else f'"{link}" is a link of a unit'
    return replace(finding, what=what, advice=f"Write {' or '.join(f'{unit}/{link}.{rest}' for unit in units)}")


def _number_findings(mechanism: Mechanism, names: Sequence[str]) -> Iterator[Finding]:
    yield from (_advise(mechanism, finding) for finding in not_numbers(mechanism, tuple(names)))
    for name, count in Counter(locate(mechanism, name).address for name in names).items():
        if count > 1:
            yield Finding(name, "it is named twice", "Name it once")
    for name in names:
        value = get(mechanism, name)
        if not isinstance(locate(mechanism, name).node, NumberNode) or value is None:
            continue
        if np.ndim(value):
            yield Finding(name, f"wrong number of values (got {np.size(value)}, expected 1)", "Update one design at a time")
        elif value == 0.0:
            yield Finding(name, "zero has no relative uncertainty", "Free another parameter, or use a value other than 0")


def _advise(mechanism: Mechanism, finding: Finding) -> Finding:
    """Hint for the mass of a drawn body."""
    body = canonical(mechanism, finding.where).split(".")
    if body[-1] != "mass" or body[:1] != ["bodies"] or not mechanism.bodies[body[1]].solids:
        return finding
    solids = f"bodies.{body[1]}.solids"
    shape = next(iter(mechanism.bodies[body[1]].solids))
    advice = f"Free a size or a density, e.g. {solids}.{shape}.size.z, or specify the mass instead of the solids"
    return replace(finding, what="the body's mass follows from its solids", advice=advice)
