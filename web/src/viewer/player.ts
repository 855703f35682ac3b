// What moves, how far and when: a motion of the data, or a pose that a page sets.

import type { Motion, MotionKey, StageData } from "./types";
import { floats } from "./unpack";

const SECONDS = 1.6;
export const AMPLITUDES = [0.01, 0.02, 0.03, 0.05, 0.08, 0.12, 0.2] as const;

export class Player {
  motion: Motion | null = null;
  twists: Float32Array | null = null;
  playing = false;
  phase = 0;
  amplitude: number = AMPLITUDES[2];
  private poseFactor = 1;
  private last: number | null = null;

  constructor(private data: StageData) {}

  /** Another design: the motion of the same name goes on, if there is one. */
  replace(data: StageData): void {
    const key = this.motion;
    this.data = data;
    if (key) this.choose(this.find(key));
    else if (this.twists && this.twists.length !== 6 * data.bodies.length) this.twists = null;
  }

  find(key: MotionKey | null): Motion | null {
    return (key && this.data.motions.find((each) => each.group === key.group && each.name === key.name)) || null;
  }

  choose(motion: Motion | null): void {
    this.motion = motion;
    this.twists = motion ? floats(motion.twists) : null;
    this.last = null;
  }

  pose(twists: Float32Array | null, factor: number): void {
    this.motion = null;
    this.twists = twists;
    this.poseFactor = factor;
  }

  /** Displacement drawn at the largest over displacement stored. */
  get exaggeration(): number {
    if (!this.motion) return this.twists ? this.poseFactor : 0;
    return this.motion.reach > 0 ? (this.amplitude * this.data.size) / this.motion.reach : 0;
  }

  /** From -1 to 1; deflections go one way. */
  get sense(): number {
    if (!this.motion) return this.twists ? 1 : 0;
    return this.motion.group === "deflection" ? 0.5 - 0.5 * Math.cos(2 * Math.PI * this.phase) : Math.sin(2 * Math.PI * this.phase);
  }

  get factor(): number {
    return this.sense * this.exaggeration;
  }

  /** Phase at which the motion is as far out as it goes. */
  get outmost(): number {
    return this.motion?.group === "deflection" ? 0.5 : 0.25;
  }

  /** The time goes on; whether anything moves. */
  step(now: number): boolean {
    const moves = this.playing && this.motion !== null;
    if (moves && this.last !== null) this.phase = (this.phase + (now - this.last) / 1000 / SECONDS) % 1;
    this.last = moves ? now : null;
    return moves;
  }

  /** The amplitude beside the slider: how much is exaggerated, or, where the stored size means nothing, how far what moves most is drawn. */
  get words(): string {
    if (!this.motion) return this.twists ? `× ${written(this.poseFactor)}` : "";
    if (this.motion.scaled) return `exaggerated × ${written(this.exaggeration)}`;
    return `shape only: largest motion drawn ${written(1e3 * this.amplitude * this.data.size)} mm`;
  }
}

/** Three digits, whole thousands apart. */
export function written(value: number): string {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  const digits = Math.max(0, 2 - Math.floor(Math.log10(Math.abs(value))));
  if (digits > 6) return value.toExponential(2);
  const [whole = "", part = ""] = Number(value.toPrecision(3)).toFixed(digits).split(".");
  const decimals = part.replace(/0+$/, "");
  return whole.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f") + (decimals && `.${decimals}`);
}
