// What lies over the picture: names, the axes, the scale, and the data of what was picked. Plain elements, so that text stays sharp.

import { Vector3 } from "three";
import type { Camera } from "./camera";
import type { Label, Part, StageData } from "./types";

const SVG = "http://www.w3.org/2000/svg";
const AXES: readonly [string, Vector3][] = [["x", new Vector3(1, 0, 0)], ["y", new Vector3(0, 1, 0)], ["z", new Vector3(0, 0, 1)]];

function make<Name extends keyof HTMLElementTagNameMap>(name: Name, kind: string, text = ""): HTMLElementTagNameMap[Name] {
  const made = document.createElement(name);
  made.className = kind;
  made.textContent = text;
  return made;
}

function fact(name: string, value: string): HTMLElement {
  const row = make("div", "fact");
  row.append(make("dt", "", name), make("dd", "", value));
  return row;
}

const KEYS: readonly [string, string][] = [
  ["drag, shift drag, wheel", "rotate, move, zoom"], ["1 to 9, 0", "play a mode, show at rest"], ["space", "pause or play"], ["[  ]", "amplitude"], ["F", "show all"],
  ["V", "next side"], ["click, again", "select, select the part behind"], ["I", "only its unit"], ["G", "platform translucent"], ["E, T", "strain energy, stress"],
  ["S", "section"], ["L", "names"],
];

export class Overlay {
  readonly element = make("div", "overlay");
  private readonly names = make("div", "names");
  private readonly card = make("div", "card");
  private readonly scale = make("div", "scale");
  private readonly keys = make("div", "card keys");
  private readonly triad = document.createElementNS(SVG, "svg");
  private readonly axes: [SVGLineElement, SVGTextElement][] = [];
  private labels: [Label, HTMLElement][] = [];

  constructor() {
    this.triad.setAttribute("class", "triad");
    this.triad.setAttribute("viewBox", "-34 -34 68 68");
    for (const [name] of AXES) {
      const line = document.createElementNS(SVG, "line"), text = document.createElementNS(SVG, "text");
      line.setAttribute("class", name);
      text.textContent = name;
      this.axes.push([line, text]);
      this.triad.append(line, text);
    }
    this.card.hidden = true;
    this.keys.hidden = true;
    this.keys.append(...KEYS.map(([name, value]) => fact(name, value)));
    this.element.append(this.names, this.triad, this.scale, this.card, this.keys);
  }

  replace(data: StageData): void {
    this.labels = data.labels.map((label) => [label, make("span", `name ${label.kind}`, label.text)]);
    this.names.replaceChildren(...this.labels.map(([, element]) => element));
  }

  toggleKeys(): boolean {
    this.keys.hidden = !this.keys.hidden;
    return !this.keys.hidden;
  }

  showNames(shown: boolean): void {
    this.names.hidden = !shown;
  }

  /** Puts names, axes and scale where they belong; `moved` says where the point of a label is now; null: it is not shown. */
  update(camera: Camera, width: number, height: number, moved: (label: Label) => Vector3 | null): void {
    if (!this.names.hidden) this.placeNames(camera, width, height, moved);
    const turn = camera.eye.quaternion.clone().invert();
    AXES.forEach(([, axis], at) => {
      const seen = axis.clone().applyQuaternion(turn), [line, text] = this.axes[at]!;
      line.setAttribute("x2", (20 * seen.x).toFixed(1));
      line.setAttribute("y2", (-20 * seen.y).toFixed(1));
      text.setAttribute("x", (27 * seen.x).toFixed(1));
      text.setAttribute("y", (-27 * seen.y + 4).toFixed(1));
    });
    const pixel = camera.metresPerPixel(height), long = 0.22 * width * pixel, power = 10 ** Math.floor(Math.log10(long));
    const length = ([5, 2, 1].find((each) => each * power <= long) ?? 1) * power;
    this.scale.style.width = `${(length / pixel).toFixed(1)}px`;
    this.scale.textContent = length >= 1 ? `${+length.toPrecision(2)} m` : length >= 1e-3 ? `${+(1e3 * length).toPrecision(2)} mm` : `${+(1e6 * length).toPrecision(2)} µm`;
  }

  private placeNames(camera: Camera, width: number, height: number, moved: (label: Label) => Vector3 | null): void {
    const taken: [number, number][] = [];
    for (const [label, element] of this.labels) {
      const point = moved(label);
      element.hidden = point === null;
      if (point === null) continue;
      const [x, y] = camera.project(point);
      let [left, top] = [x * width, y * height];
      for (let tries = 0; tries < 6 && taken.some(([a, b]) => Math.abs(a - left) < 22 && Math.abs(b - top) < 14); tries++) top += 14;
      taken.push([left, top]);
      element.style.transform = `translate(${left.toFixed(1)}px, ${top.toFixed(1)}px) translate(-50%, -50%)`;
    }
  }

  /** The data of a part, with further lines; null takes the card away. */
  showCard(part: Part | null, more: [string, string][] = []): void {
    this.card.hidden = part === null;
    if (part === null) return;
    const lines = [...part.facts, ...more].map(([name, value]) => fact(name, value));
    const where = part.address + (part.line === undefined ? "" : `, line ${part.line}`);
    this.card.replaceChildren(make("strong", "", part.name), make("span", "what", part.what.replaceAll("_", " ")), ...lines, make("small", "", where));
  }
}
