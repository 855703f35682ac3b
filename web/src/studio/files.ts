// New from the gallery of shipped cases, open, save as: dialogs about the files of the design's folder.

import { fill, h, sentence } from "./dom";
import type { PairRow, Said, Specified } from "../protocol";
import type { Question } from "./connection";
import type { Studio } from "./studio";

/** A dialog that asks the server; it stays open with the reason where that refuses. */
function dialog(studio: Studio, title: string, act: string, rows: HTMLElement[], question: (over: boolean) => Question, overwrite = "", then: (said: Said) => void = () => {}): void {
  const problem = h("p", { className: "poor", role: "alert" });
  const over = h("input", { type: "checkbox" });
  const agree = h("label", { hidden: overwrite === "" }, over, overwrite);
  const send = async (event: Event): Promise<void> => {
    event.preventDefault();
    const said = await studio.ask(question(over.checked));
    if (said.kind !== "refusal") return then(said), made.close();
    fill(problem, said.problems.map((each) => `${each.where}: ${sentence(each)}.`).join(" ") || "The server does not answer.");
    studio.notice.set({ text: "", bad: false });
  };
  const form = h("form", { submit: send }, h("h2", {}, title), ...rows, agree, problem, h("div", { className: "buttons" }, h("button", { type: "submit" }, act), h("button", { type: "button", click: () => made.close() }, "cancel")));
  const made = h("dialog", { className: "keys files", ariaLabel: title, close: () => made.remove() }, form);
  document.body.append(made);
  made.showModal();
}

const field = (value: string): HTMLInputElement => h("input", { type: "text", value, required: true, spellcheck: false, ariaLabel: "file name" });
const labelled = (text: string, ...content: Node[]): HTMLElement => h("label", {}, h("span", {}, text), ...content);

const unsaved = (studio: Studio): string => (studio.state.value?.saved === false ? "discard the unsaved changes" : "");

/** A name that is not in use, from another one. */
function free(name: string, files: string[]): string {
  const stem = name.replace(/\.toml$/, "");
  for (let number = 1; ; number++) {
    const found = number === 1 ? `${stem}.toml` : `${stem}-${number}.toml`;
    if (!files.includes(found)) return found;
  }
}

async function folder(studio: Studio): Promise<{ files: string[]; specifications: string[]; cases: Record<string, string> }> {
  const said = await studio.ask({ kind: "browse" });
  return said.kind === "folder" ? said : { files: [], specifications: [], cases: {} };
}

export async function fromGallery(studio: Studio): Promise<void> {
  const { files, cases } = await folder(studio);
  const cased = h("select", { size: 12, ariaLabel: "shipped case", change: () => (name.value = free(cased.value, files)) });
  cased.append(...Object.entries(cases).map(([each, about], at) => new Option(`${each}: ${about}`, each, false, at === 0)));
  const name = field(free(cased.value, files));
  dialog(studio, "New design", "create", [cased, labelled("file", name)], (discard) => ({ kind: "open", file: name.value.trim(), case: cased.value, discard, job: null, pair: "" }), unsaved(studio));
}

export async function openFile(studio: Studio): Promise<void> {
  const { files, specifications } = await folder(studio);
  const listed = listing(files.filter((each) => !specifications.includes(each)), studio.state.value?.file);
  dialog(studio, "Open a design file", "open", [listed], (discard) => ({ kind: "open", file: listed.value, case: "", discard, job: null, pair: "" }), unsaved(studio));
}

function listing(files: string[], chosen = files[0]): HTMLSelectElement {
  const made = h("select", { size: Math.min(12, Math.max(2, files.length)), ariaLabel: "file to open" });
  made.append(...files.map((each) => new Option(each, each, false, each === chosen)));
  return made;
}

/** An answer of a design job as the open design, in a file of its own. */
export async function openAnswer(studio: Studio, job: number, pair: PairRow): Promise<void> {
  const { files } = await folder(studio);
  const name = field(free(pair.file, files));
  dialog(studio, "Open as a design", "open", [labelled("file", name)], (discard) => ({ kind: "open", file: name.value.trim(), case: "", discard, job, pair: `${pair.architecture} with ${pair.actuator}` }), unsaved(studio));
}

export async function openSpecification(studio: Studio, then: (said: Specified, file: string) => void): Promise<void> {
  const listed = listing((await folder(studio)).specifications);
  dialog(studio, "Open a specification", "open", [listed], () => ({ kind: "specify", text: "", file: listed.value, values: "" }), "", (said) => said.kind === "specified" && then(said, listed.value));
}

/** Writes a specification to `file`, or to a new one that begins with its name. */
export async function saveSpecification(studio: Studio, text: string, file: string, name: string): Promise<void> {
  const { files } = await folder(studio);
  const place = field(file || free(`${name || "specification"}.toml`, files));
  dialog(studio, "Save the specification", "save", [labelled("file", place)], (over) => ({ kind: "savespecification", text, file: place.value.trim(), over }), "overwrite an existing file");
}

export async function saveAs(studio: Studio): Promise<void> {
  const { files } = await folder(studio);
  const name = field(free(studio.state.value?.file ?? "stage.toml", files));
  dialog(studio, "Save as", "save", [labelled("file", name)], (over) => ({ kind: "save", over, file: name.value.trim() }), "overwrite an existing file");
}
