// The mode bar: which mode plays, its phase and amplitude, a second one beside it.

import type { ModeShape } from "../protocol";
import type { Controller, Motion } from "../viewer/types";
import { byId, digits, fill, h, percent } from "./dom";
import type { StageView } from "./stage";
import type { Studio } from "./studio";

export class ModeBar {
  readonly root = h("div", { className: "strip" });
  private readonly list = h("select", { id: "modes", ariaLabel: "Mode", change: () => this.studio.mode.set(this.list.value ? Number(this.list.value) : null) });
  private readonly beside = h("select", { ariaLabel: "Second mode", hidden: true, change: () => this.playSecond() });
  private readonly phase = h("input", { type: "range", min: 0, max: 1, step: 0.005, value: "0", ariaLabel: "Phase", input: () => this.scrub() });
  private readonly amplitude = h("input", { type: "range", min: 0.005, max: 0.2, step: 0.005, value: "0.06", ariaLabel: "Amplitude", input: () => this.scale() });
  private readonly factor = h("output", {});
  private readonly button = h("button", { type: "button", title: "space", click: () => this.toggle() }, "pause");
  private readonly about = h("p", { className: "quiet about" });
  private isPlaying = true;
  private second: Controller | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly stage: StageView,
  ) {
    const energy = h("label", {}, h("input", { type: "checkbox", change: (event: Event) => studio.viewer.value?.showEnergy((event.target as HTMLInputElement).checked) }), "strain energy");
    const two = h("label", {}, h("input", { type: "checkbox", change: (event: Event) => this.two((event.target as HTMLInputElement).checked) }), "two side by side");
    fill(
      this.root,
      h("div", { className: "bar" }, this.list, this.beside, this.button, energy, two),
      h("div", { className: "bar" }, h("label", {}, "phase ", this.phase), h("label", {}, "amplitude ", this.amplitude), this.factor),
      this.about,
    );
    studio.figures.watch((said) => said && this.offer(said.modes));
    studio.mode.watch(() => this.play());
    studio.viewer.watch(() => this.play());
    studio.scene.watch(() => this.play());
  }

  private offer(modes: ModeShape[]): void {
    for (const select of [this.list, this.beside]) {
      const held = select.value;
      const still = new Option(select === this.list ? "at rest (0)" : "second mode", "");
      select.replaceChildren(still, ...modes.map((each) => new Option(`${each.number}   ${digits(each.frequency)} Hz   ${each.name}`, String(each.number))));
      select.value = modes.some((each) => String(each.number) === held) ? held : "";
    }
    this.tell();
  }

  private chosen(): ModeShape | null {
    const number = this.studio.mode.value;
    return this.studio.figures.value?.modes.find((each) => each.number === number) ?? null;
  }

  private motion(number: number | null): Motion | null {
    return this.studio.scene.value?.motions.find((each) => each.group === "mode" && each.name === String(number)) ?? null;
  }

  private play(): void {
    const number = this.studio.mode.value;
    this.list.value = number === null ? "" : String(number);
    const motion = this.motion(number);
    const { value: viewer } = this.studio.viewer;
    viewer?.setMotion(motion ? { group: "mode", name: motion.name } : null);
    if (motion) viewer?.setPlaying(this.isPlaying);
    if (motion) viewer?.setAmplitude(Number(this.amplitude.value));
    this.tell();
  }

  private tell(): void {
    const mode = this.chosen();
    const parts = mode === null ? [] : Object.entries(mode.strain).slice(0, 4).map(([name, share]) => `${name} ${percent(share, 2).slice(1)}`);
    const role = mode?.platform ? "platform's mode" : mode?.local ? "local" : "";
    fill(this.about, mode === null ? "1 to 9 play a mode, 0 stops; a click at a peak of the response plays its mode." : `${role ? `${role}, ` : ""}platform ${digits(100 * mode.share, 4)} % of kinetic energy${parts.length ? `; strain energy: ${parts.join(", ")}` : ""}`);
    this.written();
  }

  private written(): void {
    const probe = this.studio.viewer.value?.probe;
    const motion = this.motion(this.studio.mode.value);
    const size = this.studio.scene.value?.size ?? 0;
    const drawn = Number(this.amplitude.value) * size;
    if (this.chosen() && this.studio.scene.value && !motion) return fill(this.factor, "the picture does not hold this mode");
    const text = motion?.scaled ? `drawn × ${digits(probe?.factor ?? null, 3)}` : `largest motion drawn as ${digits(1000 * drawn, 3)} mm`;
    fill(this.factor, motion && probe ? text : "");
  }

  toggle(): void {
    this.isPlaying = !this.isPlaying;
    this.button.textContent = this.isPlaying ? "pause" : "play";
    this.studio.viewer.value?.setPlaying(this.isPlaying);
    this.second?.setPlaying(this.isPlaying);
    this.phase.value = String(this.studio.viewer.value?.probe.phase ?? 0);
  }

  private scrub(): void {
    if (this.isPlaying) this.toggleQuietly();
    this.studio.viewer.value?.setPhase(Number(this.phase.value));
    this.second?.setPhase(Number(this.phase.value));
  }

  private toggleQuietly(): void {
    const held = this.phase.value;
    this.toggle();
    this.phase.value = held;
  }

  private scale(): void {
    this.studio.viewer.value?.setAmplitude(Number(this.amplitude.value));
    this.second?.setAmplitude(Number(this.amplitude.value));
    this.written();
  }

  louder(times: number): void {
    this.amplitude.value = String(Number(this.amplitude.value) * times);
    this.scale();
  }

  private two(on: boolean): void {
    this.beside.hidden = !on;
    this.second = this.stage.beside(on);
    if (on && !this.beside.value) this.beside.value = String((this.studio.mode.value ?? 0) + 1);
    this.playSecond();
  }

  private playSecond(): void {
    const motion = this.motion(Number(this.beside.value));
    this.second?.setMotion(motion ? { group: "mode", name: motion.name } : null);
    this.second?.setAmplitude(Number(this.amplitude.value));
    this.second?.setPlaying(this.isPlaying);
  }
}

/** The strip below the stage: modes or jog. */
export function motionStrip(modes: ModeBar, jog: { root: HTMLElement; load(): void }): (name: "modes" | "jog") => void {
  const strips = { modes: modes.root, jog: jog.root };
  const buttons = Object.keys(strips).map((name) => h("button", { type: "button", role: "tab", click: () => show(name as "modes" | "jog") }, name === "modes" ? "Modes" : "Jog"));
  const show = (name: "modes" | "jog"): void => {
    for (const [each, strip] of Object.entries(strips)) strip.hidden = each !== name;
    for (const [at, each] of Object.keys(strips).entries()) buttons[at]?.setAttribute("aria-selected", String(each === name));
    if (name === "jog") jog.load();
  };
  fill(byId("motion"), h("div", { className: "bar tabs", role: "tablist" }, ...buttons), modes.root, jog.root);
  show("modes");
  return show;
}
