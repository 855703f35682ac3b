// The left pane: every number of the design with its slider, its field, its formula, and the effect of one per cent.

import type { Amount, Frequencies, Slopes } from "../protocol";
import { byId, change, digits, fill, grouped, h, percent, rested, shown } from "./dom";
import type { Studio } from "./studio";

const STEPS = 1000;
const REST = 40; // ms without a move, then the whole design is computed
const WORTH = 800; // ms without a new design, then what its numbers buy is asked: every number's derivative takes longer than the rest
const FINE = 0.05; // of the pointer's way with shift

/** The ends of a slider. They stay while its value lies between them, or once a person has set them. */
interface Range {
  low: number;
  high: number;
  isSet: boolean;
}

interface Row {
  amount: Amount;
  range: Range;
  root: HTMLElement;
  slider: HTMLInputElement;
  field: HTMLInputElement;
  buys: HTMLElement;
  was: HTMLButtonElement;
  formula: HTMLElement;
  ends: HTMLInputElement[];
  /** The text that was refused last. */
  refused: string;
}

type Order = "file" | "worth" | "least" | "changed";

const EFFECT = "effect of 1 %";

export class Numbers {
  private readonly rows = new Map<string, Row>();
  private readonly list = h("div", { id: "amounts" });
  private readonly effect = h("button", { type: "button", className: "effect", click: () => this.sort() }, EFFECT);
  private readonly filter = h("input", { type: "search", id: "filter", placeholder: "find  /", ariaLabel: "Find a number", input: () => this.sift() });
  private readonly order = h("select", { ariaLabel: "Order", change: () => this.layout() });
  private readonly count = h("output", { className: "quiet" });
  private held: string | null = null;
  private layoutOf = "";

  constructor(private readonly studio: Studio) {
    this.order.append(new Option("as in the file", "file"), new Option("largest effect", "worth"), new Option("smallest effect", "least"), new Option("changed first", "changed"));
    const heads = h("div", { className: "amount heads", ariaLabel: "columns" }, h("span", {}, "number"), h("span", {}, "slider"), h("span", { className: "right" }, "value"), this.effect);
    fill(byId("numbers"), h("div", { className: "bar" }, h("h2", {}, "Numbers"), this.filter, this.order), heads, this.list, h("div", { className: "bar foot" }, this.count));
    studio.state.watch(() => (this.update(), this.explain()));
    studio.slopes.watch((said) => (said && this.buy(said), this.explain()));
    studio.verdicts.watch(rested(WORTH, () => studio.connection.newest("derive", { kind: "derive" })));
    studio.connection.on("frequencies", (said) => this.warn(said));
  }

  find(): void {
    this.filter.focus();
    this.filter.select();
  }

  /** Shows the numbers at these addresses: scrolls to the first, marks all. */
  reveal(addresses: string[]): void {
    for (const [address, row] of this.rows) row.root.classList.toggle("selected", addresses.includes(address));
    const first = addresses.map((each) => this.rows.get(each)).find((each) => each !== undefined);
    const table = first?.root.closest("details");
    if (table) table.open = true;
    if (first?.root.offsetParent) first.root.scrollIntoView({ block: "nearest" });
  }

  private update(): void {
    const state = this.studio.state.value;
    if (!state) return;
    const named = new Set(state.amounts.map((each) => each.address));
    for (const [address, row] of this.rows) if (!named.has(address)) this.rows.delete(address), row.root.remove();
    for (const amount of state.amounts) this.show(this.rows.get(amount.address) ?? this.row(amount), amount);
    this.layout();
  }

  /** The meaning of the last column, and whether its values belong to the present text. */
  private explain(): void {
    const { state, slopes } = this.studio;
    const [numbers, changed, said] = [state.value?.amounts.length ?? 0, state.value?.changed ?? 0, slopes.value];
    const isOld = said !== null && !this.studio.isPresent(said.revision);
    this.list.classList.toggle("aged", isOld);
    const meaning = said === null ? "computed after the results" : said.worst ? `change of the margin of ${said.worst}${isOld ? ", of an earlier text" : ""}` : `unknown: ${said.missing["worst"] ?? ""}`;
    this.effect.title = `${EFFECT} of a number: ${meaning}. Click: sort.`;
    this.effect.setAttribute("aria-sort", this.order.value === "worth" ? "descending" : this.order.value === "least" ? "ascending" : "none");
    fill(this.count, `${numbers} numbers${changed ? `, ${changed} changed` : ""}. Effect of 1 %: ${meaning}.`);
  }

