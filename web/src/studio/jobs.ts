// Jobs: commands in processes of their own. Each has a form from the schema of its file or options; each ends with its key figures.

import type { Figure, Jobs, JobState, Run } from "../protocol";
import { byId, digits, fill, h, sentence, table } from "./dom";
import { Form, filled, options, toml } from "./form";
import type { Entry, Schema } from "./form";
import type { Studio } from "./studio";

type Command = Exclude<Run["command"], "design">; // the pane of specifications starts a design

interface Kind {
  title: string;
  about: string;
  /** The heading of its file; absent: options only. */
  file?: string;
  /** The table of a study that this command uses. */
  table?: string;
  record?: "needed" | "possible";
}

const KINDS: Record<Command, Kind> = {
  sweep: { title: "Sweep", about: "Analyses many designs, with effects and interactions of the variables.", file: "flexstage study 1", table: "sweep" },
  optimise: { title: "Optimise", about: "Finds the best design within ranges and limits.", file: "flexstage study 1", table: "optimise" },
  verify: { title: "Verify", about: "Compares theory with finite elements, first for the hinges." },
  identify: { title: "Identify", about: "Finds the modes in a test record.", record: "needed" },
  loop: { title: "Loop", about: "Computes the control loop, by default with the standard controller. With a test record, it uses the measured responses.", file: "flexstage loop 1", record: "possible" },
  analyse: { title: "Report", about: "Writes a report with all analyses and the animated stage in one file." },
};

/** A starting point of a study: the numbers with the largest effect on the worst requirement, and the measure to improve. */
function draft(studio: Studio): { free: string[]; measure: string; file: string } {
  const { slopes, state, verdicts } = studio;
  const amounts = state.value?.amounts ?? [];
  const ranked = slopes.value?.slopes.map((each) => each.address) ?? amounts.map((each) => each.address);
  const free = ranked.filter((each) => amounts.some((one) => one.address === each && one.formula === null)).slice(0, 3);
  return { free, measure: slopes.value?.worst || verdicts.value?.verdicts[0]?.key || "frequency.platform.1", file: state.value?.file.split(/[\\/]/).at(-1) ?? "stage.toml" };
}

/** What the last design that an optimisation found is pinned as. */
const OPTIMUM = "optimum";

export class JobsPane {
  private readonly root = byId("pane-jobs");
  private readonly list = h("div", { id: "jobs" });
  private readonly form = h("div", {});
  private readonly refusal = h("div", { role: "alert" });
  private readonly studies = new Map<Command, string>();
  private live = new Set<number>();
  /** Reports that this page asked for, which are shown as soon as they are there. */
  private readonly wanted = new Set<number>();

  constructor(private readonly studio: Studio) {
    fill(this.root, this.form, this.list);
    const buttons = Object.entries(KINDS).map(([name, each]) => h("button", { type: "button", title: each.about, click: () => this.offer(name as Command) }, each.title));
    fill(byId("commands"), ...buttons);
    studio.connection.on("jobs", (said) => this.show(said));
    fill(this.list, h("p", { className: "quiet" }, "No jobs yet."));
  }

  /** The form of a command; a report starts at once. */
  offer(name: Command): void {
    this.studio.tab.set("jobs");
    if (name === "analyse") return void this.run({ kind: "run", command: name, study: null, record: null, options: [] });
    fill(this.form, h("p", { className: "quiet" }, "…"));
    this.studio.connection.newest("form", { kind: "jobform", command: name }, (said) => said.kind === "blank" && this.blank(name, new Form(said.schema as Schema), said.schema as Schema));
  }

