// Written by `python -m tools.protocol` from src/flexstage/apps/studio/protocol.py. Do not edit.

/**
 * All messages between the studio's page and its server, a class each; `python -m tools.protocol` writes them for TypeScript.
 *
 * A message is a JSON object whose `kind` is the class's name in small letters. The page asks, each request with an `id` of its own; what
 * answers it says `to` whom. An answer follows every request (`Done` where there is nothing else to say, `Refusal` where it is refused), in
 * the order of asking but for `Drag` and `Pose`, of which the newest is answered and older ones are `Done`. Everything else is pushed to all
 * pages when it changes. Numbers are in SI units, null where unknown.
 */
export const VERSION = 4;

/** A finding: the object or address it is about, what was found, what to do; line and column from 1 where the text shows them. */
export interface Problem {
  where: string;
  what: string;
  advice: string;
  line: number | null;
  column: number | null;
}

/**
 * A number of the stage: `value` in `si`, `text` as the file says it, `factor` what one `unit` is in SI.
 *
 * `low` and `high` bound its slider, within what the number may be. `formula` is what it is worked out of. `old` is what the file on
 * disk says. `group` is the table it stands in. `line` where it stands, or the table around it.
 */
export interface Amount {
  address: string;
  group: string;
  value: number;
  text: string;
  si: string;
  unit: string;
  factor: number;
  quantity: string;
  low: number;
  high: number;
  old: number | null;
  formula: string | null;
  line: number | null;
  tag: string;
}

/** An actuator, an axis of the platform or a gauge: its SI unit, the unit it is shown in (`factor` SI each), and its ends if known. */
export interface Channel {
  name: string;
  si: string;
  unit: string;
  factor: number;
  low: number | null;
  high: number | null;
}

/** A result: its `name` as requirements call it, where it belongs, its value in `si`, and of the file on disk the `old` one. */
export interface Figure {
  name: string;
  group: string;
  si: string;
  unit: string;
  factor: number;
  value: number | null;
  old: number | null;
}

/** A matrix with names on both axes, one unit for all or one for each entry. */
export interface Matrix {
  rows: string[];
  columns: string[];
  unit: string | string[][];
  values: ((number | null)[])[];
}

/** An array of 64-bit floats, little-endian, in base64; the last axis runs fastest. */
export interface Floats {
  shape: number[];
  data: string;
}

/**
 * A mode: the platform's `twist` (x y z rx ry rz, m and rad) of the mass-normalised shape, `share` of kinetic energy in the platform.
 *
 * `kinetic` shares by body and `strain` shares by link, those from one per cent, largest first. `local`: a mode of other bodies.
 */
export interface ModeShape {
  number: number;
  frequency: number;
  name: string;
  platform: boolean;
  local: boolean;
  share: number;
  twist: number[];
  kinetic: Record<string, number>;
  strain: Record<string, number>;
}

/**
 * A mode of the platform by finite elements, `error` the relative one estimated of its frequency, `motion` what a viewer plays of it.
 *
 * `theory` is the number of the mode of theory that moves most like it, absent where none is alike enough: its `theory_frequency` [Hz],
 * what it is over that of finite elements less one, and the modal assurance of the two.
 */
export interface SolidMode {
  number: number;
  frequency: number;
  error: number | null;
  name: string;
  theory: number | null;
  theory_frequency: number | null;
  difference: number | null;
  assurance: number | null;
  motion: unknown;
}

/** Frequency response of an output to an input: magnitude in `unit`, phase in degrees, at the frequencies beside it. */
export interface Curve {
  input: string;
  output: string;
  unit: string;
  magnitude: Floats;
  phase: Floats;
}

/** What an actuator's motion loses: its gain (1 is ideal), its loss, and the shares of it by link, which add up to the loss. */
export interface Loss {
  actuator: string;
  gain: number;
  loss: number;
  budget: Record<string, number>;
}

/** A requirement: its key and words, limit and value in `si`, margin (0.1 is 10 % to spare), or the reason why it is not known. */
export interface Judgement {
  key: string;
  text: string;
  point: string;
  si: string;
  unit: string;
  factor: number;
  limit: number;
  value: number | null;
  old: number | null;
  margin: number | null;
  passed: boolean;
  reason: string;
  line: number | null;
}

/** How far the platform goes along a coordinate, and the actuator or stop that ends it. */
export interface Stroke {
  coordinate: string;
  low: number;
  high: number;
  limiting: string;
}

