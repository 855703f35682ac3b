// What a viewer is given and what it offers. `src/flexstage/show/viewer` writes the same data, so names here and there are one.
// Lengths are in m, angles in rad, frequencies in Hz; twists are (translation of the stage's origin, rotation): a point p moves by t + w x p.

/** Base64 of the little-endian bytes of an array. */
export type Packed = string;

export type Kind = "ground" | "body" | "platform" | "hinge" | "drive" | "gauge";

/** Something that is drawn and can be picked; `B1/front foot` is the ground behind a link. Its index in `StageData.parts` is its part number. */
export interface Part {
  /** `B1/front`, `platform.plate`, `x1`. */
  name: string;
  kind: Kind;
  /** Name of the unit that it belongs to; absent outside units. */
  unit?: string;
  /** What it is in the words of a design: "neck", "block", "encoder". */
  what: string;
  /** Its address in the design file: `horizontal/front`. */
  address: string;
  /** First line of that in the file, from 1; absent where the design has no file. */
  line?: number;
  /** The bodies that carry it, as indices of `StageData.bodies`: the same twice for what is rigid. */
  bodies: [number, number];
  /** A few lines of its data, as pairs of a name and a value with unit. */
  facts: [string, string][];
}

/** Triangles and sharp edges; every vertex lies on a carrier, which is a piece between two bodies, at one of the stations along it. */
export interface Mesh {
  /** Float32, 3 a vertex [m]. */
  points: Packed;
  /** Uint16, one a vertex: index of `StageData.parts`. */
  part: Packed;
  /** Uint16, one a vertex: index of `carriers` and `ends`. */
  carrier: Packed;
  /** Uint16, one a vertex: index of a row of `stations`. */
  station: Packed;
  /** Uint16, 2 a carrier: its first and second body; the same twice for what is rigid. */
  carriers: Packed;
  /** Float32, 6 a carrier: where it meets its first and its second body [m]. */
  ends: Packed;
  /** Float32, 5 a station: share of the second body, deflection for a unit offset and for a unit turn of the second end, and the slopes of both. */
  stations: Packed;
  /** Of what the indices are: Uint16 or Uint32. */
  indices: "u2" | "u4";
  /** 3 a triangle: vertices, counter-clockwise from outside. */
  triangles: Packed;
  /** 2 an edge: vertices. */
  edges: Packed;
}

/** A name beside a point of the stage, which moves with the mean of two bodies. */
export interface Label {
  text: string;
  kind: Kind;
  point: [number, number, number];
  bodies: [number, number];
}

export type MotionGroup = "mode" | "stroke" | "axis" | "deflection" | "drift" | "response" | "path" | "state";

/** Something that all bodies do together. */
export interface Motion {
  /** Unique within its group: "1" (modes), "B1" (strokes), "x" (axes), "gravity" (deflections). */
  name: string;
  group: MotionGroup;
  /** For the list: "1  312 Hz", "B1 1 µm". */
  label: string;
  /** Of modes [Hz]. */
  frequency?: number;
  /** What stands beside it: what the mode is, how much the actuator moves. */
  remark?: string;
  /** Float32, 6 a body of `StageData.bodies`: its twist at the stage's origin. */
  twists: Packed;
  /** Largest displacement of any vertex by those twists [m] (of modes: by the stored scale, which means nothing). */
  reach: number;
  /** Whether the scale of `twists` is physical: then an exaggeration is said, else the drawn displacement. */
  scaled: boolean;
  /** Of large displacements, along a path or about a state: where everything is; `twists` is empty then. */
  course?: Course;
  /** What happens over time; `twists` are those of its farthest instant. */
  response?: Response;
  /** Float32, one an entry of `StageData.links`: share of the strain energy in it, NaN where it is not known. */
  energy?: Packed;
  /** Float32, one an entry of `StageData.links`: share of the allowed stress that it bears, NaN where it is not known. */
  stress?: Packed;
  /** Where that stress is: "at 40 µm of B1 alone". */
  stressed?: string;
}

/** Something that is told of every point of a path, in a display unit. */
export interface Curve {
  name: string;
  unit: string;
  /** Float32, one a point, NaN where unknown. */
  values: Packed;
}

/** Small motions over time, at equal steps. */
export interface Response {
  points: number;
  /** Float32, for each coordinate 6 a body: the twists by a unit of it. */
  basis: Packed;
  /** Float32, one a coordinate, for each instant. */
  weights: Packed;
  /** The time, then what is told beside it. */
  curves: Curve[];
}

/** Large displacements through the points of a path, or a small motion about one state. */
export interface Course {
  points: number;
  /** The points that poses are of. */
  frames: number[];
  /** Float32, a row of 6 for each of `StageData.bodies` and then for the nodes along each carrier of two bodies: displacement, rotation vector. */
  poses: Packed;
  /** Float32, as one pose: the small motion. */
  shape?: Packed;
  /** What is driven, then what that takes and does. */
  curves: Curve[];
  /** Of every point, the part numbers that are beyond a limit. */
  beyond: number[][];
  /** Why, in words; empty where nothing is. */
  said: string[];
}

