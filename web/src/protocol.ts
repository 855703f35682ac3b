// Written by `python -m tools.protocol` from src/flexstage/apps/studio/protocol.py. Do not edit.

/**
 * All messages between the studio's page and its server, one class each; `python -m tools.protocol` writes them for TypeScript.
 *
 * A message is a JSON object whose `kind` is the class's name in small letters. The page sends requests, each with a unique `id`; the answer
 * contains this `id` as `to`. Every request is answered: by `Done` if it has no result, and by `Refusal` if it is refused. Answers have the
 * sequence of the requests. Exceptions are `Drag` and `Pose`: only the newest request gets a result, and older requests get `Done`. All other
 * messages are pushed to all pages when their contents change. Numbers are in SI units, null if unknown.
 */
export const VERSION = 6;

/** A finding: its object or address, the problem and the advice; line and column count from 1, null if unknown. */
export interface Problem {
  where: string;
  what: string;
  advice: string;
  line: number | null;
  column: number | null;
}

/**
 * A number of the stage: its `value` in the SI unit `si`, and its `text` as in the file. One display `unit` is `factor` SI units.
 *
 * `low` and `high` are the ends of the slider, within the bounds of the number. `formula` defines the number. `old` is the value in the
 * file on disk. `group` is the table that contains the number; `line` is the line of the number, or of this table.
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

/** An actuator, an axis of the platform or a gauge, with the ends of its range if known. One display `unit` is `factor` units `si`. */
export interface Channel {
  name: string;
  si: string;
  unit: string;
  factor: number;
  low: number | null;
  high: number | null;
}

/** A result: its `name` as in requirements, its group, its value in `si`, and the `old` value of the file on disk. */
export interface Figure {
  name: string;
  group: string;
  si: string;
  unit: string;
  factor: number;
  value: number | null;
  old: number | null;
}

/** A matrix with names of rows and columns. `unit` is a single unit for all entries, or a unit for each entry. */
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
 * A mode: the platform's `twist` (x y z rx ry rz, m and rad) in the mass-normalised shape, and its `share` of the kinetic energy.
 *
 * `kinetic` contains the fractions of kinetic energy in bodies, `strain` contains the fractions of strain energy in links. The largest
 * fractions are first; fractions below one per cent are left out. A `local` mode moves mainly bodies other than the platform.
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
 * A platform mode by finite elements: `error` is the estimated relative error of its frequency, `motion` contains data for a viewer.
 *
 * `theory` is the number of the paired mode of the lumped model; null without a pair. `theory_frequency` [Hz] is the frequency of the
 * lumped mode, `difference` is the relative difference of this frequency from finite elements, and `assurance` is the modal assurance
 * criterion of the pair.
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

/** Lost motion of an actuator: its transmission ratio `gain` (1 is ideal), its `loss`, and the contribution of each link to the loss. */
export interface Loss {
  actuator: string;
  gain: number;
  loss: number;
  budget: Record<string, number>;
}

/** A requirement: its key and text, its limit and value in `si`, its margin (0.1 is 10 %), and the `reason` if the value is unknown. */
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

/** Sensitivity to a number: derivatives of figures, and the change of the lowest margin (`worst`) if the number increases by 1 %. */
export interface Slope {
  address: string;
  si: string;
  value: number;
  slopes: Record<string, number | null>;
  worst: number | null;
}

/** Two separate bodies, and the `distance` [m] between them, which is negative for an overlap. */
export interface Clash {
  first: string;
  second: string;
  distance: number;
  text: string;
}

/**
 * A motion of the platform as a screw: its twist, and its axis in a unit `direction` through `point`.
 *
 * `pitch` [m/rad] is null for a pure translation. `links` of a free motion are the links that deform. `links` of a locked motion are the
 * links that constrain it, in descending order of strain energy.
 */
export interface Screw {
  name: string;
  twist: number[];
  point: number[];
  direction: number[];
  pitch: number | null;
  links: string[];
}

/** A snippet of the palette: `text` is TOML with `{name}` in place of each field; `fields` contains their initial values by name. */
export interface Snippet {
  name: string;
  group: string;
  title: string;
  text: string;
  fields: Record<string, string>;
}

/** A pair of architecture and actuator in a design job: its `goal` or the `reason` for its failure, and its `file` name (or empty). */
export interface PairRow {
  architecture: string;
  actuator: string;
  goal: string;
  reason: string;
  file: string;
}

/** A table of a result as text: the first row contains the column heads. */
export interface ResultTable {
  title: string;
  rows: string[][];
  notes: string[];
}

