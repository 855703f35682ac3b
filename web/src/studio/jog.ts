// Jog: a slider for every actuator and every axis of the platform; the stage bends, gauges read, and what ends the motion is told.

import type { Channel, Motion, Posed } from "../protocol";
import type { Colour, Motion as Drawn, StageData } from "../viewer/types";
import { norm, plus } from "./arrows";
import type { Point } from "./arrows";
import { digits, fill, framewise, h, shown } from "./dom";
import { singles } from "./floats";
import type { StageView } from "./stage";
import type { Studio } from "./studio";

type Row = { channel: Channel; slider: HTMLInputElement; told: HTMLOutputElement; root: HTMLElement };

const STEPS = 500;

export class Jog {
  readonly root = h("div", { className: "strip", id: "jog" });
  private readonly actuators = h("div", { className: "channels" });
  private readonly axes = h("div", { className: "channels" });
  private readonly gauges = h("div", { className: "gauges" });
  private readonly beyond = h("p", { className: "beyond", role: "status" });
  private readonly factor = h("input", { type: "range", min: 0, max: 6, step: 0.01, value: "3", ariaLabel: "Exaggeration", input: () => this.draw() });
  private readonly exaggeration = h("output", {});
  private readonly draw = framewise(() => this.drawNow());
  private rows = new Map<string, Row>();
  private axisRows = new Map<string, Row>();
  private strokes: number[] = [];
  private asked = -1;
  /** Whether the exaggeration follows from what the picture shows. */
  private isFair = false;
  private posed: Posed | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly stage: StageView,
  ) {
    const still = h("button", { type: "button", click: () => this.reset() }, "to zero");
    fill(this.root, this.actuators, this.axes, h("div", { className: "bar" }, still, h("label", {}, "exaggeration ", this.factor), this.exaggeration), this.gauges, this.beyond);
    studio.state.watch(() => this.offer());
    studio.motion.watch(() => this.fresh());
    studio.scene.watch(() => (this.isActive() ? this.draw() : this.isFair || studio.motion.value === null || this.fresh()));
    studio.figures.watch(() => this.isShown() && this.load());
    studio.mode.watch((mode) => mode !== null && this.leave());
    studio.other.watch((other) => other !== null && this.leave());
    studio.painted.watch(() => this.isActive() && this.judge());
    studio.strip.watch((strip) => strip !== "jog" && this.isActive() && this.reset());
  }

  private isShown(): boolean {
    return this.root.offsetParent !== null;
  }

  private isActive(): boolean {
    return this.strokes.some((each) => each !== 0);
  }

  /** Asks for the matrices of the present design, once. */
  load(): void {
    const revision = this.studio.state.value?.revision ?? -1;
    if (revision === this.asked) return;
    this.asked = revision;
    this.studio.connection.newest("jog", { kind: "jog" });
  }

  private offer(): void {
    const state = this.studio.state.value;
    if (!state) return;
    this.rows = this.sliders(this.actuators, state.actuators, this.rows, (at, value) => this.push(at, value));
    this.axisRows = this.sliders(this.axes, state.axes, this.axisRows, (at, value) => this.move(at, value));
    if (this.strokes.length !== state.actuators.length) this.strokes = state.actuators.map(() => 0);
    if (!state.actuators.length) fill(this.beyond, h("span", { className: "quiet" }, "This stage has no actuators: only loads move it."));
  }

  private sliders(parent: HTMLElement, channels: Channel[], held: Map<string, Row>, act: (at: number, value: number) => void): Map<string, Row> {
    const made = new Map(channels.map((channel, at) => [channel.name, held.get(channel.name) ?? slider(channel, (value) => act(at, value))]));
    for (const channel of channels) (made.get(channel.name) as Row).channel = channel;
    if ([...made.keys()].join() !== [...held.keys()].join()) fill(parent, ...[...made.values()].map((each) => each.root));
    return made;
  }

  private fresh(): void {
    const first = !this.isActive();
    if (first) this.factor.value = String(Math.log10(this.fair()));
    this.update();
  }

  /** An exaggeration at which the first actuator's whole stroke moves what it moves most by 6 % of the stage. */
  private fair(): number {
    const { scene } = this.studio;
    const [name, row] = [...this.rows][0] ?? ["", undefined];
    const drawn = scene.value?.motions.find((each) => each.group === "stroke" && each.name === name);
    const reach = (drawn?.reach ?? 0) * Math.abs(this.scale(drawn, 0)) * half(row?.channel);
    this.isFair = reach > 0;
    return reach > 0 ? Math.max(1, Math.min(1e6, (0.06 * (scene.value?.size ?? 0)) / reach)) : 1000;
  }

  private push(at: number, value: number): void {
    this.strokes[at] = value;
    this.moved();
  }

  /** Turns the wish for one axis into strokes; the other axes keep their place. */
  private move(at: number, value: number): void {
    const { value: motion } = this.studio.motion;
    if (!motion?.inputs) return this.studio.tell(motion?.missing["inputs"] ?? "These actuators cannot move the platform along its axes.", true);
    const twist = this.twist(motion);
    twist[at] = value;
    this.strokes = product(motion.inputs.values, twist);
    this.moved();
  }

  /** A step along an axis of the platform: a twentieth of what it can, a hundredth of a millimetre where that is not known. */
  nudge(axis: string, sign: number): void {
    const row = this.axisRows.get(axis);
    const { value: motion } = this.studio.motion;
    if (!row || !motion) return this.load();
    const at = [...this.axisRows.keys()].indexOf(axis);
    this.move(at, (this.twist(motion)[at] ?? 0) + (sign * half(row.channel)) / 20);
  }

  private reset(): void {
    this.leave();
    this.studio.viewer.value?.setPose(null);
  }

  /** All strokes zero; what the picture shows then is left to who comes next. */
  private leave(): void {
    this.studio.connection.drop("pose");
    this.strokes = this.strokes.map(() => 0);
    this.posed = null;
    this.update();
  }

  private moved(): void {
    this.load();
    this.studio.mode.set(null);
    this.studio.other.set(null);
    const names = [...this.rows.keys()];
    const inputs = Object.fromEntries(names.map((name, at) => [name, this.strokes[at] ?? 0]));
    this.update();
    this.studio.connection.newest("pose", { kind: "pose", inputs }, (said) => {
      if (said.kind !== "posed") return;
      this.posed = said;
      this.update();
    });
  }

  private twist(motion: Motion): number[] {
    return product(motion.platform.values, this.strokes);
  }

  private update(): void {
    const { value: motion } = this.studio.motion;
    const twist = motion ? this.twist(motion) : [];
    [...this.rows.values()].forEach((row, at) => place(row, this.strokes[at] ?? 0));
    [...this.axisRows.values()].forEach((row, at) => place(row, twist[at] ?? 0));
    this.read(motion);
    this.judge();
    this.draw();
  }

  private read(motion: Motion | null): void {
    const gauges = this.studio.state.value?.gauges ?? [];
    const linear = motion?.gauges ? product(motion.gauges.values, this.strokes) : [];
    const beyond = this.isActive() ? (this.posed?.beyond ?? {}) : {};
    fill(this.gauges, ...gauges.map((each, at) => h("span", { className: each.name in beyond ? "poor" : "", title: beyond[each.name] ?? "" }, h("b", {}, each.name), ` ${shown(this.reading(each.name, linear[at]), each, 4)}`)));
  }

  private reading(name: string, linear: number | undefined): number | null {
    return linear ?? this.posed?.readings[name] ?? null;
  }

  /** Marks what is beyond its limit, and says which: strokes by themselves, the rest as the server found it. */
  private judge(): void {
    const told: Record<string, string> = this.isActive() ? { ...this.posed?.beyond } : {};
    for (const [name, row] of this.rows) {
      const isOut = outside(row.channel, Number(row.slider.dataset["value"] ?? 0));
      if (isOut) told[name] ??= "stroke limit exceeded";
      row.root.classList.toggle("poor", name in told);
    }
    const isAny = Object.keys(told).length > 0;
    for (const row of this.axisRows.values()) row.root.classList.toggle("poor", isAny && Number(row.slider.dataset["value"]) !== 0);
    if (this.rows.size) fill(this.beyond, ...Object.entries(told).map(([name, each]) => h("span", { className: "poor" }, h("b", {}, name), ` ${each}`)));
    this.paint(told);
  }

  private paint(told: Record<string, string>): void {
    const beyond = Object.keys(told).filter((name) => name in (this.studio.state.value?.links ?? {}));
    const colours = { ...this.stresses(), ...Object.fromEntries(beyond.map((name) => [name, [0.82, 0.16, 0.16] as Colour])) };
    this.studio.viewer.value?.setColours(Object.keys(colours).length ? colours : null);
  }

  /** Links by the share of what is allowed that they bear, where that is to be painted. */
  private stresses(): Record<string, Colour> {
    const allowed = this.studio.motion.value?.allowed ?? {};
    if (!this.isActive() || this.studio.painted.value !== "stress" || !this.posed) return {};
    const shares = Object.entries(this.posed.stress).map(([name, each]) => [name, each / (allowed[name] ?? NaN)] as const);
    return Object.fromEntries(shares.filter(([, share]) => Number.isFinite(share)).map(([name, share]) => [name, warm(share)]));
  }

  private drawNow(): void {
    const factor = 10 ** Number(this.factor.value);
    fill(this.exaggeration, `drawn × ${digits(factor, 3)}`);
    const { viewer, scene, motion } = this.studio;
    if (!this.isActive() || !scene.value) return this.stage.arrows.set("jog", []);
    viewer.value?.setPose(this.pose(scene.value), factor);
    if (motion.value) this.arrows(scene.value, motion.value, factor);
  }

  /** Twists of all bodies: the strokes' motions of the picture, in their shares. */
  private pose(data: StageData): Float32Array {
    const sum = new Float32Array(6 * data.bodies.length);
    [...this.rows.keys()].forEach((name, at) => {
      const drawn = data.motions.find((each) => each.group === "stroke" && each.name === name);
      const times = this.scale(drawn, at) * (this.strokes[at] ?? 0);
      if (!drawn || times === 0) return;
      singles(drawn.twists).forEach((each, place) => (sum[place] = (sum[place] ?? 0) + times * each));
    });
    return sum;
  }

  /** How often a drawn stroke goes into a unit of it: by the platform's turn and translation in both. */
  private scale(drawn: Drawn | undefined, at: number): number {
    const { value: data } = this.studio.scene;
    const { value: motion } = this.studio.motion;
    if (!drawn || !data || !motion) return 0;
    const own = atPoint(singles(drawn.twists).subarray(6 * data.platform, 6 * data.platform + 6), data.reference as Point);
    const real = motion.platform.values.map((row) => row[at] ?? 0);
    const size = data.size / 2;
    const weigh = (twist: readonly number[]): number[] => twist.map((each, n) => (n < 3 ? each : each * size));
    const [a, b] = [weigh(own), weigh(real)];
    const square = a.reduce((sum, each) => sum + each * each, 0);
    return square > 0 ? a.reduce((sum, each, n) => sum + each * (b[n] ?? 0), 0) / square : 0;
  }

  /** Where the ideal stage would go; the picture itself shows where the elastic one goes. */
  private arrows(data: StageData, motion: Motion, factor: number): void {
    const from = data.reference as Point;
    const move = motion.ideal ? product(motion.ideal.values, this.strokes).slice(0, 3) : [];
    const isSeen = norm(move) * factor > 0.01 * data.size;
    this.stage.arrows.set("jog", isSeen ? [{ from, to: plus(from, move, factor), look: "ideal", text: "ideal" }] : []);
  }
}

