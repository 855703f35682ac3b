"""Options of commands that read test records; functions that open the records and identify modes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias, TypeVar

from flexstage.base.finding import DesignError, Finding, list_choices, refuse, require
from flexstage.base.lazy import LazyModule
from flexstage.base.units.quantity import FREQUENCY
from flexstage.base.units.unit import parse
from flexstage.experiment.identification.excitation import Excitation
from flexstage.experiment.identification.identify import Search
from flexstage.experiment.pipeline import Identification, identification, usable_measurement
from flexstage.experiment.progress import followed
from flexstage.experiment.records import options
from flexstage.experiment.records.health import RecordRequirements
from flexstage.experiment.records.record import Record, Responses
from flexstage.experiment.shapes_on_stage import StageShapes, stage_shapes
from flexstage.experiment.spectral.cross_spectra import Segments
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.model import LinearModel
from flexstage.show.command.options import band_option, rate_option, text_option, word_option
from flexstage.show.command.progress import progress_bar
from flexstage.show.command.terminal import print_note, print_warning
from flexstage.show.command.values import names

if TYPE_CHECKING:
    from flexstage.experiment.formats import read as files
else:
    files = LazyModule("flexstage.experiment.formats.read")  # loops often have no record

_Word = TypeVar("_Word", bound=Enum)
RECORD = text_option("--record", "RECORD", "Record or frequency responses of a test. Repeatable.")
Inputs: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--inputs",
        "NAMES",
        'Input channels, e.g. "u*" or B1,B2. Default: the channels that the file marks as inputs; for unmarked channels, names such as u1 '
        "decide. Repeatable.",
    ),
]
Outputs: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--outputs",
        "NAMES",
        'Output channels, e.g. "S?". Default: the channels that the file marks as outputs; for unmarked channels, names such as S1 decide. '
        "Repeatable.",
    ),
]
Channels: TypeAlias = Annotated[
    list[str] | None, text_option("--channels", "NAMES", 'Channels to use, e.g. "S*". Default: all. Repeatable.')
]
Units: TypeAlias = Annotated[list[str] | None, text_option("--units", "NAMES=UNIT", 'Units of channels, e.g. "S*=um". Repeatable.')]
Rate: TypeAlias = Annotated[str | None, rate_option("the rate in the file")]
Arrays: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--array",
        "MEANING=NAMES",
        "Meaning of arrays in the file, e.g. samples=u,y or time=t. "
        "Further meanings: rate, step, names, units, frequencies, responses, coherence. Repeatable.",
    ),
]
AcceptFault: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--accept-fault",
        "FAULT",
        "Fault to accept: truncated, gaps, dead, clipped, units, dependent, short, slow, names, windowed or incomplete. Repeatable.",
    ),
]
Moved: TypeAlias = Annotated[
    Excitation | None,
    word_option(
        "--excitation",
        Excitation,
        "Excitation of the stage: recorded inputs, floor motion, or free decay. Default: recorded.",
        show_default=False,
    ),
]


@dataclass(frozen=True)
class RecordTexts:
    """Record options as command-line strings; the field `excitation` is empty for commands without this option."""

    inputs: Inputs = None
    outputs: Outputs = None
    channels: Channels = None
    units: Units = None
    rate: Rate = None
    arrays: Arrays = None
    kind: Annotated[
        str | None,
        text_option("--kind", "<record|responses>", "Kind of data to read from a file that contains both a record and responses."),
    ] = None
    accept_fault: AcceptFault = None
    band: Annotated[tuple[str, str] | None, band_option("the whole range of the record")] = None
    frequency_resolution: Annotated[
        str | None,
        text_option(
            "--frequency-resolution",
            "FREQUENCY",
            'Frequency resolution of the spectra, e.g. "0.5 Hz". Default: chosen according to the length of the record.',
        ),
    ] = None
    excitation: Excitation | None = None

    def options(self) -> options.Options:
        """Convert these strings to options of the record reader; raises `DesignError` with all errors."""
        findings: list[Finding] = []
        units = _units(self.units, findings)
        accepted = [_word("--accept-fault", word, options.FaultTolerance, findings) for word in names(self.accept_fault)]
        kind = None if self.kind is None else _word("--kind", self.kind, options.Kind, findings)
        arrays = _arrays(self.arrays, findings)
        require(findings)
        return options.Options(
            inputs=names(self.inputs),
            outputs=names(self.outputs),
            only=names(self.channels),
            rate=_hertz("--rate", self.rate),
            units=units,
            kind=kind,
            arrays=arrays,
            accept_faults=frozenset(each for each in accepted if each is not None),
        )

    def require_unsaid(self) -> None:
        """Raise `DesignError` for every record option that is used without a record."""
        said = ("array" if name == "arrays" else name.replace("_", "-") for name, value in vars(self).items() if value)
        require(Finding(f"--{name}", "only applies with a record", "Add --record RECORD, or omit this option") for name in said)

    def search(self) -> Search:
        """Return the search parameters of the identification."""
        low, high = (_hertz("--band", text) for text in self.band or (None, None))
        band = None if low is None or high is None else (low, high)
        if self.band and band and band[0] >= band[1]:
            raise refuse("--band", f"invalid band (got {self.band[0]} to {self.band[1]})", "Use a low frequency, then a higher frequency")
        lines = self._resolution()
        return Search(band=band, segments=Segments(1.0 / lines) if lines else None, excitation=self.excitation or Excitation.RECORDED)

    def requirements(self, model: LinearModel | None, highest: float | None = None) -> RecordRequirements:
        """Return the requirements on a record: the model's outputs, the resolution, and the band's upper end (default: `highest` [Hz])."""
        top = _hertz("--band", self.band[1]) if self.band else highest
        outputs = None if model is None else tuple((channel.name, channel.unit) for channel in model.outputs)
        unrecorded = self.excitation not in (None, Excitation.RECORDED)
        return RecordRequirements(resolution=self._resolution(), highest=top, outputs=outputs, unrecorded=unrecorded)

    def _resolution(self) -> float | None:
        return _hertz("--frequency-resolution", self.frequency_resolution)


def open_records(paths: Sequence[Path], reader: options.Options) -> list[Record | Responses]:
    """Read the record files; raises `DesignError` with the errors of all files."""
    found: list[Record | Responses] = []
    findings = list(_repeated(paths))
    for path in dict.fromkeys(paths):
        try:
            found.append(files.read(path, reader))
        except DesignError as error:
            findings += error.findings
    require(findings)
    return found


def identify_records(paths: Sequence[Path], texts: RecordTexts, model: LinearModel | None, highest: float | None = None) -> Identification:
    """Identify the modes of records and print each warning; check the records against the `model` and its `highest` mode [Hz], if known."""
    reader, search, needs = texts.options(), texts.search(), texts.requirements(model, highest)
    with progress_bar() as shown, followed(shown.share):
        seen = identification(usable_measurement(open_records(paths, reader), reader.accept_faults, needs), search)
    for warning in seen.found.data_warnings:
        print_warning(warning)
    return seen


def shapes_on(mechanism: Mechanism, seen: Identification) -> StageShapes:
    """Map measured shapes to motions of the stage; if this is impossible, print the reason."""
    found = stage_shapes(ideal(mechanism), seen.found)
    if found.missing:
        print_note(f"the shapes cannot be mapped to the stage: {found.missing}")
    return found


def _repeated(paths: Sequence[Path]) -> Iterator[Finding]:
    counts = Counter(path.resolve() for path in paths)
    for path in {path.resolve(): path for path in paths}.values():
        if (count := counts[path.resolve()]) > 1:
            yield Finding(str(path), f"it is given {count} times", "Name each record once: a repeated record would count as another test")


def _units(texts: Sequence[str] | None, findings: list[Finding]) -> tuple[tuple[str, str], ...]:
    pairs = list[tuple[str, str]]()
    for text in texts or ():
        listed, _, unit = (part.strip() for part in text.rpartition("="))
        if not listed or not unit:
            findings.append(Finding(f"--units {text}", "channel or unit missing", 'Use e.g. --units "S*=um"'))
        pairs += [(name, unit) for name in names([listed])]
    return tuple(pairs)


def _arrays(texts: Sequence[str] | None, findings: list[Finding]) -> options.Arrays:
    known, stated = [each.name for each in fields(options.Arrays)], dict[str, tuple[str, ...]]()
    for text in texts or ():
        meaning, _, listed = text.partition("=")
        if meaning.strip() not in known or not names([listed]):
            findings.append(
                Finding(f"--array {text}", f"unknown meaning, or array missing (known: {', '.join(known)})", "Use e.g. samples=u,y")
            )
        else:
            stated[meaning.strip()] = stated.get(meaning.strip(), ()) + names([listed])
    return options.Arrays(**stated)


def _word(option: str, word: str, kind: type[_Word], findings: list[Finding]) -> _Word | None:
    known = {str(each.value): each for each in kind}
    if word not in known:
        findings.append(Finding(f"{option} {word}", "unknown word", f"Use {list_choices([*known])}"))
    return known.get(word)


def _hertz(option: str, text: str | None) -> float | None:
    if text is None:
        return None
    value = parse(text, FREQUENCY, where=option)
    if value < 0.0 or (value == 0.0 and option != "--band"):
        raise refuse(option, f"not a frequency above zero (got {text})", 'Use e.g. "2 kHz"')
    return value
