"""All messages between the studio's page and its server, one class each; `python -m tools.protocol` writes them for TypeScript.

A message is a JSON object whose `kind` is the class's name in small letters. The page sends requests, each with a unique `id`; the answer
contains this `id` as `to`. Every request is answered: by `Done` if it has no result, and by `Refusal` if it is refused. Answers have the
sequence of the requests. Exceptions are `Drag` and `Pose`: only the newest request gets a result, and older requests get `Done`. All other
messages are pushed to all pages when their contents change. Numbers are in SI units, null if unknown.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, dataclass_transform

VERSION = 6
"""Version of the protocol, which is increased if a message changes its meaning."""


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
class MessagePart:
    """Base class of messages and their parts: every subclass is a frozen dataclass."""

    def __init_subclass__(cls) -> None:
        dataclass(frozen=True)(cls)


# --- parts of messages ---


class Problem(MessagePart):
    """A finding: its object or address, the problem and the advice; line and column count from 1, null if unknown."""

    where: str
    what: str
    advice: str
    line: int | None = None
    column: int | None = None


class Amount(MessagePart):
    """A number of the stage: its `value` in the SI unit `si`, and its `text` as in the file. One display `unit` is `factor` SI units.

    `low` and `high` are the ends of the slider, within the bounds of the number. `formula` defines the number. `old` is the value in the
    file on disk. `group` is the table that contains the number; `line` is the line of the number, or of this table.
    """

    address: str
    group: str
    value: float
    text: str
    si: str
    unit: str
    factor: float
    quantity: str
    low: float
    high: float
    old: float | None
    formula: str | None
    line: int | None
    tag: str


class Channel(MessagePart):
    """An actuator, an axis of the platform or a gauge, with the ends of its range if known. One display `unit` is `factor` units `si`."""

    name: str
    si: str
    unit: str
    factor: float
    low: float | None
    high: float | None


class Figure(MessagePart):
    """A result: its `name` as in requirements, its group, its value in `si`, and the `old` value of the file on disk."""

    name: str
    group: str
    si: str
    unit: str
    factor: float
    value: float | None
    old: float | None


class Matrix(MessagePart):
    """A matrix with names of rows and columns. `unit` is a single unit for all entries, or a unit for each entry."""

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    unit: str | tuple[tuple[str, ...], ...]
    values: tuple[tuple[float | None, ...], ...]


class Floats(MessagePart):
    """An array of 64-bit floats, little-endian, in base64; the last axis runs fastest."""

    shape: tuple[int, ...]
    data: str


class ModeShape(MessagePart):
    """A mode: the platform's `twist` (x y z rx ry rz, m and rad) in the mass-normalised shape, and its `share` of the kinetic energy.

    `kinetic` contains the fractions of kinetic energy in bodies, `strain` contains the fractions of strain energy in links. The largest
    fractions are first; fractions below one per cent are left out. A `local` mode moves mainly bodies other than the platform.
    """

    number: int
    frequency: float
    name: str
    platform: bool
    local: bool
    share: float
    twist: tuple[float, ...]
    kinetic: dict[str, float]
    strain: dict[str, float]


class SolidMode(MessagePart):
    """A platform mode by finite elements: `error` is the estimated relative error of its frequency, `motion` contains data for a viewer.

    `theory` is the number of the paired mode of the lumped model; null without a pair. `theory_frequency` [Hz] is the frequency of the
    lumped mode, `difference` is the relative difference of this frequency from finite elements, and `assurance` is the modal assurance
    criterion of the pair.
    """

    number: int
    frequency: float
    error: float | None
    name: str
    theory: int | None
    theory_frequency: float | None
    difference: float | None
    assurance: float | None
    motion: Any


class Curve(MessagePart):
    """Frequency response of an output to an input: magnitude in `unit`, phase in degrees, at the listed frequencies."""

    input: str
    output: str
    unit: str
    magnitude: Floats
    phase: Floats


class Loss(MessagePart):
    """Lost motion of an actuator: its transmission ratio `gain` (1 is ideal), its `loss`, and the contribution of each link to the loss."""

    actuator: str
    gain: float
    loss: float
    budget: dict[str, float]


class Judgement(MessagePart):
    """A requirement: its key and text, its limit and value in `si`, its margin (0.1 is 10 %), and the `reason` if the value is unknown."""

    key: str
    text: str
    point: str
    si: str
    unit: str
    factor: float
    limit: float
    value: float | None
    old: float | None
    margin: float | None
    passed: bool
    reason: str
    line: int | None


class Stroke(MessagePart):
    """Stroke of the platform along a coordinate, and the actuator or stop that limits it."""

    coordinate: str
    low: float
    high: float
    limiting: str


class Slope(MessagePart):
    """Sensitivity to a number: derivatives of figures, and the change of the lowest margin (`worst`) if the number increases by 1 %."""

    address: str
    si: str
    value: float
    slopes: dict[str, float | None]
    worst: float | None


class Clash(MessagePart):
    """Two separate bodies, and the `distance` [m] between them, which is negative for an overlap."""

    first: str
    second: str
    distance: float
    text: str


class Screw(MessagePart):
    """A motion of the platform as a screw: its twist, and its axis in a unit `direction` through `point`.

    `pitch` [m/rad] is null for a pure translation. `links` of a free motion are the links that deform. `links` of a locked motion are the
    links that constrain it, in descending order of strain energy.
    """

    name: str
    twist: tuple[float, ...]
    point: tuple[float, ...]
    direction: tuple[float, ...]
    pitch: float | None
    links: tuple[str, ...]


class Snippet(MessagePart):
    """A snippet of the palette: `text` is TOML with `{name}` in place of each field; `fields` contains their initial values by name."""

    name: str
    group: str
    title: str
    text: str
    fields: dict[str, str]


class PairRow(MessagePart):
    """A pair of architecture and actuator in a design job: its `goal` or the `reason` for its failure, and its `file` name (or empty)."""

    architecture: str
    actuator: str
    goal: str
    reason: str
    file: str


class ResultTable(MessagePart):
    """A table of a result as text: the first row contains the column heads."""

    title: str
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...]


class JobState(MessagePart):
    """A job: its state, the completed `fraction`, the estimated time `left` [s], the last output lines `said`, and its results.

    `report` is the address of its report, null without a report. A job of the command `design` also has the finished `pairs` and, when it
    has ended, the `tables` of the command.
    """

    job: int
    command: str
    state: Literal["waits", "runs", "done", "failed", "cancelled"]
    text: str
    fraction: float | None
    left: float | None
    said: tuple[str, ...]
    report: str | None
    figures: tuple[Figure, ...] = ()
    pairs: tuple[PairRow, ...] = ()
    tables: tuple[ResultTable, ...] = ()


class Draft(MessagePart):
    """The unsaved text of an ended studio: the `time` of its last change [s since 1970]. If `stale`, the file changed after this time."""

    name: str
    time: float
    stale: bool


class Fact(MessagePart):
    """A line of a card: its name, and its value as text with the unit."""

    name: str
    text: str


# --- requests of the page ---


class Request(MessagePart):
    """A message of the page."""


class NumberedRequest(Request):
    """A request with its number."""

    id: int


class Hello(Request):
    """The first message of a page, with the token from its address."""

    token: str
    version: int


class Edit(NumberedRequest):
    """The text as typed. Refused if another page changed the text after `revision`, the last revision that this page knows."""

    text: str
    revision: int


class Set(NumberedRequest):
    """Set a number: a value in any unit of its quantity, a formula, or a relative change (`+10 %`)."""

    address: str
    text: str


class Drag(NumberedRequest):
    """Report the value of a moving slider. The answer is `Frequencies`; the text does not change."""

    address: str
    value: float


class Rest(NumberedRequest):
    """Report the value of a released slider, which is written into the text."""

    address: str
    value: float


class Part(NumberedRequest):
    """Request for the card of a link (`B1/front`)."""

    link: str


class Line(NumberedRequest):
    """Request for the entries at a line of the text."""

    line: int


class Respond(NumberedRequest):
    """Choose the frequency responses. Without a band, the frequencies are chosen so that every resonance is visible."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    low: float | None
    high: float | None


