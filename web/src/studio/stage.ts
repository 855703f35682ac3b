// The middle: the turning stage, its tools, and arrows over it. Without WebGL the words say so, and everything else lives.

import type { Scene } from "../protocol";
import type { Controller, Picked, StageData } from "../viewer/types";
import { Arrows, norm } from "./arrows";
import type { Point } from "./arrows";
import { byId, digits, fill, h } from "./dom";
import type { Studio } from "./studio";

/** The viewer is a script of its own, which reports carry too; where it did not start, the page lives without. */
declare const flexstage: typeof import("../viewer") | undefined;

const VIEWS = ["iso", "top", "front", "right"] as const;

/** A length in millimetres, to a tenth of a micrometre. */
const mm = (value = 0): string => digits(Math.round(1e7 * value) / 1e4 + 0, 7);

export class StageView {
  readonly arrows: Arrows;
  private readonly told = byId("told");
  private readonly units = h("select", { ariaLabel: "Show one unit alone", change: () => this.viewer?.isolate(this.units.value || null) });
  private readonly cut = h("select", { ariaLabel: "Section", change: () => this.section() });
  private readonly depth = h("input", { type: "range", min: 0, max: 1, step: 0.005, value: "0.5", ariaLabel: "Position of the section plane", hidden: true, input: () => this.section() });
  private readonly measured = h("output", { id: "measured" });
  private first: Point | null = null;
  private readonly toggles = new Map<string, HTMLButtonElement>();
  private isOld = false;
  private second: Controller | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly picked: (name: Picked | null) => void,
  ) {
    this.arrows = new Arrows(byId("views"), studio);
    studio.connection.on("scene", (said) => this.take(said));
    studio.scene.watch((data) => data && this.show(data));
    studio.link.watch((name) => this.viewer?.select(name));
    studio.against.watch(() => this.ghost());
    studio.keptOne.watch(() => this.ghost());
    fill(this.told, "The picture is updated after the figures.");
  }

  private get viewer(): Controller | null {
    return this.studio.viewer.value;
  }

  private take(said: Scene): void {
    this.studio.scene.set(said.data as StageData);
  }

  private show(data: StageData): void {
    this.isOld = false;
    if (this.viewer === null) this.begin(data);
    else if (this.viewer.alive) this.viewer.replace(data);
    if (this.toggles.get("measure")?.getAttribute("aria-pressed") === "true") this.measure(true);
    this.second?.replace(data);
    if (this.viewer?.alive) fill(this.told, data.notes.filter((each) => each.startsWith("drawn ")).join("; "));
    this.offerUnits(data);
    this.ghost();
  }

  private begin(data: StageData): void {
    const made = this.attempt(data);
    if (made === null || !made.alive) return this.without();
    this.studio.viewer.set(made);
    this.tools();
    byId("stage").append(this.measured);
    made.onPick((picked) => this.picked(picked));
    made.select(this.studio.link.value);
  }

  private attempt(data: StageData): Controller | null {
    try {
      return typeof flexstage === "undefined" ? null : flexstage.view(byId("view"), data, { controls: false });
    } catch (error) {
      console.warn("the viewer does not start:", error);
      return null;
    }
  }

  private without(): void {
    document.body.classList.add("flat");
    this.studio.look();
    fill(this.told, "This browser has no WebGL: the stage is not drawn. Numbers, figures, responses and the file work without it; links are selected under Part.");
  }

  private tools(): void {
    this.cut.append(new Option("no section", ""), ...["x", "y", "z"].map((axis) => new Option(`cut ${axis}`, axis)));
    fill(
      byId("tools"),
      this.button("fit", "Fit (F)", () => this.fit()),
      ...VIEWS.map((name) => this.button(name, name, () => this.viewer?.look(name))),
      this.toggle("platform", "translucent platform (G)", (on) => this.viewer?.ghostPlatform(on)),
      this.toggle("names", "names (L)", (on) => this.viewer?.showLabels(on), true),
      this.units,
      this.cut,
      this.depth,
      this.toggle("measure", "distance between two points: click each point; clicks snap to corners", (on) => this.measure(on)),
      this.toggle("old", "show the old design as solid, the new design as ghost (C)", (on) => this.swap(on)),
    );
  }

  /** Clicks give points of the stage at rest, and their distance. */
  private measure(on: boolean): void {
    const { studio } = this;
    if (on) studio.mode.set(null), studio.other.set(null), this.viewer?.setPose(null);
    this.first = null;
    this.arrows.set("measure", []);
    fill(this.measured, on ? "click the first point" : "");
    this.viewer?.onPoint(on ? (point) => this.point(point) : null);
  }

  private point(at: Point | null): void {
    const { first } = this;
    if (at === null) return fill(this.measured, "no surface there: click a part");
    this.first = first ? null : at;
    if (!first) {
      this.arrows.set("measure", [{ from: at, to: at, look: "measure" }]);
      return fill(this.measured, `from (${at.map(mm).join(", ")}) mm: click the second point`);
    }
    const way = at.map((each, axis) => each - (first[axis] ?? 0));
    const text = `${mm(norm(way))} mm`;
    this.arrows.set("measure", [{ from: first, to: at, look: "measure", text }]);
    fill(this.measured, h("b", {}, text), ` x ${mm(way[0])}, y ${mm(way[1])}, z ${mm(way[2])} mm`);
  }

  private button(text: string, title: string, act: () => void): HTMLButtonElement {
    return h("button", { type: "button", title, click: act }, text);
  }

  private toggle(text: string, title: string, act: (on: boolean) => void, isOn = false): HTMLButtonElement {
    const made = this.button(text, title, () => {
      const on = made.getAttribute("aria-pressed") !== "true";
      made.setAttribute("aria-pressed", String(on));
      act(on);
    });
    made.setAttribute("aria-pressed", String(isOn));
    this.toggles.set(text, made);
    return made;
  }

  /** Presses one of the tools, as its key does. */
  press(name: string): void {
    this.toggles.get(name)?.click();
  }

  fit(): void {
    this.viewer?.fit(this.studio.link.value ?? undefined);
  }

  private offerUnits(data: StageData): void {
    const units = [...new Set(data.parts.map((each) => each.unit).filter((each) => each !== undefined))];
    if (this.units.options.length === units.length + 1) return;
    this.units.replaceChildren(new Option("all units", ""), ...units.map((each) => new Option(each)));
  }

  private section(): void {
    const axis = (this.cut.value || null) as "x" | "y" | "z" | null;
    this.depth.hidden = axis === null;
    this.viewer?.section(axis, Number(this.depth.value));
  }

  /** The stage that is compared with; none where it is the present one. */
  private other(): StageData | null {
    const kept = this.studio.kept.get(this.studio.against.value)?.scene ?? null;
    return kept === this.studio.scene.value ? null : kept;
  }

  private ghost(): void {
    const { viewer } = this;
    if (!viewer?.alive) return;
    const other = this.other();
    viewer.showGhost(this.isOld ? this.studio.scene.value : other);
    const button = this.toggles.get("old");
    if (button) button.disabled = other === null && !this.isOld;
  }

  private swap(toOld: boolean): void {
    const data = toOld ? this.other() : this.studio.scene.value;
    if (!data) return;
    this.isOld = toOld;
    this.viewer?.replace(data);
    this.ghost();
    byId("stage").classList.toggle("shows-old", toOld);
  }

  /** Shows a second picture beside the first, or takes it away. */
  beside(on: boolean): Controller | null {
    const place = byId("second");
    place.hidden = !on;
    this.studio.besides.set(on);
    const data = this.studio.scene.value;
    if (on && !this.second && data && this.viewer?.alive) this.second = flexstage?.view(place, data, { controls: false }) ?? null;
    setTimeout(() => [this.viewer, this.second].forEach((each) => each?.fit()), 100); // when both have their new size
    return on ? this.second : null;
  }
}
