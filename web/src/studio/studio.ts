// What all panes share: the connection, the newest of every kind of result, and what is selected.

import type { Figures, Motion, Reach, Said, Slopes, State, Verdicts } from "../protocol";
import type { Controller, MotionKey, StageData } from "../viewer/types";
import { Cell } from "./cell";
import type { Connection, Question } from "./connection";
import { sentence } from "./dom";

export class Studio {
  readonly state = new Cell<State | null>(null);
  readonly figures = new Cell<Figures | null>(null);
  readonly verdicts = new Cell<Verdicts | null>(null);
  readonly reach = new Cell<Reach | null>(null);
  readonly slopes = new Cell<Slopes | null>(null);
  readonly motion = new Cell<Motion | null>(null);
  readonly scene = new Cell<StageData | null>(null);
  /** The link that is selected (`B1/front`). */
  readonly link = new Cell<string | null>(null);
  /** The number of the mode that plays; null: the stage is still, or jogged. */
  readonly mode = new Cell<number | null>(null);
  /** A load or a change of temperature that plays instead. */
  readonly other = new Cell<MotionKey | null>(null);
  /** What the links are painted by. */
  readonly painted = new Cell<"energy" | "stress" | null>(null);
  /** The pane of the right column. */
  readonly tab = new Cell<string>("figures");
  /** Whether a second picture stands beside the first. */
  readonly besides = new Cell<boolean>(false);
  /** What the strip below the picture shows. */
  readonly strip = new Cell<string>("modes");
  /** A line of the text to go to, with a count so that the same line can be asked for twice. */
  readonly line = new Cell<{ line: number; focus: boolean }>({ line: 0, focus: false });
  /** The design that the present one is compared with: "" is the file. */
  readonly against = new Cell<string>("");
  /** What a person is told: text, and whether it is bad. */
  readonly notice = new Cell<{ text: string; bad: boolean }>({ text: "", bad: false });
  readonly viewer = new Cell<Controller | null>(null);
  /** Results of the file and of pinned designs that this page has seen, by name ("" is the file). */
  readonly kept = new Map<string, { scene: StageData | null; figures: Figures | null }>();
  readonly keptOne = new Cell<number>(0);

  private looked = "";

  constructor(readonly connection: Connection) {
    connection.on("state", (said) => this.take(said));
    connection.on("figures", (said) => this.figures.set(said));
    connection.on("verdicts", (said) => this.verdicts.set(said));
    connection.on("reach", (said) => this.reach.set(said));
    connection.on("slopes", (said) => this.slopes.set(said));
    connection.on("motion", (said) => this.motion.set(said));
    connection.on("refusal", (said) => this.tell(said.problems.map((each) => `${each.where}: ${sentence(each)}`).join(" "), true));
    for (const each of [this.viewer, this.tab, this.mode, this.other, this.besides, this.strip, connection.state]) each.watch(() => this.look());
    this.figures.watch(() => this.keepFile());
    this.scene.watch(() => this.keepFile());
  }

  /** Another text in another file is another design: the page begins anew. */
  private take(said: State): void {
    const before = this.state.value;
    if (before && before.file !== said.file && before.text !== said.text) location.reload();
    else this.state.set(said);
  }

  /** Tells the server what is shown, where that changed: nothing else is computed after a change. */
  look(): void {
    const { viewer, tab, mode, other, besides, strip } = this;
    const moves = mode.value !== null || other.value !== null || besides.value || strip.value === "jog";
    const drawn = viewer.value?.alive !== false && !document.body.classList.contains("flat");
    const panes = (["stage", "motions", "reach"] as const).filter((each) => ({ stage: drawn, motions: drawn && moves, reach: tab.value === "figures" })[each]);
    const isOpen = this.connection.state.value === "open";
    if (isOpen && panes.join() !== this.looked) this.connection.newest("look", { kind: "look", panes: [...panes] });
    this.looked = isOpen ? panes.join() : "";
  }

  ask(question: Question): Promise<Said> {
    return this.connection.ask(question);
  }

  tell(text: string, bad = false): void {
    if (text) this.notice.set({ text, bad });
  }

  /** Whether a pane of results may show this: it belongs to the text as it is. */
  isPresent(revision: number): boolean {
    return revision === this.state.value?.revision;
  }

  /** Whether the text has no error and what is shown of it is of the text as it is. */
  get isCurrent(): boolean {
    const { state, figures, verdicts } = this;
    return state.value?.sound === true && [figures.value, verdicts.value].every((each) => each !== null && this.isPresent(each.revision));
  }

  goto(line: number | null | undefined, focus = true): void {
    if (line) this.line.set({ line, focus });
  }

  /** Keeps the present results under a name. */
  keep(name: string): void {
    this.kept.set(name, { scene: this.scene.value, figures: this.figures.value });
    this.keptOne.set(this.keptOne.value + 1);
  }

  private keepFile(): void {
    const state = this.state.value;
    if (state && state.saved && state.sound) this.keep("");
  }
}
