// A stage on the graphics card: one geometry, four small tables, and the materials that draw it.

import {
  BufferAttribute, BufferGeometry, DataTexture, DoubleSide, FloatType, FrontSide, GLSL3, LineSegments, Mesh, NearestFilter, RawShaderMaterial, RGBAFormat, Scene,
  Vector4,
} from "three";
import { edgeFragment, edgeVertex, pickFragment, surfaceFragment, surfaceVertex } from "./shaders";
import type { StageData } from "./types";
import { floats, indices, numbers } from "./unpack";

const WIDTH = 512;
/** Places along what bends at which a pose tells where it lies; `NODES` in show/viewer/animation.py, and in the shader. */
const NODES = 12;

/** A table of rows of four floats, laid out in lines of a texture. */
class Table {
  readonly texture: DataTexture;
  readonly values: Float32Array;

  constructor(rows: number) {
    const lines = Math.max(1, Math.ceil(rows / WIDTH));
    this.values = new Float32Array(4 * WIDTH * lines);
    this.texture = new DataTexture(this.values, WIDTH, lines, RGBAFormat, FloatType);
    this.texture.magFilter = this.texture.minFilter = NearestFilter;
    this.texture.needsUpdate = true;
  }

  set(row: number, values: ArrayLike<number>): void {
    for (let at = 0; at < values.length; at++) this.values[4 * row + at] = values[at]!;
  }

  changed(): void {
    this.texture.needsUpdate = true;
  }
}

/** No plane: nothing lies before it. */
export const UNCUT = new Vector4(0, 0, 0, 1);

export class Model {
  readonly points: Float32Array;
  readonly carriers: Uint16Array;
  readonly part: Uint16Array;
  /** Corners of the faces, three a face. */
  readonly triangles: ArrayLike<number>;
  private readonly carrier: Uint16Array;
  private readonly twists: Table;
  private readonly poses: Table;
  /** How many rows a pose of this stage has. */
  readonly rows: number;
  private readonly paints: Table;
  private readonly surface = new BufferGeometry();
  private readonly lines = new BufferGeometry();
  private readonly shared: Record<string, { value: unknown }>;
  private readonly materials: RawShaderMaterial[] = [];
  private readonly picking: Mesh;
  readonly scene = new Scene();
  readonly pickScene = new Scene();

  /** A ghost has no surface: its edges alone, in the ghost's ink. */
  constructor(readonly data: StageData, ink: Vector4, ghost = false) {
    const mesh = data.mesh;
    this.points = floats(mesh.points);
    this.part = numbers(mesh.part);
    this.carrier = numbers(mesh.carrier);
    this.carriers = numbers(mesh.carriers);
    this.twists = new Table(2 * data.bodies.length);
    this.rows = data.bodies.length + NODES * this.bending;
    this.poses = new Table(2 * this.rows);
    this.paints = new Table(data.parts.length);
    this.shared = {
      twists: { value: this.twists.texture },
      poses: { value: this.poses.texture },
      paints: { value: this.paints.texture },
      carriers: { value: this.carrierTable(floats(mesh.ends)).texture },
      stations: { value: stationTable(floats(mesh.stations)).texture },
      factor: { value: 0 },
      finite: { value: 0 },
      plane: { value: UNCUT.clone() },
    };
    const attributes: [string, Float32Array | Uint16Array, number][] = [
      ["position", this.points, 3], ["part", this.part, 1], ["carrier", this.carrier, 1], ["station", numbers(mesh.station), 1],
    ];
    for (const [name, values, size] of attributes) {
      const attribute = new BufferAttribute(values, size);
      this.surface.setAttribute(name, attribute);
      this.lines.setAttribute(name, attribute);
    }
    const corners = indices(mesh.triangles, mesh.indices);
    this.triangles = corners;
    this.surface.setIndex(new BufferAttribute(corners, 1));
    this.lines.setIndex(new BufferAttribute(indices(mesh.edges, mesh.indices), 1));
    this.picking = new Mesh(this.surface, this.material(edgeVertex, pickFragment, {}));
    this.addPicking();
    if (!ghost) this.addSurfaces();
    const edges = new LineSegments(this.lines, this.material(edgeVertex, edgeFragment, { ink: { value: ink } }, true));
    edges.renderOrder = 1;
    this.add(edges);
  }

  private add(drawn: Mesh | LineSegments): void {
    drawn.frustumCulled = false;
    this.scene.add(drawn);
  }

