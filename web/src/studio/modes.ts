// The mode bar: which mode plays, its phase and amplitude, a second one beside it.

import type { ModeShape, SolidMode } from "../protocol";
import type { Controller, Motion, MotionGroup, MotionKey } from "../viewer/types";
import { byId, digits, fill, h, percent } from "./dom";
import { singles } from "./floats";
import type { StageView } from "./stage";
import type { Studio } from "./studio";

const OTHERS: Partial<Record<MotionGroup, string>> = { deflection: "Under permanent load", drift: "Thermal drift, actuators fixed" };

export class ModeBar {
  readonly root = h("div", { className: "strip" });
  private readonly list = h("select", { id: "modes", ariaLabel: "Mode", change: () => this.choose(this.list.value) });
  private readonly beside = h("select", { ariaLabel: "Second mode", hidden: true, change: () => ((this.isOwn = true), this.playSecond()) });
  private readonly phase = h("input", { type: "range", min: 0, max: 1, step: 0.005, value: "0", ariaLabel: "Phase", input: () => this.scrub() });
  private readonly amplitude = h("input", { type: "range", min: 0.005, max: 0.2, step: 0.005, value: "0.06", ariaLabel: "Amplitude", input: () => this.scale() });
  private readonly factor = h("output", {});
  private readonly button = h("button", { type: "button", title: "space", click: () => this.toggle() }, "pause");
  private readonly about = h("p", { className: "quiet about" });
  private isPlaying = true;
  private second: Controller | null = null;
  private solids: SolidMode[] = [];
  private hadSolids = false;
  /** Loads and changes of temperature that were there last: what they do is worked out when it is looked at. */
  private others: Motion[] = [];
  private why = "";
  /** Whether a person chose the second mode. */
  private isOwn = false;

  constructor(
    private readonly studio: Studio,
    private readonly stage: StageView,
  ) {
    const energy = this.paints("energy", "strain energy", "colour links by their fraction of the strain energy");
    const stress = this.paints("stress", "stress", "colour links by their stress utilisation, under loads and at jogged strokes");
    const two = h("label", {}, h("input", { type: "checkbox", change: (event: Event) => this.two((event.target as HTMLInputElement).checked) }), "two side by side");
    fill(
      this.root,
      h("div", { className: "bar" }, this.list, this.beside, this.button, energy, stress, two),
      h("div", { className: "bar" }, h("label", {}, "phase ", this.phase), h("label", {}, "amplitude ", this.amplitude), this.factor),
      this.about,
    );
    studio.figures.watch(() => this.offer());
    studio.mode.watch((mode) => (mode !== null && studio.other.set(null), this.play()));
    studio.other.watch(() => this.play());
    studio.viewer.watch(() => this.play());
    studio.scene.watch((scene) => (this.offer(), this.play(), scene && this.fresh()));
    studio.painted.watch((what) => this.paint(what));
    studio.connection.on("jobs", (said) => said.jobs.some((each) => each.command === "verify" && each.state === "done" && !this.verified.has(each.job) && this.verified.add(each.job)) && this.ask());
  }

  private readonly verified = new Set<number>();

  private paints(what: "energy" | "stress", text: string, title: string): HTMLElement {
    const made = h("input", { type: "checkbox", change: () => this.studio.painted.set(made.checked ? what : null) });
    this.studio.painted.watch((now) => (made.checked = now === what));
    return h("label", { title }, made, text);
  }

  private paint(what: "energy" | "stress" | null): void {
    if (what === "stress") this.studio.viewer.value?.showStress(true);
    else this.studio.viewer.value?.showEnergy(what === "energy");
    this.tell();
  }

  /** Asks for modes by finite elements: once, and as long as there are any for some text. */
  private fresh(): void {
    if (this.hadSolids || this.why === "") this.ask();
  }

