// Clashes and gaps with their distances, the least first; a click shows both bodies in colour.

import type { Clash, Clearances } from "../protocol";
import { byId, fill, h, sentence, shown, table } from "./dom";
import type { Studio } from "./studio";

const LENGTH = { unit: "mm", factor: 1e-3 };

export class GapsPane {
  private readonly root = byId("pane-gaps");

  constructor(private readonly studio: Studio) {
    studio.tab.watch((tab) => (tab === "gaps" ? this.ask() : studio.viewer.value?.setColours(null)));
    studio.figures.watch(() => studio.tab.value === "gaps" && this.ask());
  }

  private ask(): void {
    if (!this.root.childElementCount) fill(this.root, h("p", { className: "quiet" }, "Gaps are computed…"));
    this.studio.connection.newest("gaps", { kind: "gaps" }, (said) => said.kind === "clearances" && this.show(said));
  }

  private show(said: Clearances): void {
    const rows = said.clashes.map((each) => [this.button(each), h("span", { className: each.distance < 0 ? "poor" : "" }, shown(each.distance, LENGTH, 4))]);
    fill(
      this.root,
      ...said.problems.map((each) => h("p", { className: "poor" }, `${each.where}: ${sentence(each)}`)),
      said.clashes.length ? table(["bodies", "distance"], rows, "figures") : h("p", { className: "quiet" }, "No overlap, and no small gap."),
    );
  }

  private button(each: Clash): HTMLElement {
    return h("button", { type: "button", title: each.text, click: () => this.paint(each) }, `${each.first} – ${each.second}`);
  }

  private paint(each: Clash): void {
    const parts = this.studio.scene.value?.parts ?? [];
    const belongs = (name: string, body: string): boolean => name === body || name.startsWith(`${body}.`) || name.startsWith(`${body}/`);
    const named = parts.map((part) => part.name).filter((name) => belongs(name, each.first) || belongs(name, each.second));
    const colour = (name: string): [number, number, number] => (belongs(name, each.first) ? [0.85, 0.2, 0.15] : [0.9, 0.55, 0.1]);
    this.studio.viewer.value?.setColours(Object.fromEntries(named.map((name) => [name, colour(name)])));
  }
}
