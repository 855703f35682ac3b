// Forms from a JSON Schema: an entry for each value with its default, tables as groups. What is left empty keeps its default.

import { fill, h } from "./dom";

export interface Schema {
  $ref?: string;
  $defs?: Record<string, Schema>;
  const?: unknown;
  default?: unknown;
  description?: string;
  enum?: unknown[];
  examples?: unknown[];
  type?: string;
  minItems?: number;
  items?: Schema | false;
  prefixItems?: Schema[];
  additionalProperties?: Schema | boolean;
  oneOf?: Schema[];
  anyOf?: Schema[];
  properties?: Record<string, Schema>;
  required?: string[];
}

export type Value = string | number | boolean | Value[] | Table;
export interface Table {
  [key: string]: Value;
}

/** An entry: what a person sees, and the value that differs from the default; a table has the entries of its keys. */
export interface Entry {
  root: HTMLElement;
  value: () => Value | undefined;
  show?: (value: Value | undefined) => void;
  keys?: () => Map<string, Entry>;
}

const LEFT_OUT = ["format", "tags"];

export class Form {
  constructor(private readonly root: Schema) {}

  /** The schema of a table of the file. */
  table(name: string): Schema {
    return this.resolved(this.root.properties?.[name] ?? {});
  }

  private resolved(schema: Schema): Schema {
    const name = schema.$ref?.split("/").at(-1);
    return name === undefined ? schema : { ...this.root.$defs?.[name], ...(schema.description ? { description: schema.description } : {}) };
  }

  /** The entries of a table but those left out. */
  entries(schema: Schema, without: string[] = []): Map<string, Entry> {
    const found = Object.entries(schema.properties ?? {}).filter(([name]) => ![...LEFT_OUT, ...without].includes(name));
    return new Map(found.flatMap(([name, each]) => { const made = this.entry(name, this.resolved(each)); return made ? [[name, made]] : []; }));
  }

  private entry(name: string, schema: Schema): Entry | null {
    const tables = (schema.oneOf ?? []).map((each) => this.resolved(each)).filter((each) => each.properties);
    if (tables.length) return this.choice(name, schema, tables);
    const texts = typeof schema.additionalProperties === "object" && schema.additionalProperties.type === "string";
    if (texts && !Object.keys(schema.properties ?? {}).length) return named(name, schema);
    if (schema.properties) return this.group(name, schema);
    if (schema.type === "object" || (schema.items && schema.items.$ref)) return null; // tables of any name, lists of tables: written in the file
    if (schema.items && schema.items.enum && schema.default === undefined) return several(name, schema, schema.items.enum.map(String));
    if (schema.const !== undefined) return { root: h("span", { hidden: true }), value: () => schema.const as Value };
    return single(name, schema);
  }

  /** A table: closed, and absent while nothing in it is filled in. */
  private group(name: string, schema: Schema): Entry {
    const entries = this.entries(schema);
    const root = h("details", {}, h("summary", { title: schema.description ?? "" }, name), ...[...entries.values()].map((each) => each.root));
    return shownTable(root, entries);
  }

  /** One of several tables, by their kinds. */
  private choice(name: string, schema: Schema, tables: Schema[]): Entry {
    const kinds = tables.map((each, at) => String(each.properties?.["kind"]?.const ?? each.description?.split(/[.:]/)[0] ?? at));
    const body = h("div", {});
    let entries = new Map<string, Entry>();
    const pick = h("select", { ariaLabel: name, change: () => {
      const table = tables[pick.selectedIndex - 1];
      entries = table ? this.entries(table) : new Map<string, Entry>();
      fill(body, ...[...entries.values()].map((each) => each.root));
    } });
    pick.append(new Option("default", ""), ...kinds.map((each) => new Option(each, each)));
    return { root: h("details", {}, h("summary", { title: schema.description ?? "" }, name), h("label", {}, h("span", {}, "kind"), pick), body), value: () => filled(entries) };
  }
}

/** The values of a table that differ from their defaults, with what distinguishes its kind if there are any; else nothing. */
export function filled(entries: Map<string, Entry>): Table | undefined {
  const found = [...entries].flatMap(([name, each]) => { const value = each.value(); return value === undefined ? [] : [[name, value] as const]; });
  return found.length ? Object.fromEntries(found) : undefined;
}

/** A table with its entries; it keeps what has none. */
export function shownTable(root: HTMLElement, entries: Map<string, Entry>): Entry {
  let rest: Table = {};
  const show = (value: Value | undefined): void => {
    const table = value !== undefined && isTable(value) ? value : {};
    rest = Object.fromEntries(Object.entries(table).filter(([name]) => !entries.has(name)));
    for (const [name, each] of entries) each.show?.(table[name]);
    if (root instanceof HTMLDetailsElement) root.open ||= value !== undefined;
  };
  const value = (): Table | undefined => {
    const found = { ...rest, ...filled(entries) };
    return Object.keys(found).length ? found : undefined;
  };
  return { root, value, show, keys: () => entries };
}

