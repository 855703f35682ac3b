// Elements, and numbers as people read them.

type Child = Node | string | null | undefined | false;
type Values = Record<string, string | number | boolean | null | undefined | ((event: never) => void)>;

/** An element: functions become listeners, what the element has as a property is set so, the rest are attributes. */
export function h<K extends keyof HTMLElementTagNameMap>(tag: K, values: Values = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(values)) assign(made, name, value);
  made.append(...children.filter((each): each is Node | string => each !== null && each !== undefined && each !== false));
  return made;
}

function assign(made: HTMLElement, name: string, value: Values[string]): void {
  if (value === null || value === undefined || value === false) return;
  if (typeof value === "function") made.addEventListener(name, value as EventListener);
  else if (name in made && name !== "list" && name !== "form") (made as unknown as Record<string, unknown>)[name] = value;
  else made.setAttribute(name, value === true ? "" : String(value));
}

/** The element of the page that carries this id. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (found === null) throw new Error(`The page has no element ${id}.`);
  return found as T;
}

export function fill(parent: Element, ...children: Child[]): void {
  parent.replaceChildren(...children.filter((each): each is Node | string => each !== null && each !== undefined && each !== false));
}

/** Five digits, as the tables of flexstage print them; a dash where it is not known. */
export function digits(value: number | null | undefined, figures = 5): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  const text = size !== 0 && (size >= 1e6 || size < 1e-4) ? tidy(value.toExponential(figures - 1)) : String(Number(value.toPrecision(figures)));
  return text.replace("-", "−");
}

function tidy(text: string): string {
  return text.replace(/\.?0*e/, "e").replace("e+", "e");
}

/** A value of SI in the unit it is shown in; without `figures` as many as tables have. */
export function shown(value: number | null | undefined, scale: { unit: string; factor: number }, figures = 5): string {
  if (value === null || value === undefined) return "–";
  const number = digits(value / scale.factor, figures);
  return scale.unit && scale.unit !== "1" ? `${number} ${scale.unit}` : number;
}

/** A change in per cent with its sign; nothing where it is below what five digits show. */
export function change(now: number | null, before: number | null): string {
  if (now === null || before === null || before === 0) return "";
  return percent(now / before - 1);
}

export function percent(share: number | null, figures = 3): string {
  if (share === null || !Number.isFinite(share)) return "";
  if (Math.abs(share) < 5e-6) return "";
  const text = `${digits(100 * share, figures)} %`;
  return share > 0 ? `+${text}` : text;
}

/** A table of text with a head; cells are text or elements. */
export function table(head: string[], rows: (string | Node)[][], name = ""): HTMLTableElement {
  return h(
    "table",
    { className: name },
    h("thead", {}, h("tr", {}, ...head.map((each) => h("th", { scope: "col" }, each)))),
    h("tbody", {}, ...rows.map((row) => h("tr", {}, ...row.map((cell, at) => h(at === 0 ? "th" : "td", at === 0 ? { scope: "row" } : {}, cell))))),
  );
}

/** What is called often, at most once a frame. */
export function framewise(act: () => void): () => void {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      act();
    });
  };
}

/** What is called once after `wait` milliseconds of rest; `now` calls what waits. */
export function rested(wait: number, act: () => void): { (): void; now: () => boolean } {
  let timer: number | undefined;
  const due = (): void => {
    timer = undefined;
    act();
  };
  const call = (): void => {
    clearTimeout(timer);
    timer = setTimeout(due, wait) as unknown as number;
  };
  const now = (): boolean => {
    if (timer === undefined) return false;
    clearTimeout(timer);
    due();
    return true;
  };
  return Object.assign(call, { now });
}

/** Values by what `key` says of them, in the order they are met. */
export function grouped<T>(values: Iterable<T>, key: (value: T) => string): Map<string, T[]> {
  const found = new Map<string, T[]>();
  for (const value of values) {
    const name = key(value);
    const group = found.get(name);
    if (group) group.push(value);
    else found.set(name, [value]);
  }
  return found;
}

/** A finding in words: what was found, and what to do. */
export function sentence(each: { what: string; advice: string }): string {
  return [each.what, each.advice].filter(Boolean).join(". ");
}
