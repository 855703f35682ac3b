// The palette: what a stage is built of by hand; its text is written into the file.

import type { Snippet } from "../protocol";
import { byId, fill, grouped, h } from "./dom";
import type { Studio } from "./studio";

export class BuildPane {
  private readonly root = byId("pane-build");

  constructor(private readonly studio: Studio) {
    studio.tab.watch((tab) => tab === "build" && this.ask());
    studio.state.watch(() => studio.tab.value === "build" && this.ask());
  }

  private ask(): void {
    if (this.root.contains(document.activeElement) && document.activeElement?.tagName === "INPUT") return;
    this.studio.connection.newest("palette", { kind: "palette" }, (said) => said.kind === "snippets" && this.show(said.snippets));
  }

  private show(snippets: Snippet[]): void {
    const open = new Set([...this.root.querySelectorAll("details[open]")].map((each) => each.getAttribute("data-name")));
    const parts = [...grouped(snippets, (each) => each.group)].flatMap(([name, group]) => [h("h4", {}, name), ...group.map((each) => this.snippet(each, open.has(each.name)))]);
    fill(this.root, h("p", { className: "quiet" }, "The text is inserted after the entries of its kind in the design file, where you can edit it."), ...parts);
  }

  private snippet(each: Snippet, isOpen: boolean): HTMLElement {
    const inputs = Object.entries(each.fields).map(([name, text]) => ({ name, input: h("input", { type: "text", value: text, spellcheck: false, ariaLabel: name }) }));
    const insert = (): void => void this.insert(each, Object.fromEntries(inputs.map(({ name, input }) => [name, input.value])));
    const rows = inputs.map(({ name, input }) => h("label", {}, name, input));
    const made = h("details", { open: isOpen }, h("summary", {}, each.title), h("form", { className: "snippet", submit: (event: Event) => (event.preventDefault(), insert()) }, ...rows, h("button", { type: "submit" }, "insert")));
    made.dataset["name"] = each.name;
    return made;
  }

  private async insert(each: Snippet, fields: Record<string, string>): Promise<void> {
    const before = this.studio.state.value?.text ?? "";
    const said = await this.studio.ask({ kind: "insert", snippet: each.name, fields });
    if (said.kind !== "done") return;
    await this.read(said.revision);
    this.studio.goto(differs(before, this.studio.state.value?.text ?? ""), false);
  }

  /** Until a revision of the text has come: what it says is read first. */
  private read(revision: number): Promise<void> {
    return new Promise((resolve) => {
      const end = this.studio.state.watch((state) => done(state?.revision ?? 0));
      const done = (known: number): void => {
        if (known < revision) return;
        end();
        resolve();
      };
      done(this.studio.state.value?.revision ?? 0);
    });
  }
}

/** The first line in which two texts differ. */
function differs(one: string, other: string): number {
  const lines = one.split("\n");
  const found = other.split("\n").findIndex((line, at) => line !== lines[at]);
  return found + 1;
}
