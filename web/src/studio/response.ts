// Frequency responses: the present design's solid, the one it is compared with dashed; a click near a peak plays that mode.
// Curves that are zero but for rounding are not drawn; the legend lists them.

import uPlot from "uplot";
import type { AlignedData, Axis, Options, Scale, Series } from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Curve, Figures, ModeShape } from "../protocol";
import { floats } from "./floats";
import { byId, digits, fill, framewise, h } from "./dom";
import type { Studio } from "./studio";

const NEAR = 24; // pixels between a click and the mode that is meant
const NOISE = 1e-8; // of the largest curve, where the plot ends: what is smaller is rounding noise of the solve

export class Responses {
  private readonly root = h("div", { id: "curves" });
  private readonly input = h("select", { ariaLabel: "input", change: () => this.choose() });
  private readonly output = h("select", { ariaLabel: "output", change: () => this.choose() });
  private readonly told = h("span", { className: "quiet cursor" });
  private readonly values = h("div", { className: "values", hidden: true });
  private readonly redraw = framewise(() => this.draw());
  private plots: uPlot[] = [];
  private curves: Curve[] = [];
  private channels = "";

  constructor(private readonly studio: Studio) {
    const bar = h("div", { className: "bar" }, h("h2", {}, "Response"), h("label", {}, "from ", this.input), h("label", {}, "to ", this.output), this.told);
    fill(byId("response"), bar, this.root);
    studio.figures.watch(this.redraw);
    studio.mode.watch(this.redraw);
    studio.against.watch(this.redraw);
    studio.state.watch(() => this.offer());
    new ResizeObserver(this.redraw).observe(this.root);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", this.redraw);
  }

  private offer(): void {
    const state = this.studio.state.value;
    const channels = JSON.stringify([state?.inputs, state?.outputs]);
    if (!state || channels === this.channels) return;
    this.channels = channels;
    for (const [select, names] of [[this.input, state.inputs], [this.output, state.outputs]] as const) {
      select.replaceChildren(new Option(select === this.input ? "first actuator" : "platform", ""), ...names.map((each) => new Option(each)));
    }
  }

  private choose(): void {
    const inputs = this.input.value ? [this.input.value] : [];
    const outputs = this.output.value ? [this.output.value] : [];
    this.studio.connection.newest("respond", { kind: "respond", inputs, outputs, low: null, high: null });
  }

  private draw(): void {
    for (const each of this.plots) each.destroy();
    this.plots = [];
    const present = this.studio.figures.value;
    this.curves = this.significant(present?.curves ?? []);
    if (!present?.frequency || !this.curves.length || this.root.clientWidth < 40) {
      fill(this.root, h("p", { className: "quiet" }, present?.missing["curves"] ?? present?.missing["response"] ?? (present?.curves.length ? "These outputs do not respond to this input." : "No response yet.")));
      return;
    }
    const other = this.studio.kept.get(this.studio.against.value)?.figures ?? null;
    const before = other === present ? null : other;
    fill(this.root, this.values);
    this.values.hidden = true;
    const height = Math.max(this.root.clientHeight, 150);
    const phase = Math.round(0.38 * height);
    this.name(present, before);
    this.root.ariaLabel = `Magnitude [${units(this.curves)}] and phase [deg] over frequency [Hz]`;
    this.plots = [this.plot(present, before, "magnitude", height - phase), this.plot(present, before, "phase", phase)];
  }

  /** Curves above rounding noise. Rotations are compared by the motion that they cause at the edge of the stage. */
  private significant(curves: Curve[]): Curve[] {
    const arm = (this.studio.scene.value?.size ?? 0.2) / 2;
    const sizes = curves.map((each) => Math.max(...floats(each.magnitude)) * (each.unit.startsWith("rad") ? arm : 1));
    const most = Math.max(...sizes);
    return curves.filter((_, at) => (sizes[at] ?? 0) > NOISE * most).slice(0, COLOURS);
  }