class Jog(NumberedRequest):
    """Request for the linear maps between strokes, platform motion and gauge readings."""


class Pose(NumberedRequest):
    """Request for the displacement at given strokes or forces of the actuators, with readings, stress, and exceeded limits."""

    inputs: dict[str, float]


class Derive(NumberedRequest):
    """Request for the sensitivities to each number."""


class Travel(NumberedRequest):
    """Move the stage along a load path at large displacements: `drive` from `start` to `end` (with units) under `loads` (NAME=VALUE).

    If `path` names a load path of the design, its drive, ends, points and loads are used instead.
    """

    drive: str
    start: str
    end: str
    points: int
    loads: tuple[str, ...]
    path: str


class Halt(NumberedRequest):
    """Abort the computation of the load path."""


class Free(NumberedRequest):
    """Request for the platform's free motions, redundant constraints, and locked motions."""


class Gaps(NumberedRequest):
    """Request for overlaps and gaps between bodies."""


class Solid(NumberedRequest):
    """Request for the platform's modes by finite elements, if a verification has stored them in the cache."""


class Pin(NumberedRequest):
    """Store the present design under a name (A, B, C). If `keep` is false, remove the design pinned under this name."""

    name: str
    keep: bool


class Compare(NumberedRequest):
    """Request for a comparison of the results of the file, the pinned designs and the present design."""


