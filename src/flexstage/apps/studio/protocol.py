"""All messages between the studio's page and its server, one class each; `python -m tools.protocol` writes them for TypeScript.

A message is a JSON object whose `kind` is the class's name in small letters. The page sends requests, each with a unique `id`; the
answer contains it as `to`. Every request has an answer (`Done` without a result, `Refusal` if it is refused), in the order of
the requests except for `Drag` and `Pose`. Of these the newest is answered, and older ones are `Done`. Everything else is pushed to all
pages when it changes. Numbers are in SI units, null if unknown.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

VERSION = 6
"""Increased if a message changes its meaning."""

# --- parts of messages ---


@dataclass(frozen=True)
class Problem:
    """A finding: its object or address, problem, advice; line and column from 1 if the text shows them."""

    where: str
    what: str
    advice: str
    line: int | None = None
    column: int | None = None


@dataclass(frozen=True)
class Amount:
    """A number of the stage: `value` in `si`, `text` as in the file, `factor` the value of one `unit` in SI.

    `low` and `high` bound its slider, within the bounds of the number. `formula` is its definition. `old` is its value in the file on
    disk. `group` is its table in the file, and `line` its line, or that of the table.
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


@dataclass(frozen=True)
class Channel:
    """An actuator, an axis of the platform or a gauge: its SI unit, its display unit (`factor` SI each), and its ends if known."""

    name: str
    si: str
    unit: str
    factor: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Figure:
    """A result: its `name` as in requirements, its group, its value in `si`, and the `old` one of the file on disk."""

    name: str
    group: str
    si: str
    unit: str
    factor: float
    value: float | None
    old: float | None


@dataclass(frozen=True)
class Matrix:
    """A matrix with names on both axes, one unit for all or one for each entry."""

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    unit: str | tuple[tuple[str, ...], ...]
    values: tuple[tuple[float | None, ...], ...]


@dataclass(frozen=True)
class Floats:
    """An array of 64-bit floats, little-endian, in base64; the last axis runs fastest."""

    shape: tuple[int, ...]
    data: str


@dataclass(frozen=True)
class ModeShape:
    """A mode: the platform's `twist` (x y z rx ry rz, m and rad) of the mass-normalised shape, `share` of kinetic energy in the platform.

    `kinetic` shares by body and `strain` shares by link, at least one per cent, largest first. `local`: a mode of other bodies.
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


@dataclass(frozen=True)
class SolidMode:
    """A mode of the platform by finite elements, `error` the relative one estimated of its frequency, `motion` its name in a viewer.

    `theory` is the number of the paired mode of theory, absent without one. Further fields are its `theory_frequency` [Hz],
    its relative difference from that of finite elements, and the modal assurance of the two.
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


@dataclass(frozen=True)
class Curve:
    """Frequency response of an output to an input: magnitude in `unit`, phase in degrees, at the listed frequencies."""

    input: str
    output: str
    unit: str
    magnitude: Floats
    phase: Floats


@dataclass(frozen=True)
class Loss:
    """Lost motion of an actuator: its gain (1 is ideal), its loss, and the shares by link, which add up to the loss."""

    actuator: str
    gain: float
    loss: float
    budget: dict[str, float]


@dataclass(frozen=True)
class Judgement:
    """A requirement: its key and text, limit and value in `si`, margin (0.1 is 10 % to spare), or the reason why it is unknown."""

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


@dataclass(frozen=True)
class Stroke:
    """Stroke of the platform along a coordinate, and the actuator or stop that limits it."""

    coordinate: str
    low: float
    high: float
    limiting: str


@dataclass(frozen=True)
class Slope:
    """Sensitivity to a number: change of each figure per unit of the number, and of the worst requirement's margin by one per cent."""

    address: str
    si: str
    value: float
    slopes: dict[str, float | None]
    worst: float | None


@dataclass(frozen=True)
class Clash:
    """Two separate bodies that touch, or a gap between them: the `distance` [m] is negative for an overlap."""

    first: str
    second: str
    distance: float
    text: str


@dataclass(frozen=True)
class Screw:
    """A motion: the platform's twist (unit length), its axis through `point`, pitch [m/rad], null for a pure translation.

    `links` are those that deform in a free motion, or that constrain a locked one: by strain energy, largest share first, if known.
    """

    name: str
    twist: tuple[float, ...]
    point: tuple[float, ...]
    direction: tuple[float, ...]
    pitch: float | None
    links: tuple[str, ...]


@dataclass(frozen=True)
class Snippet:
    """A snippet of the palette: `text` is TOML with `{name}` for a field's text; fields by name with their initial texts."""

    name: str
    group: str
    title: str
    text: str
    fields: dict[str, str]


