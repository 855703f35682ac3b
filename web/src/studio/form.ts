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
  items?: Schema;
  oneOf?: Schema[];
  anyOf?: Schema[];
  properties?: Record<string, Schema>;
  required?: string[];
}

type Value = string | number | boolean | Value[] | { [key: string]: Value };

/** An entry: what a person sees, and the value that differs from the default. */
export interface Entry {
  root: HTMLElement;
  value: () => Value | undefined;
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
    if (schema.properties) return this.group(name, schema);
    if (schema.type === "object" || schema.items?.$ref) return null; // tables of any name, lists of tables: written in the file
    if (schema.const !== undefined) return { root: h("span", { hidden: true }), value: () => schema.const as Value };
    return single(name, schema);
  }

  /** A table: closed, and absent while nothing in it is filled in. */
  private group(name: string, schema: Schema): Entry {
    const entries = this.entries(schema);
    const root = h("details", {}, h("summary", { title: schema.description ?? "" }, name), ...[...entries.values()].map((each) => each.root));
    return { root, value: () => filled(entries) };
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
export function filled(entries: Map<string, Entry>): { [key: string]: Value } | undefined {
  const found = [...entries].flatMap(([name, each]) => { const value = each.value(); return value === undefined ? [] : [[name, value] as const]; });
  return found.length ? Object.fromEntries(found) : undefined;
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
    return { root: h("label", {}, label, pick), value: () => (pick.value === "" ? undefined : schema.enum ? pick.value : pick.value === "true") };
  }
  const [example] = schema.examples ?? [];
  const hint = given === undefined ? (example === undefined ? "" : `e.g. ${example}`) : `default: ${given}`;
  const input = h("input", { type: "text", spellcheck: false, ariaLabel: name, placeholder: hint, title });
  return { root: h("label", {}, label, input), value: () => read(input.value.trim(), schema) };
}

/** Text as the schema means it: an integer, a list, several values, or text. */
function read(text: string, schema: Schema): Value | undefined {
  if (text === "") return undefined;
  const parts = text.split(/\s*,\s*/);
  if (["integer", "number"].some((type) => schema.type === type || schema.anyOf?.some((each) => each.type === type))) return Number.isFinite(Number(text)) ? Number(text) : text;
  if (schema.type === "array" || (schema.minItems ?? 0) > 1) return parts.map((each) => read(each, schema.items ?? {}) ?? each);
  if (schema.oneOf?.some((each) => each.type === "array") && parts.length > 1) return parts;
  return text;
}

/** A table as TOML, under its heading. */
export function toml(values: { [key: string]: Value }, path: string[] = []): string {
  const isTable = (value: Value): value is { [key: string]: Value } => typeof value === "object" && !Array.isArray(value);
  const own = Object.entries(values).filter(([, value]) => !isTable(value)).map(([name, value]) => `${key(name)} = ${JSON.stringify(value)}`);
  const tables = Object.entries(values).flatMap(([name, value]) => (isTable(value) ? [toml(value, [...path, name])] : []));
  const head = path.length && own.length ? [`[${path.map(key).join(".")}]`] : [];
  return [[...head, ...own].join("\n"), ...tables].filter(Boolean).join("\n\n");
}

const key = (name: string): string => (/^[\w-]+$/.test(name) ? name : JSON.stringify(name));

/** Options of the command line. */
export function options(values: { [key: string]: Value }): string[] {
  return Object.entries(values).flatMap(([name, value]) => (value === true ? [name] : value === false ? [] : [name, ...(Array.isArray(value) ? value.map(String) : [String(value)])]));
}