export interface StageData {
  format: 1;
  name: string;
  /** Diagonal of the box around everything and its middle [m]. */
  size: number;
  centre: [number, number, number];
  /** Bodies that move; 0 is the ground. */
  bodies: string[];
  /** Index of the platform among the bodies; 0 where there is none. */
  platform: number;
  /** Point of the platform about which its twist is told [m]. */
  reference: [number, number, number];
  /** Points of all bodies about which poses are told [m]. */
  references: [number, number, number][];
  parts: Part[];
  labels: Label[];
  /** Part numbers of hinges and actuators: what strain energy is told of. */
  links: number[];
  mesh: Mesh;
  motions: Motion[];
  /** What is not shown, and why. */
  notes: string[];
}

/** How a viewer begins. */
export interface Options {
  /** Motion that plays at the start: group and name. */
  motion?: MotionKey;
  /** Whether it plays at once; else it stands still at full amplitude. */
  playing?: boolean;
  /** Whether the list of motions and the buttons are shown; the studio has its own. With them the wheel is the page's until the picture has the focus. */
  controls?: boolean;
  /** Whether keys act on the page (the studio: yes) or only while the viewer has the focus (default). */
  globalKeys?: boolean;
  /** Data of a stage that is shown as a ghost. */
  ghost?: StageData;
}

export interface MotionKey {
  group: MotionGroup;
  name: string;
}

/** A colour of a part instead of its kind's: red, green, blue from 0 to 1. */
export type Colour = [number, number, number];

export type StandardView = "iso" | "top" | "bottom" | "front" | "back" | "left" | "right";

export interface Picked {
  part: Part;
  index: number;
}

/** What a page does with a viewer. Without WebGL all of it does nothing, and `alive` is false. */
export interface Controller {
  readonly element: HTMLElement;
  readonly alive: boolean;
  /** Curves over the path that is shown, with its cursor: a viewer with controls has them below the picture, else a page puts them where it likes. */
  readonly curves: HTMLElement;
  /** Shows another design in place; camera, picked part (by name) and motion (by name) stay where they exist. */
  replace(data: StageData): void;
  /** Replaces motions alone: modes of another design on the same mesh. */
  replaceMotions(motions: Motion[]): void;
  /** Highlights a part by name, or none. Does not call `onPick`. */
  select(name: string | null): void;
  /** Calls back when a person picks a part, or nothing (null); returns what ends it. */
  onPick(callback: (picked: Picked | null) => void): () => void;
  /** Calls back with the point [m] of the undeformed stage where a person clicks, instead of picking a part; null: clicks pick again. */
  onPoint(callback: ((point: [number, number, number] | null) => void) | null): void;
  /** Calls back when the motion changes by the viewer's own keys and buttons. */
  onMotion(callback: (motion: Motion | null) => void): () => void;
  /** Plays or holds a motion of the data; null: at rest. */
  setMotion(key: MotionKey | null): void;
  /** Holds any twists of the bodies (Float32, 6 a body), exaggerated by `factor`: jog, strokes together. */
  setPose(twists: Float32Array | null, factor?: number): void;
  setPlaying(playing: boolean): void;
  /** Phase of the motion, 0 to 1 of a period. */
  setPhase(phase: number): void;
  /** Largest drawn displacement as a share of the stage's size. */
  setAmplitude(share: number): void;
  /** Colours by part name; what is not named keeps its own. Null: all keep their own. */
  setColours(colours: Readonly<Record<string, Colour>> | null): void;
  /** Paints links by their share of the strain energy of the motion. */
  showEnergy(shown: boolean): void;
  /** Paints links by the share of their allowed stress in the motion, from none to all of it. */
  showStress(shown: boolean): void;
  /** Another stage as a pale outline (before | after); null takes it away. */
  showGhost(data: StageData | null): void;
  /** Draws the platform translucent, or not. */
  ghostPlatform(shown: boolean): void;
  /** Shows one unit alone; null shows all. */
  isolate(unit: string | null): void;
  showLabels(shown: boolean): void;
  /** Cuts away what lies beyond a plane: axis, and place from 0 to 1 along the stage; null takes it away. */
  section(axis: "x" | "y" | "z" | null, place?: number): void;
  look(view: StandardView): void;
  /** Fits all, or one part. */
  fit(name?: string): void;
  /** The picture as a PNG data URL. */
  picture(): string;
  /** What tests and pages may ask. */
  readonly probe: Probe;
  dispose(): void;
}

/** The state of a viewer, for tests. */
export interface Probe {
  readonly webgl: boolean;
  readonly frames: number;
  readonly camera: { position: [number, number, number]; target: [number, number, number]; zoom: number };
  readonly picked: string | null;
  readonly motion: MotionKey | null;
  readonly phase: number;
  /** Displacement drawn over displacement stored. */
  readonly factor: number;
  /** Where on a path it is: a point, or between two. */
  readonly place: number;
  /** Name of the part at a place of the element (CSS pixels from its upper left corner), as it is drawn now. */
  partAt(x: number, y: number): string | null;
  /** All parts at a place, from the nearest on. */
  partsAt(x: number, y: number): string[];
  /** Colour of a pixel, drawn anew for it: red, green, blue, opacity from 0 to 255. */
  pixel(x: number, y: number): [number, number, number, number];
  /** Where a point of the stage [m] is seen (CSS pixels). */
  project(point: [number, number, number]): [number, number];
}
