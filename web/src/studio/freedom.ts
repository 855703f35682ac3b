// Freedom and constraint: free and constrained motions as arrows, each with its links; sets of redundant constraints. A click colours the links.

import type { Fact, Freedoms, Screw } from "../protocol";
import type { StageData } from "../viewer/types";
import { norm, plus } from "./arrows";
import type { Arrow, Point } from "./arrows";
import { byId, digits, fill, grouped, h } from "./dom";
import { facts } from "./part";
import type { StageView } from "./stage";
import type { Studio } from "./studio";

type Paint = [number, number, number];
const BENDS: Paint = [0.95, 0.82, 0.1], HOLDS: Paint = [0.82, 0.16, 0.16], SUPERFLUOUS: Paint = [0.85, 0.1, 0.75]; // none is the colour of a part
const NAMED = 8; // links by name; more are counted

export class FreedomPane {
  private readonly root = byId("pane-freedom");
  private said: Freedoms | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly stage: StageView,
  ) {
    studio.tab.watch((tab) => this.turn(tab === "freedom"));
    studio.figures.watch(() => studio.tab.value === "freedom" && this.ask());
  }

  private turn(on: boolean): void {
    if (on) this.ask();
    else this.picture(null);
  }

  private ask(): void {
    this.studio.connection.newest("free", { kind: "free" }, (said) => said.kind === "freedoms" && this.show(said));
  }

  private show(said: Freedoms): void {
    this.said = said;
    fill(
      this.root,
      h("p", {}, `Mobility ${said.mobility}: the platform has ${said.free.length} free ${said.free.length === 1 ? "motion" : "motions"}.`),
      ...this.list("Free", "deforms", said.free),
      ...this.list("Constrained", "constrained by", said.locked),
      ...told("Locked actuators", said.blocked),
      ...this.sets(said.redundant),
      ...told("Free internal modes, which move neither platform nor actuators", said.idle),
      h("button", { type: "button", click: () => this.picture(this.said) }, "show all arrows"),
    );
    this.picture(this.studio.tab.value === "freedom" ? said : null);
  }

  private list(title: string, verb: string, screws: Screw[]): HTMLElement[] {
    if (!screws.length) return [];
    const items = screws.map((each) => h("li", {}, h("button", { type: "button", click: () => this.point([each]) }, each.name), ` ${spell(each)}; ${verb} `, named(each.links)));
    return [h("h4", {}, title), h("ul", {}, ...items)];
  }

  /** Sets of constraints with one superfluous member: by link, with the locked directions in its frame. */
  private sets(said: Fact[]): HTMLElement[] {
    if (!said.length) return [];
    const items = said.map((each, at) => {
      const links = [...grouped(each.text.split(", "), (name) => name.slice(0, name.lastIndexOf(".")))].map(([link, names]) => ({ link, text: `${link} (${names.map((name) => name.slice(link.length + 1)).join(", ")})` }));
      return h("li", {}, h("button", { type: "button", ariaPressed: "false", click: (event: Event) => this.mark(event.currentTarget as HTMLElement, links.map(({ link }) => link)) }, `set ${at + 1}`), " ", named(links.map(({ text }) => text)));
    });
    return [h("h4", {}, "Redundant constraints: one constraint of each set is superfluous, and stresses the stage if parts do not fit exactly"), h("ul", { id: "redundant" }, ...items)];
  }

  /** Colours the links of one set, or of none. */
  private mark(button: HTMLElement, links: string[]): void {
    const on = button.getAttribute("aria-pressed") !== "true";
    for (const each of this.root.querySelectorAll("[aria-pressed]")) each.setAttribute("aria-pressed", String(each === button && on));
    this.stage.arrows.set("freedom", []);
    this.colour(on ? links : [], SUPERFLUOUS);
  }

  private colour(links: string[], paint: Paint): void {
    this.studio.viewer.value?.setColours(links.length ? Object.fromEntries(links.map((each) => [each, paint])) : null);
  }

  private picture(said: Freedoms | null): void {
    if (said === null) {
      this.stage.arrows.set("freedom", []);
      this.studio.viewer.value?.setColours(null);
    } else this.point([...said.free, ...said.locked]);
  }

  private point(screws: Screw[]): void {
    const { value: data } = this.studio.scene;
    if (!data) return;
    const locked = new Set(this.said?.locked ?? []);
    this.stage.arrows.set("freedom", screws.map((each) => arrow(each, data, locked.has(each))));
    const [only] = screws;
    if (screws.length === 1 && only) this.colour(only.links, locked.has(only) ? HOLDS : BENDS);
    else this.colour([], HOLDS);
    for (const each of this.root.querySelectorAll("[aria-pressed]")) each.setAttribute("aria-pressed", "false");
  }
}

function arrow(screw: Screw, data: StageData, isLocked: boolean): Arrow {
  const length = 0.28 * data.size;
  const isMove = screw.pitch === null;
  const from = (isMove ? data.reference : screw.point) as Point;
  const direction = norm(screw.direction) > 0 ? screw.direction : screw.twist.slice(isMove ? 0 : 3);
  const size = norm(direction.slice(0, 3)) || 1;
  return { from, to: plus(from, direction, length / size), look: isLocked ? "locked" : "free", turns: !isMove, text: screw.name };
}

/** Links by name, the first ones; all of them in its title. */
function named(links: string[]): HTMLElement {
  const more = links.length > NAMED ? ` and ${links.length - NAMED} more` : "";
  return h("small", { title: links.join(", ") }, links.length ? `${links.slice(0, NAMED).join(", ")}${more}` : "unknown links");
}

function spell(screw: Screw): string {
  if (screw.pitch === null) return `moves along (${screw.direction.map((each) => digits(Math.abs(each) < 1e-9 ? 0 : each, 3)).join(", ")})`;
  const point = screw.point.map((each) => digits(Math.abs(each) < 1e-9 ? 0 : 1000 * each, 4)).join(", ");
  const pitch = Math.abs(screw.pitch) < 1e-9 ? "" : `, pitch ${digits(1000 * screw.pitch, 4)} mm/rad`;
  return `rotates about (${screw.direction.map((each) => digits(Math.abs(each) < 1e-9 ? 0 : each, 3)).join(", ")}) through (${point}) mm${pitch}`;
}

function told(title: string, said: Fact[]): HTMLElement[] {
  return said.length ? [h("h4", {}, title), facts(said)] : [];
}