  private ask(): void {
    this.studio.connection.newest("solid", { kind: "solid" }, (said) => {
      if (said.kind !== "solidmodes") return;
      this.solids = said.modes;
      this.why = said.missing;
      this.hadSolids ||= said.modes.length > 0;
      this.offer();
      if (this.partner && !this.isOwn) this.beside.value = `fea ${this.partner.number}`;
      this.playSecond();
    });
  }

  private offer(): void {
    const modes = (this.studio.figures.value?.modes ?? []).map((each) => new Option(`${each.number}   ${digits(each.frequency)} Hz   ${each.name}`, String(each.number)));
    if (this.studio.scene.value?.motions.length) this.others = this.studio.scene.value.motions;
    const others = Object.entries(OTHERS).map(([group, title]) => this.group(title, this.others.filter((each) => each.group === group).map((each) => new Option(each.label, `${group} ${each.name}`))));
    const solids = this.group("Finite elements", this.solids.map((each) => new Option(`FEA ${each.number}   ${digits(each.frequency)} Hz   ${each.name}`, `fea ${each.number}`)));
    this.fill(this.list, new Option("at rest (0)", ""), [...modes, ...others]);
    this.fill(this.beside, new Option("second mode", ""), [...modes.map((each) => new Option(each.text, each.value)), solids]);
    this.tell();
  }

  private group(label: string, options: HTMLOptionElement[]): HTMLOptGroupElement | null {
    return options.length ? h("optgroup", { label }, ...options) : null;
  }

  private fill(select: HTMLSelectElement, still: HTMLOptionElement, rest: (HTMLElement | null)[]): void {
    const held = select.value;
    fill(select, still, ...rest);
    select.value = [...select.options].some((each) => each.value === held) ? held : "";
  }

  private choose(value: string): void {
    const [group, ...name] = value.split(" ");
    const isMode = name.length === 0;
    this.studio.mode.set(isMode && value ? Number(value) : null);
    this.studio.other.set(isMode ? null : { group: group as MotionGroup, name: name.join(" ") });
  }

  private chosen(): ModeShape | null {
    const number = this.studio.mode.value;
    return this.studio.figures.value?.modes.find((each) => each.number === number) ?? null;
  }

  private motion(key: MotionKey | null): Motion | null {
    return this.studio.scene.value?.motions.find((each) => each.group === key?.group && each.name === key.name) ?? null;
  }

  /** What plays: a mode, a load or a change of temperature. */
  private get now(): MotionKey | null {
    const { mode, other } = this.studio;
    return mode.value === null ? other.value : { group: "mode", name: String(mode.value) };
  }

  /** The mode of finite elements that moves like the one that plays. */
  private get partner(): SolidMode | null {
    return this.solids.find((each) => each.theory !== null && each.theory === this.studio.mode.value) ?? null;
  }

  private play(): void {
    const key = this.now;
    this.list.value = key === null ? "" : key.group === "mode" ? key.name : `${key.group} ${key.name}`;
    const motion = this.motion(key);
    const { value: viewer } = this.studio.viewer;
    viewer?.setMotion(motion ? key : null);
    if (this.partner && this.beside.value.startsWith("fea ")) this.beside.value = `fea ${this.partner.number}`;
    if (this.second) this.playSecond();
    if (motion) viewer?.setPlaying(this.isPlaying);
    if (motion) viewer?.setAmplitude(Number(this.amplitude.value));
    this.tell();
  }

  private tell(): void {
    const mode = this.chosen();
    const parts = mode === null ? [] : Object.entries(mode.strain).slice(0, 4).map(([name, share]) => `${name} ${percent(share, 2).slice(1)}`);
    const role = mode?.platform ? "platform mode" : mode?.local ? "local" : "";
    const other = this.motion(this.studio.other.value);
    const still = other ? [other.remark, this.most(other)].filter(Boolean).join("; ") : "Keys 1 to 9 play a mode, 0 stops. A click on a peak of the response plays its mode.";
    fill(this.about, mode === null ? still : [role, this.beyond(mode), `${digits(100 * mode.share, 4)} % of the kinetic energy in the platform`, parts.length ? `strain energy: ${parts.join(", ")}` : ""].filter(Boolean).join("; "));
    this.written();
  }