  /** Largest effect first, then smallest first, then as in the file. */
  private sort(): void {
    const next: Record<Order, Order> = { file: "worth", changed: "worth", worth: "least", least: "file" };
    this.order.value = next[this.order.value as Order];
    this.layout();
  }

  private row(amount: Amount): Row {
    const address = amount.address;
    const slider = h("input", { type: "range", min: 0, max: STEPS, step: 1, tabIndex: -1, ariaLabel: `${address}, slider` });
    const field = h("input", { type: "text", spellcheck: false, autocomplete: "off", ariaLabel: address });
    const buys = h("span", { className: "buys" });
    const was = h("button", { type: "button", className: "was", title: "restore the file's value" });
    const name = h("button", { type: "button", className: "name", title: address }, address.slice(amount.group.length).replace(/^\./, "") || address);
    const formula = h("span", { className: "formula" });
    const ends = ["low", "high"].map((each) => h("input", { type: "text", spellcheck: false, ariaLabel: `${address}, ${each} end of the slider` }));
    const more = h("label", { className: "ends" }, "slider from ", ...ends.flatMap((each, at) => (at ? [" to ", each] : [each])));
    const root = h("div", { className: "amount" }, name, slider, field, buys, formula, more, was);
    root.dataset["address"] = address;
    const row = { amount, range: fresh(amount), root, slider, field, buys, was, formula, ends, refused: "" };
    this.rows.set(address, row);
    this.wire(row, name);
    return row;
  }

  private wire(row: Row, name: HTMLButtonElement): void {
    const { slider, field, was } = row;
    const address = row.amount.address;
    const rest = rested(REST, () => this.rest(row));
    let isHeld = false;
    const done = (moved: boolean): void => {
      isHeld = false;
      if (moved) this.rest(row);
    };
    slider.addEventListener("pointerdown", (event) => ((isHeld = true), grasp(slider, event, done)));
    slider.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
    slider.addEventListener("input", () => (this.drag(row), isHeld || rest()));
    slider.addEventListener("change", () => isHeld && done(true));
    field.addEventListener("keydown", (event) => this.type(row, event));
    field.addEventListener("blur", () => this.enter(row));
    was.addEventListener("click", () => row.amount.old !== null && this.studio.ask({ kind: "rest", address, value: row.amount.old }));
    name.addEventListener("click", () => this.choose(row));
    for (const each of row.ends) each.addEventListener("change", () => this.bound(row));
  }

  private choose(row: Row): void {
    const isOpen = row.root.classList.toggle("open");
    this.reveal([row.amount.address]);
    this.studio.goto(row.amount.line, false);
    if (isOpen) this.show(row, row.amount);
  }

  /** Ends of a slider as typed: numbers in the unit of the value, or with that unit. */
  private bound(row: Row): void {
    const { amount, ends } = row;
    const [low = NaN, high = NaN] = ends.map((each) => read(each.value, amount.unit) * amount.factor);
    const isSound = Number.isFinite(low) && Number.isFinite(high) && low < high;
    for (const each of ends) each.classList.toggle("bad", !isSound);
    const got = ends.map((each) => `"${each.value}"`).join(" and ");
    if (!isSound) return this.studio.tell(`${amount.address}: the ends of the slider must be two numbers${amount.unit && ` in ${amount.unit}`}, the lower one first (got ${got}).`, true);
    row.range = { low, high, isSet: true };
    this.show(row, amount);
  }

  private at(row: Row): number {
    const { low, high } = row.range;
    return low + (Number(row.slider.value) / STEPS) * (high - low);
  }

  private drag(row: Row): void {
    const value = this.at(row);
    this.held = row.amount.address;
    row.field.value = shown(value, row.amount);
    row.root.classList.remove("bad");
    this.studio.connection.newest("drag", { kind: "drag", address: row.amount.address, value });
  }

  /** Writes the number at the slider's place: one step of undo for a whole drag. */
  private rest(row: Row): void {
    this.studio.connection.drop("drag");
    const value = Number(digitsOf(this.at(row) / row.amount.factor)) * row.amount.factor;
    this.studio.connection.newest("rest", { kind: "rest", address: row.amount.address, value }, (said) => {
      this.held = null;
      if (said.kind === "refusal") this.show(row, row.amount);
    });
  }