@dataclass(frozen=True)
class PairRow:
    """A pair of a design job: its goal, or the reason of its failure; `file` is a name for its design, empty without an answer."""

    architecture: str
    actuator: str
    goal: str
    reason: str
    file: str


@dataclass(frozen=True)
class ResultTable:
    """A table of a result as text: its heads are the first row."""

    title: str
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class JobState:
    """A job: its state, fraction done and estimated seconds left, its output, its report's address if any, its key figures.

    A design job has its finished `pairs`, and at its end the `tables` of its command.
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


@dataclass(frozen=True)
class Draft:
    """The unsaved text of an ended studio: its last change [s since 1970], and whether the file was changed since."""

    name: str
    time: float
    stale: bool


@dataclass(frozen=True)
class Fact:
    """A line of a card: its name, and its value as text with units."""

    name: str
    text: str


# --- requests of the page ---


@dataclass(frozen=True)
class Hello:
    """The first message of a page: the token out of its address."""

    token: str
    version: int


@dataclass(frozen=True)
class Edit:
    """The text as typed. Refused if another page changed it after `revision`, the last one that this page knows."""

    id: int
    text: str
    revision: int


@dataclass(frozen=True)
class Set:
    """A number, in any unit of its quantity, as a formula or as a change (`+10 %`)."""

    id: int
    address: str
    text: str


@dataclass(frozen=True)
class Drag:
    """A moving slider: answered by `Frequencies`, the text is unchanged."""

    id: int
    address: str
    value: float


@dataclass(frozen=True)
class Rest:
    """A released slider: the number is written into the text."""

    id: int
    address: str
    value: float


@dataclass(frozen=True)
class Part:
    """The card of a link (`B1/front`)."""

    id: int
    link: str


@dataclass(frozen=True)
class Line:
    """Request for the entries at a line of the text."""

    id: int
    line: int


@dataclass(frozen=True)
class Respond:
    """Choice of the frequency responses; without frequencies, those that show every resonance."""

    id: int
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Jog:
    """The matrices between strokes, platform and gauges."""

    id: int


@dataclass(frozen=True)
class Pose:
    """Request for the exact displacement at those strokes (or forces) of the actuators: readings, stress, and exceeded limits."""

    id: int
    inputs: dict[str, float]


@dataclass(frozen=True)
class Derive:
    """Request for the sensitivities to each number."""

    id: int


@dataclass(frozen=True)
class Travel:
    """Move the stage along a path at large displacements: `drive` from `start` to `end` (texts with units) under `loads`, NAME=VALUE.

    `path` names a path of the design, whose drive, ends, points and loads then apply.
    """

    id: int
    drive: str
    start: str
    end: str
    points: int
    loads: tuple[str, ...]
    path: str


@dataclass(frozen=True)
class Halt:
    """Abort the running path."""

    id: int


@dataclass(frozen=True)
class Free:
    """Request for the platform's free motions, redundant constraints, and locked motions."""

    id: int


@dataclass(frozen=True)
class Gaps:
    """Request for clashes and gaps."""

    id: int


@dataclass(frozen=True)
class Solid:
    """Request for the platform's modes by finite elements, if a verification has stored them in the cache."""

    id: int


@dataclass(frozen=True)
class Pin:
    """Store the present design under a name (A, B, C); with `keep` false, remove it."""

    id: int
    name: str
    keep: bool


@dataclass(frozen=True)
class Compare:
    """Request for the figures of the file, of the pinned designs and of the present one side by side."""

    id: int


@dataclass(frozen=True)
class Recall:
    """Make the text of a pinned design the present one; the empty name is the file's own."""

    id: int
    name: str


@dataclass(frozen=True)
class Undo:
    """Restore the text before the last change."""

    id: int


@dataclass(frozen=True)
class Redo:
    """Restore the text before the last undo."""

    id: int


@dataclass(frozen=True)
class Save:
    """Write the text to its file, or to another `file` of its folder.

    Refused after a change on disk, or if the other file exists, unless `over` allows overwriting.
    """

    id: int
    over: bool
    file: str = ""


@dataclass(frozen=True)
class Browse:
    """Request for the files of the folder, and the shipped cases."""

    id: int


@dataclass(frozen=True)
class Open:
    """Open a file of the folder, written first from a shipped `case` or from the answer for a `pair` of a `job` if named.

    Refused with unsaved changes, unless `discard`.
    """

    id: int
    file: str
    case: str
    discard: bool
    job: int | None
    pair: str


@dataclass(frozen=True)
class Reload:
    """Read the text from disk; the present one remains in undo."""

    id: int


@dataclass(frozen=True)
class Recover:
    """Read the unsaved text of an ended studio in `State.drafts`; without `keep` it is discarded."""

    id: int
    draft: str
    keep: bool


@dataclass(frozen=True)
class Palette:
    """Request for the snippets."""

    id: int


