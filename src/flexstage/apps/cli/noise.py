"""Random inputs from options: `--noise ground.z="1 nm/Hz^0.5"`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from flexstage.base.finding import DesignError, Finding, require

if TYPE_CHECKING:
    from flexstage.analysis.random_response import Spectrum
    from flexstage.readings.linear.model import LinearModel

_EXAMPLE = 'Write for example --noise "ground.z=1 nm/Hz^0.5", or an acceleration, "ground.z=1e-5 m/s^2/Hz^0.5"'


def spectra_from(model: LinearModel, noises: Sequence[str]) -> dict[str, Spectrum]:
    """White spectra by input from texts INPUT=AMPLITUDE DENSITY, of the input or of its first or second rate; all mistakes together."""
    found: dict[str, Spectrum] = {}
    findings: list[Finding] = []
    for text in noises:
        name, _, value = (part.strip() for part in text.partition("="))
        try:
            found[name] = _spectrum(model, name, value, f"--noise {text}")
        except DesignError as error:
            findings += error.findings
    require(findings)
    return found


def _spectrum(model: LinearModel, name: str, value: str, where: str) -> Spectrum:
    from flexstage.analysis.random_response import Rate, Spectrum
    from flexstage.base.quantity import Quantity
    from flexstage.base.unit import parse
    from flexstage.readings.linear.port import ports

    unit = ports(model, ("platform",), (name,)).inputs[0].unit
    units = {Rate.VALUE: unit, Rate.VELOCITY: f"{unit}/s", Rate.ACCELERATION: f"{unit}/s^2"}
    for rate, form in units.items():
        density = Quantity("amplitude density", f"{form}/Hz^0.5", f"{form}/Hz^0.5", f"1e-9 {form}/Hz^0.5")
        try:
            return Spectrum(parse(value, density, where=where) ** 2, rate=rate)
        except DesignError:
            continue
    what = f'found "{value}", which is no amplitude density of {name} [{unit}/Hz^0.5] or of its rates'
    raise DesignError([Finding(where, what, _EXAMPLE)])