/** A table of texts under any names: a row for each. */
function named(name: string, schema: Schema): Entry {
  const list = h("div", {});
  let rows: { key: HTMLInputElement; entry: Entry }[] = [];
  const add = (key: string, value?: Value): void => {
    const entry = single("limit", { examples: ["at least 500 Hz"] });
    const field = h("input", { type: "text", value: key, spellcheck: false, ariaLabel: "key", placeholder: "key" });
    const row = { key: field, entry };
    const remove = h("button", { type: "button", title: "remove", ariaLabel: "remove", click: () => ((rows = rows.filter((each) => each !== row)), entry.root.remove(), list.dispatchEvent(new Event("change", { bubbles: true }))) }, "×");
    entry.root.firstElementChild?.replaceWith(field);
    entry.root.append(remove);
    entry.show?.(value);
    rows.push(row);
    list.append(entry.root);
  };
  const root = h("details", {}, h("summary", { title: schema.description ?? "" }, name), list, h("button", { type: "button", click: () => add("") }, "one more"));
  const keys = (): Map<string, Entry> => new Map(rows.map(({ key, entry }) => [key.value.trim(), entry] as const).filter(([key]) => key));
  const show = (value: Value | undefined): void => {
    rows = [];
    fill(list);
    for (const [key, each] of Object.entries(value !== undefined && isTable(value) ? value : {})) add(key, each);
    root.open ||= rows.length > 0;
  };
  return { root, value: () => filled(keys()), show, keys };
}

/** Several of some choices; none stands for the default. */
function several(name: string, schema: Schema, choices: string[]): Entry {
  const boxes = choices.map((each) => h("input", { type: "checkbox", value: each, ariaLabel: each }));
  const root = h("div", { className: "several", title: schema.description ?? "", role: "group", ariaLabel: name }, h("span", {}, name), ...boxes.map((each) => h("label", {}, each, each.value)));
  const show = (value: Value | undefined): void => boxes.forEach((each) => (each.checked = Array.isArray(value) && value.includes(each.value)));
  const value = (): Value | undefined => {
    const found = boxes.filter((each) => each.checked).map((each) => each.value);
    return found.length ? found : undefined;
  };
  return { root, value, show };
}

/** The entry of an address, or of the innermost table around it. */
export function entryAt(entries: Map<string, Entry>, address: string): Entry | undefined {
  const known = [...entries].filter(([name]) => address === name || address.startsWith(`${name}.`) || address.startsWith(`${name}[`));
  const [name, found] = known.sort(([one], [other]) => other.length - one.length)[0] ?? ["", undefined];
  return (found?.keys && entryAt(found.keys(), address.slice(name.length + 1))) ?? found;
}

/** One value: a choice, a switch, or text. */
function single(name: string, schema: Schema): Entry {
  const given = schema.default ?? /Default: (.*?)\.( |$)/.exec(schema.description ?? "")?.[1];
  const title = [schema.description, given === undefined ? "" : `default ${given}`].filter(Boolean).join("; ");
  const label = h("span", { title }, name.replace(/^--/, ""));
  if (schema.enum || schema.type === "boolean") {
    const choices = schema.enum?.map(String) ?? ["true", "false"];
    const pick = h("select", { ariaLabel: name, title });
    pick.append(new Option(given === undefined ? "default" : `default: ${given}`, ""), ...choices.map((each) => new Option(schema.enum ? each : each === "true" ? "yes" : "no", each)));
    const show = (value: Value | undefined): void => void (pick.value = value === undefined ? "" : String(value));
    return { root: h("label", {}, label, pick), value: () => (pick.value === "" ? undefined : schema.enum ? pick.value : pick.value === "true"), show };
  }
  const several = schema.prefixItems?.map((each) => String(each.examples?.[0] ?? "")).join(", ");
  const example = several ?? schema.examples?.[0];
  const hint = given === undefined ? (example === undefined ? "" : `e.g. ${example}`) : `default: ${given}`;
  const input = h("input", { type: "text", spellcheck: false, ariaLabel: name, placeholder: hint, title });
  let kept: { text: string; value: Value } | null = null; // a value that is not of the schema stays as it is
  const show = (value: Value | undefined): void => {
    input.value = value === undefined ? "" : Array.isArray(value) ? value.join(", ") : typeof value === "object" ? JSON.stringify(value) : String(value);
    kept = value === undefined ? null : { text: input.value, value };
  };
  return { root: h("label", {}, label, input), value: () => (kept?.text === input.value ? kept.value : read(input.value.trim(), schema)), show };
}

/** Text as the schema means it: an integer, a list, several values, or text. */
function read(text: string, schema: Schema): Value | undefined {
  if (text === "") return undefined;
  const parts = text.split(/\s*,\s*/);
  if (["integer", "number"].some((type) => schema.type === type || schema.anyOf?.some((each) => each.type === type))) return Number.isFinite(Number(text)) ? Number(text) : text;
  if (schema.type === "array" || (schema.minItems ?? 0) > 1) return parts.map((each) => read(each, schema.items || {}) ?? each);
  if (schema.oneOf?.some((each) => each.type === "array") && parts.length > 1) return parts;
  return text;
}

/** A table as TOML, under its heading. */
export function toml(values: Table, path: string[] = []): string {
  const own = Object.entries(values).filter(([, value]) => !isTable(value)).map(([name, value]) => `${key(name)} = ${JSON.stringify(value)}`);
  const tables = Object.entries(values).flatMap(([name, value]) => (isTable(value) ? [toml(value, [...path, name])] : []));
  const head = path.length && own.length ? [`[${path.map(key).join(".")}]`] : [];
  return [[...head, ...own].join("\n"), ...tables].filter(Boolean).join("\n\n");
}

const isTable = (value: Value): value is Table => typeof value === "object" && !Array.isArray(value);
const key = (name: string): string => (/^[\w-]+$/.test(name) ? name : JSON.stringify(name));

/** Options of the command line. */
export function options(values: Table): string[] {
  return Object.entries(values).flatMap(([name, value]) => (value === true ? [name] : value === false ? [] : [name, ...(Array.isArray(value) ? value.map(String) : [String(value)])]));
}
