// The card of a part: what it is, its 6x6, what it bears and takes, theory beside finite elements, its lines.

import type { Card, Fact } from "../protocol";
import type { Picked } from "../viewer/types";
import { byId, fill, h, percent, sentence, shown } from "./dom";
import { matrix } from "./figures";
import type { Studio } from "./studio";

const STRESS = { unit: "MPa", factor: 1e6 };

export class PartCard {
  private readonly pick = h("select", { ariaLabel: "Part", change: () => this.studio.link.set(this.pick.value || null) });
  private readonly body = h("div", { className: "card" });
  private names = "";

  constructor(
    private readonly studio: Studio,
    private readonly lighten: (card: Card) => void,
  ) {
    fill(byId("pane-part"), h("div", { className: "bar" }, h("label", {}, "part ", this.pick)), this.body);
    this.hint();
    studio.state.watch(() => this.offer());
    studio.link.watch((link) => this.choose(link));
    studio.reach.watch(() => this.refresh());
  }

  private offer(): void {
    const names = Object.keys(this.studio.state.value?.links ?? {});
    if (names.join() === this.names) return;
    this.names = names.join();
    this.pick.replaceChildren(new Option("none", ""), ...names.map((each) => new Option(each)));
    this.pick.value = this.studio.link.value ?? "";
  }

  private choose(link: string | null): void {
    this.pick.value = link ?? "";
    if (link) this.studio.connection.newest("part", { kind: "part", link }, (said) => said.kind === "card" && said.link === this.studio.link.value && this.show(said, true));
    else this.hint();
  }

  private hint(): void {
    fill(this.body, h("p", { className: "quiet" }, "Click a part of the stage, or its line in the file."));
  }

  private refresh(): void {
    const link = this.studio.link.value;
    if (link && !byId("pane-part").hidden) this.studio.connection.newest("part", { kind: "part", link }, (said) => said.kind === "card" && this.show(said, false));
  }

  private show(card: Card, isNew: boolean): void {
    if (isNew) {
      this.studio.tab.set("part");
      this.lighten(card);
    }
    const lines = card.lines.map((line) => h("button", { type: "button", click: () => this.studio.goto(line) }, `line ${line}`));
    const shares = Object.entries(card.shares).sort(([, one], [, other]) => Math.abs(other) - Math.abs(one));
    fill(
      this.body,
      h("h3", {}, card.link, h("span", { className: "quiet" }, ` ${card.part} (${card.part_kind}) between ${card.bodies.join(" and ")}`)),
      h("div", { className: "buttons" }, ...lines, h("button", { type: "button", click: () => this.studio.viewer.value?.fit(card.link) }, "fit")),
      facts([...this.bears(card), ...(card.free.length ? [{ name: "free", text: card.free.join(", ") }] : []), ...card.facts]),
      shares.length ? facts(shares.map(([name, share]) => ({ name: `part of lost motion of ${name}`, text: percent(share).replace("+", "") || "0 %" }))) : null,
      card.compliance && section("Compliance about the centre of the link, in its frame", matrix(card.compliance)),
      card.stiffness && section("Stiffness", matrix(card.stiffness)),
      card.verified.length ? section("Theory compared with finite elements", facts(card.verified)) : null,
      ...card.problems.map((each) => h("p", { className: "fair" }, sentence(each))),
      ...Object.entries(card.missing).map(([name, reason]) => h("p", { className: "quiet" }, h("b", {}, name), ` ${reason}`)),
    );
  }

  private bears(card: Card): Fact[] {
    if (card.stress === null) return [];
    const limit = card.limit === null ? "" : ` of ${shown(card.limit, STRESS, 4)}`;
    const safety = card.safety === null ? "" : `, safety ${shown(card.safety, { unit: "1", factor: 1 }, 4)}`;
    return [{ name: "peak stress", text: `${shown(card.stress, STRESS, 4)}${limit}${safety}` }];
  }

  /** What the picture itself says of a part that is no link. */
  other(picked: Picked): void {
    this.studio.tab.set("part");
    const { name, what, facts: said, line } = picked.part;
    const go = line === undefined ? null : h("button", { type: "button", click: () => this.studio.goto(line) }, `line ${line}`);
    fill(this.body, h("h3", {}, name, h("span", { className: "quiet" }, ` ${what}`)), h("div", { className: "buttons" }, go), facts(said.map(([key, text]) => ({ name: key, text }))));
    this.studio.goto(line, false);
  }
}

export function facts(said: Fact[]): HTMLElement {
  return h("dl", {}, ...said.flatMap((each) => [h("dt", {}, each.name), h("dd", {}, each.text)]));
}

function section(title: string, content: HTMLElement): HTMLElement {
  return h("div", {}, h("h4", {}, title), content);
}
