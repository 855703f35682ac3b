"""All messages between the studio's page and its server, a class each; `python -m tools.protocol` writes them for TypeScript.

A message is a JSON object whose `kind` is the class's name in small letters. The page asks, each request with an `id` of its own; what
answers it says `to` whom. An answer follows every request (`Done` where there is nothing else to say, `Refusal` where it is refused), in
the order of asking but for `Drag` and `Pose`, of which the newest is answered and older ones are `Done`. Everything else is pushed to all
pages when it changes. Numbers are in SI units, null where unknown.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

VERSION = 4
"""Raised when a message changes its meaning."""

# --- what messages are made of ---


@dataclass(frozen=True)
class Problem:
    """A finding: the object or address it is about, what was found, what to do; line and column from 1 where the text shows them."""

    where: str
    what: str
    advice: str
    line: int | None = None
    column: int | None = None


@dataclass(frozen=True)
class Amount:
    """A number of the stage: `value` in `si`, `text` as the file says it, `factor` what one `unit` is in SI.

    `low` and `high` bound its slider, within what the number may be. `formula` is what it is worked out of. `old` is what the file on
    disk says. `group` is the table it stands in. `line` where it stands, or the table around it.
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
    """An actuator, an axis of the platform or a gauge: its SI unit, the unit it is shown in (`factor` SI each), and its ends if known."""

    name: str
    si: str
    unit: str
    factor: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Figure:
    """A result: its `name` as requirements call it, where it belongs, its value in `si`, and of the file on disk the `old` one."""

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

    `kinetic` shares by body and `strain` shares by link, those from one per cent, largest first. `local`: a mode of other bodies.
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
    """A mode of the platform by finite elements, `error` the relative one estimated of its frequency, `motion` what a viewer plays of it.

    `theory` is the number of the mode of theory that moves most like it, absent where none is alike enough: its `theory_frequency` [Hz],
    what it is over that of finite elements less one, and the modal assurance of the two.
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
    """Frequency response of an output to an input: magnitude in `unit`, phase in degrees, at the frequencies beside it."""

    input: str
    output: str
    unit: str
    magnitude: Floats
    phase: Floats


@dataclass(frozen=True)
class Loss:
    """What an actuator's motion loses: its gain (1 is ideal), its loss, and the shares of it by link, which add up to the loss."""

    actuator: str
    gain: float
    loss: float
    budget: dict[str, float]


@dataclass(frozen=True)
class Judgement:
    """A requirement: its key and words, limit and value in `si`, margin (0.1 is 10 % to spare), or the reason why it is not known."""

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
    """How far the platform goes along a coordinate, and the actuator or stop that ends it."""

    coordinate: str
    low: float
    high: float
    limiting: str


@dataclass(frozen=True)
class Slope:
    """What a number buys: change of each figure per unit of the number, and of the worst requirement's margin by one per cent of it."""

    address: str
    si: str
    value: float
    slopes: dict[str, float | None]
    worst: float | None


@dataclass(frozen=True)
class Clash:
    """Two bodies that are meant to be apart and touch, or a gap between them: the `distance` [m] is negative where they overlap."""

    first: str
    second: str
    distance: float
    text: str


@dataclass(frozen=True)
class Screw:
    """A free motion: the platform's twist (unit length), its axis through `point`, pitch [m/rad], null where it is a pure translation."""

    name: str
    twist: tuple[float, ...]
    point: tuple[float, ...]
    direction: tuple[float, ...]
    pitch: float | None
    links: tuple[str, ...]


@dataclass(frozen=True)
class Snippet:
    """What the palette offers: `text` is TOML with `{name}` where a field's text goes; fields by name with what stands there first."""

    name: str
    group: str
    title: str
    text: str
    fields: dict[str, str]


@dataclass(frozen=True)
class JobState:
    """A job: where it stands, its fraction done and seconds left as far as can be told, what it said, and its report's address if any."""

    job: int
    command: str
    state: Literal["waits", "runs", "done", "failed", "cancelled"]
    text: str
    fraction: float | None
    left: float | None
    said: tuple[str, ...]
    report: str | None


