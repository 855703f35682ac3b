// Commands that run beside: what they take, how far they are, and their results.

import type { Jobs, JobState, Run } from "../protocol";
import { byId, digits, fill, h, sentence } from "./dom";
import type { Studio } from "./studio";

type Command = Run["command"];

interface Form {
  title: string;
  about: string;
  study: string | null;
  record: "needed" | "possible" | null;
}

/** A study to begin with: the numbers that buy most of the worst requirement, ten per cent to both sides. */
function draft(studio: Studio, last: string): string {
  const { slopes, state, verdicts } = studio;
  const amounts = state.value?.amounts ?? [];
  const ranked = slopes.value?.slopes.map((each) => each.address) ?? [];
  const free = (ranked.length ? ranked : amounts.map((each) => each.address)).filter((each) => amounts.some((one) => one.address === each && one.formula === null)).slice(0, 3);
  const variables = free.map((each, at) => `v${at + 1} = { address = "${each}", from = "-10 %", to = "+10 %" }`);
  const wanted = slopes.value?.worst || verdicts.value?.verdicts[0]?.key || "frequency.platform.1";
  const file = state.value?.file.split(/[\\/]/).at(-1) ?? "stage.toml";
  return ['format = "flexstage study 1"', `design = "${file}"`, "", "[variables]", ...variables, "", "[responses]", `worst = "${wanted}"`, "", last, ""].join("\n");
}

const SWEEP = '[sweep]\nsampling = "sobol"\ndesigns = 64';
const OPTIMISE = '[optimise]\nmaximise = "worst"';

const FORMS: Record<Command, Form> = {
  sweep: { title: "Sweep", about: "Computes many designs, effects and interactions.", study: SWEEP, record: null },
  optimise: { title: "Optimise", about: "Finds the best design within ranges and limits.", study: OPTIMISE, record: null },
  verify: { title: "Verify", about: "Compares theory with finite elements, hinges first.", study: null, record: null },
  identify: { title: "Identify", about: "Finds the modes in a record of a test.", study: null, record: "needed" },
  loop: { title: "Loop", about: "Closes the control loop, by default the standard one. With a record of a test, on the measured responses.", study: "", record: "possible" },
  analyse: { title: "Report", about: "Writes the report: all analyses, with the animated model, in one file.", study: null, record: null },
};

/** What the last design that an optimisation found is pinned as. */
const OPTIMUM = "optimum";

export class JobsPane {
  private readonly root = byId("pane-jobs");
  private readonly list = h("div", { id: "jobs" });
  private readonly form = h("div", {});
  private readonly studies = new Map<Command, string>();
  private live = new Set<number>();
  /** Reports that this page asked for, which are shown as soon as they are there. */
  private readonly wanted = new Set<number>();

  constructor(private readonly studio: Studio) {
    fill(this.root, this.form, this.list);
    const buttons = Object.entries(FORMS).map(([name, each]) => h("button", { type: "button", title: each.about, click: () => this.offer(name as Command) }, each.title));
    fill(byId("commands"), ...buttons);
    studio.connection.on("jobs", (said) => this.show(said));
    fill(this.list, h("p", { className: "quiet" }, "No jobs yet."));
  }

  /** What a command takes; one that takes nothing starts at once. */
  offer(name: Command): void {
    const form = FORMS[name];
    this.studio.tab.set("jobs");
    if (name === "analyse") return void this.run({ kind: "run", command: name, study: null, record: null, options: [] });
    const study = form.study === null ? null : h("textarea", { rows: 9, spellcheck: false, ariaLabel: "study", value: this.studies.get(name) ?? (form.study && draft(this.studio, form.study)) });
    const record = form.record ? h("input", { type: "text", required: form.record === "needed", placeholder: "record.mat", ariaLabel: "record" }) : null;
    const options = h("input", { type: "text", placeholder: "as on the command line", ariaLabel: "options" });
    const start = (event: Event): void => {
      event.preventDefault();
      if (study) this.studies.set(name, study.value);
      void this.run({ kind: "run", command: name, study: study?.value.trim() ? study.value : null, record: record?.value || null, options: options.value.split(/\s+/).filter(Boolean) });
    };
    fill(
      this.form,
      h("form", { className: "run", submit: start }, h("h3", {}, form.title), h("p", { className: "quiet" }, form.about), study, record && h("label", {}, "record's file ", record), h("label", {}, "options ", options), h("button", { type: "submit" }, `Start ${form.title.toLowerCase()}`)),
    );
    (study ?? record ?? options).focus();
    study?.setSelectionRange(0, 0); // its beginning is what is to be seen
  }

  private async run(question: Omit<Run, "id">): Promise<void> {
    const said = await this.studio.ask(question);
    if (said.kind === "done" && said.job !== null && question.command === "analyse") this.wanted.add(said.job);
    if (said.kind === "done") fill(this.form);
    else if (said.kind === "refusal") fill(this.form, ...said.problems.map((each) => h("p", { className: "poor" }, `${each.where}: ${sentence(each)}`)));
  }

  private show(said: Jobs): void {
    const best = said.jobs.filter((each) => each.command === "optimise" && each.state === "done").at(-1);
    fill(this.list, ...[...said.jobs].reverse().map((each) => this.job(each, each === best && this.studio.state.value?.pins.includes(OPTIMUM))));
    for (const each of said.jobs) if (this.live.has(each.job) && isOver(each)) this.studio.tell(`${each.command}: ${each.state}.`, each.state === "failed");
    for (const each of said.jobs) if (isOver(each) && this.wanted.delete(each.job) && each.report) showReport(each.report, "Report");
    this.live = new Set(said.jobs.filter((each) => !isOver(each)).map((each) => each.job));
  }

  private job(each: JobState, hasOptimum = false): HTMLElement {
    const isLive = !isOver(each);
    const left = each.left === null ? "" : `, ${digits(Math.ceil(each.left), 3)} s left`;
    const cancel = h("button", { type: "button", click: () => this.studio.ask({ kind: "cancel", job: each.job }) }, "cancel");
    const address = each.report;
    const show = address && h("button", { type: "button", click: () => showReport(address, `Report of ${each.command}`) }, "show the report");
    const take = h("button", { type: "button", title: "make it the present design; undo takes it back", click: () => this.studio.ask({ kind: "recall", name: OPTIMUM }) }, "take the optimum");
    const bar = h("progress", { ariaLabel: each.command, max: 1, ...(each.fraction === null ? {} : { value: each.fraction }) });
    return h(
      "article",
      { className: `job ${each.state}` },
      h("h3", {}, `${each.command} `, h("span", { className: "quiet" }, `${each.state}${left}`), isLive && cancel, show, hasOptimum && take),
      isLive && bar,
      h("p", {}, each.text),
      each.said.length > 0 && h("pre", {}, each.said.join("\n")),
    );
  }
}

/** A report over the page, in a frame of its own that reaches nothing of the studio. */
function showReport(address: string, title: string): void {
  const made = h("dialog", { className: "report", ariaLabel: title, close: () => made.remove() });
  const frame = h("iframe", { title, src: address });
  frame.setAttribute("sandbox", "allow-scripts allow-downloads allow-modals");
  const away = h("a", { href: address, target: "_blank", rel: "noopener" }, "in a tab of its own");
  fill(made, h("form", { method: "dialog" }, h("b", {}, title), away, h("button", {}, "close")), frame);
  document.body.append(made);
  made.showModal();
}

const isOver = (each: JobState): boolean => each.state !== "waits" && each.state !== "runs";