/**
 * A job: its state, the completed `fraction`, the estimated time `left` [s], the last output lines `said`, and its results.
 *
 * `report` is the address of its report, null without a report. A job of the command `design` also has the finished `pairs` and, when it
 * has ended, the `tables` of the command.
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

/** The unsaved text of an ended studio: the `time` of its last change [s since 1970]. If `stale`, the file changed after this time. */
export interface Draft {
  name: string;
  time: number;
  stale: boolean;
}

/** A line of a card: its name, and its value as text with the unit. */
export interface Fact {
  name: string;
  text: string;
}

/** The first message of a page, with the token from its address. */
export interface Hello {
  kind: "hello";
  token: string;
  version: number;
}

/** The text as typed. Refused if another page changed the text after `revision`, the last revision that this page knows. */
export interface Edit {
  kind: "edit";
  id: number;
  text: string;
  revision: number;
}

/** Set a number: a value in any unit of its quantity, a formula, or a relative change (`+10 %`). */
export interface Set {
  kind: "set";
  id: number;
  address: string;
  text: string;
}

/** Report the value of a moving slider. The answer is `Frequencies`; the text does not change. */
export interface Drag {
  kind: "drag";
  id: number;
  address: string;
  value: number;
}

/** Report the value of a released slider, which is written into the text. */
export interface Rest {
  kind: "rest";
  id: number;
  address: string;
  value: number;
}

/** Request for the card of a link (`B1/front`). */
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

/** Choose the frequency responses. Without a band, the frequencies are chosen so that every resonance is visible. */
export interface Respond {
  kind: "respond";
  id: number;
  inputs: string[];
  outputs: string[];
  low: number | null;
  high: number | null;
}

/** Request for the linear maps between strokes, platform motion and gauge readings. */
export interface Jog {
  kind: "jog";
  id: number;
}

/** Request for the displacement at given strokes or forces of the actuators, with readings, stress, and exceeded limits. */
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
 * Move the stage along a load path at large displacements: `drive` from `start` to `end` (with units) under `loads` (NAME=VALUE).
 *
 * If `path` names a load path of the design, its drive, ends, points and loads are used instead.
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

/** Abort the computation of the load path. */
export interface Halt {
  kind: "halt";
  id: number;
}

/** Request for the platform's free motions, redundant constraints, and locked motions. */
export interface Free {
  kind: "free";
  id: number;
}

/** Request for overlaps and gaps between bodies. */
export interface Gaps {
  kind: "gaps";
  id: number;
}

/** Request for the platform's modes by finite elements, if a verification has stored them in the cache. */
export interface Solid {
  kind: "solid";
  id: number;
}

/** Store the present design under a name (A, B, C). If `keep` is false, remove the design pinned under this name. */
export interface Pin {
  kind: "pin";
  id: number;
  name: string;
  keep: boolean;
}

/** Request for a comparison of the results of the file, the pinned designs and the present design. */
export interface Compare {
  kind: "compare";
  id: number;
}

/** Make the text of a pinned design the present text. The empty name selects the text of the file. */
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
 * The request is refused if the file has changed on disk, or if the other file exists, unless `over` allows overwriting.
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
 * Open a file of the folder. If a shipped `case`, or a `pair` of a design `job`, is named, its design is first written to the file.
 *
 * Refused if there are unsaved changes, unless `discard` is true.
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

/** Read the text from disk. The present text remains in undo. */
export interface Reload {
  kind: "reload";
  id: number;
}

/** Restore an unsaved text of an ended studio from `State.drafts`. If `keep` is false, discard the text. */
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
 * Report the panes that a page shows. After a change, only shown panes are computed. Other panes are computed when they are shown.
 *
 * The pane `stage` is the picture, `motions` contains its motions, and `reach` contains strokes and strength.
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
 * Check the `text` of a specification, in which `values` (TOML) from the form replace values.
 *
 * An empty text is replaced by the text of `file` in the folder. Without a file, the last text is used (initially an example).
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

/** Start a command as a job. `study` is a study, set-up or specification as text; `record` is the path of a record file. */
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

/** The page was admitted. */
export interface Welcome {
  kind: "welcome";
  version: number;
  flexstage: string;
  page: number;
  pages: number;
}

/**
 * The text and its contents, sent to all pages after every change. `digest` is the digest of the file on disk.
 *
 * If `sound`, the design has no error; otherwise, `problems` lists the errors, and all numbers are from the last text without errors.
 * `changed` is the number of values that differ from the file. `page` made the change (0: the server). `pins` are the names of the pinned
 * designs. `links` contains the line of each link of the expanded stage. `unprotected` is the reason why unsaved changes would be lost if
 * the server ended. `drafts` lists unsaved changes of earlier servers.
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

/** State of the computing process, its task `text`, and the expected duration [s]. If `ended`, the process crashed and was restarted. */
export interface Engine {
  kind: "engine";
  state: "starts" | "ready" | "computes" | "ended";
  text: string;
  seconds: number | null;
}