/** From grey at no stress to red at all that is allowed. */
function warm(share: number): Colour {
  const way = Math.sqrt(Math.min(1, share));
  return [0.76 + 0.06 * way, 0.8 - 0.66 * way, 0.84 - 0.7 * way];
}

function half(channel: Channel | undefined): number {
  const most = Math.max(Math.abs(channel?.low ?? 0), Math.abs(channel?.high ?? 0));
  if (most > 0) return most;
  return channel?.si === "rad" ? 1e-3 : channel?.si === "m" ? 1e-4 : 1;
}

function outside(channel: Channel, value: number): boolean {
  const slack = 1e-9 * half(channel);
  return (channel.high !== null && value > channel.high + slack) || (channel.low !== null && value < channel.low - slack);
}

/** A slider reaches a fifth beyond what is known to end it, so that the end can be felt. */
function slider(channel: Channel, act: (value: number) => void): Row {
  const made = h("input", { type: "range", min: -STEPS, max: STEPS, step: 1, value: "0", ariaLabel: channel.name });
  const told = h("output", {});
  const root = h("label", { className: "channel" }, h("b", {}, channel.name), made, told);
  const row = { channel, slider: made, told, root };
  made.addEventListener("input", () => act(((1.2 * Number(made.value)) / STEPS) * half(row.channel)));
  made.addEventListener("dblclick", () => act(0));
  return row;
}

function place(row: Row, value: number): void {
  row.slider.dataset["value"] = String(value);
  if (document.activeElement !== row.slider) row.slider.value = String(Math.round((STEPS * value) / (1.2 * half(row.channel))));
  fill(row.told, shown(Math.abs(value) < 1e-9 * half(row.channel) ? 0 : value, row.channel, 3));
}

function product(rows: (number | null)[][], vector: readonly number[]): number[] {
  return rows.map((row) => row.reduce<number>((sum, each, at) => sum + (each ?? 0) * (vector[at] ?? 0), 0));
}

/** A twist told at a point: translation there, and the rotation. */
function atPoint(twist: Float32Array, [x, y, z]: Point): number[] {
  const [tx = 0, ty = 0, tz = 0, wx = 0, wy = 0, wz = 0] = twist;
  return [tx + wy * z - wz * y, ty + wz * x - wx * z, tz + wx * y - wy * x, wx, wy, wz];
}
