// The left pane: every number of the design with its slider, its field and what it buys.

import type { Amount, Frequencies, Slopes } from "../protocol";
import { byId, change, digits, fill, grouped, h, percent, rested, shown } from "./dom";
import type { Studio } from "./studio";

const STEPS = 1000;
const REST = 40; // ms without a move, then the whole design is computed
const WORTH = 800; // ms without a new design, then what its numbers buy is asked: every number's derivative takes longer than the rest
const HELD = 160; // ms as long as the pointer holds the slider, so that a slow hand does not write at every step

interface Row {
  amount: Amount;
  root: HTMLElement;
  slider: HTMLInputElement;
  field: HTMLInputElement;
  buys: HTMLElement;
  was: HTMLButtonElement;
  /** The text that was refused last. */
  refused: string;
}

type Order = "file" | "worth" | "changed";

export class Numbers {
  private readonly rows = new Map<string, Row>();
  private readonly list = h("div", { id: "amounts" });
  private readonly filter = h("input", { type: "search", id: "filter", placeholder: "find  /", ariaLabel: "Find a number", input: () => this.sift() });
  private readonly order = h("select", { ariaLabel: "Order", change: () => this.layout() });
  private readonly count = h("output", { className: "quiet" });
  private held: string | null = null;
  private layoutOf = "";

  constructor(private readonly studio: Studio) {
    this.order.append(new Option("as in the file", "file"), new Option("by sensitivity", "worth"), new Option("changed first", "changed"));
    fill(byId("numbers"), h("div", { className: "bar" }, h("h2", {}, "Numbers"), this.filter, this.order), this.list, h("div", { className: "bar foot" }, this.count));
    studio.state.watch(() => this.update());
    studio.slopes.watch((said) => said && this.buy(said));
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
    fill(this.count, `${state.amounts.length} numbers`, state.changed ? `, ${state.changed} changed` : "");
  }

  private row(amount: Amount): Row {
    const address = amount.address;
    const slider = h("input", { type: "range", min: 0, max: STEPS, step: 1, tabIndex: -1, ariaLabel: `${address}, slider` });
    const field = h("input", { type: "text", spellcheck: false, autocomplete: "off", ariaLabel: address });
    const buys = h("span", { className: "buys" });
    const was = h("button", { type: "button", className: "was", title: "restore the file's value" });
    const name = h("button", { type: "button", className: "name", title: address }, address.slice(amount.group.length).replace(/^\./, "") || address);
    const root = h("div", { className: "amount" }, name, slider, field, buys, was);
    root.dataset["address"] = address;
    const row = { amount, root, slider, field, buys, was, refused: "" };
    this.rows.set(address, row);
    this.wire(row, name);
    return row;
  }

  private wire(row: Row, name: HTMLButtonElement): void {
    const { slider, field, was } = row;
    const address = row.amount.address;
    const [rest, held] = [rested(REST, () => this.rest(row)), rested(HELD, () => this.rest(row))];
    let isHeld = false;
    slider.addEventListener("pointerdown", () => (isHeld = true));
    slider.addEventListener("input", () => this.drag(row, isHeld ? held : rest));
    slider.addEventListener("change", () => ((isHeld = false), rest.now() || held.now()));
    field.addEventListener("keydown", (event) => this.type(row, event));
    field.addEventListener("blur", () => this.enter(row));
    was.addEventListener("click", () => row.amount.old !== null && this.studio.ask({ kind: "rest", address, value: row.amount.old }));
    name.addEventListener("click", () => this.choose(row));
  }

  private choose(row: Row): void {
    this.reveal([row.amount.address]);
    this.studio.goto(row.amount.line, false);
  }

  private at(row: Row): number {
    const { low, high } = row.amount;
    return low + (Number(row.slider.value) / STEPS) * (high - low);
  }

  private drag(row: Row, rest: () => void): void {
    const value = this.at(row);
    this.held = row.amount.address;
    row.field.value = shown(value, row.amount);
    row.root.classList.remove("bad");
    this.studio.connection.newest("drag", { kind: "drag", address: row.amount.address, value });
    rest();
  }

  private rest(row: Row): void {
    this.studio.connection.drop("drag");
    const value = Number(digitsOf(this.at(row) / row.amount.factor)) * row.amount.factor;
    this.studio.connection.newest("rest", { kind: "rest", address: row.amount.address, value }, () => (this.held = null));
  }

  private type(row: Row, event: KeyboardEvent): void {
    if (event.key === "Enter") this.enter(row);
    else if (event.key === "Escape") row.field.value = row.amount.text;
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
    if (text === row.amount.text || text === row.refused || row.amount.address === this.held) return;
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
      row.field.value = amount.text;
      row.slider.value = String(Math.round((STEPS * (amount.value - amount.low)) / (amount.high - amount.low || 1)));
      row.root.classList.remove("bad");
    }
    row.slider.disabled = amount.high <= amount.low || amount.formula !== null;
    row.slider.title = `${shown(amount.low, amount)} to ${shown(amount.high, amount)}`;
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
      row.buys.title = gain === null ? "" : `one per cent more changes the margin of ${said.worst} by ${percent(gain)}`;
      row.buys.dataset["gain"] = String(gain ?? 0);
      row.buys.style.setProperty("--share", String(Math.abs(gain ?? 0) / most));
      row.buys.classList.toggle("minus", (gain ?? 0) < 0);
    }
    this.order.title = `change of the margin of ${said.worst} by one per cent of a number [%]`;
    if (this.order.value === "worth") this.layout();
  }

  private ordered(): [string, Row[]][] {
    const rows = [...(this.studio.state.value?.amounts ?? [])].map((each) => this.rows.get(each.address)).filter((each) => each !== undefined);
    const order = this.order.value as Order;
    if (order === "worth") return [[`for ${this.studio.slopes.value?.worst || "the worst requirement"}`, rows.sort((one, other) => gain(other) - gain(one))]];
    const tables = grouped(rows, (row) => (order === "changed" && row.root.classList.contains("changed") ? "changed" : row.amount.group));
    return [...tables].sort(([one], [other]) => Number(other === "changed") - Number(one === "changed"));
  }

  /** Tables and rows in their order; nothing moves where nothing is new, so that what is typed and dragged stays. */
  private layout(): void {
    const tables = this.ordered();
    const wanted = tables.map(([name, rows]) => `${name}:${rows.map((row) => row.amount.address).join()}`).join("|");
    if (wanted !== this.layoutOf) {
      const closed = new Set([...this.list.querySelectorAll("details:not([open])")].map((each) => each.getAttribute("data-table")));
      fill(this.list, ...tables.map(([name, rows]) => folder(name, rows, !closed.has(name), this.order.value === "worth")));
      this.layoutOf = wanted;
    }
    this.sift();
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

/** An address that may be broken behind its dots. */
function broken(address: string): (string | Node)[] {
  return address.split(/(?<=\.)/).flatMap((each) => [each, h("wbr")]);
}

const LONG = 18; // letters of a name that has a row of its own

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