  private addPicking(): void {
    this.picking.frustumCulled = false;
    this.pickScene.add(this.picking);
  }

  /** Opaque faces, the depth of translucent ones, and their colours: only the nearest translucent face tints what is behind it. */
  private addSurfaces(): void {
    for (const [order, translucent, coloured] of [[0, 0, true], [2, 1, false], [3, 1, true]] as const) {
      const material = this.material(surfaceVertex, surfaceFragment, { translucent: { value: translucent }, opacity: { value: 1 } }, translucent === 1);
      material.polygonOffset = true;
      material.polygonOffsetFactor = material.polygonOffsetUnits = 1;
      material.colorWrite = coloured;
      material.depthWrite = order < 3;
      if (translucent) material.side = FrontSide;
      const surface = new Mesh(this.surface, material);
      surface.renderOrder = order;
      this.add(surface);
    }
  }

  private material(vertexShader: string, fragmentShader: string, own: Record<string, { value: unknown }>, transparent = false): RawShaderMaterial {
    const uniforms = { ...this.shared, ...own };
    const made = new RawShaderMaterial({ vertexShader, fragmentShader, uniforms, transparent, side: DoubleSide, glslVersion: GLSL3 });
    this.materials.push(made);
    return made;
  }

  private carrierTable(ends: Float32Array): Table {
    const count = this.carriers.length / 2;
    const table = new Table(3 * count);
    let start = this.data.bodies.length;
    for (let at = 0; at < count; at++) {
      const [first, second] = this.carriers.subarray(2 * at, 2 * at + 2) as unknown as [number, number];
      table.set(3 * at, [first, second, start]);
      if (first !== second) start += NODES;
      table.set(3 * at + 1, ends.subarray(6 * at, 6 * at + 3));
      table.set(3 * at + 2, ends.subarray(6 * at + 3, 6 * at + 6));
    }
    return table;
  }

  /** Twists of the bodies at the origin, 6 a body. */
  setTwists(values: Float32Array): void {
    this.twists.values.fill(0);
    for (let body = 0; body < this.data.bodies.length; body++) {
      this.twists.set(2 * body, values.subarray(6 * body, 6 * body + 3));
      this.twists.set(2 * body + 1, values.subarray(6 * body + 3, 6 * body + 6));
    }
    this.twists.changed();
  }

  /** Carriers of two bodies. */
  private get bending(): number {
    return this.carriers.filter((body, at) => at % 2 === 0 && body !== this.carriers[at + 1]).length;
  }

  /** Large displacements in place of twists: rows of displacement and rotation vector, bodies about the origin; null: none. */
  setPoses(values: Float32Array | null): void {
    const fits = values !== null && values.length === 6 * this.rows;
    this.shared["finite"]!.value = fits ? 1 : 0;
    if (!fits) return;
    for (let row = 0; row < this.rows; row++) {
      this.poses.set(2 * row, values.subarray(6 * row, 6 * row + 3));
      this.poses.set(2 * row + 1, values.subarray(6 * row + 3, 6 * row + 6));
    }
    this.poses.changed();
  }

  set factor(value: number) {
    this.shared["factor"]!.value = value;
  }

  set plane(value: Vector4) {
    (this.shared["plane"]!.value as Vector4).copy(value);
  }

  /** Red, green, blue and opacity of every part; an opacity of -1 hides it. */
  setPaints(paint: (part: number) => readonly [number, number, number, number]): void {
    for (let part = 0; part < this.data.parts.length; part++) this.paints.set(part, paint(part));
    this.paints.changed();
  }

  opacity(part: number): number {
    return this.paints.values[4 * part + 3]!;
  }

  setOpacity(part: number, value: number): void {
    this.paints.values[4 * part + 3] = value;
    this.paints.changed();
  }

  dispose(): void {
    this.surface.dispose();
    this.lines.dispose();
    for (const each of this.materials) each.dispose();
    for (const each of Object.values(this.shared)) if (each.value instanceof DataTexture) each.value.dispose();
  }
}

function stationTable(values: Float32Array): Table {
  const count = values.length / 5;
  const table = new Table(2 * count);
  for (let at = 0; at < count; at++) {
    table.set(2 * at, values.subarray(5 * at, 5 * at + 3));
    table.set(2 * at + 1, values.subarray(5 * at + 3, 5 * at + 5));
  }
  return table;
}