/** What a number buys: change of each figure per unit of the number, and of the worst requirement's margin by one per cent of it. */
export interface Slope {
  address: string;
  si: string;
  value: number;
  slopes: Record<string, number | null>;
  worst: number | null;
}

/** Two bodies that are meant to be apart and touch, or a gap between them: the `distance` [m] is negative where they overlap. */
export interface Clash {
  first: string;
  second: string;
  distance: number;
  text: string;
}

/** A free motion: the platform's twist (unit length), its axis through `point`, pitch [m/rad], null where it is a pure translation. */
export interface Screw {
  name: string;
  twist: number[];
  point: number[];
  direction: number[];
  pitch: number | null;
  links: string[];
}

/** What the palette offers: `text` is TOML with `{name}` where a field's text goes; fields by name with what stands there first. */
export interface Snippet {
  name: string;
  group: string;
  title: string;
  text: string;
  fields: Record<string, string>;
}

/** A job: where it stands, its fraction done and seconds left as far as can be told, what it said, and its report's address if any. */
export interface JobState {
  job: number;
  command: string;
  state: "waits" | "runs" | "done" | "failed" | "cancelled";
  text: string;
  fraction: number | null;
  left: number | null;
  said: string[];
  report: string | null;
}

/** The text that a studio had not saved when it ended: its last change [s since 1970], and whether the file was changed since. */
export interface Draft {
  name: string;
  time: number;
  stale: boolean;
}

/** A line of a card: what it is, and what it says in words and units. */
export interface Fact {
  name: string;
  text: string;
}

/** The first message of a page: the token out of its address. */
export interface Hello {
  kind: "hello";
  token: string;
  version: number;
}

/** The text as typed. Refused if another page changed it after `revision`, the last one that this page knows. */
export interface Edit {
  kind: "edit";
  id: number;
  text: string;
  revision: number;
}

/** A number, in any unit of its quantity, as a formula or as a change (`+10 %`). */
export interface Set {
  kind: "set";
  id: number;
  address: string;
  text: string;
}

/** A slider moves: answered by `Frequencies`, the text stays. */
export interface Drag {
  kind: "drag";
  id: number;
  address: string;
  value: number;
}

/** A slider is let go: the number is written into the text. */
export interface Rest {
  kind: "rest";
  id: number;
  address: string;
  value: number;
}

/** The card of a link (`B1/front`). */
export interface Part {
  kind: "part";
  id: number;
  link: string;
}

/** What stands at a line of the text. */
export interface Line {
  kind: "line";
  id: number;
  line: number;
}

/** Which frequency responses are shown from now on; without frequencies, those that show every resonance. */
export interface Respond {
  kind: "respond";
  id: number;
  inputs: string[];
  outputs: string[];
  low: number | null;
  high: number | null;
}

/** The matrices between strokes, platform and gauges. */
export interface Jog {
  kind: "jog";
  id: number;
}

/** What the stage does at those strokes (or forces) of its actuators, exactly: readings, stress, and what is beyond its limit. */
export interface Pose {
  kind: "pose";
  id: number;
  inputs: Record<string, number>;
}

/** What each number buys. */
export interface Derive {
  kind: "derive";
  id: number;
}

/**
 * Bring the stage along a path at large displacements: `drive` from `start` to `end` (texts with units) under `loads`, NAME=VALUE.
 *
 * `path` names one that the design states, whose drive, ends, points and loads then hold.
 */
export interface Travel {
  kind: "travel";
  id: number;
  drive: string;
  start: string;
  end: string;
  points: number;
  loads: string[];
  path: string;
}

/** Give up the path that is computed. */
export interface Halt {
  kind: "halt";
  id: number;
}

/** The platform's free motions, redundant constraints, and what locks it. */
export interface Free {
  kind: "free";
  id: number;
}

/** Clashes and gaps. */
export interface Gaps {
  kind: "gaps";
  id: number;
}

/** The platform's modes by finite elements, as far as a verification has left them in the cache. */
export interface Solid {
  kind: "solid";
  id: number;
}

/** Keep the present design under a name (A, B, C); `keep` false lets it go. */
export interface Pin {
  kind: "pin";
  id: number;
  name: string;
  keep: boolean;
}

/** The figures of the file, of the pinned designs and of the present one side by side. */
export interface Compare {
  kind: "compare";
  id: number;
}

/** The text of a pinned design becomes the present one; the empty name is the file's own. */
export interface Recall {
  kind: "recall";
  id: number;
  name: string;
}

/** The text before the last change. */
export interface Undo {
  kind: "undo";
  id: number;
}