  private blank(name: Command, form: Form, schema: Schema): void {
    const kind = KINDS[name];
    const study = kind.table === undefined ? null : new StudyForm(this.studio, form, kind.table);
    const entries = study?.entries ?? form.entries(schema);
    const text = kind.file === undefined ? null : h("textarea", { rows: 9, spellcheck: false, ariaLabel: "study", value: this.studies.get(name) ?? "" });
    const compose = (): string => {
      const rest = filled(entries) ?? {};
      if (study) return study.text(rest);
      return Object.keys(rest).length ? `${toml({ format: kind.file ?? "", ...rest })}\n` : "";
    };
    if (text && !text.value) text.value = compose();
    const record = kind.record ? h("input", { type: "text", required: kind.record === "needed", placeholder: "record.mat", ariaLabel: "record" }) : null;
    const more = text && h("input", { type: "text", placeholder: "as on the command line", ariaLabel: "options" });
    const start = (event: Event): void => {
      event.preventDefault();
      if (text) this.studies.set(name, text.value);
      void this.run({ kind: "run", command: name, study: text?.value.trim() ? text.value : null, record: record?.value || null, options: more ? more.value.split(/\s+/).filter(Boolean) : options(filled(entries) ?? {}) });
    };
    const about = (kind.table === undefined ? schema : form.table(kind.table)).description?.replaceAll("`", "");
    const body = h("div", { className: "entries" }, ...(about ? [h("p", { className: "quiet" }, about)] : []), ...(study ? [study.root] : []), ...[...entries.values()].map((each) => each.root));
    for (const event of ["input", "change"]) body.addEventListener(event, () => text && (text.value = compose()));
    study?.changed(() => text && (text.value = compose()));
    fill(
      this.form,
      h("details", { className: "blank", open: true }, h("summary", {}, h("h3", {}, kind.title)), h("form", { className: "run", submit: start }, h("p", { className: "quiet" }, kind.about), record && h("label", {}, "record's file ", record), body, text && h("details", {}, h("summary", {}, "as a file"), text), more && h("label", {}, "further options ", more), h("button", { type: "submit" }, `Start ${kind.title.toLowerCase()}`), this.refusal)),
    );
    fill(this.refusal);
    this.form.querySelector<HTMLElement>("input, select, button")?.focus();
  }

  private async run(question: Omit<Run, "id">): Promise<void> {
    const said = await this.studio.ask(question);
    if (said.kind === "done" && said.job !== null && question.command === "analyse") this.wanted.add(said.job);
    const blank = this.form.querySelector("details");
    if (said.kind === "done" && blank) blank.open = false; // it keeps what was filled in
    else if (said.kind === "refusal") fill(this.refusal, ...said.problems.map((each) => h("p", { className: "poor" }, `${each.where}: ${sentence(each)}`)));
  }

  private show(said: Jobs): void {
    const best = said.jobs.filter((each) => each.command === "optimise" && each.state === "done").at(-1);
    const newest = new Map(said.jobs.filter((each) => each.figures.length).map((each) => [each.command, each]));
    fill(this.list, ...[...said.jobs].reverse().map((each) => jobArticle(this.studio, each, each === best && this.studio.state.value?.pins.includes(OPTIMUM), newest.get(each.command) === each ? said.jobs : [])));
    for (const each of said.jobs) if (this.live.has(each.job) && isOver(each)) this.studio.tell(`${each.command}: ${each.state}.`, each.state === "failed");
    for (const each of said.jobs) if (isOver(each) && this.wanted.delete(each.job) && each.report) showReport(each.report, "Report");
    this.live = new Set(said.jobs.filter((each) => !isOver(each)).map((each) => each.job));
  }
}

/** A job: its state, progress, report, key figures and output. */
export function jobArticle(studio: Studio, each: JobState, hasOptimum = false, runs: JobState[] = []): HTMLElement {
  const isLive = !isOver(each);
  const left = each.left === null ? "" : `, ${digits(Math.ceil(each.left), 3)} s left`;
  const cancel = h("button", { type: "button", click: () => studio.ask({ kind: "cancel", job: each.job }) }, "cancel");
  const address = each.report;
  const show = address && h("button", { type: "button", click: () => showReport(address, `Report of ${each.command}`) }, "show the report");
  const take = h("button", { type: "button", title: "make the optimum the present design; undo restores the previous design", click: () => studio.ask({ kind: "recall", name: OPTIMUM }) }, "take the optimum");
  const bar = h("progress", { ariaLabel: each.command, max: 1, ...(each.fraction === null ? {} : { value: each.fraction }) });
  return h(
    "article",
    { className: `job ${each.state}` },
    h("h3", {}, `${each.job}. ${each.command} `, h("span", { className: "quiet" }, `${each.state}${left}`), isLive && cancel, show, hasOptimum && take),
    isLive && bar,
    each.text !== each.state && h("p", {}, each.text),
    runs.length > 0 && compared(runs.filter((one) => one.command === each.command && one.figures.length)),
    each.said.length > 0 && !each.tables.length && h("details", { open: each.state !== "done" }, h("summary", {}, "output"), h("pre", {}, each.said.join("\n"))),
  );
}

/** The key figures of runs of one command, a column for each. */
function compared(runs: JobState[]): HTMLElement {
  const names = new Map(runs.flatMap((each) => each.figures).map((each) => [each.name, each]));
  const shown = runs.slice(-COMPARED);
  const rows = [...names.values()].map((row) => {
    const values = shown.map((each) => each.figures.find((one) => one.name === row.name)?.value ?? null);
    const { unit, factor } = scale(row, values);
    return [h("span", {}, row.name, h("small", { className: "quiet" }, unit && ` ${unit}`)), ...values.map((each) => digits(each === null ? null : each / factor))];
  });
  return h("div", { className: "wide" }, table(["key figures", ...shown.map((each) => `run ${each.job}`)], rows, "figures runs"));
}