  private type(row: Row, event: KeyboardEvent): void {
    if (event.key === "Enter") this.enter(row);
    else if (event.key === "Escape") row.field.value = stated(row.amount);
    else if (event.key === "ArrowUp" || event.key === "ArrowDown") this.step(row, event.key === "ArrowUp" ? 1 : -1, event.shiftKey);
    else return;
    if (event.key.startsWith("Arrow")) event.preventDefault();
  }

  /** One hundredth of the slider's range; with shift a tenth of that. */
  private step(row: Row, sign: number, fine: boolean): void {
    row.slider.value = String(Number(row.slider.value) + sign * (fine ? 1 : 10));
    row.slider.dispatchEvent(new Event("input"));
  }

  private async enter(row: Row): Promise<void> {
    const text = row.field.value.trim();
    if (text === stated(row.amount) || text === row.refused || row.amount.address === this.held) return;
    const said = await this.studio.ask({ kind: "set", address: row.amount.address, text });
    row.refused = said.kind === "refusal" ? text : "";
    row.root.classList.toggle("bad", said.kind === "refusal");
    row.field.title = said.kind === "refusal" ? said.problems.map((each) => each.what).join(" ") : "";
  }

  private show(row: Row, amount: Amount): void {
    row.amount = amount;
    const isHeld = this.held === amount.address;
    const isTyped = document.activeElement === row.field && row.root.classList.contains("bad");
    if (!isHeld && !isTyped) {
      if (!row.range.isSet && !(row.range.low <= amount.value && amount.value <= row.range.high)) row.range = fresh(amount);
      row.field.value = stated(amount);
      row.slider.value = String(Math.round((STEPS * (amount.value - row.range.low)) / (row.range.high - row.range.low || 1)));
      row.root.classList.remove("bad");
    }
    const { low, high } = row.range;
    row.slider.disabled = high <= low || amount.formula !== null;
    row.slider.title = `${shown(low, amount)} to ${shown(high, amount)}. Shift: finer steps. Click the name to set this range.`;
    for (const [at, each] of row.ends.entries()) if (document.activeElement !== each) each.value = shown(at ? high : low, amount);
    fill(row.formula, amount.formula ? `= ${amount.formula}` : "");
    const isChanged = amount.old !== null && amount.old !== amount.value;
    row.root.classList.toggle("changed", isChanged);
    fill(row.was, isChanged ? `was ${shown(amount.old, amount)}  ${change(amount.value, amount.old)}` : "");
    row.field.title = amount.formula ? `${amount.formula} = ${shown(amount.value, amount)}` : amount.tag;
  }

  private buy(said: Slopes): void {
    const worth = new Map(said.slopes.map((each) => [each.address, each]));
    const most = Math.max(...said.slopes.map((each) => Math.abs(each.worst ?? 0)), 1e-12);
    for (const [address, row] of this.rows) {
      const slope = worth.get(address);
      const gain = slope?.worst ?? null;
      fill(row.buys, gain === null || Math.abs(gain) < 5e-5 ? "" : percent(gain, 2).replace(" %", ""));
      row.buys.title = gain === null ? "" : `an increase by 1 % changes the margin of ${said.worst} by ${percent(gain)}`;
      row.buys.dataset["gain"] = String(gain ?? 0);
      row.buys.style.setProperty("--share", String(Math.abs(gain ?? 0) < 0.04 * most ? 0 : Math.abs(gain ?? 0) / most));
      row.buys.classList.toggle("minus", (gain ?? 0) < 0);
    }
    if (this.isSorted) this.layout();
  }

  private get isSorted(): boolean {
    return this.order.value === "worth" || this.order.value === "least";
  }

  /** Tables with their rows: `[numbers]` first, as they determine the others. */
  private ordered(): [string, Row[]][] {
    const rows = [...(this.studio.state.value?.amounts ?? [])].map((each) => this.rows.get(each.address)).filter((each) => each !== undefined);
    const order = this.order.value as Order;
    const sign = order === "least" ? -1 : 1;
    if (this.isSorted) return [[`for ${this.studio.slopes.value?.worst || "the worst requirement"}`, rows.sort((one, other) => sign * (gain(other) - gain(one)))]];
    const tables = grouped(rows, (row) => (order === "changed" && row.root.classList.contains("changed") ? "changed" : row.amount.group));
    const rank = (name: string): number => (name === "changed" ? 2 : name === "numbers" ? 1 : 0);
    return [...tables].sort(([one], [other]) => rank(other) - rank(one));
  }

