// Large displacements: where everything is at a place of a path, or in a small motion about a state, as rows of displacement and rotation vector.

import type { Course, StageData } from "./types";
import { floats } from "./unpack";

type Turn = [number, number, number, number];

/** The quaternion of a rotation vector, its real part first. */
function quaternion(x: number, y: number, z: number): Turn {
  const angle = Math.hypot(x, y, z), share = angle < 1e-9 ? 0.5 : Math.sin(angle / 2) / angle;
  return [Math.cos(angle / 2), x * share, y * share, z * share];
}

function times(a: Turn, b: Turn): Turn {
  return [
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
  ];
}

function vector(q: Turn): [number, number, number] {
  const size = Math.hypot(q[1], q[2], q[3]), sign = q[0] < 0 ? -1 : 1;
  const share = size < 1e-12 ? 2 : (2 * Math.atan2(size, Math.abs(q[0]))) / size;
  return [sign * share * q[1], sign * share * q[2], sign * share * q[3]];
}

/** A point that moves with a row about its centre. */
export function moved(rows: Float32Array, row: number, centre: readonly number[], point: readonly number[]): [number, number, number] {
  const at = 6 * row, turn = quaternion(rows[at + 3]!, rows[at + 4]!, rows[at + 5]!);
  const [x, y, z] = [point[0]! - centre[0]!, point[1]! - centre[1]!, point[2]! - centre[2]!];
  const [, a, b, c] = times(times(turn, [0, x, y, z]), [turn[0], -turn[1], -turn[2], -turn[3]]);
  return [centre[0]! + rows[at]! + a, centre[1]! + rows[at + 1]! + b, centre[2]! + rows[at + 2]! + c];
}

export class Route {
  readonly points: number;
  private readonly poses: Float32Array;
  private readonly shape: Float32Array | null;
  private readonly size: number;
  /** The largest rotation of anything along it. */
  readonly turn: number;

  constructor(readonly course: Course) {
    this.points = course.points;
    this.poses = floats(course.poses);
    this.shape = course.shape === undefined ? null : floats(course.shape);
    this.size = this.poses.length / course.frames.length;
    let most = 0;
    for (let at = 0; at < this.poses.length; at += 6) most = Math.max(most, Math.hypot(this.poses[at + 3]!, this.poses[at + 4]!, this.poses[at + 5]!));
    this.turn = most;
  }

  get rows(): number {
    return this.size / 6;
  }

  /** Whether it is a small motion about one state, which goes to and fro. */
  get shakes(): boolean {
    return this.shape !== null;
  }

  /** The rows at a place between points, drawn `times` as large; where a point has no equilibrium, those of its nearest neighbour that has. */
  at(place: number, times: number): Float32Array {
    const { frames } = this.course, found = new Float32Array(this.size);
    let after = frames.findIndex((each) => each >= place);
    if (after < 0) after = frames.length - 1;
    const before = Math.max(0, after - 1), [low, high] = [frames[before]!, frames[after]!];
    const share = high > low ? Math.max(0, Math.min(1, (place - low) / (high - low))) : 1;
    for (let at = 0; at < this.size; at++) {
      const first = this.poses[before * this.size + at]!, second = this.poses[after * this.size + at]!;
      found[at] = times * (first + share * (second - first));
    }
    return found;
  }

  /** The rows of the state with `amount` of the small motion about it. */
  shaken(amount: number): Float32Array {
    const found = this.poses.slice(0, this.size), shape = this.shape!;
    for (let at = 0; at < this.size; at += 6) {
      for (let axis = 0; axis < 3; axis++) found[at + axis]! += amount * shape[at + axis]!;
      const small = quaternion(amount * shape[at + 3]!, amount * shape[at + 4]!, amount * shape[at + 5]!);
      found.set(vector(times(small, quaternion(found[at + 3]!, found[at + 4]!, found[at + 5]!))), at + 3);
    }
    return found;
  }

  /** Rows as the graphics card takes them: of bodies about the stage's origin. */
  static aboutOrigin(rows: Float32Array, data: StageData): Float32Array {
    const found = rows.slice();
    data.references.forEach((centre, body) => found.set(moved(rows, body, centre, [0, 0, 0]), 6 * body));
    return found;
  }
}
