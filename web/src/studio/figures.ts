// The right pane: verdicts on one screen; below them figures, old and new, and the pinned designs.

import type { Comparison, Figure, Frequencies, Judgement, Matrix } from "../protocol";
import { byId, change, digits, fill, grouped, h, percent, shown, table } from "./dom";
import type { Studio } from "./studio";

const PINS = ["A", "B", "C"];
const NONE = "No results: the design file has errors, listed below its text.";

/** The requirements: value, limit, and a bar of the margin, full at 50 % to spare. */
export class VerdictTable {
  private readonly root = byId("verdicts");

  constructor(private readonly studio: Studio) {
    studio.verdicts.watch((said) => said && this.show(said.verdicts));
    studio.state.watch(() => this.age());
    this.age();
  }

  private age(): void {
    const { verdicts, state } = this.studio;
    this.root.classList.toggle("aged", verdicts.value !== null && verdicts.value.revision !== state.value?.revision);
    if (verdicts.value === null) fill(this.root, h("h2", {}, "Verdicts"), state.value?.sound === false ? h("p", { className: "poor" }, NONE) : h("p", { className: "quiet" }, "…"));
  }

  private show(verdicts: Judgement[]): void {
    const met = verdicts.filter((each) => each.passed).length;
    const isAll = met === verdicts.length;
    const head = h("h2", {}, "Verdicts ", h("span", { className: isAll ? "pill good" : "pill poor" }, `${met} of ${verdicts.length} met`));
    const rows = verdicts.map((each) => this.row(each));
    const none = h("p", { className: "quiet" }, "There are no verdicts, because the file has no [requirements] table.");
    fill(this.root, head, verdicts.length ? h("table", { className: "verdicts" }, h("tbody", {}, ...rows)) : none);
    this.age();
  }

  private row(each: Judgement): HTMLElement {
    const moved = change(each.value, each.old);
    const title = `${each.key}: ${each.text}${each.point ? ` (${each.point})` : ""}${moved ? `; in the file ${shown(each.old, each)}, now ${moved}` : ""}`;
    return h(
      "tr",
      { className: each.value === null ? "unknown" : each.passed ? "good" : "poor", title, click: () => this.studio.goto(each.line, false) },
      h("th", { scope: "row" }, h("b", { ariaLabel: each.passed ? "met" : "not met" }, each.value === null ? "?" : each.passed ? "✓" : "✗"), "\u00a0", ...named(each.key)),
      ...(each.value === null ? [h("td", { className: "reason", colSpan: 3 }, `${demand(each)}: ${each.reason || "not known"}`)] : this.cells(each)),
    );
  }

  private cells(each: Judgement): HTMLElement[] {
    const bar = h("span", { className: "margin" }, h("i", {}));
    bar.style.setProperty("--margin", String(Math.max(-1, Math.min(1, 2 * (each.margin ?? 0)))));
    const margin = each.margin === null ? "" : percent(each.margin) || "0 %";
    return [h("td", { className: "number" }, shown(each.value, each)), h("td", { className: "quiet limit" }, demand(each)), h("td", { className: "number" }, bar, margin)];
  }
}

/** A key that may break into lines at its dots. */
function named(key: string): (string | HTMLElement)[] {
  return key.split(".").flatMap((word, place) => (place ? [".", h("wbr", {}), word] : [word]));
}

function demand(each: Judgement): string {
  const sign = each.text.includes("at most") || each.text.includes("below") ? "≤" : each.text.includes("at least") ? "≥" : "";
  return `${sign} ${shown(each.limit, each)}`;
}

/** Figures by group: old, new, change, and a column for each pin. */
export class FigureTable {
  private readonly root = byId("pane-figures");
  private readonly body = h("div", {});
  private readonly pins = h("div", { className: "bar" });
  private readonly loading = h("p", { className: "quiet" });
  private readonly cells = new Map<string, HTMLElement>();
  private compared: Comparison | null = null;

  constructor(private readonly studio: Studio) {
    fill(this.root, this.pins, this.loading, this.body);
    studio.figures.watch(() => this.results());
    studio.reach.watch(() => this.results());
    studio.state.watch(() => (this.showPins(), this.age()));
    studio.keptOne.watch(() => this.showPins());
    studio.against.watch(() => (this.showPins(), this.show()));
    studio.connection.on("frequencies", (said) => this.live(said));
    this.showPins();
  }