  private plot(present: Figures, before: Figures | null, what: "magnitude" | "phase", height: number): uPlot {
    const { curves } = this;
    const old = curves.map((each) => before?.curves.find((one) => one.input === each.input && one.output === each.output) ?? null);
    const [along, ...values] = aligned(present, before, curves, old, what);
    const series: Series[] = [{}, ...curves.map((each, at) => line(each, at, false)), ...old.filter((each) => each !== null).map((each, at) => line(each, at, true))];
    const options: Options = {
      width: this.root.clientWidth,
      height,
      legend: { show: false },
      cursor: { sync: { key: "response" }, points: { size: 6 }, drag: { x: false, y: false } },
      scales: { x: { time: false, distr: 3, range: (_, low, high) => [low, high] }, y: scale(what) },
      axes: [
        { ...axis(what === "phase" ? 24 : 8, what === "phase" ? spell : () => [], what === "phase" ? "Frequency [Hz]" : ""), ...logarithmic },
        { ...axis(50, spell, what === "phase" ? "Phase [deg]" : `Magnitude [${units(curves)}]`), ...(what === "phase" ? { splits: () => [-180, 0, 180] } : logarithmic) },
      ],
      series,
      hooks: { draw: [(plot) => this.modes(plot, what)], setCursor: [(plot) => this.tell(plot, curves)], ready: [(plot) => this.listen(plot)] },
    };
    return new uPlot(options, [along, ...values] as AlignedData, this.root);
  }

  private listen(plot: uPlot): void {
    plot.over.addEventListener("click", () => this.play(plot));
    plot.over.addEventListener("mouseleave", () => (this.values.hidden = true));
  }

  /** The platform's modes, else all that are listed. */
  private listed(): ModeShape[] {
    const modes = this.studio.figures.value?.modes ?? [];
    const own = modes.filter((each) => each.platform);
    return own.length ? own : modes;
  }

  private play(plot: uPlot): void {
    const at = plot.cursor.left ?? -1;
    const distances = this.listed().map((each) => ({ each, away: Math.abs(plot.valToPos(each.frequency, "x") - at) }));
    const [nearest] = distances.sort((one, other) => one.away - other.away);
    if (nearest && nearest.away < NEAR) this.studio.mode.set(nearest.each.number);
  }