const COMPARED = 5;
const PREFIXES: [number, string][] = [[1, ""], [1e-3, "m"], [1e-6, "u"], [1e-9, "n"], [1e-12, "p"]];

/** A unit with the prefix in which the largest value has one to three digits before the point. */
function scale(each: Figure, values: (number | null)[]): { unit: string; factor: number } {
  const most = Math.max(...values.map((value) => Math.abs(value ?? 0)));
  if (each.si !== "m" && each.si !== "rad") return { unit: each.si === "1" ? "" : each.si, factor: 1 };
  const [factor, prefix] = PREFIXES.find(([size]) => most >= size) ?? [1, ""];
  return { unit: prefix + each.si, factor };
}

/** A report over the page, in a frame of its own that reaches nothing of the studio. */
function showReport(address: string, title: string): void {
  const made = h("dialog", { className: "report", ariaLabel: title, close: () => made.remove() });
  const frame = h("iframe", { title, src: address });
  frame.setAttribute("sandbox", "allow-scripts allow-downloads allow-modals");
  const away = h("a", { href: address, target: "_blank", rel: "noopener" }, "in a separate tab");
  fill(made, h("form", { method: "dialog" }, h("b", {}, title), away, h("button", {}, "close")), frame);
  document.body.append(made);
  made.showModal();
}

/** Numbers with their ranges, a measure, and the table of a study. */
class StudyForm {
  readonly entries: Map<string, Entry>;
  readonly root = h("div", {});
  private readonly rows: HTMLInputElement[][] = [];
  private readonly list = h("div", {});
  private readonly measure: HTMLInputElement;
  private act: () => void = () => {};

  constructor(private readonly studio: Studio, form: Form, private readonly name: string) {
    const { free, measure } = draft(studio);
    this.entries = form.entries(form.table(name), ["maximise", "minimise"]);
    const addresses = h("datalist", { id: "addresses" });
    addresses.append(...(studio.state.value?.amounts ?? []).filter((each) => each.formula === null).map((each) => new Option(each.address)));
    const measures = h("datalist", { id: "measures" });
    measures.append(...[...(studio.figures.value?.figures ?? []), ...(studio.reach.value?.figures ?? [])].map((each) => new Option(each.name)));
    this.measure = h("input", { type: "text", ariaLabel: "measure", value: measure, required: true });
    this.measure.setAttribute("list", "measures");
    const more = h("button", { type: "button", click: () => (this.add(""), this.act()) }, "one more number");
    fill(this.root, h("h4", {}, "Numbers and their ranges"), this.list, more, h("label", {}, h("span", {}, name === "optimise" ? "maximise" : "response"), this.measure), addresses, measures);
    for (const each of free) this.add(each);
  }

  changed(act: () => void): void {
    this.act = act;
  }

  private add(address: string): void {
    const fields = [address, "-10 %", "+10 %"].map((value, at) => h("input", { type: "text", value, spellcheck: false, ariaLabel: ["number", "from", "to"][at] ?? "" }));
    fields[0]?.setAttribute("list", "addresses");
    const root = h("div", { className: "varied" }, ...fields, h("button", { type: "button", title: "remove", ariaLabel: "remove", click: () => (this.rows.splice(this.rows.indexOf(fields), 1), root.remove(), this.act()) }, "×"));
    this.rows.push(fields);
    this.list.append(root);
  }

  text(rest: { [key: string]: unknown }): string {
    const { file } = draft(this.studio);
    const rows = this.rows.map((row) => row.map((each) => JSON.stringify(each.value.trim()))).filter(([address]) => address !== '""');
    const variables = rows.map(([address, from, to], at) => `v${at + 1} = { address = ${address}, from = ${from}, to = ${to} }`);
    const aim = this.name === "optimise" ? { maximise: "worst" } : {};
    return ['format = "flexstage study 1"', `design = ${JSON.stringify(file)}`, "", "[variables]", ...variables, "", "[responses]", `worst = ${JSON.stringify(this.measure.value.trim())}`, "", toml({ ...aim, ...rest } as Parameters<typeof toml>[0], [this.name]) || `[${this.name}]`, ""].join("\n");
  }
}

export const isOver = (each: JobState): boolean => each.state !== "waits" && each.state !== "runs";