  /** Tables and rows in their order; nothing moves where nothing is new, so that what is typed and dragged stays. */
  private layout(): void {
    const tables = this.ordered();
    const wanted = tables.map(([name, rows]) => `${name}:${rows.map((row) => row.amount.address).join()}`).join("|");
    if (wanted !== this.layoutOf) {
      const closed = new Set([...this.list.querySelectorAll("details:not([open])")].map((each) => each.getAttribute("data-table")));
      fill(this.list, ...tables.map(([name, rows]) => folder(name, rows, !closed.has(name), this.isSorted)));
      this.layoutOf = wanted;
    }
    this.sift();
    this.explain();
  }

  private sift(): void {
    const words = this.filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const [address, row] of this.rows) {
      const text = `${address} ${row.amount.tag} ${row.amount.unit}`.toLowerCase();
      row.root.hidden = !words.every((word) => text.includes(word));
    }
    for (const each of this.list.querySelectorAll("details")) {
      const hasAny = each.querySelector(".amount:not([hidden])") !== null;
      each.hidden = !hasAny;
      if (words.length && hasAny) each.open = true;
    }
  }

  /** What a slider's place is refused for. */
  private warn(said: Frequencies): void {
    const row = this.rows.get(said.address);
    row?.root.classList.toggle("bad", said.problems.length > 0);
    if (said.problems.length) this.studio.tell(said.problems.map((each) => each.what).join(" "), true);
  }
}

const gain = (row: Row): number => Math.abs(Number(row.buys.dataset["gain"] ?? 0));

function digitsOf(value: number): string {
  return value.toPrecision(5);
}

/** What a field shows: the text of the file; of a dependent number, its value. */
const stated = (amount: Amount): string => (amount.formula === null ? amount.text : shown(amount.value, amount, 6));

const fresh = ({ low, high }: Amount): Range => ({ low, high, isSet: false });

/** A number that may be followed by a unit, which must be this one; else not a number. */
function read(text: string, unit: string): number {
  const [, number = "", own = ""] = /^\s*(\S+?)\s*([^\d.\s].*)?$/.exec(text.replace("−", "-")) ?? [];
  return number && (own.trim() === "" || own.trim() === unit) ? Number(number) : NaN;
}

/** Moves a slider by the way of the pointer, from where it is: a click changes nothing, and shift makes the way twenty times finer. */
function grasp(slider: HTMLInputElement, event: PointerEvent, done: (moved: boolean) => void): void {
  if (!event.isTrusted || event.button !== 0 || slider.disabled) return;
  event.preventDefault();
  slider.focus();
  slider.setPointerCapture(event.pointerId);
  let [place, last] = [Number(slider.value), event.clientX];
  const start = place, gain = STEPS / Math.max(1, slider.clientWidth - 16); // the thumb has 16 pixels
  const move = (next: PointerEvent): void => {
    place = Math.max(0, Math.min(STEPS, place + (next.clientX - last) * gain * (next.shiftKey ? FINE : 1)));
    last = next.clientX;
    if (Math.round(place) === Number(slider.value)) return;
    slider.value = String(Math.round(place));
    slider.dispatchEvent(new Event("input"));
  };
  const end = (): void => {
    slider.removeEventListener("pointermove", move);
    slider.removeEventListener("lostpointercapture", end);
    done(Number(slider.value) !== start);
  };
  slider.addEventListener("pointermove", move);
  slider.addEventListener("lostpointercapture", end);
}

/** An address that may be broken behind its dots and underscores. */
function broken(address: string): (string | Node)[] {
  return address.split(/(?<=[._])/).flatMap((each) => [each, h("wbr")]);
}

const LONG = 24; // letters of a name that has a row of its own

function folder(name: string, rows: Row[], isOpen: boolean, isWhole: boolean): HTMLElement {
  for (const row of rows) {
    const [label] = row.root.getElementsByClassName("name");
    const short = row.amount.address.slice(row.amount.group.length).replace(/^[./]/, "");
    const name = isWhole ? row.amount.address : short || row.amount.address;
    if (label) fill(label as HTMLElement, ...broken(name));
    row.root.classList.toggle("long", isWhole || name.length > LONG);
  }
  const made = h("details", { open: isOpen }, h("summary", {}, name || "stage", h("span", { className: "quiet" }, ` ${digits(rows.length)}`)), ...rows.map((row) => row.root));
  made.dataset["table"] = name;
  return made;
}