/** The text before the last undo. */
export interface Redo {
  kind: "redo";
  id: number;
}

/** Write the text to its file. Refused if that changed on disk since, unless `over` says to write over it. */
export interface Save {
  kind: "save";
  id: number;
  over: boolean;
}

/** Take the text that is on disk now; the present one stays in undo. */
export interface Reload {
  kind: "reload";
  id: number;
}

/** Take the unsaved text of a studio that ended, which `State.drafts` lists; without `keep` it is discarded. */
export interface Recover {
  kind: "recover";
  id: number;
  draft: string;
  keep: boolean;
}

/** What can be inserted. */
export interface Palette {
  kind: "palette";
  id: number;
}

/** Insert a snippet with its fields filled in. */
export interface Insert {
  kind: "insert";
  id: number;
  snippet: string;
  fields: Record<string, string>;
}

/**
 * What a page shows: only that is computed after a change, the rest when it is looked at.
 *
 * `stage`: the picture; `motions`: what plays in it; `reach`: strokes and strength.
 */
export interface Look {
  kind: "look";
  id: number;
  panes: ("stage" | "motions" | "reach")[];
}

/** Start a command beside; `study` is the study's or set-up's text where the command takes one, `record` a file's path. */
export interface Run {
  kind: "run";
  id: number;
  command: "analyse" | "sweep" | "optimise" | "verify" | "identify" | "loop";
  study: string | null;
  record: string | null;
  options: string[];
}

/** End a job. */
export interface Cancel {
  kind: "cancel";
  id: number;
  job: number;
}

/** The page is let in. */
export interface Welcome {
  kind: "welcome";
  version: number;
  flexstage: string;
  page: number;
  pages: number;
}

/**
 * The text and what it says; pushed at every change. `digest` is that of the file on disk.
 *
 * `sound`: the design has no error. If not, `problems` list them; where they are of the text, numbers and figures are those of the last
 * text without. `changed` counts numbers that differ from the file's, `warnings` are those told last, `page` is the one whose request made
 * the change (0: the server), `pins` the pinned designs. `links` are those of the expanded stage, with the line of each. `unprotected` is
 * the reason why unsaved changes would be lost with the server, `drafts` list those of earlier servers.
 */
export interface State {
  kind: "state";
  revision: number;
  page: number;
  file: string;
  name: string;
  text: string;
  digest: string;
  saved: boolean;
  sound: boolean;
  changed: number;
  undo: boolean;
  redo: boolean;
  problems: Problem[];
  warnings: Problem[];
  amounts: Amount[];
  actuators: Channel[];
  axes: Channel[];
  gauges: Channel[];
  inputs: string[];
  outputs: string[];
  links: Record<string, number | null>;
  paths: string[];
  pins: string[];
  unprotected: string;
  drafts: Draft[];
}

/** What the process that computes is doing, for how long as far as can be told [s]; `ended` where it died and is started anew. */
export interface Engine {
  kind: "engine";
  state: "starts" | "ready" | "computes" | "ended";
  text: string;
  seconds: number | null;
}

/** The geometry of a revision for the viewer; without motions where no page looks at them. */
export interface Scene {
  kind: "scene";
  revision: number;
  data: unknown;
}

/** The platform's frequencies [Hz] while a slider moves. Null: none there. */
export interface Frequencies {
  kind: "frequencies";
  to: number;
  address: string;
  value: number;
  frequencies: (number | null)[];
  problems: Problem[];
}

/**
 * Results of a revision: what is missing has its reason by name. `frequency` (f,) is what all curves stand along.
 *
 * `loading` says what the dead load changes where it is felt: stiffness, modes and curves are then those of the loaded stage.
 */
export interface Figures {
  kind: "figures";
  revision: number;
  figures: Figure[];
  stiffness: Matrix | null;
  compliance: Matrix | null;
  losses: Loss[];
  modes: ModeShape[];
  frequency: Floats | null;
  curves: Curve[];
  loading: string;
  missing: Record<string, string>;
  milliseconds: number;
}

/** The requirements of a revision. */
export interface Verdicts {
  kind: "verdicts";
  revision: number;
  verdicts: Judgement[];
  milliseconds: number;
}

/** Strokes, safety and use of actuators and gauges of a revision. */
export interface Reach {
  kind: "reach";
  revision: number;
  figures: Figure[];
  strokes: Stroke[];
  missing: Record<string, string>;
  milliseconds: number;
}

/** What is doubtful or taken by default in a revision; the last that is told of it. */
export interface Warnings {
  kind: "warnings";
  revision: number;
  warnings: Problem[];
}