  private modes(plot: uPlot, what: string): void {
    const { ctx, bbox } = plot;
    const style = getComputedStyle(this.root);
    ctx.save();
    ctx.setLineDash([]);
    let free = -1e9;
    for (const mode of this.listed()) {
      const x = plot.valToPos(mode.frequency, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      const isPlaying = mode.number === this.studio.mode.value;
      ctx.strokeStyle = style.getPropertyValue(isPlaying ? "--accent" : "--edge");
      ctx.lineWidth = (isPlaying ? 2 : 1) * devicePixelRatio;
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      if (what !== "magnitude" || x < free) continue;
      ctx.fillStyle = style.getPropertyValue(isPlaying ? "--accent" : "--quiet");
      ctx.font = `${10 * devicePixelRatio}px sans-serif`;
      const [left, foot] = [x + 2 * devicePixelRatio, bbox.top + 10 * devicePixelRatio];
      ctx.strokeStyle = style.getPropertyValue("--paper");
      ctx.lineWidth = 4 * devicePixelRatio;
      ctx.strokeText(String(mode.number), left, foot);
      ctx.fillText(String(mode.number), left, foot);
      free = x + 14 * devicePixelRatio;
    }
    ctx.restore();
  }

  /** The legend: each curve in words with its unit, and which are omitted. */
  private name(present: Figures, before: Figures | null): void {
    const names = this.curves.flatMap((each, at) => [h("span", {}, h("i", { className: `curve-${at}` }), `${worded(each)} [${unit(each)}]`)]);
    const absent = present.curves.filter((each) => !this.curves.includes(each));
    const zero = absent.length ? h("span", { title: "values below 1e-8 of the largest curve are rounding noise" }, `Zero: ${absent.map((each) => spoken(each.output)).join(", ")}`) : null;
    const old = before && h("span", {}, h("i", { className: "dashed" }), this.studio.against.value || "file");
    fill(this.told, ...names, old, zero);
    this.told.title = this.told.textContent ?? "";
  }

  private tell(plot: uPlot, curves: Curve[]): void {
    const at = plot.cursor.idx;
    const along = at === null || at === undefined ? undefined : plot.data[0][at];
    const [magnitude, phase] = this.plots;
    if (at === null || at === undefined || along === undefined || !magnitude || !phase) return;
    const values = curves.map((each, n) => h("div", {}, h("i", { className: `curve-${n}` }), `${worded(each)} ${digits(magnitude.data[n + 1]?.[at], 4)} ${unit(each)}, ${digits(phase.data[n + 1]?.[at], 4)}°`));
    fill(this.values, h("b", {}, `${digits(along)} Hz`), ...values);
    this.values.hidden = false;
    this.values.classList.toggle("away", (plot.cursor.left ?? 0) > plot.over.clientWidth / 2);
  }
}

/** All curves along the present frequencies; the older ones by the nearest of their own. */
function aligned(present: Figures, before: Figures | null, curves: Curve[], old: (Curve | null)[], what: "magnitude" | "phase"): number[][] {
  const along = present.frequency ? floats(present.frequency) : [];
  const theirs = before?.frequency ? floats(before.frequency) : [];
  const others = old.filter((each) => each !== null).map((each) => interpolated(along, theirs, floats(each[what])));
  return [along, ...curves.map((each) => floats(each[what])), ...others];
}

/** Values of a curve at other places, straight between its own; outside of them nothing. */
function interpolated(along: number[], own: number[], values: number[]): number[] {
  let at = 0;
  return along.map((place) => {
    while (at < own.length - 2 && (own[at + 1] ?? 0) < place) at += 1;
    const [low, high] = [own[at] ?? NaN, own[at + 1] ?? NaN];
    const share = (place - low) / (high - low);
    const inside = share >= -1e-9 && share <= 1 + 1e-9;
    return inside ? (1 - share) * (values[at] ?? NaN) + share * (values[at + 1] ?? NaN) : (null as unknown as number);
  });
}

const COLOURS = 6;

const WORDS: Readonly<Record<string, string>> = { x: "x", y: "y", z: "z", rx: "rotation x", ry: "rotation y", rz: "rotation z", fx: "force x", fy: "force y", fz: "force z", mx: "moment x", my: "moment y", mz: "moment z" };

/** A channel in words: `platform.rx` is "platform rotation x". */
function spoken(channel: string): string {
  const [place, component] = [channel.slice(0, channel.lastIndexOf(".")), channel.slice(channel.lastIndexOf(".") + 1)];
  return place && WORDS[component] ? `${place} ${WORDS[component]}` : channel;
}

const INPUTS: Readonly<Record<string, string>> = { m: "stroke of ", N: "force of ", A: "current of ", V: "voltage of " };

/** A curve in words: "platform x per stroke of B1". */
function worded(curve: Curve): string {
  const per = curve.unit === "1" || curve.unit === "rad/m" ? "m" : (curve.unit.split("/")[1] ?? "");
  const kind = curve.input.includes(".") ? "" : (INPUTS[per] ?? "");
  return `${spoken(curve.output)} per ${kind}${spoken(curve.input)}`;
}

const unit = (curve: Curve): string => (curve.unit === "1" ? "m/m" : curve.unit);

const units = (curves: Curve[]): string => [...new Set(curves.map(unit))].join(", ");

const colour = (at: number): (() => string) => () => getComputedStyle(document.documentElement).getPropertyValue(`--curve-${at % COLOURS}`);

function line(curve: Curve, at: number, isOld: boolean): Series {
  return { label: worded(curve), stroke: colour(at), width: isOld ? 1 : 1.6, pxAlign: 0, points: { show: false }, ...(isOld ? { dash: [5, 4] } : {}) };
}

/** Magnitudes over eight decades below the largest; what is less is rounding noise of the solve. */
function scale(what: string): Scale {
  return what === "magnitude" ? { distr: 3, range: (_, low, high) => [Math.max(low, high * NOISE), high * 1.5] } : { range: [-190, 190] };
}

/** Powers of ten between two values, with twice and five times where there are few, and every second or third where there are many. */
function decades(low: number, high: number): number[] {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const step = Math.max(1, Math.ceil((last - first) / 5));
  const parts = last - first <= 3 ? [1, 2, 5] : [1];
  const powers = Array.from({ length: Math.floor((last - first) / step) + 1 }, (_, at) => 10 ** (first + at * step));
  return powers.flatMap((power) => parts.map((part) => part * power)).filter((each) => each >= low && each <= high);
}

const logarithmic: Pick<Axis, "splits" | "filter"> = { splits: (_, __, low, high) => decades(low, high), filter: (_, all) => all };

function axis(size: number, values: Axis["values"], label: string): Axis {
  const ink = (): string => getComputedStyle(document.documentElement).getPropertyValue("--quiet");
  const edge = (): string => getComputedStyle(document.documentElement).getPropertyValue("--faint");
  return { stroke: ink, size, font: "10px sans-serif", ...(label ? { label, labelSize: 15, labelGap: 0, labelFont: "10px sans-serif" } : {}), grid: { stroke: edge, width: 1 }, ticks: { show: false }, ...(values ? { values } : {}) };
}

/** Powers of ten and what lies between as far as there is room. */
function spell(_: uPlot, splits: number[]): string[] {
  return splits.map((each) => (each === null ? "" : digits(each, 3)));
}
