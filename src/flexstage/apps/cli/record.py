"""Options and opening of tests for the commands that read records: `identify`, `compare`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from flexstage.apps.cli.bar import bar
from flexstage.base.finding import DesignError, Finding, refuse, require

if TYPE_CHECKING:
    from enum import Enum

    from flexstage.readings.linear.model import LinearModel
    from flexstage.readings.measured.health import Needs
    from flexstage.readings.measured.identify import Search
    from flexstage.readings.measured.options import Options
    from flexstage.readings.measured.record import Record, Responses
    from flexstage.studies.identification import Told


Inputs: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--inputs", metavar="NAMES", help='Channels that were inputs, e.g. "u*" or B1,B2. Default: told by name.', show_default=False
    ),
]
Outputs: TypeAlias = Annotated[
    list[str] | None, typer.Option("--outputs", metavar="NAMES", help='Channels that were outputs, e.g. "S?".', show_default=False)
]
Only: TypeAlias = Annotated[
    list[str] | None, typer.Option("--only", metavar="NAMES", help="The channels that count at all.", show_default=False)
]
Units: TypeAlias = Annotated[
    list[str] | None,
    typer.Option("--units", metavar="NAMES=UNIT", help='Units of channels, e.g. "S*=um". May be given several times.', show_default=False),
]
Rate: TypeAlias = Annotated[
    str | None,
    typer.Option("--rate", metavar="FREQUENCY", help='Sampling rate, if the file has none or a wrong one: "2048 Hz".', show_default=False),
]
Kind: TypeAlias = Annotated[
    str | None,
    typer.Option("--kind", metavar="<record|responses>", help="Which is meant of a file that holds both.", show_default=False),
]
Allow: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--allow",
        metavar="FAULT",
        help="What may be used although it is bad: truncated, gaps, dead, clipped, units, dependent, short, slow, names, incomplete.",
        show_default=False,
    ),
]
Band: TypeAlias = Annotated[
    tuple[str, str] | None,
    typer.Option("--band", metavar="LOW HIGH", help='Where modes are looked for, e.g. --band "50 Hz" "400 Hz".', show_default=False),
]
Resolution: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--resolution", metavar="FREQUENCY", help='Resolution of the spectra, e.g. "0.5 Hz". Default: by length.', show_default=False
    ),
]


@dataclass(frozen=True)
class Said:
    """What the user says about records, as texts of the command line."""

    inputs: list[str] | None
    outputs: list[str] | None
    only: list[str] | None
    units: list[str] | None
    rate: str | None
    kind: str | None
    allow: list[str] | None
    band: tuple[str, str] | None
    resolution: str | None

    def options(self) -> Options:
        """The options of the reader; raises `DesignError` with all that is wrong with them."""
        from flexstage.readings.measured import options

        findings: list[Finding] = []
        units = _units(self.units, findings)
        allowed = [_word("--allow", word, options.Allow, findings) for word in _names(self.allow)]
        kind = None if self.kind is None else _word("--kind", self.kind, options.Kind, findings)
        require(findings)
        return options.Options(
            inputs=_names(self.inputs),
            outputs=_names(self.outputs),
            only=_names(self.only),
            rate=None if self.rate is None else _hertz("--rate", self.rate),
            units=units,
            kind=None if kind is None else options.Kind(kind),
            allow=frozenset(options.Allow(word) for word in allowed if word is not None),
        )

    def search(self) -> Search:
        """What is searched for."""
        from flexstage.readings.measured.identify import Search
        from flexstage.readings.measured.spectra import Segments

        band = None if self.band is None else (_hertz("--band", self.band[0]), _hertz("--band", self.band[1]))
        if self.band is not None and band is not None and band[0] >= band[1]:
            raise refuse("--band", f"{self.band[0]} to {self.band[1]} is no band", "Give a low frequency and a higher one")
        lines = self._resolution()
        return Search(band=band, segments=None if lines is None else Segments(1.0 / lines))

    def needs(self, model: LinearModel | None, highest: float | None = None) -> Needs:
        """What is asked of records: outputs of the stage where there is one, a rate for the highest mode or the band, the resolution."""
        from flexstage.readings.measured.health import Needs

        top = _hertz("--band", self.band[1]) if self.band is not None else highest
        outputs = None if model is None else tuple((channel.name, channel.unit) for channel in model.outputs)
        return Needs(resolution=self._resolution(), highest=top, outputs=outputs)

    def _resolution(self) -> float | None:
        return None if self.resolution is None else _hertz("--resolution", self.resolution)


def opened_records(paths: Sequence[Path], options: Options) -> list[Record | Responses]:
    """What the files hold; raises `DesignError` with all that keeps any of them from being read."""
    from flexstage.readings.measured.read import read

    found: list[Record | Responses] = []
    findings = list(_twice(paths))
    for path in dict.fromkeys(paths):
        try:
            found.append(read(path, options))
        except DesignError as error:
            findings += error.findings
    require(findings)
    return found


def _twice(paths: Sequence[Path]) -> Iterator[Finding]:
    counts = Counter(path.resolve() for path in paths)
    for path in {path.resolve(): path for path in paths}.values():
        if (count := counts[path.resolve()]) > 1:
            yield Finding(str(path), f"it is given {count} times", "Give every record once: it would count as so many tests")


@contextmanager
def told() -> Generator[Told]:
    """A bar of progress on the terminal that follows what it is told."""
    with bar() as shown:
        yield shown.share


def _names(texts: Sequence[str] | None) -> tuple[str, ...]:
    return tuple(name.strip() for text in texts or () for name in text.split(",") if name.strip())


def _units(texts: Sequence[str] | None, findings: list[Finding]) -> tuple[tuple[str, str], ...]:
    pairs = [tuple(part.strip() for part in text.rpartition("=")[::2]) for text in texts or ()]
    for text, (name, unit) in zip(texts or (), pairs, strict=True):
        if not name or not unit:
            findings.append(Finding(f"--units {text}", "this names no channel and unit", 'Write for example --units "S*=um"'))
    return tuple((name, unit) for names, unit in pairs for name in _names([names]))


def _word(option: str, word: str, kind: type[Enum], findings: list[Finding]) -> str | None:
    known = [str(each.value) for each in kind]
    if word in known:
        return word
    findings.append(Finding(f"{option} {word}", f'"{word}" is none of {", ".join(known)}', "Write one of these words"))
    return None


def _hertz(option: str, text: str) -> float:
    from flexstage.base.quantity import FREQUENCY
    from flexstage.base.unit import parse

    value = parse(text, FREQUENCY, where=option)
    if value < 0.0 or (value == 0.0 and option != "--band"):
        raise refuse(option, f"{text} is no frequency to use", 'Give one above zero, e.g. "2 kHz"')
    return value