class Recall(NumberedRequest):
    """Make the text of a pinned design the present text. The empty name selects the text of the file."""

    name: str


class Undo(NumberedRequest):
    """Restore the text before the last change."""


class Redo(NumberedRequest):
    """Restore the text before the last undo."""


class Save(NumberedRequest):
    """Write the text to its file, or to another `file` of its folder.

    The request is refused if the file has changed on disk, or if the other file exists, unless `over` allows overwriting.
    """

    over: bool
    file: str = ""


class Browse(NumberedRequest):
    """Request for the files of the folder, and the shipped cases."""


class Open(NumberedRequest):
    """Open a file of the folder. If a shipped `case`, or a `pair` of a design `job`, is named, its design is first written to the file.

    Refused if there are unsaved changes, unless `discard` is true.
    """

    file: str
    case: str
    discard: bool
    job: int | None
    pair: str


class Reload(NumberedRequest):
    """Read the text from disk. The present text remains in undo."""


class Recover(NumberedRequest):
    """Restore an unsaved text of an ended studio from `State.drafts`. If `keep` is false, discard the text."""

    draft: str
    keep: bool


class Palette(NumberedRequest):
    """Request for the snippets."""


class Insert(NumberedRequest):
    """Insert a snippet with its fields filled in."""

    snippet: str
    fields: dict[str, str]


class Look(NumberedRequest):
    """Report the panes that a page shows. After a change, only shown panes are computed. Other panes are computed when they are shown.

    The pane `stage` is the picture, `motions` contains its motions, and `reach` contains strokes and strength.
    """

    panes: tuple[Literal["stage", "motions", "reach"], ...]


class JobForm(NumberedRequest):
    """Request for the form of a command."""

    command: Literal["sweep", "optimise", "verify", "identify", "loop", "design"]


class Specify(NumberedRequest):
    """Check the `text` of a specification, in which `values` (TOML) from the form replace values.

    An empty text is replaced by the text of `file` in the folder. Without a file, the last text is used (initially an example).
    """

    text: str
    file: str
    values: str


class SaveSpecification(NumberedRequest):
    """Write a specification to a file of the folder. Refused if the file exists, unless `over` allows overwriting."""

    text: str
    file: str
    over: bool


class Run(NumberedRequest):
    """Start a command as a job. `study` is a study, set-up or specification as text; `record` is the path of a record file."""

    command: Literal["analyse", "sweep", "optimise", "verify", "identify", "loop", "design"]
    study: str | None
    record: str | None
    options: tuple[str, ...]


class Cancel(NumberedRequest):
    """End a job."""

    job: int


# --- messages of the server ---


class Said(MessagePart):
    """A message of the server."""