@dataclass(frozen=True)
class Insert:
    """Insert a snippet with its fields filled in."""

    id: int
    snippet: str
    fields: dict[str, str]


@dataclass(frozen=True)
class Look:
    """Panes of a page: only these are computed after a change, the others when they are shown.

    `stage`: the picture; `motions`: its motions; `reach`: strokes and strength.
    """

    id: int
    panes: tuple[Literal["stage", "motions", "reach"], ...]


@dataclass(frozen=True)
class JobForm:
    """Request for the form of a command."""

    id: int
    command: Literal["sweep", "optimise", "verify", "identify", "loop", "design"]


@dataclass(frozen=True)
class Specify:
    """Check a specification: a `text`, with the `values` of its form if there are any, as TOML.

    An empty text is that of a `file` of the folder if named, or else the last one, at first an example.
    """

    id: int
    text: str
    file: str
    values: str


@dataclass(frozen=True)
class SaveSpecification:
    """Write a specification to a file of the folder. Refused if the file exists, unless `over` allows overwriting."""

    id: int
    text: str
    file: str
    over: bool


@dataclass(frozen=True)
class Run:
    """Start a command as a job; `study` is the text of its study, set-up or specification if it needs one, `record` a file's path."""

    id: int
    command: Literal["analyse", "sweep", "optimise", "verify", "identify", "loop", "design"]
    study: str | None
    record: str | None
    options: tuple[str, ...]


@dataclass(frozen=True)
class Cancel:
    """End a job."""

    id: int
    job: int


# --- messages of the server ---


@dataclass(frozen=True)
class Welcome:
    """The page is admitted."""

    version: int
    flexstage: str
    page: int
    pages: int


@dataclass(frozen=True)
class State:
    """The text and its contents; pushed at every change. `digest` belongs to the file on disk.

    `sound`: the design has no error, otherwise `problems` lists the errors. If the text has errors, numbers and figures belong to the
    last text without errors. `changed` counts numbers that differ from the file's, `warnings` are the last reported ones, `page` is the
    one whose request made the change (0: the server), `pins` the pinned designs. `links` belong to the expanded stage, with the line of
    each. `unprotected` is the reason why unsaved changes would be lost with the server, `drafts` list those of earlier servers.
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


@dataclass(frozen=True)
class Engine:
    """Task of the computing process, and its expected duration [s]; `ended` after a crash and restart."""

    state: Literal["starts", "ready", "computes", "ended"]
    text: str
    seconds: float | None


@dataclass(frozen=True)
class Scene:
    """The geometry of a revision for the viewer; without motions if no page shows them."""

    revision: int
    data: Any


@dataclass(frozen=True)
class Frequencies:
    """The platform's frequencies [Hz] for a moving slider. Null: none."""

    to: int
    address: str
    value: float
    frequencies: tuple[float | None, ...]
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class Figures:
    """Results of a revision: missing ones have a reason by name. `frequency` (f,) is the common axis of all curves.

    `loading` describes a significant effect of the permanent load: stiffness, modes and curves are then those of the loaded stage.
    """

    revision: int
    figures: tuple[Figure, ...]
    stiffness: Matrix | None
    compliance: Matrix | None
    losses: tuple[Loss, ...]
    modes: tuple[ModeShape, ...]
    frequency: Floats | None
    curves: tuple[Curve, ...]
    loading: str
    missing: dict[str, str]
    milliseconds: float


@dataclass(frozen=True)
class Verdicts:
    """The requirements of a revision."""

    revision: int
    verdicts: tuple[Judgement, ...]
    milliseconds: float


@dataclass(frozen=True)
class Reach:
    """Strokes, safety and use of actuators and gauges of a revision."""

    revision: int
    figures: tuple[Figure, ...]
    strokes: tuple[Stroke, ...]
    missing: dict[str, str]
    milliseconds: float


@dataclass(frozen=True)
class Warnings:
    """Warnings and default values of a revision; the last message about it."""

    revision: int
    warnings: tuple[Problem, ...]


@dataclass(frozen=True)
class Card:
    """A link: its part, its lines of the text, 6x6 about its centre in its own frame, its stress and lost motion.

    `stress` [Pa] is the peak over all strokes, `limit` the allowable one, `share` its share of every actuator's lost motion. `facts` are
    further properties as text; `problems` are missing comparisons of beam theory with elasticity. `verified` compares with stored finite
    elements.
    """

    to: int
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


@dataclass(frozen=True)
class Place:
    """Entries at a line: links (one or several), and the addresses of the numbers there."""

    to: int
    line: int
    links: tuple[str, ...]
    bodies: tuple[str, ...]
    addresses: tuple[str, ...]


