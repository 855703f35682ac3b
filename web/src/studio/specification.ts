// The specification of a stage: a form that the server checks, the design as a job, a row for each pair, answers that open as designs.

import type { Jobs, JobState, PairRow, Problem, Specified } from "../protocol";
import { byId, fill, h, rested, sentence, table } from "./dom";
import { openAnswer, openSpecification, saveSpecification } from "./files";
import { Form, entryAt, shownTable, toml } from "./form";
import type { Entry, Schema, Table, Value } from "./form";
import { isOver, jobArticle } from "./jobs";
import type { Studio } from "./studio";

const CHECKED = 300; // ms of rest before what was typed is checked
const MORE = { "--prove": "finite elements", "--tolerance": "yield", "--loop": "control loop" };

export class SpecificationPane {
  private readonly blank = h("div", {});
  private readonly job = h("div", {});
  private readonly pairs = h("div", {});
  private readonly faults = h("div", { role: "alert" });
  private readonly area = h("textarea", { rows: 9, spellcheck: false, ariaLabel: "specification" });
  private form: Entry | null = null;
  private text = "";
  private file = "";
  private problems: Problem[] = [];
  /** The shown results, so that progress alone draws no row again. */
  private drawn = "";

  constructor(
    private readonly studio: Studio,
    private readonly settled: () => Promise<void>,
  ) {
    fill(byId("pane-specification"), this.blank, this.job, this.pairs);
    studio.tab.watch((tab) => tab === "specification" && this.form === null && this.begin());
    studio.connection.on("jobs", (said) => this.show(said));
  }

  private begin(): void {
    this.studio.connection.newest("form", { kind: "jobform", command: "design" }, (said) => said.kind === "blank" && this.build(said.schema as Schema));
  }

  private build(schema: Schema): void {
    const form = new Form(schema);
    const entries = form.entries(schema);
    const body = h("div", { className: "entries" }, ...[...entries.values()].map((each) => each.root));
    this.form = shownTable(body, entries);
    const typed = rested(CHECKED, () => this.check(this.text, toml((this.form?.value() ?? {}) as Table)));
    const written = rested(CHECKED, () => this.check(this.area.value || "\n", ""));
    body.addEventListener("input", typed);
    body.addEventListener("change", () => (typed(), typed.now()));
    this.area.addEventListener("input", written);
    const boxes = Object.entries(MORE).map(([option, title]) => ({ option, box: h("input", { type: "checkbox" }), title }));
    const more = h("input", { type: "text", placeholder: "as on the command line", ariaLabel: "options" });
    const ready = async (): Promise<void> => {
      typed.now();
      written.now();
      await this.studio.connection.idle("specify");
    };
    const start = async (event: Event): Promise<void> => {
      event.preventDefault();
      await ready();
      if (this.problems.length) return this.studio.tell("The specification has errors: correct them first.", true);
      const options = [...boxes.filter((each) => each.box.checked).map((each) => each.option), ...more.value.split(/\s+/).filter(Boolean)];
      const said = await this.studio.ask({ kind: "run", command: "design", study: this.text, record: null, options });
      if (said.kind === "done") details.open = false;
    };
    const open = (): void => void openSpecification(this.studio, (said, file) => ((this.file = file), this.take(said, true)));
    const save = (): void => void ready().then(() => saveSpecification(this.studio, this.text, this.file, String((this.form?.value() as Table | undefined)?.["name"] ?? "")));
    const details = h(
      "details",
      { className: "blank", open: !this.pairs.childElementCount },
      h("summary", {}, h("h3", {}, "Specification")),
      h(
        "form",
        { className: "run", submit: (event: Event) => void start(event) },
        h("p", { className: "quiet" }, "Designs stages for required motions, payload, box and requirements. Every pair of architecture and actuator is excluded by a bound or optimised."),
        h("div", { className: "buttons" }, h("button", { type: "button", click: open }, "Open"), h("button", { type: "button", click: save }, "Save as")),
        this.faults,
        body,
        h("details", {}, h("summary", {}, "as a file"), this.area),
        h("div", { className: "several" }, h("span", {}, "first three answers"), ...boxes.map((each) => h("label", {}, each.box, each.title))),
        h("label", {}, "further options ", more),
        h("button", { type: "submit" }, "Start design"),
      ),
    );
    fill(this.blank, details);
    this.check("", "", true);
  }

