// Figures of curves are read: a cursor over them tells the values there; peaks and what is marked are points that keep it.

import { written } from "../viewer/player";
import { floats } from "../viewer/unpack";
import { play } from "./play";

const SVG = "http://www.w3.org/2000/svg";

/** A peak is that much above the lowest on both its sides, and a mode belongs to it if it lies that near. */
const [STANDS_OUT, NEAR] = [1.5, 1.02];
const RADIUS = 4;

/** x is a number among what all curves stand over. */
interface Packed { readonly name: string; readonly colour: string; readonly x: number; readonly y: string }
interface Spot { readonly x: number; readonly text: string; readonly y?: number; readonly panel: number; readonly plays?: string }
interface Frame { readonly box: [number, number, number, number]; readonly x: [number, number]; readonly y: [number, number]; readonly log: [boolean, boolean]; readonly name: string }
interface Told { readonly along: string; readonly over: string[]; readonly panels: (Frame & { readonly curves: Packed[] })[]; readonly spots: Spot[] }
interface Curve { readonly name: string; readonly colour: string; readonly x: Float32Array; readonly y: Float32Array }

const made = (kind: string, values: Readonly<Record<string, string | number>>): SVGElement => {
  const found = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(values)) found.setAttribute(name, String(value));
  return found;
};

const signed = (value: number): string => written(value).replace("-", "−");

class Panel {
  readonly cursor: SVGElement;

  constructor(readonly frame: Frame, readonly curves: readonly Curve[]) {
    const [, top, , height] = frame.box;
    this.cursor = made("line", { class: "cursor", y1: top, y2: top + height, visibility: "hidden" });
  }

  holds(x: number, y: number): boolean {
    const [left, top, width, height] = this.frame.box;
    return x >= left && x <= left + width && y >= top && y <= top + height;
  }

  /** The value that stands at a share of the picture's width. */
  along(x: number): number {
    const [left, , width] = this.frame.box, [low, high] = this.frame.x, share = (x - left) / width;
    return this.frame.log[0] ? low * (high / low) ** share : low + share * (high - low);
  }

  place(x: number): number {
    const [left, , width] = this.frame.box, [low, high] = this.frame.x;
    return left + width * (this.frame.log[0] ? Math.log(x / low) / Math.log(high / low) : (x - low) / (high - low));
  }

  height(y: number): number {
    const [, top, , height] = this.frame.box, [low, high] = this.frame.y;
    return top + height * (1 - (this.frame.log[1] ? Math.log(y / low) / Math.log(high / low) : (y - low) / (high - low)));
  }

  /** What a curve is there: straight between its points, as it is drawn. */
  value(curve: Curve, x: number): number {
    const at = curve.x.findIndex((each) => each >= x);
    if (at < 0 || (at === 0 && curve.x[0]! > x)) return NaN;
    if (at === 0) return curve.y[0]!;
    const scale = (value: number, log: boolean): number => (log ? Math.log(value) : value), [one, other] = this.frame.log;
    const from = scale(curve.x[at - 1]!, one), to = scale(curve.x[at]!, one), share = to > from ? (scale(x, one) - from) / (to - from) : 1;
    const low = scale(curve.y[at - 1]!, other), high = scale(curve.y[at]!, other), found = low + share * (high - low);
    return other ? Math.exp(found) : found;
  }

  /** Maxima that stand out of a curve on logarithmic axes, within what is drawn. */
  peaks(curve: Curve): { x: number; y: number }[] {
    const found: { x: number; y: number }[] = [], { x, y } = curve, [low, high] = this.frame.x, [bottom, top] = this.frame.y;
    for (let at = 1; at < y.length - 1; at++) {
      if (!(y[at]! > y[at - 1]! && y[at]! >= y[at + 1]!)) continue;
      let before = at, after = at, left = y[at]!, right = y[at]!;
      while (before > 0 && y[before]! <= y[at]!) left = Math.min(left, y[--before]!);
      while (after < y.length - 1 && y[after]! <= y[at]!) right = Math.min(right, y[++after]!);
      if (y[at]! > STANDS_OUT * Math.max(left, right) && x[at]! > low && x[at]! < high && y[at]! > bottom && y[at]! < top) found.push({ x: x[at]!, y: y[at]! });
    }
    return found;
  }
}

class Reading {
  private readonly panels: Panel[];
  private readonly told = document.createElement("div");
  private kept: number | null = null;

  constructor(private readonly svg: SVGSVGElement, private readonly data: Told) {
    const over = data.over.map(floats);
    this.panels = data.panels.map((each) => new Panel(each, each.curves.map(({ name, colour, x, y }) => ({ name, colour, x: over[x]!, y: floats(y) }))));
    this.told.className = "reading";
    this.told.setAttribute("aria-live", "polite");
    this.rest();
    svg.append(...this.panels.map((each) => each.cursor), ...this.points());
    svg.removeAttribute("role"); // a picture for those who read by ear hides the points in it
    svg.after(this.told);
    svg.addEventListener("pointermove", (event) => this.hover(event));
    svg.addEventListener("pointerleave", () => (this.kept === null ? this.rest() : undefined));
    svg.addEventListener("click", (event) => this.click(event));
  }