@dataclass(frozen=True)
class Motion:
    """Linear maps of a revision, elastic: `platform` is the platform's twist per unit input, `inputs` its (pseudo-)inverse.

    `gauges` are readings per input, `ideal` the twist without elasticity. `stress` (links x inputs) [Pa per unit input]: the sum of
    magnitudes over all inputs bounds a link's stress from above, with `rest` at no stroke; `allowed` its limit.
    """

    to: int
    revision: int
    platform: Matrix
    inputs: Matrix | None
    ideal: Matrix | None
    gauges: Matrix | None
    stress: Matrix | None
    rest: dict[str, float]
    allowed: dict[str, float | None]
    missing: dict[str, str]


@dataclass(frozen=True)
class Posed:
    """The stage at some strokes: twist, readings, stress of each link, and exceeded limits, as text by the name of their cause."""

    to: int
    twist: tuple[float, ...]
    readings: dict[str, float]
    stress: dict[str, float]
    beyond: dict[str, str]


@dataclass(frozen=True)
class Slopes:
    """Sensitivities, sorted by their effect on the worst requirement, `worst`."""

    to: int
    revision: int
    worst: str
    slopes: tuple[Slope, ...]
    missing: dict[str, str]


@dataclass(frozen=True)
class Underway:
    """Progress of a path from a `request` of a page: the completed fraction, and a text."""

    request: int
    fraction: float
    text: str


@dataclass(frozen=True)
class Travelled:
    """A path of a revision: `motions` are the viewer's, the path itself first, then modes at its last stable point."""

    to: int
    revision: int
    motions: Any
    warnings: tuple[Problem, ...]


@dataclass(frozen=True)
class Freedoms:
    """Free motions, constraints with the redundant ones, free internal modes, and locked motions."""

    to: int
    revision: int
    mobility: int
    free: tuple[Screw, ...]
    redundant: tuple[Fact, ...]
    idle: tuple[Fact, ...]
    locked: tuple[Screw, ...]
    blocked: tuple[Fact, ...]


@dataclass(frozen=True)
class Clearances:
    """Clashes first, then gaps, smallest first; `problems` are violations of aperture and envelope."""

    to: int
    revision: int
    clashes: tuple[Clash, ...]
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class SolidModes:
    """The platform's modes by finite elements; without any, `missing` is the reason."""

    to: int
    revision: int
    modes: tuple[SolidMode, ...]
    missing: str


@dataclass(frozen=True)
class Comparison:
    """Figures of designs: one row for each figure, one column for each design; null for a missing one."""

    to: int
    designs: tuple[str, ...]
    figures: tuple[Figure, ...]
    values: tuple[tuple[float | None, ...], ...]


@dataclass(frozen=True)
class Snippets:
    """The palette."""

    to: int
    snippets: tuple[Snippet, ...]


@dataclass(frozen=True)
class Folder:
    """The files of the folder, those of them that are specifications, and the shipped cases with their summaries."""

    to: int
    files: tuple[str, ...]
    specifications: tuple[str, ...]
    cases: dict[str, str]


@dataclass(frozen=True)
class Blank:
    """The form of a command: the JSON Schema of its study or set-up, or of its options."""

    to: int
    command: str
    schema: Any


@dataclass(frozen=True)
class Specified:
    """A specification: its text and values, null if it cannot be read, and its errors by address."""

    to: int
    text: str
    values: Any
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class Jobs:
    """All jobs; pushed at each progress."""

    jobs: tuple[JobState, ...]


@dataclass(frozen=True)
class Done:
    """A completed request without another answer: the new revision of the text; a new job's number."""

    to: int
    revision: int
    job: int | None = None


@dataclass(frozen=True)
class Refusal:
    """A refused request. `stale`: another page or program changed the text or file first."""

    to: int
    problems: tuple[Problem, ...]
    stale: bool = False


Request: TypeAlias = (
    Hello
    | Edit
    | Set
    | Drag
    | Rest
    | Part
    | Line
    | Respond
    | Jog
    | Pose
    | Derive
    | Travel
    | Halt
    | Free
    | Gaps
    | Solid
    | Pin
    | Compare
    | Recall
    | Undo
    | Redo
    | Save
    | Browse
    | Open
    | Reload
    | Recover
    | Palette
    | Insert
    | Look
    | JobForm
    | Specify
    | SaveSpecification
    | Run
    | Cancel
)
Said: TypeAlias = (
    Welcome
    | State
    | Engine
    | Scene
    | Frequencies
    | Figures
    | Verdicts
    | Reach
    | Warnings
    | Card
    | Place
    | Motion
    | Posed
    | Slopes
    | Underway
    | Travelled
    | Freedoms
    | Clearances
    | SolidModes
    | Comparison
    | Snippets
    | Folder
    | Blank
    | Specified
    | Jobs
    | Done
    | Refusal
)
