// Strokes at large displacements: what is driven and how far; the stage then goes along its path, over curves with a cursor.

import type { Travelled, Underway } from "../protocol";
import type { Motion } from "../viewer/types";
import { fill, framewise, h, sentence, shown } from "./dom";
import type { Studio } from "./studio";

const COORDINATES = ["x", "y", "z", "rx", "ry", "rz"].map((each) => `platform.${each}`);

const PATHS = "paths.";

export class Travel {
  readonly root = h("div", { className: "strip", id: "travel" });
  private readonly drive = h("select", { ariaLabel: "Drive", change: () => ((this.isChosen = true), (this.isTyped = false), this.turn()) });
  private readonly start = h("input", { type: "text", size: 8, placeholder: "at rest", ariaLabel: "from", input: () => (this.isTyped = true) });
  private readonly end = h("input", { type: "text", size: 8, required: true, placeholder: "1 mm", ariaLabel: "to", input: () => (this.isTyped = true) });
  private readonly points = h("input", { type: "number", min: 2, max: 201, value: "21", ariaLabel: "points" });
  private readonly load = h("input", { type: "text", size: 16, placeholder: "platform.fy=-20 N", ariaLabel: "loads" });
  private readonly own = [h("label", {}, "from ", this.start), h("label", {}, "to ", this.end), h("label", {}, this.points, " points"), h("label", {}, "under ", this.load)];
  private readonly go = h("button", { type: "submit" }, "compute");
  private readonly stop = h("button", { type: "button", hidden: true, click: () => void this.studio.ask({ kind: "halt" }) }, "cancel");
  private readonly busy = h("progress", { ariaLabel: "path", hidden: true });
  private readonly place = h("input", { type: "range", min: 0, max: 1, step: 0.002, value: "0", ariaLabel: "Stroke", input: () => this.scrub() });
  private readonly playing = h("button", { type: "button", click: () => this.toggle() }, "pause");
  private readonly shapes = h("select", { ariaLabel: "Path or mode", change: () => this.choose() });
  private readonly player = h("div", { className: "bar", hidden: true }, this.shapes, this.playing, this.place);
  private readonly about = h("p", { className: "beyond", role: "status" });
  private readonly curves = h("div", {});
  private motions: Motion[] = [];
  private revision = -1;
  private isPlaying = true;
  /** Whether a person chose the drive, and typed the ends of its path. */
  private isChosen = false;
  private isTyped = false;
  private readonly follow = framewise(() => this.followNow());

  constructor(private readonly studio: Studio) {
    const form = h(
      "form",
      { className: "bar", submit: (event: Event) => { event.preventDefault(); void this.ask(); } },
      this.drive, ...this.own, this.go, this.stop, this.busy,
    );
    fill(this.root, form, this.player, this.about, this.curves);
    fill(this.about, h("span", { className: "quiet" }, "Large displacements with weight: true positions of bodies and leaves. Strokes are relative to static equilibrium."));
    for (const each of [studio.state, studio.reach]) each.watch(() => this.offer());
    studio.connection.on("underway", (said) => this.tell(said));
    studio.figures.watch((each) => each?.revision !== this.revision && this.leave("The design has changed: compute again."));
    studio.scene.watch(() => this.put());
    studio.mode.watch((mode) => mode !== null && this.leave(""));
  }

  /** What can be driven; the design's own paths first. */
  private offer(): void {
    const state = this.studio.state.value, held = this.drive.value;
    const names = [...(state?.paths.map((each) => PATHS + each) ?? []), ...COORDINATES, ...(state?.actuators.map((each) => each.name) ?? [])];
    if (names.join() !== [...this.drive.options].map((each) => each.value).join()) this.drive.replaceChildren(...names.map((each) => new Option(each)));
    const [first] = this.studio.reach.value?.strokes ?? [];
    if (this.isChosen && names.includes(held)) this.drive.value = held;
    else if (!state?.paths.length && first) this.drive.value = `platform.${first.coordinate}`;
    this.turn();
  }

  /** The name of a path that the design states, which says ends and loads itself. */
  private get path(): string {
    return this.drive.value.startsWith(PATHS) ? this.drive.value.slice(PATHS.length) : "";
  }