  private get unit(): string {
    return /\[(.*)\]/.exec(this.data.along)?.[1] ?? "";
  }

  private points(): SVGElement[] {
    const named = this.data.spots.flatMap((spot) => (spot.y === undefined ? [] : this.point(this.panels[spot.panel], spot.x, spot.y, spot.text)));
    const peaks = this.panels.filter((each) => each.frame.log[1]).flatMap((panel) =>
      panel.curves.flatMap((curve) => panel.peaks(curve).flatMap(({ x, y }) => this.point(panel, x, y, `peak of ${curve.name}: ${this.said(panel, y)} at ${written(x)} ${this.unit}`, curve.colour))));
    return [...peaks, ...named];
  }

  private point(panel: Panel | undefined, x: number, y: number, text: string, colour = "currentColor"): SVGElement[] {
    if (!panel || !panel.holds(panel.place(x), panel.height(y))) return [];
    const point = made("circle", { class: "point", cx: panel.place(x).toFixed(1), cy: panel.height(y).toFixed(1), r: RADIUS, tabindex: 0, role: "button", "aria-label": text });
    (point as SVGElement & { style: CSSStyleDeclaration }).style.setProperty("--colour", colour);
    const title = made("title", {});
    title.textContent = text;
    point.append(title);
    const keep = (event: Event): void => { event.stopPropagation(); this.kept = x; this.show(panel, x, text); };
    point.addEventListener("click", keep);
    point.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); keep(event); } });
    return [point];
  }

  private at(event: MouseEvent): [Panel, number] | null {
    const matrix = this.svg.getScreenCTM();
    if (!matrix) return null;
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    const panel = this.panels.find((each) => each.holds(x, y) && each.curves.length);
    return panel ? [panel, panel.along(x)] : null;
  }

  private hover(event: PointerEvent): void {
    if (this.kept !== null) return;
    const found = this.at(event);
    if (found) this.show(...found);
    else this.rest();
  }

  /** A click keeps the cursor there, the next one lets it go; a finger has no other way. */
  private click(event: MouseEvent): void {
    const found = this.at(event), free = this.kept !== null;
    this.kept = null;
    if (!found || free) return this.rest();
    this.kept = found[1];
    this.show(...found);
  }

  private rest(): void {
    for (const each of this.panels) each.cursor.setAttribute("visibility", "hidden");
    this.told.textContent = "Point at a curve to read its values. Click to fix the cursor, also at a peak.";
  }

  private show(panel: Panel, x: number, text = ""): void {
    const shares = (each: Panel): boolean => String(each.frame.x) === String(panel.frame.x);
    // over frequency, magnitude and phase of a column belong together; over time, every panel is of another motion
    const there = this.panels.filter((each) => each === panel || (panel.frame.log[0] && shares(each) && each.frame.box[0] === panel.frame.box[0]));
    for (const each of this.panels) {
      const isShown = shares(each), at = each.place(x).toFixed(2);
      each.cursor.setAttribute("visibility", isShown ? "visible" : "hidden");
      each.cursor.setAttribute("x1", at);
      each.cursor.setAttribute("x2", at);
    }
    const head = document.createElement("b");
    const own = there.length > 1 || this.panels.length < 2 ? "" : panel.frame.name.replace(/ \[.*\]/, "");
    head.textContent = text || [own, `${written(x)} ${this.unit}`].filter(Boolean).join(", ");
    this.told.replaceChildren(head, ...this.rows(there, x), ...this.button(panel, x));
  }

  /** A curve a row, with its values in all panels above one another. */
  private rows(there: Panel[], x: number): HTMLElement[] {
    const names = new Map(there.flatMap((panel) => panel.curves.map((curve) => [curve.name, curve.colour] as const)));
    return [...names].map(([name, colour]) => {
      const row = document.createElement("span"), sign = document.createElement("i");
      sign.style.background = colour;
      const values = there.flatMap((panel) => panel.curves.filter((each) => each.name === name).map((curve) => this.said(panel, panel.value(curve, x))));
      row.append(sign, `${name} ${values.join(", ")}`);
      return row;
    });
  }

  private said(panel: Panel, value: number): string {
    const unit = /\[(.*)\]/.exec(panel.frame.name)?.[1] ?? "";
    return Number.isFinite(value) ? `${signed(value)}${unit === "°" ? "" : " "}${unit}`.trim() : "–";
  }

  /** What the page's viewer plays near there. */
  private button(panel: Panel, x: number): HTMLElement[] {
    const near = this.data.spots.filter((each) => each.plays && panel.frame.log[0] && Math.max(each.x / x, x / each.x) < NEAR);
    return near.map((spot) => {
      const pressed = document.createElement("button");
      pressed.type = "button";
      pressed.className = "play";
      pressed.textContent = `▶ ${spot.text}`;
      pressed.addEventListener("click", () => play(spot.plays ?? ""));
      return pressed;
    });
  }
}

/** Gives figures whose curves are known a cursor. */
export function addReadings(): void {
  for (const figure of document.querySelectorAll<HTMLElement>("figure[data-reading]")) {
    const svg = figure.querySelector("svg");
    if (svg) new Reading(svg, JSON.parse(figure.dataset["reading"] ?? "") as Told);
  }
}