class StudioAnswer(Said):
    """The answer to the request with the number `to`, which the session sets."""

    to: int = field(default=0, kw_only=True)


class DesignMessage(Said):
    """A result for a revision, which the session sets."""

    revision: int = field(default=0, kw_only=True)


class DesignAnswer(StudioAnswer):
    """The answer for a revision, which the session sets."""

    revision: int = field(default=0, kw_only=True)


class Welcome(Said):
    """The page was admitted."""

    version: int
    flexstage: str
    page: int
    pages: int


class State(Said):
    """The text and its contents, sent to all pages after every change. `digest` is the digest of the file on disk.

    If `sound`, the design has no error; otherwise, `problems` lists the errors, and all numbers are from the last text without errors.
    `changed` is the number of values that differ from the file. `page` made the change (0: the server). `pins` are the names of the pinned
    designs. `links` contains the line of each link of the expanded stage. `unprotected` is the reason why unsaved changes would be lost if
    the server ended. `drafts` lists unsaved changes of earlier servers.
    """

    revision: int
    page: int
    file: str
    name: str
    text: str
    digest: str
    saved: bool
    sound: bool
    changed: int
    undo: bool
    redo: bool
    problems: tuple[Problem, ...]
    warnings: tuple[Problem, ...]
    amounts: tuple[Amount, ...]
    actuators: tuple[Channel, ...]
    axes: tuple[Channel, ...]
    gauges: tuple[Channel, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    links: dict[str, int | None]
    paths: tuple[str, ...]
    pins: tuple[str, ...]
    unprotected: str
    drafts: tuple[Draft, ...]


class Engine(Said):
    """State of the computing process, its task `text`, and the expected duration [s]. If `ended`, the process crashed and was restarted."""

    state: Literal["starts", "ready", "computes", "ended"]
    text: str = ""
    seconds: float | None = None


class Scene(DesignMessage):
    """The geometry of a revision for the viewer. The motions are left out if no page shows them."""

    data: Any


class Frequencies(StudioAnswer):
    """The platform frequencies [Hz] for a moving slider, null where unknown."""

    address: str
    value: float
    frequencies: tuple[float | None, ...]
    problems: tuple[Problem, ...]


class Figures(DesignMessage):
    """Results of a revision. `missing` contains the reason for each missing result. `frequency` (f,) is the frequency axis of all curves.

    `loading` describes the effect of a significant permanent load; stiffness, modes and curves then belong to the loaded stage.
    """

    figures: tuple[Figure, ...]
    stiffness: Matrix | None
    compliance: Matrix | None
    losses: tuple[Loss, ...]
    modes: tuple[ModeShape, ...]
    frequency: Floats | None
    curves: tuple[Curve, ...]
    loading: str
    missing: dict[str, str]
    milliseconds: float = 0.0


class Verdicts(DesignMessage):
    """The requirements of a revision."""

    verdicts: tuple[Judgement, ...]
    milliseconds: float = 0.0


class Reach(DesignMessage):
    """Platform strokes of a revision, and safety factors of its flexures against stress and buckling."""

    figures: tuple[Figure, ...]
    strokes: tuple[Stroke, ...]
    missing: dict[str, str]
    milliseconds: float = 0.0


class Warnings(DesignMessage):
    """Warnings and default values of a revision. The server sends this message last for each revision."""

    warnings: tuple[Problem, ...]


class Card(StudioAnswer):
    """A link: its part, its lines in the text, its 6x6 matrices about the part's centre in the link frame, its stress and lost motion.

    `stress` [Pa] is the peak over all strokes, `limit` is the allowable stress. `shares` contains the link's contribution to the lost
    motion of each actuator. `facts` are further properties as text. `problems` are warnings about the part, such as dimensions outside the
    validated range of beam theory. `verified` compares the link with stored results of finite elements.
    """

    link: str
    part: str
    part_kind: str
    bodies: tuple[str, ...]
    lines: tuple[int, ...]
    addresses: tuple[str, ...]
    free: tuple[str, ...]
    compliance: Matrix | None
    stiffness: Matrix | None
    stress: float | None
    limit: float | None
    safety: float | None
    shares: dict[str, float]
    facts: tuple[Fact, ...]
    verified: tuple[Fact, ...]
    problems: tuple[Problem, ...]
    missing: dict[str, str]


class Place(StudioAnswer):
    """Entries at a line: its links and bodies, and the addresses of its numbers."""

    line: int
    links: tuple[str, ...]
    bodies: tuple[str, ...]
    addresses: tuple[str, ...]


class Motion(DesignAnswer):
    """Linear maps of the elastic stage: `platform` is the platform twist per unit input, `inputs` are the actuator inputs per unit twist.

    `gauges` contains the readings per unit input; `ideal` is the platform twist per unit input of the ideal stage. `stress` (links x
    inputs) is in Pa per unit input; `rest` is the stress without strokes. The stress of a link is at most `rest` plus the sum of the
    magnitudes over all inputs. `allowed` contains the allowable stresses.
    """

    platform: Matrix
    inputs: Matrix | None
    ideal: Matrix | None
    gauges: Matrix | None
    stress: Matrix | None
    rest: dict[str, float]
    allowed: dict[str, float | None]
    missing: dict[str, str]


class Posed(StudioAnswer):
    """The stage at given strokes: platform twist, readings, and stress of each link. `beyond` names and describes exceeded limits."""

    twist: tuple[float, ...]
    readings: dict[str, float]
    stress: dict[str, float]
    beyond: dict[str, str]


class Slopes(DesignAnswer):
    """Sensitivities, sorted by their effect on `worst`, the requirement with the lowest margin."""

    worst: str
    slopes: tuple[Slope, ...]
    missing: dict[str, str]


class Underway(Said):
    """Progress of the load path of a page's `request`: the completed fraction, and a text."""

    request: int
    fraction: float
    text: str


class Travelled(DesignAnswer):
    """A load path of a revision. `motions` for the viewer are the path itself, then the modes at its last stable point."""

    motions: Any
    warnings: tuple[Problem, ...]


class Freedoms(DesignAnswer):
    """Free motions, redundant constraints, free internal modes, locked motions, and locked strokes (`blocked`)."""

    mobility: int
    free: tuple[Screw, ...]
    redundant: tuple[Fact, ...]
    idle: tuple[Fact, ...]
    locked: tuple[Screw, ...]
    blocked: tuple[Fact, ...]


class Clearances(DesignAnswer):
    """Overlaps and gaps between bodies, the largest overlap first. `problems` are violations of aperture and envelope."""

    clashes: tuple[Clash, ...]
    problems: tuple[Problem, ...]


class SolidModes(DesignAnswer):
    """Platform modes by finite elements. Without modes, `missing` is the reason."""

    modes: tuple[SolidMode, ...]
    missing: str


class Comparison(StudioAnswer):
    """Figures of designs: one row for each figure, one column for each design, null for a missing figure."""

    designs: tuple[str, ...]
    figures: tuple[Figure, ...]
    values: tuple[tuple[float | None, ...], ...]


class Snippets(StudioAnswer):
    """The palette."""

    snippets: tuple[Snippet, ...]


class Folder(StudioAnswer):
    """The design files and specifications of the folder, and the shipped cases with their summaries."""

    files: tuple[str, ...]
    specifications: tuple[str, ...]
    cases: dict[str, str]


class Blank(StudioAnswer):
    """The form of a command, as the JSON Schema of its study, set-up or options."""

    command: str
    schema: Any


class Specified(StudioAnswer):
    """A specification: its text, its values (null if the text cannot be read), and its errors by address."""

    text: str
    values: Any
    problems: tuple[Problem, ...]


class Jobs(Said):
    """All jobs, pushed after each progress report."""

    jobs: tuple[JobState, ...]


class Done(StudioAnswer):
    """A completed request without a result: the revision of the text, and the number of a new job."""

    revision: int
    job: int | None = None


class Refusal(StudioAnswer):
    """A refused request. If `stale`, another page or program has changed the text or the file."""

    problems: tuple[Problem, ...]
    stale: bool = False