/**
 * A link: its part, lines of the text it comes from, 6x6 about its centre in its own frame, what it bears and takes.
 *
 * `stress` [Pa] is the peak over all strokes, `limit` what is allowed, `share` its share of every actuator's lost motion. `facts` say the
 * rest in words; `problems` where beam theory was not compared with elasticity. `verified` compares with stored finite elements.
 */
export interface Card {
  kind: "card";
  to: number;
  link: string;
  part: string;
  part_kind: string;
  bodies: string[];
  lines: number[];
  addresses: string[];
  free: string[];
  compliance: Matrix | null;
  stiffness: Matrix | null;
  stress: number | null;
  limit: number | null;
  safety: number | null;
  shares: Record<string, number>;
  facts: Fact[];
  verified: Fact[];
  problems: Problem[];
  missing: Record<string, string>;
}

/** What stands at a line: links (one or several), and the addresses of the numbers there. */
export interface Place {
  kind: "place";
  to: number;
  line: number;
  links: string[];
  bodies: string[];
  addresses: string[];
}

/**
 * Linear maps of a revision, elastic: `platform` is the platform's twist per unit input, `inputs` its inverse as far as there is one.
 *
 * `gauges` are readings per input, `ideal` the twist without elasticity. `stress` (links x inputs) [Pa per unit input]: the sum of
 * magnitudes over all inputs bounds a link's stress from above, with `rest` at no stroke; `allowed` its limit.
 */
export interface Motion {
  kind: "motion";
  to: number;
  revision: number;
  platform: Matrix;
  inputs: Matrix | null;
  ideal: Matrix | null;
  gauges: Matrix | null;
  stress: Matrix | null;
  rest: Record<string, number>;
  allowed: Record<string, number | null>;
  missing: Record<string, string>;
}

/** The stage at some strokes: twist, readings, stress of each link, and what is beyond its limit, in words by the name of its cause. */
export interface Posed {
  kind: "posed";
  to: number;
  twist: number[];
  readings: Record<string, number>;
  stress: Record<string, number>;
  beyond: Record<string, string>;
}

/** What numbers buy, sorted by what they do for the requirement that is worst, `worst`. */
export interface Slopes {
  kind: "slopes";
  to: number;
  revision: number;
  worst: string;
  slopes: Slope[];
  missing: Record<string, string>;
}

/** How far a path is that a page asked for with `request`: the fraction that is done, and what of it in words. */
export interface Underway {
  kind: "underway";
  request: number;
  fraction: number;
  text: string;
}

/** A path of a revision: `motions` are the viewer's, the path itself first, then modes at its last stable point. */
export interface Travelled {
  kind: "travelled";
  to: number;
  revision: number;
  motions: unknown;
  warnings: Problem[];
}

/** Free motions, constraints of which some are superfluous with what they hold, motions that nothing feels, and what locks it. */
export interface Freedoms {
  kind: "freedoms";
  to: number;
  revision: number;
  mobility: number;
  free: Screw[];
  redundant: Fact[];
  idle: Fact[];
  locked: Screw[];
  blocked: Fact[];
}

/** Clashes first, then gaps, least first; `problems` say what does not fit into opening and envelope. */
export interface Clearances {
  kind: "clearances";
  to: number;
  revision: number;
  clashes: Clash[];
  problems: Problem[];
}

/** The platform's modes by finite elements; without any, `missing` says why. */
export interface SolidModes {
  kind: "solidmodes";
  to: number;
  revision: number;
  modes: SolidMode[];
  missing: string;
}

/** Figures of designs: a row a figure, a column a design; null where a design has none. */
export interface Comparison {
  kind: "comparison";
  to: number;
  designs: string[];
  figures: Figure[];
  values: ((number | null)[])[];
}

/** The palette. */
export interface Snippets {
  kind: "snippets";
  to: number;
  snippets: Snippet[];
}

/** All jobs; pushed when one of them goes on. */
export interface Jobs {
  kind: "jobs";
  jobs: JobState[];
}

/** A request was done, and nothing else answers it: the text's revision is this one now; a new job's number. */
export interface Done {
  kind: "done";
  to: number;
  revision: number;
  job: number | null;
}

/** A request was refused. `stale`: another page or program changed the text or file first. */
export interface Refusal {
  kind: "refusal";
  to: number;
  problems: Problem[];
  stale: boolean;
}

export type Request =
  | Hello
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
  | Cancel;

export type Said =
  | Welcome
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
  | Refusal;