/** The geometry of a revision for the viewer. The motions are left out if no page shows them. */
export interface Scene {
  kind: "scene";
  revision: number;
  data: unknown;
}

/** The platform frequencies [Hz] for a moving slider, null where unknown. */
export interface Frequencies {
  kind: "frequencies";
  to: number;
  address: string;
  value: number;
  frequencies: (number | null)[];
  problems: Problem[];
}

/**
 * Results of a revision. `missing` contains the reason for each missing result. `frequency` (f,) is the frequency axis of all curves.
 *
 * `loading` describes the effect of a significant permanent load; stiffness, modes and curves then belong to the loaded stage.
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

/** Platform strokes of a revision, and safety factors of its flexures against stress and buckling. */
export interface Reach {
  kind: "reach";
  revision: number;
  figures: Figure[];
  strokes: Stroke[];
  missing: Record<string, string>;
  milliseconds: number;
}

/** Warnings and default values of a revision. The server sends this message last for each revision. */
export interface Warnings {
  kind: "warnings";
  revision: number;
  warnings: Problem[];
}

/**
 * A link: its part, its lines in the text, its 6x6 matrices about the part's centre in the link frame, its stress and lost motion.
 *
 * `stress` [Pa] is the peak over all strokes, `limit` is the allowable stress. `shares` contains the link's contribution to the lost
 * motion of each actuator. `facts` are further properties as text. `problems` are warnings about the part, such as dimensions outside the
 * validated range of beam theory. `verified` compares the link with stored results of finite elements.
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

/** Entries at a line: its links and bodies, and the addresses of its numbers. */
export interface Place {
  kind: "place";
  to: number;
  line: number;
  links: string[];
  bodies: string[];
  addresses: string[];
}

/**
 * Linear maps of the elastic stage: `platform` is the platform twist per unit input, `inputs` are the actuator inputs per unit twist.
 *
 * `gauges` contains the readings per unit input; `ideal` is the platform twist per unit input of the ideal stage. `stress` (links x
 * inputs) is in Pa per unit input; `rest` is the stress without strokes. The stress of a link is at most `rest` plus the sum of the
 * magnitudes over all inputs. `allowed` contains the allowable stresses.
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

/** The stage at given strokes: platform twist, readings, and stress of each link. `beyond` names and describes exceeded limits. */
export interface Posed {
  kind: "posed";
  to: number;
  twist: number[];
  readings: Record<string, number>;
  stress: Record<string, number>;
  beyond: Record<string, string>;
}

/** Sensitivities, sorted by their effect on `worst`, the requirement with the lowest margin. */
export interface Slopes {
  kind: "slopes";
  to: number;
  revision: number;
  worst: string;
  slopes: Slope[];
  missing: Record<string, string>;
}

/** Progress of the load path of a page's `request`: the completed fraction, and a text. */
export interface Underway {
  kind: "underway";
  request: number;
  fraction: number;
  text: string;
}

/** A load path of a revision. `motions` for the viewer are the path itself, then the modes at its last stable point. */
export interface Travelled {
  kind: "travelled";
  to: number;
  revision: number;
  motions: unknown;
  warnings: Problem[];
}

/** Free motions, redundant constraints, free internal modes, locked motions, and locked strokes (`blocked`). */
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

/** Overlaps and gaps between bodies, the largest overlap first. `problems` are violations of aperture and envelope. */
export interface Clearances {
  kind: "clearances";
  to: number;
  revision: number;
  clashes: Clash[];
  problems: Problem[];
}

/** Platform modes by finite elements. Without modes, `missing` is the reason. */
export interface SolidModes {
  kind: "solidmodes";
  to: number;
  revision: number;
  modes: SolidMode[];
  missing: string;
}

/** Figures of designs: one row for each figure, one column for each design, null for a missing figure. */
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

/** The design files and specifications of the folder, and the shipped cases with their summaries. */
export interface Folder {
  kind: "folder";
  to: number;
  files: string[];
  specifications: string[];
  cases: Record<string, string>;
}

/** The form of a command, as the JSON Schema of its study, set-up or options. */
export interface Blank {
  kind: "blank";
  to: number;
  command: string;
  schema: unknown;
}

/** A specification: its text, its values (null if the text cannot be read), and its errors by address. */
export interface Specified {
  kind: "specified";
  to: number;
  text: string;
  values: unknown;
  problems: Problem[];
}

/** All jobs, pushed after each progress report. */
export interface Jobs {
  kind: "jobs";
  jobs: JobState[];
}

/** A completed request without a result: the revision of the text, and the number of a new job. */
export interface Done {
  kind: "done";
  to: number;
  revision: number;
  job: number | null;
}

/** A refused request. If `stale`, another page or program has changed the text or the file. */
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
