// Curves over the points of a path, one small figure each, with a cursor that stands where the picture does. What is beyond a limit is red.

import { written } from "./player";

/** Numbers with as many digits as tell them apart, where they are not the same. */
function apart(ends: number[]): string[] {
  const told = ends.map(written), [low, high] = ends;
  for (let digits = 4; low !== high && told[0] === told[1] && digits <= 6; digits++) told.splice(0, 2, ...ends.map((each) => String(Number(each.toPrecision(digits)))));
  return told;
}
import type { Course, Curve, Response } from "./types";
import { floats } from "./unpack";

const SVG = "http://www.w3.org/2000/svg";
const [WIDE, HIGH] = [100, 40];

/** What changes by less than this share of itself is rounding of what is sent, and drawn flat. */
const ROUNDING = 3e-6;

const STYLE = `
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(150px, 1fr)); gap: 2px 12px; padding: 8px 12px; font: 12px/1.35 system-ui, sans-serif; color: CanvasText; }
:host([hidden]) { display: none; }
figure { margin: 0; min-width: 0; cursor: ew-resize; touch-action: pan-y; }
figcaption { display: flex; justify-content: space-between; gap: 6px; white-space: nowrap; overflow: hidden; }
figcaption span { opacity: 0.72; overflow: hidden; text-overflow: ellipsis; } output { font-variant-numeric: tabular-nums; }
svg { display: block; width: 100%; height: 46px; overflow: visible; }
path { fill: none; stroke: #0f9488; stroke-width: 1.6; vector-effect: non-scaling-stroke; }
.axis { stroke: currentColor; stroke-opacity: 0.25; stroke-width: 1; } .cursor { stroke: #d9117f; stroke-width: 1.4; vector-effect: non-scaling-stroke; }
.beyond { fill: #d03b3b; fill-opacity: 0.2; }
.range { display: flex; justify-content: space-between; opacity: 0.6; font-size: 10px; font-variant-numeric: tabular-nums; }
`;

function line(kind: string, values: Readonly<Record<string, number>>): SVGLineElement {
  const made = document.createElementNS(SVG, "line");
  made.setAttribute("class", kind);
  for (const [name, value] of Object.entries(values)) made.setAttribute(name, value.toFixed(2));
  return made;
}

class Small {
  readonly element = document.createElement("figure");
  private readonly values: Float32Array;
  private readonly told = document.createElement("output");
  private readonly cursor = line("cursor", { x1: 0, x2: 0, y1: 0, y2: HIGH });

  constructor(private readonly curve: Curve, said: string[], private readonly along: (share: number) => void) {
    this.values = floats(curve.values);
    const known = [...this.values].filter(Number.isFinite), low = Math.min(...known), high = Math.max(...known);
    const large = Math.max(Math.abs(low), Math.abs(high)), span = high - low > ROUNDING * large ? high - low : 0;
    const svg = document.createElementNS(SVG, "svg"), path = document.createElementNS(SVG, "path");
    svg.setAttribute("viewBox", `0 0 ${WIDE} ${HIGH}`);
    svg.setAttribute("preserveAspectRatio", "none");
    path.setAttribute("d", this.outline(low, span));
    svg.append(...this.bands(said), line("axis", { x1: 0, x2: WIDE, y1: HIGH, y2: HIGH }), path, this.cursor);
    const caption = document.createElement("figcaption"), name = document.createElement("span"), range = document.createElement("div");
    name.textContent = curve.name.replace(/^platform\./, ""); // its value stands beside it, and both are to be read
    name.title = curve.name;
    caption.append(name, this.told);
    range.className = "range";
    const ends = (known.length ? [low, high] : []).map((each) => (Math.abs(each) > ROUNDING * large ? each : 0));
    range.append(...(span > 0 ? apart(ends) : ends.map(written)).map((each) => Object.assign(document.createElement("span"), { textContent: each.replace("-", "−") })));
    this.element.append(caption, svg, range);
    this.listen(svg);
  }

  private x(point: number): number {
    return (WIDE * point) / Math.max(1, this.values.length - 1);
  }

  private outline(low: number, span: number): string {
    let pen = "M";
    return [...this.values].map((value, point) => {
      if (!Number.isFinite(value)) { pen = "M"; return ""; }
      const y = HIGH - 2 - (span > 0 ? ((HIGH - 4) * (value - low)) / span : 0.5 * HIGH - 2);
      const step = `${pen}${this.x(point).toFixed(2)} ${y.toFixed(2)}`;
      pen = "L";
      return step;
    }).join("");
  }

  private bands(said: string[]): SVGRectElement[] {
    const half = 0.5 * this.x(1);
    return said.flatMap((words, point) => {
      if (!words) return [];
      const made = document.createElementNS(SVG, "rect"), low = Math.max(0, this.x(point) - half), high = Math.min(WIDE, this.x(point) + half);
      const place = { x: low, width: high - low, y: 0, height: HIGH };
      for (const [name, value] of Object.entries(place)) made.setAttribute(name, value.toFixed(2));
      made.setAttribute("class", "beyond");
      return [made];
    });
  }

  private listen(svg: SVGSVGElement): void {
    const go = (event: PointerEvent): void => {
      const box = svg.getBoundingClientRect();
      this.along(Math.max(0, Math.min(1, (event.clientX - box.left) / box.width)));
    };
    svg.addEventListener("pointerdown", (event) => { svg.setPointerCapture(event.pointerId); go(event); });
    svg.addEventListener("pointermove", (event) => { if (event.buttons) go(event); });
  }

  place(point: number): void {
    const x = this.x(point).toFixed(2), low = Math.floor(point), high = Math.min(this.values.length - 1, low + 1);
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
    const value = this.values[low]! + (point - low) * (point > low ? this.values[high]! - this.values[low]! : 0);
    this.told.textContent = Number.isFinite(value) ? `${written(value).replace("-", "−")} ${this.curve.unit}` : "–";
  }
}

export class Curves {
  readonly element = document.createElement("div");
  private readonly root = this.element.attachShadow({ mode: "open" });
  private figures: Small[] = [];

  /** `along` hears where a person drags the cursor, from 0 to 1. */
  constructor(private readonly along: (share: number) => void) {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(STYLE);
    this.root.adoptedStyleSheets = [sheet];
    this.element.className = "curves";
    this.element.hidden = true;
  }

  show(told: Course | Response | null): void {
    const said = told && "said" in told ? told.said : [];
    this.figures = (told?.curves ?? []).map((each) => new Small(each, said, this.along));
    this.root.replaceChildren(...this.figures.map((each) => each.element));
    this.element.hidden = !this.figures.length;
  }

  place(point: number): void {
    for (const each of this.figures) each.place(point);
  }
}
