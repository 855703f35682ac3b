// Written by `python -m tools.protocol` from src/flexstage/apps/studio/protocol.py. Do not edit.

/**
 * All messages between the studio's page and its server, one class each; `python -m tools.protocol` writes them for TypeScript.
 *
 * A message is a JSON object whose `kind` is the class's name in small letters. The page sends requests, each with a unique `id`; the
 * answer contains it as `to`. Every request has an answer (`Done` without a result, `Refusal` if it is refused), in the order of
 * the requests except for `Drag` and `Pose`. Of these the newest is answered, and older ones are `Done`. Everything else is pushed to all
 * pages when it changes. Numbers are in SI units, null if unknown.
 */
export const VERSION = 6;

/** A finding: its object or address, problem, advice; line and column from 1 if the text shows them. */
export interface Problem {
  where: string;
  what: string;
  advice: string;
  line: number | null;
  column: number | null;
}

/**
 * A number of the stage: `value` in `si`, `text` as in the file, `factor` the value of one `unit` in SI.
 *
 * `low` and `high` bound its slider, within the bounds of the number. `formula` is its definition. `old` is its value in the file on
 * disk. `group` is its table in the file, and `line` its line, or that of the table.
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

/** An actuator, an axis of the platform or a gauge: its SI unit, its display unit (`factor` SI each), and its ends if known. */
export interface Channel {
  name: string;
  si: string;
  unit: string;
  factor: number;
  low: number | null;
  high: number | null;
}

/** A result: its `name` as in requirements, its group, its value in `si`, and the `old` one of the file on disk. */
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
 * `kinetic` shares by body and `strain` shares by link, at least one per cent, largest first. `local`: a mode of other bodies.
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
 * A mode of the platform by finite elements, `error` the relative one estimated of its frequency, `motion` its name in a viewer.
 *
 * `theory` is the number of the paired mode of theory, absent without one. Further fields are its `theory_frequency` [Hz],
 * its relative difference from that of finite elements, and the modal assurance of the two.
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

/** Frequency response of an output to an input: magnitude in `unit`, phase in degrees, at the listed frequencies. */
export interface Curve {
  input: string;
  output: string;
  unit: string;
  magnitude: Floats;
  phase: Floats;
}

/** Lost motion of an actuator: its gain (1 is ideal), its loss, and the shares by link, which add up to the loss. */
export interface Loss {
  actuator: string;
  gain: number;
  loss: number;
  budget: Record<string, number>;
}

/** A requirement: its key and text, limit and value in `si`, margin (0.1 is 10 % to spare), or the reason why it is unknown. */
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

/** Stroke of the platform along a coordinate, and the actuator or stop that limits it. */
export interface Stroke {
  coordinate: string;
  low: number;
  high: number;
  limiting: string;
}

/** Sensitivity to a number: change of each figure per unit of the number, and of the worst requirement's margin by one per cent. */
export interface Slope {
  address: string;
  si: string;
  value: number;
  slopes: Record<string, number | null>;
  worst: number | null;
}

/** Two separate bodies that touch, or a gap between them: the `distance` [m] is negative for an overlap. */
export interface Clash {
  first: string;
  second: string;
  distance: number;
  text: string;
}

/**
 * A motion: the platform's twist (unit length), its axis through `point`, pitch [m/rad], null for a pure translation.
 *
 * `links` are those that deform in a free motion, or that constrain a locked one: by strain energy, largest share first, if known.
 */
export interface Screw {
  name: string;
  twist: number[];
  point: number[];
  direction: number[];
  pitch: number | null;
  links: string[];
}

/** A snippet of the palette: `text` is TOML with `{name}` for a field's text; fields by name with their initial texts. */
export interface Snippet {
  name: string;
  group: string;
  title: string;
  text: string;
  fields: Record<string, string>;
}

/** A pair of a design job: its goal, or the reason of its failure; `file` is a name for its design, empty without an answer. */
export interface PairRow {
  architecture: string;
  actuator: string;
  goal: string;
  reason: string;
  file: string;
}

/** A table of a result as text: its heads are the first row. */
export interface ResultTable {
  title: string;
  rows: string[][];
  notes: string[];
}

/**
 * A job: its state, fraction done and estimated seconds left, its output, its report's address if any, its key figures.
 *
 * A design job has its finished `pairs`, and at its end the `tables` of its command.
 */
export interface JobState {
  job: number;
  command: string;
  state: "waits" | "runs" | "done" | "failed" | "cancelled";
  text: string;
  fraction: number | null;
  left: number | null;
  said: string[];
  report: string | null;
  figures: Figure[];
  pairs: PairRow[];
  tables: ResultTable[];
}