  private all(): Figure[] {
    return [...(this.studio.figures.value?.figures ?? []), ...(this.studio.reach.value?.figures ?? [])];
  }

  private age(): void {
    const { figures, reach, state } = this.studio;
    const told = [figures.value, reach.value].filter((each) => each !== null);
    this.root.classList.toggle("aged", told.some((each) => each.revision !== state.value?.revision));
    if (!told.length && state.value?.sound === false) fill(this.body, h("p", { className: "poor" }, NONE));
  }

  private async results(): Promise<void> {
    this.show();
    this.age();
    if (!this.studio.state.value?.pins.length) return;
    this.studio.connection.newest("compare", { kind: "compare" }, (said) => {
      if (said.kind === "comparison") this.compared = said;
      this.show();
    });
  }

  private showPins(): void {
    const pins = this.studio.state.value?.pins ?? [];
    const against = this.studio.against.value;
    const pick = h("select", { ariaLabel: "Compare with", change: (event: Event) => this.studio.against.set((event.target as HTMLSelectElement).value) });
    pick.append(new Option("file", "", false, against === ""), ...pins.map((each) => new Option(each, each, false, against === each)));
    fill(this.pins, h("label", {}, "old: ", pick), h("span", { className: "buttons" }, ...[...PINS, ...pins.filter((each) => !PINS.includes(each))].map((name) => this.pin(name, pins.includes(name)))));
  }

  private pin(name: string, isKept: boolean): HTMLElement {
    const title = isKept ? `make ${name} the present design (shift: remove it)` : `pin the present design as ${name}`;
    return h("button", { type: "button", title, className: isKept ? "pressed" : "", click: (event: MouseEvent) => void this.press(name, isKept, event.shiftKey) }, isKept ? name : `pin ${name}`);
  }

  private async press(name: string, isKept: boolean, isAway: boolean): Promise<void> {
    if (isKept && !isAway) await this.studio.ask({ kind: "recall", name });
    else await this.studio.ask({ kind: "pin", name, keep: !isKept });
    if (!isKept) this.studio.keep(name);
    await this.results();
  }

  /** The value of the design that is compared with. */
  private before(figure: Figure): number | null {
    const against = this.studio.against.value;
    return against === "" ? figure.old : this.pinned(figure.name, against);
  }

  private pinned(name: string, design: string): number | null {
    const row = this.compared?.figures.findIndex((each) => each.name === name) ?? -1;
    const column = this.compared?.designs.indexOf(design) ?? -1;
    return this.compared?.values[row]?.[column] ?? null;
  }

  private show(): void {
    const groups = [...grouped(this.all(), (each) => each.group)];
    const { figures, reach } = this.studio;
    const matrices = ([["Stiffness", figures.value?.stiffness], ["Compliance", figures.value?.compliance]] as const).map(([name, each]) => each && folded(name, matrix(each), name === "Stiffness"));
    const missing = Object.entries({ ...figures.value?.missing, ...reach.value?.missing }).map(([name, reason]) => h("p", { className: "quiet" }, h("b", {}, name), ` ${reason}`));
    this.loading.textContent = figures.value?.loading ?? "";
    this.cells.clear();
    const closed = new Set([...this.body.querySelectorAll("details:not([open])")].map((each) => each.getAttribute("data-group")));
    const parts = [...groups.map(([name, rows]) => folded(name, this.table(rows), true)), this.strokes(), this.losses(), ...matrices];
    for (const each of parts) if (each && closed.has(each.getAttribute("data-group"))) each.open = false;
    fill(this.body, ...parts, ...missing);
  }

  private table(rows: Figure[]): HTMLElement {
    const pins = (this.studio.state.value?.pins ?? []).filter((each) => each !== this.studio.against.value && this.compared?.designs.includes(each));
    const head = ["", this.studio.against.value || "old", "new", "change", ...pins];
    return h("div", { className: "wide" }, table(head, rows.map((each) => this.row(each, pins)), pins.length ? "figures many" : "figures"));
  }

  private row(each: Figure, pins: string[]): (string | Node)[] {
    const before = this.before(each);
    const now = h("output", {}, digits(each.value === null ? null : each.value / each.factor));
    now.dataset["figure"] = each.name;
    this.cells.set(each.name, now);
    const name = h("span", {}, each.name, h("small", { className: "quiet" }, each.unit === "1" ? "" : ` ${each.unit}`));
    const old = h("span", { className: "quiet" }, digits(before === null ? null : before / each.factor));
    const others = pins.map((pin) => digits(divided(this.pinned(each.name, pin), each.factor)));
    return [name, old, now, h("small", {}, change(each.value, before)), ...others];
  }