@dataclass(frozen=True)
class Draft:
    """The text that a studio had not saved when it ended: its last change [s since 1970], and whether the file was changed since."""

    name: str
    time: float
    stale: bool


@dataclass(frozen=True)
class Fact:
    """A line of a card: what it is, and what it says in words and units."""

    name: str
    text: str


# --- what the page asks ---


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
    """A slider moves: answered by `Frequencies`, the text stays."""

    id: int
    address: str
    value: float


@dataclass(frozen=True)
class Rest:
    """A slider is let go: the number is written into the text."""

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
    """What stands at a line of the text."""

    id: int
    line: int


@dataclass(frozen=True)
class Respond:
    """Which frequency responses are shown from now on; without frequencies, those that show every resonance."""

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
    """What the stage does at those strokes (or forces) of its actuators, exactly: readings, stress, and what is beyond its limit."""

    id: int
    inputs: dict[str, float]


@dataclass(frozen=True)
class Derive:
    """What each number buys."""

    id: int


@dataclass(frozen=True)
class Travel:
    """Bring the stage along a path at large displacements: `drive` from `start` to `end` (texts with units) under `loads`, NAME=VALUE.

    `path` names one that the design states, whose drive, ends, points and loads then hold.
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
    """Give up the path that is computed."""

    id: int


@dataclass(frozen=True)
class Free:
    """The platform's free motions, redundant constraints, and what locks it."""

    id: int


@dataclass(frozen=True)
class Gaps:
    """Clashes and gaps."""

    id: int


@dataclass(frozen=True)
class Solid:
    """The platform's modes by finite elements, as far as a verification has left them in the cache."""

    id: int


@dataclass(frozen=True)
class Pin:
    """Keep the present design under a name (A, B, C); `keep` false lets it go."""

    id: int
    name: str
    keep: bool


@dataclass(frozen=True)
class Compare:
    """The figures of the file, of the pinned designs and of the present one side by side."""

    id: int


@dataclass(frozen=True)
class Recall:
    """The text of a pinned design becomes the present one; the empty name is the file's own."""

    id: int
    name: str


@dataclass(frozen=True)
class Undo:
    """The text before the last change."""

    id: int


@dataclass(frozen=True)
class Redo:
    """The text before the last undo."""

    id: int


@dataclass(frozen=True)
class Save:
    """Write the text to its file. Refused if that changed on disk since, unless `over` says to write over it."""

    id: int
    over: bool


@dataclass(frozen=True)
class Reload:
    """Take the text that is on disk now; the present one stays in undo."""

    id: int


@dataclass(frozen=True)
class Recover:
    """Take the unsaved text of a studio that ended, which `State.drafts` lists; without `keep` it is discarded."""

    id: int
    draft: str
    keep: bool


@dataclass(frozen=True)
class Palette:
    """What can be inserted."""

    id: int


@dataclass(frozen=True)
class Insert:
    """Insert a snippet with its fields filled in."""

    id: int
    snippet: str
    fields: dict[str, str]


@dataclass(frozen=True)
class Look:
    """What a page shows: only that is computed after a change, the rest when it is looked at.

    `stage`: the picture; `motions`: what plays in it; `reach`: strokes and strength.
    """

    id: int
    panes: tuple[Literal["stage", "motions", "reach"], ...]


@dataclass(frozen=True)
class Run:
    """Start a command beside; `study` is the study's or set-up's text where the command takes one, `record` a file's path."""

    id: int
    command: Literal["analyse", "sweep", "optimise", "verify", "identify", "loop"]
    study: str | None
    record: str | None
    options: tuple[str, ...]


@dataclass(frozen=True)
class Cancel:
    """End a job."""

    id: int
    job: int


# --- what the server says ---


@dataclass(frozen=True)
class Welcome:
    """The page is let in."""

    version: int
    flexstage: str
    page: int
    pages: int


