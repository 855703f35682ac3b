// The list of motions, the player's sliders and the buttons beside the picture.

import { AMPLITUDES, type Player } from "./player";
import type { Motion, MotionGroup, StageData } from "./types";

const HEADS: Readonly<Record<MotionGroup, string>> = {
  mode: "Modes", stroke: "One actuator at a time", axis: "Ideal motions of the platform", deflection: "Under permanent load", drift: "Thermal drift", response: "Over time, in the loop", path: "Along a load path",
  state: "Small motions about a state",
};

/** What the buttons do; the viewer gives it. */
export interface Acts {
  choose(motion: Motion | null): void;
  play(): void;
  scrub(phase: number): void;
  amplify(step: number): void;
  fit(): void;
  toggle(what: Toggle): boolean;
  turn(): void;
  cut(place: number): void;
}

export type Toggle = "platform" | "names" | "energy" | "stress" | "section" | "unit" | "keys";
const TOGGLES: readonly [Toggle, string, string][] = [
  ["platform", "Platform", "Draw the platform translucent or solid (G)"],
  ["names", "Names", "Names of actuators and gauges (L)"],
  ["energy", "Energy", "Colour links by their fraction of the strain energy (E)"],
  ["stress", "Stress", "Colour links by their stress utilisation under strokes and loads (T)"],
  ["section", "Section", "Cut the stage open (S); press again for another plane"],
  ["unit", "Unit", "Show only the unit of the selected part (I)"],
  ["keys", "?", "List of the keys (?)"],
];

function button(text: string, title: string, act: () => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.title = title;
  made.addEventListener("click", act);
  return made;
}

function slider(name: string, most: number, step: string, act: (value: number) => void): [HTMLLabelElement, HTMLInputElement] {
  const label = document.createElement("label"), input = document.createElement("input");
  input.type = "range";
  input.min = "0";
  input.max = String(most);
  input.step = step;
  input.setAttribute("aria-label", name);
  input.addEventListener("input", () => act(Number(input.value)));
  label.textContent = name;
  return [label, input];
}

export class Panel {
  readonly element = document.createElement("div");
  private readonly list = document.createElement("ul");
  private readonly words = document.createElement("div");
  private readonly notes = document.createElement("div");
  private readonly play: HTMLButtonElement;
  private readonly phase: HTMLInputElement;
  private readonly phaseName: HTMLLabelElement;
  private readonly amplitude: HTMLInputElement;
  private readonly cutRow: [HTMLLabelElement, HTMLInputElement];
  private readonly toggles = new Map<Toggle, HTMLButtonElement>();
  private readonly buttons = new Map<Motion | null, HTMLButtonElement>();

  constructor(private readonly acts: Acts) {
    this.element.className = "panel";
    this.list.className = "motions";
    this.words.className = "words";
    const player = document.createElement("div"), tools = document.createElement("div");
    player.className = "play";
    tools.className = "tools";
    const [phaseName, phase] = slider("Phase", 1, "0.005", (value) => acts.scrub(value));
    const [amplitudeName, amplitude] = slider("Amplitude", AMPLITUDES.length - 1, "1", (value) => acts.amplify(value));
    [this.phase, this.phaseName, this.amplitude] = [phase, phaseName, amplitude];
    this.cutRow = slider("Section", 1, "0.01", (value) => acts.cut(value));
    player.append(phaseName, phase, amplitudeName, amplitude, this.words, ...this.cutRow);
    this.showCut(null, 0.5);
    this.play = button("Pause", "Play or pause (space)", () => acts.play());
    tools.append(this.play, button("Fit", "Show all (F)", () => acts.fit()), button("View", "Next standard view (V)", () => acts.turn()));
    for (const [what, text, title] of TOGGLES) {
      const made = button(text, title, () => this.press(what));
      made.setAttribute("aria-pressed", String(what === "platform" || what === "names"));
      this.toggles.set(what, made);
      tools.append(made);
    }
    this.element.append(this.list, player, tools, this.notes);
  }

  press(what: Toggle): void {
    this.toggles.get(what)?.setAttribute("aria-pressed", String(this.acts.toggle(what)));
  }

  /** Shows a button as pressed, or not. */
  hold(what: Toggle, held: boolean): void {
    this.toggles.get(what)?.setAttribute("aria-pressed", String(held));
  }

  /** The slider of the plane, which stands there while there is one. */
  showCut(axis: "x" | "y" | "z" | null, place: number): void {
    for (const each of this.cutRow) each.hidden = axis === null;
    if (axis !== null) this.cutRow[0].textContent = `Section ${axis}`;
    this.cutRow[1].value = String(place);
  }

  replace(data: StageData): void {
    this.buttons.clear();
    const rows: HTMLLIElement[] = [this.row(null, "At rest")];
    let group: MotionGroup | null = null;
    for (const motion of data.motions) {
      if (motion.group !== group) {
        group = motion.group;
        const head = document.createElement("li");
        head.className = "head";
        head.textContent = HEADS[group];
        rows.push(head);
      }
      rows.push(this.row(motion, motion.label));
    }
    this.list.replaceChildren(...rows);
    this.notes.replaceChildren(...data.notes.map((note) => {
      const line = document.createElement("p");
      line.className = "note";
      line.textContent = note;
      return line;
    }));
  }

  private row(motion: Motion | null, text: string): HTMLLIElement {
    const made = document.createElement("li");
    const press = button(text, motion?.remark ?? "", () => this.acts.choose(motion));
    this.buttons.set(motion, press);
    made.append(press);
    return made;
  }

  /** `painted` says what the links' colours mean. */
  update(player: Player, painted: string): void {
    for (const [motion, each] of this.buttons) each.setAttribute("aria-pressed", String(motion === player.motion));
    this.play.textContent = player.playing ? "Pause" : "Play";
    this.phaseName.textContent = player.travels ? "Stroke" : "Phase";
    this.phase.value = String(player.phase);
    const place = AMPLITUDES.findIndex((each) => each >= player.amplitude - 1e-9);
    this.amplitude.value = String(place < 0 ? AMPLITUDES.length - 1 : place);
    this.words.classList.toggle("red", player.travels && (player.route!.course.said[Math.round(player.place)] ?? "") !== "");
    this.words.textContent = [player.words, player.motion?.remark, painted].filter(Boolean).join("; ");
  }
}