  private strokes(): HTMLDetailsElement | null {
    const axes = new Map(this.studio.state.value?.axes.map((each) => [each.name, each]));
    const rows = (this.studio.reach.value?.strokes ?? []).map((each) => {
      const scale = axes.get(each.coordinate) ?? { unit: "", factor: 1 };
      return [each.coordinate, shown(each.low, scale, 4), shown(each.high, scale, 4), each.limiting];
    });
    return rows.length ? folded("Single-axis strokes", table(["", "from", "to", "limited by"], rows, "figures"), true) : null;
  }

  private losses(): HTMLDetailsElement | null {
    const losses = this.studio.figures.value?.losses ?? [];
    if (!losses.length) return null;
    const rows = losses.map((each) => [each.actuator, digits(each.gain), percent(each.loss, 4).replace("+", ""), this.budget(each.budget)]);
    return folded("Lost motion", table(["", "gain", "loss", "largest"], rows, "figures"), true);
  }

  private budget(shares: Record<string, number>): HTMLElement {
    const most = Object.entries(shares).sort(([, one], [, other]) => Math.abs(other) - Math.abs(one));
    const [first] = most;
    const title = most.slice(0, 12).map(([name, share]) => `${name} ${percent(share)}`).join("\n");
    return h("small", { title }, first ? `${first[0]} ${percent(first[1], 2).replace("+", "")}` : "");
  }

  /**
   * The platform's frequencies while a slider moves, of the stage as it is drawn, in the figures' order. Where those are of the loaded
   * stage, which may have others and more of them, they stand by themselves: no row tells of two stages.
   */
  private live(said: Frequencies): void {
    if (this.studio.figures.value?.loading) return this.drawn(said);
    const keys = this.all().filter((each) => /^frequency\.platform\./.test(each.name) || /platform.*mode|^f\d/.test(each.name));
    for (const [at, each] of keys.entries()) {
      const value = said.frequencies[at];
      const cell = this.cells.get(each.name);
      if (!cell || value === undefined) continue;
      cell.textContent = digits(value);
      cell.classList.add("moving");
    }
  }

  private drawn(said: Frequencies): void {
    const known = said.frequencies.filter((each) => each !== null).map((each) => digits(each));
    fill(this.loading, h("b", {}, "Without permanent load"), ", the platform frequencies at the slider's position are ", h("output", { className: "moving" }, `${known.join(", ")} Hz`), ". The rows below belong to the loaded stage, at the last position where the slider was released.");
  }
}

const divided = (value: number | null, factor: number): number | null => (value === null ? null : value / factor);

function folded(name: string, content: HTMLElement, isOpen: boolean): HTMLDetailsElement {
  const made = h("details", { open: isOpen }, h("summary", {}, name), content);
  made.dataset["group"] = name;
  return made;
}

/** A matrix with the unit of each row over that of each column; the unit of an entry is in its title. Rounding noise is 0. */
export function matrix(each: Matrix): HTMLElement {
  const { unit, rows, columns } = each;
  const of = (at: number, column: number): string => (typeof unit === "string" ? unit : (unit[at]?.[column] ?? ""));
  const cells = each.values.map((row, at) => [
    short(rows[at] ?? ""),
    ...row.map((value, column) => h("span", { title: `${digits(value, 6)} ${of(at, column)}` }, digits(value, 3))),
  ]);
  const found = table(["", ...columns.map(short)], cells, "matrix");
  return h("div", { className: "wide" }, found, h("small", { className: "quiet" }, blocks(each, of)));
}

const short = (name: string): string => name.slice(name.lastIndexOf(".") + 1);

/** The units of a matrix: one, or those of its blocks, rows over columns. */
function blocks({ rows, columns, unit }: Matrix, of: (row: number, column: number) => string): string {
  if (typeof unit === "string") return `Unit: ${unit}`;
  const names = new Map<string, [Set<string>, Set<string>]>();
  rows.forEach((row, at) => columns.forEach((column, place) => {
    const [own, other] = names.get(of(at, place)) ?? [new Set<string>(), new Set<string>()];
    names.set(of(at, place), [own.add(short(row)), other.add(short(column))]);
  }));
  return `Units: ${[...names].map(([name, [own, other]]) => `${[...own].join(" ")} over ${[...other].join(" ")}: ${name}`).join("; ")}`;
}
