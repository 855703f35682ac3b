"""Reading of option texts: quantities with units, platform motions, random inputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TypeVar

from flexstage.analysis.dynamics.random_response import Rate, Spectrum
from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.units.quantity import ANGLE, CURRENT, DISPLACEMENT, FREQUENCY, RESISTANCE, Quantity
from flexstage.base.units.unit import parse
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.port import ports
from flexstage.spatial.frame import COMPONENTS

_Value = TypeVar("_Value")
_Name = TypeVar("_Name")
_ASD_EXAMPLE = 'Use e.g. --input-asd "ground.z=1 nm/Hz^0.5", or "ground.z=1e-5 m/s^2/Hz^0.5" for an acceleration'


class Values:
    """Reader of option texts that collects all errors in `findings`, so that they are reported together."""

    def __init__(self) -> None:
        self.findings: list[Finding] = []

    def attempt(self, action: Callable[[], _Value]) -> _Value | None:
        """Return the result of an action; if it raises `DesignError`, collect the errors and return `None`."""
        try:
            return action()
        except DesignError as error:
            self.findings += error.findings
            return None

    def value(self, option: str, text: str | None, quantity: Quantity) -> float | None:
        """Return the value of a text in SI units; `None` if the text is absent or wrong."""
        return None if text is None else self.attempt(lambda: parse(text, quantity, where=option))


def names(texts: Sequence[str] | None) -> tuple[str, ...]:
    """Split texts at commas into names."""
    return tuple(name.strip() for text in texts or () for name in text.split(",") if name.strip())


def first_that_parses(text: str, known: Mapping[_Name, Quantity]) -> tuple[_Name, float] | None:
    """Find the first known quantity that fits the unit of a text. Returns the quantity's name and the SI value; `None` if none fits."""
    for name, quantity in known.items():
        try:
            return name, parse(text, quantity)
        except DesignError:
            continue
    return None


def amplifier_values(values: Values, texts: Sequence[str]) -> dict[str, float]:
    """Read the values of `--amplifier` by name in SI units: bandwidth, resistance and current, distinguished by their units."""
    known = {"bandwidth": FREQUENCY, "resistance": RESISTANCE, "current": CURRENT}
    found: dict[str, float] = {}
    for text in texts:
        if (fit := first_that_parses(text, known)) is None:
            what = f'must be a frequency, resistance or current (got "{text}")'
            values.findings.append(Finding("--amplifier", what, 'Use e.g. "500 Hz", "50 ohm" or "0.2 A"'))
        else:
            found[fit[0]] = fit[1]
    return found


def read_pairs(texts: Sequence[str], option: str, read: Callable[[str, str, str], _Value]) -> dict[str, _Value]:
    """Read texts NAME=VALUE of an option with the function `read(name, value, where)`; report all errors together.

    >>> read_pairs(["x=5 um"], "--at", lambda name, value, where: parse(value, DISPLACEMENT, where=where))
    {'x': 5e-06}
    """
    values, found = Values(), dict[str, _Value]()
    for text in texts:
        name, _, value = (part.strip() for part in text.partition("="))
        if name in found:
            values.findings.append(Finding(f"{option} {name}", "given twice", "Give one value"))
        elif (one := values.attempt(partial(read, name, value, f"{option} {text}"))) is not None:
            found[name] = one
    require(values.findings)
    return found


def motions(texts: Sequence[str], option: str = "--command") -> dict[str, float]:
    """Read the magnitudes [m, rad] of platform motions from texts AXIS=VALUE of an option; report all errors together."""

    def read(name: str, value: str, where: str) -> float:
        if name not in COMPONENTS or not value:
            raise refuse(where, "must be an axis and a value", f"{suggest_nearest(name, COMPONENTS)}, e.g. z=150um")
        return abs(parse(value, ANGLE if name.startswith("r") else DISPLACEMENT, where=where))

    return read_pairs(texts, option, read)


def band_limits(band: tuple[str, str] | None) -> tuple[float, float] | None:
    """Read the frequencies [Hz] of `--band`; raises `DesignError` unless 0 < low < high. Returns `None` without a band.

    >>> band_limits(("10 Hz", "2 kHz"))
    (10.0, 2000.0)
    """
    if band is None:
        return None
    low, high = (parse(text, FREQUENCY, where="--band") for text in band)
    if not 0.0 < low < high:
        raise refuse("--band", f"{band[0]} to {band[1]} is not a band", "Use a lower limit above zero and a higher upper limit")
    return low, high


def spectra(model: LinearModel, densities: Sequence[str]) -> dict[str, Spectrum]:
    """Read the white spectrum of each input from texts INPUT=DENSITY of `--input-asd`.

    The unit of an amplitude spectral density determines whether it is the density of the input, its velocity or its acceleration. All
    errors are reported together.
    """
    return read_pairs(densities, "--input-asd", partial(_spectrum, model))


def _spectrum(model: LinearModel, name: str, value: str, where: str) -> Spectrum:
    unit = ports(model, ("platform",), (name,)).inputs[0].unit
    units = {Rate.VALUE: unit, Rate.VELOCITY: f"{unit}/s", Rate.ACCELERATION: f"{unit}/s^2"}
    forms = {rate: f"{form}/Hz^0.5" for rate, form in units.items()}
    known = {rate: Quantity("amplitude density", form, form, f"1e-9 {form}") for rate, form in forms.items()}
    if (fit := first_that_parses(value, known)) is not None:
        return Spectrum(fit[1] ** 2, rate=fit[0])
    what = f'must be an amplitude spectral density of {name} [{unit}/Hz^0.5], or of its velocity or acceleration (got "{value}")'
    raise refuse(where, what, _ASD_EXAMPLE)