  private check(text: string, values: string, isNew = values === ""): void {
    this.studio.connection.newest("specify", { kind: "specify", text, file: "", values }, (said) => said.kind === "specified" && this.take(said, isNew));
  }

  /** Shows a checked specification: with its values if it is another text, with its errors. */
  private take(said: Specified, isNew: boolean): void {
    [this.text, this.problems] = [said.text, said.problems];
    if (document.activeElement !== this.area) this.area.value = said.text;
    if (isNew && said.values !== null) this.form?.show?.(said.values as Value);
    this.mark();
  }

  /** Every error at its field; those without one above the form. */
  private mark(): void {
    const root = this.blank;
    for (const each of root.querySelectorAll(".fault")) each.remove();
    for (const each of root.querySelectorAll("[aria-invalid]")) each.removeAttribute("aria-invalid");
    fill(this.faults);
    const entries = this.form?.keys?.() ?? new Map<string, Entry>();
    for (const each of this.problems) {
      const missing = /^(\w+) missing$/.exec(each.what)?.[1];
      const address = missing === undefined ? each.where : each.where === "specification" ? missing : `${each.where}.${missing}`;
      const entry = entryAt(entries, address);
      const line = each.line === null ? "" : `line ${each.line}: `;
      (entry?.root ?? this.faults).append(h("p", { className: "fault poor" }, entry ? sentence(each) : `${line}${each.where}: ${sentence(each)}`));
      if (!(entry?.root instanceof HTMLDetailsElement)) entry?.root.querySelector("input, select")?.setAttribute("aria-invalid", "true");
      for (let around = entry?.root.closest("details"); around; around = around.parentElement?.closest("details")) around.open = true;
    }
  }

  private show(said: Jobs): void {
    const job = said.jobs.filter((each) => each.command === "design").at(-1);
    fill(this.job, job && jobArticle(this.studio, job));
    const key = JSON.stringify([job?.job, job?.pairs, job?.tables]);
    if (key !== this.drawn) fill(this.pairs, ...(job ? this.results(job) : []));
    this.drawn = key;
  }

  /** The tables of the command; until its end, a row for each pair as soon as it is finished. */
  private results(job: JobState): HTMLElement[] {
    if (!job.tables.length) {
      const rows = job.pairs.map((each) => [each.architecture, each.actuator, each.goal ? this.opener(job, each, `open, ${each.goal}`) : each.reason]);
      const empty = h("p", { className: "quiet" }, isOver(job) ? "No pair was finished." : "No pair is finished yet.");
      return rows.length ? [h("div", { className: "wide" }, table(["architecture", "actuator", "result"], rows, "pairs"))] : [empty];
    }
    return job.tables.flatMap(({ title, rows: [head = [], ...rows], notes }, at) => {
      const cells = rows.map((row) => {
        const pair = at === 0 && job.pairs.find((each) => each.file && row.includes(each.architecture) && row.includes(each.actuator));
        return pair ? [this.opener(job, pair, `open ${row[0]}`), ...row.slice(1)] : row;
      });
      return [h("h4", {}, title), h("div", { className: "wide" }, table(head, cells, "pairs final")), h("details", {}, h("summary", {}, "notes"), ...notes.map((each) => h("p", { className: "quiet" }, each)))];
    });
  }

  private opener(job: JobState, pair: PairRow, text: string): HTMLElement {
    const open = (): void => void this.settled().then(() => openAnswer(this.studio, job.job, pair));
    return h("button", { type: "button", title: "open as a design", click: open }, text);
  }
}