@dataclass(frozen=True)
class State:
    """The text and what it says; pushed at every change. `digest` is that of the file on disk.

    `sound`: the design has no error. If not, `problems` list them; where they are of the text, numbers and figures are those of the last
    text without. `changed` counts numbers that differ from the file's, `warnings` are those told last, `page` is the one whose request made
    the change (0: the server), `pins` the pinned designs. `links` are those of the expanded stage, with the line of each. `unprotected` is
    the reason why unsaved changes would be lost with the server, `drafts` list those of earlier servers.
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
    """What the process that computes is doing, for how long as far as can be told [s]; `ended` where it died and is started anew."""

    state: Literal["starts", "ready", "computes", "ended"]
    text: str
    seconds: float | None


@dataclass(frozen=True)
class Scene:
    """The geometry of a revision for the viewer; without motions where no page looks at them."""

    revision: int
    data: Any


@dataclass(frozen=True)
class Frequencies:
    """The platform's frequencies [Hz] while a slider moves. Null: none there."""

    to: int
    address: str
    value: float
    frequencies: tuple[float | None, ...]
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class Figures:
    """Results of a revision: what is missing has its reason by name. `frequency` (f,) is what all curves stand along.

    `loading` says what the dead load changes where it is felt: stiffness, modes and curves are then those of the loaded stage.
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
    """What is doubtful or taken by default in a revision; the last that is told of it."""

    revision: int
    warnings: tuple[Problem, ...]


@dataclass(frozen=True)
class Card:
    """A link: its part, lines of the text it comes from, 6x6 about its centre in its own frame, what it bears and takes.

    `stress` [Pa] is the peak over all strokes, `limit` what is allowed, `share` its share of every actuator's lost motion. `facts` say the
    rest in words; `problems` where beam theory was not compared with elasticity. `verified` compares with stored finite elements.
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
    """What stands at a line: links (one or several), and the addresses of the numbers there."""

    to: int
    line: int
    links: tuple[str, ...]
    bodies: tuple[str, ...]
    addresses: tuple[str, ...]


@dataclass(frozen=True)
class Motion:
    """Linear maps of a revision, elastic: `platform` is the platform's twist per unit input, `inputs` its inverse as far as there is one.

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
    """The stage at some strokes: twist, readings, stress of each link, and what is beyond its limit, in words by the name of its cause."""

    to: int
    twist: tuple[float, ...]
    readings: dict[str, float]
    stress: dict[str, float]
    beyond: dict[str, str]


@dataclass(frozen=True)
class Slopes:
    """What numbers buy, sorted by what they do for the requirement that is worst, `worst`."""

    to: int
    revision: int
    worst: str
    slopes: tuple[Slope, ...]
    missing: dict[str, str]


@dataclass(frozen=True)
class Underway:
    """How far a path is that a page asked for with `request`: the fraction that is done, and what of it in words."""

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
    """Free motions, constraints of which some are superfluous with what they hold, motions that nothing feels, and what locks it."""

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
    """Clashes first, then gaps, least first; `problems` say what does not fit into opening and envelope."""

    to: int
    revision: int
    clashes: tuple[Clash, ...]
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class SolidModes:
    """The platform's modes by finite elements; without any, `missing` says why."""

    to: int
    revision: int
    modes: tuple[SolidMode, ...]
    missing: str


@dataclass(frozen=True)
class Comparison:
    """Figures of designs: a row a figure, a column a design; null where a design has none."""

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
class Jobs:
    """All jobs; pushed when one of them goes on."""

    jobs: tuple[JobState, ...]


@dataclass(frozen=True)
class Done:
    """A request was done, and nothing else answers it: the text's revision is this one now; a new job's number."""

    to: int
    revision: int
    job: int | None = None


@dataclass(frozen=True)
class Refusal:
    """A request was refused. `stale`: another page or program changed the text or file first."""

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
    | Reload
    | Recover
    | Palette
    | Insert
    | Look
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
    | Jobs
    | Done
    | Refusal
)