/** The unsaved text of an ended studio: its last change [s since 1970], and whether the file was changed since. */
export interface Draft {
  name: string;
  time: number;
  stale: boolean;
}

/** A line of a card: its name, and its value as text with units. */
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

/** A moving slider: answered by `Frequencies`, the text is unchanged. */
export interface Drag {
  kind: "drag";
  id: number;
  address: string;
  value: number;
}

/** A released slider: the number is written into the text. */
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

/** Request for the entries at a line of the text. */
export interface Line {
  kind: "line";
  id: number;
  line: number;
}

/** Choice of the frequency responses; without frequencies, those that show every resonance. */
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

/** Request for the exact displacement at those strokes (or forces) of the actuators: readings, stress, and exceeded limits. */
export interface Pose {
  kind: "pose";
  id: number;
  inputs: Record<string, number>;
}

/** Request for the sensitivities to each number. */
export interface Derive {
  kind: "derive";
  id: number;
}

/**
 * Move the stage along a path at large displacements: `drive` from `start` to `end` (texts with units) under `loads`, NAME=VALUE.
 *
 * `path` names a path of the design, whose drive, ends, points and loads then apply.
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

/** Abort the running path. */
export interface Halt {
  kind: "halt";
  id: number;
}

/** Request for the platform's free motions, redundant constraints, and locked motions. */
export interface Free {
  kind: "free";
  id: number;
}

/** Request for clashes and gaps. */
export interface Gaps {
  kind: "gaps";
  id: number;
}

/** Request for the platform's modes by finite elements, if a verification has stored them in the cache. */
export interface Solid {
  kind: "solid";
  id: number;
}

/** Store the present design under a name (A, B, C); with `keep` false, remove it. */
export interface Pin {
  kind: "pin";
  id: number;
  name: string;
  keep: boolean;
}

/** Request for the figures of the file, of the pinned designs and of the present one side by side. */
export interface Compare {
  kind: "compare";
  id: number;
}

/** Make the text of a pinned design the present one; the empty name is the file's own. */
export interface Recall {
  kind: "recall";
  id: number;
  name: string;
}

/** Restore the text before the last change. */
export interface Undo {
  kind: "undo";
  id: number;
}

/** Restore the text before the last undo. */
export interface Redo {
  kind: "redo";
  id: number;
}

/**
 * Write the text to its file, or to another `file` of its folder.
 *
 * Refused after a change on disk, or if the other file exists, unless `over` allows overwriting.
 */
export interface Save {
  kind: "save";
  id: number;
  over: boolean;
  file: string;
}

/** Request for the files of the folder, and the shipped cases. */
export interface Browse {
  kind: "browse";
  id: number;
}

/**
 * Open a file of the folder, written first from a shipped `case` or from the answer for a `pair` of a `job` if named.
 *
 * Refused with unsaved changes, unless `discard`.
 */
export interface Open {
  kind: "open";
  id: number;
  file: string;
  case: string;
  discard: boolean;
  job: number | null;
  pair: string;
}

/** Read the text from disk; the present one remains in undo. */
export interface Reload {
  kind: "reload";
  id: number;
}

/** Read the unsaved text of an ended studio in `State.drafts`; without `keep` it is discarded. */
export interface Recover {
  kind: "recover";
  id: number;
  draft: string;
  keep: boolean;
}

/** Request for the snippets. */
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
 * Panes of a page: only these are computed after a change, the others when they are shown.
 *
 * `stage`: the picture; `motions`: its motions; `reach`: strokes and strength.
 */
export interface Look {
  kind: "look";
  id: number;
  panes: ("stage" | "motions" | "reach")[];
}

/** Request for the form of a command. */
export interface JobForm {
  kind: "jobform";
  id: number;
  command: "sweep" | "optimise" | "verify" | "identify" | "loop" | "design";
}

/**
 * Check a specification: a `text`, with the `values` of its form if there are any, as TOML.
 *
 * An empty text is that of a `file` of the folder if named, or else the last one, at first an example.
 */
export interface Specify {
  kind: "specify";
  id: number;
  text: string;
  file: string;
  values: string;
}

/** Write a specification to a file of the folder. Refused if the file exists, unless `over` allows overwriting. */
export interface SaveSpecification {
  kind: "savespecification";
  id: number;
  text: string;
  file: string;
  over: boolean;
}