  private turn(): void {
    for (const each of this.own) each.hidden = this.path !== "";
    this.end.required = this.path === "";
    if (!this.isTyped) [this.start.value, this.end.value] = this.limits();
  }

  /** The ends of the drive's own stroke, empty if unknown. */
  private limits(): [string, string] {
    const { state, reach } = this.studio, name = this.drive.value;
    const axis = name.replace("platform.", "");
    const stroke = axis === name ? undefined : reach.value?.strokes.find((each) => each.coordinate === axis);
    const channel = [...(state.value?.actuators ?? []), ...(state.value?.axes ?? [])].find((each) => each.name === name || each.name === axis);
    const ends = stroke ?? channel;
    if (!channel || !ends || ends.low === null || ends.high === null) return ["", ""];
    return [shown(ends.low, channel, 4).replace("−", "-"), shown(ends.high, channel, 4).replace("−", "-")];
  }

  private async ask(): Promise<void> {
    this.wait(true);
    const loads = this.load.value.split(",").map((each) => each.trim()).filter(Boolean);
    const said = await this.studio.ask({ kind: "travel", drive: this.drive.value, start: this.start.value.trim(), end: this.end.value.trim(), points: Number(this.points.value), loads, path: this.path });
    this.wait(false);
    if (said.kind === "travelled") this.show(said);
    else if (said.kind === "refusal") fill(this.about, said.problems.length ? h("span", { className: "poor" }, said.problems.map((each) => `${each.where.replace("--load", "load")}: ${sentence(each)}`).join(" ")) : "Cancelled.");
  }

  private tell(said: Underway): void {
    this.busy.value = said.fraction;
    this.busy.title = said.text;
    fill(this.about, h("span", { className: "quiet" }, said.text));
  }

  private wait(on: boolean): void {
    if (on) this.busy.removeAttribute("value");
    this.go.disabled = on;
    this.stop.hidden = this.busy.hidden = !on;
  }

  private show(said: Travelled): void {
    const viewer = this.studio.viewer.value, scene = this.studio.scene.value;
    this.studio.mode.set(null);
    this.motions = said.motions as Motion[];
    this.revision = said.revision;
    fill(this.about, ...said.warnings.map((each) => h("span", { className: "fair" }, `${each.where}: ${sentence(each)}`)));
    this.shapes.replaceChildren(...this.motions.map((each) => new Option([each.label, each.remark].filter(Boolean).join("  "), `${each.group} ${each.name}`)));
    if (!viewer?.alive || !scene) return;
    fill(this.curves, viewer.curves);
    this.put();
    this.player.hidden = false;
    this.choose();
  }

  /** The path beside the picture's own motions. */
  private put(): void {
    const { viewer, scene } = this.studio;
    if (this.motions.length && scene.value) viewer.value?.replaceMotions([...scene.value.motions, ...this.motions]);
  }

  private choose(): void {
    const { value: viewer } = this.studio.viewer, chosen = this.motions[this.shapes.selectedIndex];
    if (!viewer || !chosen) return;
    viewer.setMotion({ group: chosen.group, name: chosen.name });
    if (chosen.group === "path") viewer.setPhase(0);
    viewer.setPlaying(this.isPlaying);
    this.follow();
  }

  private followNow(): void {
    const { value: viewer } = this.studio.viewer;
    if (!viewer?.probe.motion || this.player.hidden || !["path", "state"].includes(viewer.probe.motion.group)) return;
    if (document.activeElement !== this.place || this.isPlaying) this.place.value = String(viewer.probe.phase);
    this.follow();
  }

  private toggle(): void {
    this.isPlaying = !this.isPlaying;
    this.playing.textContent = this.isPlaying ? "pause" : "play";
    this.studio.viewer.value?.setPlaying(this.isPlaying);
  }

  private scrub(): void {
    if (this.isPlaying) this.toggle();
    this.studio.viewer.value?.setPhase(Number(this.place.value));
  }

  /** The path is of another design, or something else plays. */
  private leave(words: string): void {
    if (this.player.hidden) return;
    if (words) fill(this.about, h("span", { className: "quiet" }, words));
    if (words) this.motions = [];
    this.player.hidden = words !== "";
  }
}
