// Freedom and constraint: free screws and what locks the platform as arrows, superfluous constraints in words, the culprits in colour.

import type { Fact, Freedoms, Screw } from "../protocol";
import type { StageData } from "../viewer/types";
import { norm, plus } from "./arrows";
import type { Arrow, Point } from "./arrows";
import { byId, digits, fill, h } from "./dom";
import { facts } from "./part";
import type { StageView } from "./stage";
import type { Studio } from "./studio";

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
      ...list("Free", said.free, (each) => this.point([each])),
      ...list("Locked", said.locked, (each) => this.point([each])),
      ...told("Locked motions", said.blocked),
      ...told("Redundant constraints: they stress the stage if parts do not fit exactly", said.redundant),
      ...told("Free internal modes: move neither platform nor stroke", said.idle),
      h("button", { type: "button", click: () => this.picture(this.said) }, "show all arrows"),
    );
    this.picture(this.studio.tab.value === "freedom" ? said : null);
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
    const culprits = screws.filter((each) => locked.has(each)).flatMap((each) => each.links);
    this.studio.viewer.value?.setColours(culprits.length ? Object.fromEntries(culprits.map((each) => [each, [0.82, 0.16, 0.16] as [number, number, number]])) : null);
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

function list(title: string, screws: Screw[], point: (each: Screw) => void): HTMLElement[] {
  if (!screws.length) return [];
  const items = screws.map((each) => h("li", {}, h("button", { type: "button", click: () => point(each) }, each.name), ` ${spell(each)}`, h("small", { className: "quiet", title: each.links.join(", ") }, ` ${each.links.length} links ${title === "Locked" ? "hold it" : "bend"}`)));
  return [h("h4", {}, title), h("ul", {}, ...items)];
}

function spell(screw: Screw): string {
  if (screw.pitch === null) return `moves along (${screw.direction.map((each) => digits(Math.abs(each) < 1e-9 ? 0 : each, 3)).join(", ")})`;
  const point = screw.point.map((each) => digits(Math.abs(each) < 1e-9 ? 0 : 1000 * each, 4)).join(", ");
  const pitch = Math.abs(screw.pitch) < 1e-9 ? "" : `, ${digits(1000 * screw.pitch, 4)} mm a radian`;
  return `rotates about (${screw.direction.map((each) => digits(Math.abs(each) < 1e-9 ? 0 : each, 3)).join(", ")}) through (${point}) mm${pitch}`;
}

function told(title: string, said: Fact[]): HTMLElement[] {
  return said.length ? [h("h4", {}, title), facts(said)] : [];
}