/** Start a command as a job; `study` is the text of its study, set-up or specification if it needs one, `record` a file's path. */
export interface Run {
  kind: "run";
  id: number;
  command: "analyse" | "sweep" | "optimise" | "verify" | "identify" | "loop" | "design";
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

/** The page is admitted. */
export interface Welcome {
  kind: "welcome";
  version: number;
  flexstage: string;
  page: number;
  pages: number;
}

/**
 * The text and its contents; pushed at every change. `digest` belongs to the file on disk.
 *
 * `sound`: the design has no error, otherwise `problems` lists the errors. If the text has errors, numbers and figures belong to the
 * last text without errors. `changed` counts numbers that differ from the file's, `warnings` are the last reported ones, `page` is the
 * one whose request made the change (0: the server), `pins` the pinned designs. `links` belong to the expanded stage, with the line of
 * each. `unprotected` is the reason why unsaved changes would be lost with the server, `drafts` list those of earlier servers.
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

/** Task of the computing process, and its expected duration [s]; `ended` after a crash and restart. */
export interface Engine {
  kind: "engine";
  state: "starts" | "ready" | "computes" | "ended";
  text: string;
  seconds: number | null;
}

/** The geometry of a revision for the viewer; without motions if no page shows them. */
export interface Scene {
  kind: "scene";
  revision: number;
  data: unknown;
}

/** The platform's frequencies [Hz] for a moving slider. Null: none. */
export interface Frequencies {
  kind: "frequencies";
  to: number;
  address: string;
  value: number;
  frequencies: (number | null)[];
  problems: Problem[];
}

/**
 * Results of a revision: missing ones have a reason by name. `frequency` (f,) is the common axis of all curves.
 *
 * `loading` describes a significant effect of the permanent load: stiffness, modes and curves are then those of the loaded stage.
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

/** Warnings and default values of a revision; the last message about it. */
export interface Warnings {
  kind: "warnings";
  revision: number;
  warnings: Problem[];
}

/**
 * A link: its part, its lines of the text, 6x6 about its centre in its own frame, its stress and lost motion.
 *
 * `stress` [Pa] is the peak over all strokes, `limit` the allowable one, `share` its share of every actuator's lost motion. `facts` are
 * further properties as text; `problems` are missing comparisons of beam theory with elasticity. `verified` compares with stored finite
 * elements.
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

/** Entries at a line: links (one or several), and the addresses of the numbers there. */
export interface Place {
  kind: "place";
  to: number;
  line: number;
  links: string[];
  bodies: string[];
  addresses: string[];
}

/**
 * Linear maps of a revision, elastic: `platform` is the platform's twist per unit input, `inputs` its (pseudo-)inverse.
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

/** The stage at some strokes: twist, readings, stress of each link, and exceeded limits, as text by the name of their cause. */
export interface Posed {
  kind: "posed";
  to: number;
  twist: number[];
  readings: Record<string, number>;
  stress: Record<string, number>;
  beyond: Record<string, string>;
}

/** Sensitivities, sorted by their effect on the worst requirement, `worst`. */
export interface Slopes {
  kind: "slopes";
  to: number;
  revision: number;
  worst: string;
  slopes: Slope[];
  missing: Record<string, string>;
}

/** Progress of a path from a `request` of a page: the completed fraction, and a text. */
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

/** Free motions, constraints with the redundant ones, free internal modes, and locked motions. */
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

/** Clashes first, then gaps, smallest first; `problems` are violations of aperture and envelope. */
export interface Clearances {
  kind: "clearances";
  to: number;
  revision: number;
  clashes: Clash[];
  problems: Problem[];
}

/** The platform's modes by finite elements; without any, `missing` is the reason. */
export interface SolidModes {
  kind: "solidmodes";
  to: number;
  revision: number;
  modes: SolidMode[];
  missing: string;
}

/** Figures of designs: one row for each figure, one column for each design; null for a missing one. */
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

/** The files of the folder, those of them that are specifications, and the shipped cases with their summaries. */
export interface Folder {
  kind: "folder";
  to: number;
  files: string[];
  specifications: string[];
  cases: Record<string, string>;
}

/** The form of a command: the JSON Schema of its study or set-up, or of its options. */
export interface Blank {
  kind: "blank";
  to: number;
  command: string;
  schema: unknown;
}

/** A specification: its text and values, null if it cannot be read, and its errors by address. */
export interface Specified {
  kind: "specified";
  to: number;
  text: string;
  values: unknown;
  problems: Problem[];
}

/** All jobs; pushed at each progress. */
export interface Jobs {
  kind: "jobs";
  jobs: JobState[];
}

/** A completed request without another answer: the new revision of the text; a new job's number. */
export interface Done {
  kind: "done";
  to: number;
  revision: number;
  job: number | null;
}

/** A refused request. `stale`: another page or program changed the text or file first. */
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
  | Folder
  | Blank
  | Specified
  | Jobs
  | Done
  | Refusal;