  /** What finite elements say of a mode. */
  private beyond(mode: ModeShape): string {
    const { partner } = this;
    if (partner) return `finite elements ${digits(partner.frequency)} Hz, theory ${percent(partner.difference, 2) || "0 %"}, modal assurance ${digits(partner.assurance, 3)}`;
    if (!mode.platform) return "";
    return this.solids.length ? "no paired mode of finite elements" : this.beside.hidden ? "" : this.why;
  }

  /** The link that bears most in a motion whose stress is known. */
  private most(motion: Motion): string {
    const { scene } = this.studio;
    if (!motion.stress || !scene.value) return "";
    const shares = [...singles(motion.stress)].map((share, at) => [share, scene.value!.parts[scene.value!.links[at] ?? -1]?.name ?? ""] as const).filter(([share]) => Number.isFinite(share));
    const [share, name] = shares.reduce((best, each) => (each[0] > best[0] ? each : best), [0, ""] as const);
    return name ? `highest stress in ${name}: ${digits(100 * share, 3)} % of the limit, ${motion.stressed ?? ""}` : "";
  }

  private written(): void {
    const probe = this.studio.viewer.value?.probe;
    const motion = this.motion(this.now);
    const size = this.studio.scene.value?.size ?? 0;
    const drawn = Number(this.amplitude.value) * size;
    if (this.chosen() && this.studio.scene.value?.motions.length && !motion) return fill(this.factor, "the picture does not contain this mode");
    const text = motion?.scaled ? `drawn × ${digits(motion.reach > 0 ? drawn / motion.reach : null, 3)}` : `largest motion drawn as ${digits(1000 * drawn, 3)} mm`;
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
    if (on && !this.beside.value) this.beside.value = this.partner ? `fea ${this.partner.number}` : String((this.studio.mode.value ?? 0) + 1);
    if (on) this.ask();
    this.playSecond();
  }

  private playSecond(): void {
    const solids = this.solids.map((each) => each.motion as Motion), scene = this.studio.scene.value;
    if (!this.second || !scene) return this.tell();
    const name = this.beside.value;
    if (name.startsWith("fea ")) this.second.replaceMotions([...scene.motions, ...solids]);
    this.second.setMotion(name ? { group: "mode", name } : null);
    this.second.setAmplitude(Number(this.amplitude.value));
    this.second.setPlaying(this.isPlaying);
    this.tell();
  }
}

type Strip = "modes" | "jog" | "travel";
const TITLES: Readonly<Record<Strip, string>> = { modes: "Modes", jog: "Jog", travel: "Stroke" };

/** The strip below the stage: modes, jog or a stroke at large displacements. */
export function motionStrip(studio: Studio, modes: ModeBar, jog: { root: HTMLElement; load(): void }, travel: { root: HTMLElement }): (name: Strip) => void {
  const strips: Record<Strip, HTMLElement> = { modes: modes.root, jog: jog.root, travel: travel.root };
  const names = Object.keys(strips) as Strip[];
  const buttons = names.map((name) => h("button", { type: "button", role: "tab", click: () => show(name) }, TITLES[name]));
  const show = (name: Strip): void => {
    for (const [each, strip] of Object.entries(strips)) strip.hidden = each !== name;
    for (const [at, each] of Object.keys(strips).entries()) buttons[at]?.setAttribute("aria-selected", String(each === name));
    studio.strip.set(name);
    if (name === "jog") jog.load();
  };
  fill(byId("motion"), h("div", { className: "bar tabs", role: "tablist" }, ...buttons), modes.root, jog.root, travel.root);
  show("modes");
  return show;
}
