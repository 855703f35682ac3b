// What moves, how far and when: a motion of the data, or a pose that a page sets.

import { Route } from "./course";
import type { Course, Motion, MotionKey, Response, StageData } from "./types";
import { floats } from "./unpack";

const SECONDS = 1.6;
const RUN = 6; // seconds that something takes which happens over time
const ACROSS = 4; // seconds from one end of a path to the other
const MOST_TURN = 0.4; // a path is not exaggerated beyond this rotation, or ends would gape [rad]
export const AMPLITUDES = [0.01, 0.02, 0.03, 0.05, 0.08, 0.12, 0.2] as const;

/** Twists of all bodies between two instants of something that happens over time. */
class Answer {
  private readonly basis: Float32Array;
  private readonly weights: Float32Array;
  private readonly count: number;

  constructor(readonly response: Response, private readonly bodies: number) {
    this.basis = floats(response.basis);
    this.weights = floats(response.weights);
    this.count = this.weights.length / response.points;
  }

  at(place: number): Float32Array {
    const found = new Float32Array(6 * this.bodies), before = Math.floor(place), after = Math.min(this.response.points - 1, before + 1);
    for (let of = 0; of < this.count; of++) {
      const [one, other] = [before, after].map((each) => this.weights[each * this.count + of]!) as [number, number];
      const weight = one + (place - before) * (other - one);
      for (let at = 0; weight !== 0 && at < found.length; at++) found[at]! += weight * this.basis[of * found.length + at]!;
    }
    return found;
  }
}

export class Player {
  motion: Motion | null = null;
  twists: Float32Array | null = null;
  route: Route | null = null;
  private answer: Answer | null = null;
  playing = false;
  phase = 0;
  amplitude: number = AMPLITUDES[2];
  private poseFactor = 1;
  private last: number | null = null;
  private back = false;

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
    this.route = motion?.course ? new Route(motion.course) : null;
    this.answer = motion?.response ? new Answer(motion.response, this.data.bodies.length) : null;
    this.twists = motion && !motion.course ? floats(motion.twists) : null;
    this.follow();
    this.last = null;
  }

  pose(twists: Float32Array | null, factor: number): void {
    this.motion = null;
    this.route = this.answer = null;
    this.twists = twists;
    this.poseFactor = factor;
  }

  /** Displacement drawn at the largest over displacement stored. */
  get exaggeration(): number {
    if (!this.motion) return this.twists ? this.poseFactor : 0;
    const wanted = this.motion.reach > 0 ? (this.amplitude * this.data.size) / this.motion.reach : 0;
    return this.travels ? Math.max(1, Math.min(wanted, MOST_TURN / Math.max(1e-9, this.route!.turn))) : wanted;
  }

  /** Whether it goes along a path. */
  get travels(): boolean {
    return this.route !== null && !this.route.shakes;
  }

  /** Where on its path it is: a point, or between two. */
  get place(): number {
    return this.curves ? this.phase * (this.curves.points - 1) : 0;
  }

  /** What curves are drawn of: a path, or something that happens over time. */
  get curves(): Course | Response | null {
    return this.travels ? this.route!.course : (this.answer?.response ?? null);
  }

  /** Whether something happens over time. */
  get happens(): boolean {
    return this.answer !== null;
  }

  /** Brings the bodies to where they are now. */
  follow(): void {
    if (this.answer) this.twists = this.answer.at(this.place);
  }

  /** Where everything is, of large displacements. */
  get rows(): Float32Array | null {
    if (!this.route) return null;
    return this.travels ? this.route.at(this.place, this.exaggeration) : this.route.shaken(this.factor);
  }

  /** Part numbers that are beyond a limit here. */
  get beyond(): number[] {
    return this.travels ? (this.route!.course.beyond[Math.round(this.place)] ?? []) : [];
  }

  /** From -1 to 1; deflections go one way. */
  get sense(): number {
    if (!this.motion) return this.twists ? 1 : 0;
    if (this.travels || this.happens) return 1;
    return this.motion.group === "deflection" ? 0.5 - 0.5 * Math.cos(2 * Math.PI * this.phase) : Math.sin(2 * Math.PI * this.phase);
  }

  get factor(): number {
    return this.sense * this.exaggeration;
  }

  /** Phase at which the motion is as far out as it goes. */
  get outmost(): number {
    if (this.travels) return 1;
    if (this.happens) return 0;
    return this.motion?.group === "deflection" ? 0.5 : 0.25;
  }

  /** The time goes on; whether anything moves. */
  step(now: number): boolean {
    const moves = this.playing && this.motion !== null;
    if (moves && this.last !== null && this.travels) this.travel((now - this.last) / 1000 / ACROSS);
    else if (moves && this.last !== null && this.happens) this.phase = (this.phase + (now - this.last) / 1000 / RUN) % 1;
    else if (moves && this.last !== null) this.phase = (this.phase + (now - this.last) / 1000 / SECONDS) % 1;
    this.last = moves ? now : null;
    this.follow();
    return moves;
  }

  private travel(share: number): void {
    this.phase += this.back ? -share : share;
    if (this.phase <= 0 || this.phase >= 1) this.back = this.phase >= 1;
    this.phase = Math.max(0, Math.min(1, this.phase));
  }

  private get there(): string {
    const { course } = this.route!, said = course.said[Math.round(this.place)];
    const times = this.exaggeration, scale = times > 1.005 ? `drawn × ${written(times)}` : "true positions";
    return [scale, said].filter(Boolean).join("; ");
  }

  /** The amplitude beside the slider: how much is exaggerated, or, where the stored size means nothing, how far what moves most is drawn. */
  get words(): string {
    if (!this.motion) return this.twists ? `× ${written(this.poseFactor)}` : "";
    if (this.travels) return this.there;
    if (this.happens) return `exaggerated × ${written(this.exaggeration)}, ideal motions of all bodies`;
    if (this.motion.scaled && !this.route) return `exaggerated × ${written(this.exaggeration)}`;
    return `arbitrary amplitude; largest motion drawn as ${written(1e3 * this.amplitude * this.data.size)} mm`;
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
