// The viewer: a stage in a page, its camera, its motions and its keys.

import { ColorManagement, LinearSRGBColorSpace, Ray, Scene, Vector3, Vector4, WebGLRenderer, WebGLRenderTarget } from "three";
import { TwistArrows } from "./arrows";
import { Camera } from "./camera";
import { moved as movedPoint, Route } from "./course";
import { Curves } from "./curves";
import { Model, UNCUT } from "./model";
import { Overlay } from "./overlay";
import { Panel, type Acts, type Toggle } from "./panel";
import { AMPLITUDES, Player, written } from "./player";
import { STYLE } from "./style";
import { mixed, PLATFORM_OPACITY, theme } from "./theme";
import type { Colour, Controller, Kind, Label, Motion, MotionKey, Options, Picked, Probe, StageData, StandardView } from "./types";
import { floats } from "./unpack";

ColorManagement.enabled = false;

const VIEWS: readonly StandardView[] = ["iso", "top", "front", "right", "back", "left", "bottom"];
const DEEP = 12;
const SNAP = 9; // pixels within which a point is that of a corner
const HOVER = 4; // pixels a pointer may move between down and up and still have clicked

export class Viewer implements Controller {
  readonly alive = true;
  readonly probe: Probe;
  private readonly root: HTMLDivElement;
  private readonly stage = document.createElement("div");
  private readonly renderer: WebGLRenderer;
  private readonly camera: Camera;
  private readonly overlay = new Overlay();
  private readonly panel: Panel | null;
  private readonly figures = new Curves((share) => this.drag(share));
  readonly curves = this.figures.element;
  private told = "";
  private readonly arrows = new TwistArrows();
  private readonly over = new Scene();
  private readonly target = new WebGLRenderTarget(1, 1);
  private readonly ends: (() => void)[] = [];
  private readonly dark = matchMedia("(prefers-color-scheme: dark)");
  private readonly player: Player;
  private readonly ink = new Vector4();
  private readonly ghostInk = new Vector4();
  private readonly plane = UNCUT.clone();
  private model: Model;
  private ghost: Model | null = null;
  private picked: string | null = null;
  private colours: Readonly<Record<string, Colour>> | null = null;
  private painted: "energy" | "stress" | null = null;
  private platformGhost = true;
  private unit: string | null = null;
  private cutAxis = -1;
  private view = 0;
  private frames = 0;
  private due = 0;
  private seen = true;
  private shares: Float32Array | null = null;
  private rest: Model | null = null;
  private pointer: ((point: [number, number, number] | null) => void) | null = null;
  private readonly pickers = new Set<(picked: Picked | null) => void>();
  private readonly watchers = new Set<(motion: Motion | null) => void>();

  constructor(readonly element: HTMLElement, private data: StageData, private readonly options: Options) {
    const canvas = document.createElement("canvas");
    const context = canvas.getContext("webgl2", { antialias: true, alpha: true, premultipliedAlpha: true });
    if (!context) throw new Error("no WebGL 2");
    this.renderer = new WebGLRenderer({ canvas, context });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.autoClear = false;
    this.player = new Player(data);
    this.root = document.createElement("div");
    this.root.className = options.controls === false ? "viewer bare" : "viewer";
    this.stage.className = "stage";
    this.stage.tabIndex = 0;
    this.stage.setAttribute("role", "application");
    this.stage.append(canvas, this.overlay.element);
    this.root.append(this.stage);
    this.panel = options.controls === false ? null : new Panel(this.acts());
    if (this.panel) this.root.append(this.panel.element, this.curves);
    this.mount();
    this.camera = new Camera(canvas, () => this.draw());
    this.model = this.build(data);
    this.over.add(this.arrows.group);
    this.probe = this.makeProbe(canvas);
    this.listen(canvas);
    this.paintTheme();
    this.show(data);
    this.resize();
    this.camera.look("iso");
    this.fit();
    this.start();
  }

  private mount(): void {
    const shadow = this.element.shadowRoot ?? this.element.attachShadow({ mode: "open" });
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(STYLE);
    shadow.adoptedStyleSheets = [sheet];
    shadow.replaceChildren(this.root, document.createElement("slot"));
  }

  private start(): void {
    const { motion, ghost } = this.options;
    this.player.choose(this.player.find(motion ?? null));
    this.player.phase = this.player.outmost;
    this.player.playing = (this.options.playing ?? true) && !matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (ghost) this.showGhost(ghost);
    this.moved();
  }

  private acts(): Acts {
    return {
      choose: (motion) => this.choose(motion),
      play: () => this.setPlaying(!this.player.playing),
      scrub: (phase) => this.drag(phase),
      amplify: (step) => this.setAmplitude(AMPLITUDES[step] ?? AMPLITUDES[0]),
      fit: () => this.fit(),
      toggle: (what) => this.toggle(what),
      turn: () => this.turn(),
      cut: (place) => this.section(this.cutAxis < 0 ? null : (["x", "y", "z"] as const)[this.cutAxis]!, place),
    };
  }

  private build(data: StageData): Model {
    const model = new Model(data, this.ink);
    model.plane = this.plane;
    this.camera.scale(data.size);
    return model;
  }

  private show(data: StageData): void {
    this.overlay.replace(data);
    this.panel?.replace(data);
    this.stage.setAttribute("aria-label", `${data.name}, drawn from its design: drag to rotate it, keys 1 to 9 for its modes`);
    this.paint();
  }

  // What pages ask for.

  replace(data: StageData): void {
    this.model.dispose();
    this.data = data;
    this.model = this.build(data);
    this.player.replace(data);
    if (this.picked !== null && !data.parts.some((each) => each.name === this.picked)) this.select(null);
    if (this.unit !== null && !data.parts.some((each) => each.unit === this.unit)) this.unit = null;
    this.show(data);
    this.moved();
  }

  replaceMotions(motions: Motion[]): void {
    this.data = { ...this.data, motions };
    this.player.replace(this.data);
    this.panel?.replace(this.data);
    this.moved();
  }

  select(name: string | null): void {
    this.picked = name;
    this.paint();
    this.card();
  }

  onPick(callback: (picked: Picked | null) => void): () => void {
    this.pickers.add(callback);
    return () => this.pickers.delete(callback);
  }

  onPoint(callback: ((point: [number, number, number] | null) => void) | null): void {
    this.pointer = callback;
  }

  onMotion(callback: (motion: Motion | null) => void): () => void {
    this.watchers.add(callback);
    return () => this.watchers.delete(callback);
  }

  setMotion(key: MotionKey | null): void {
    this.player.choose(this.player.find(key));
    this.moved();
  }

  setPose(twists: Float32Array | null, factor = 1): void {
    this.player.pose(twists, factor);
    this.moved();
  }

  setPlaying(playing: boolean): void {
    this.player.playing = playing;
    this.player.step(performance.now());
    this.panel?.update(this.player, this.meaning);
    this.draw();
  }

  /** A person takes hold of the phase. */
  private drag(phase: number): void {
    this.player.playing = false;
    this.setPhase(phase);
  }

  setPhase(phase: number): void {
    this.player.phase = phase;
    this.player.follow();
    this.panel?.update(this.player, this.meaning);
    this.travelled();
    this.draw();
  }

  setAmplitude(share: number): void {
    this.player.amplitude = share;
    this.panel?.update(this.player, this.meaning);
    this.draw();
  }

  setColours(colours: Readonly<Record<string, Colour>> | null): void {
    this.colours = colours;
    this.paint();
  }

  showEnergy(shown: boolean): void {
    this.paintLinks(shown ? "energy" : null);
  }

  showStress(shown: boolean): void {
    this.paintLinks(shown ? "stress" : null);
  }

  /** Links in colours of something that is known of each in the motion; null: in their own. */
  private paintLinks(what: "energy" | "stress" | null): void {
    this.painted = what;
    this.panel?.hold("energy", what === "energy");
    this.panel?.hold("stress", what === "stress");
    this.moved();
    this.paint();
  }

  showGhost(data: StageData | null): void {
    this.ghost?.dispose();
    this.ghost = data ? new Model(data, this.ghostInk, true) : null;
    this.ghost?.setPaints(() => [1, 1, 1, 1]);
    this.draw();
  }

  /** The drawn shape as a pale outline, beside what goes away from it to one side. */
  private showRest(shown: boolean): void {
    if (shown === (this.rest?.data === this.data)) return;
    this.rest?.dispose();
    this.rest = shown ? new Model(this.data, this.ghostInk, true) : null;
    this.rest?.setPaints(() => [1, 1, 1, 1]);
  }

  ghostPlatform(shown: boolean): void {
    this.platformGhost = shown;
    this.paint();
  }

  isolate(unit: string | null): void {
    this.unit = unit;
    this.paint();
  }

  showLabels(shown: boolean): void {
    this.overlay.showNames(shown);
    this.draw();
  }

  section(axis: "x" | "y" | "z" | null, place = 0.5): void {
    this.cutAxis = axis === null ? -1 : "xyz".indexOf(axis);
    this.plane.copy(UNCUT);
    if (axis !== null) {
      const [low, high] = this.extent(this.cutAxis);
      this.plane.set(axis === "x" ? 1 : 0, axis === "y" ? -1 : 0, axis === "z" ? 1 : 0, 0);
      const at = low + place * (high - low);
      this.plane.w = axis === "y" ? -at : at; // what is nearer to the usual eye goes
    }
    this.model.plane = this.plane;
    this.panel?.showCut(axis, place);
    this.draw();
  }

  look(view: StandardView): void {
    this.view = VIEWS.indexOf(view);
    this.camera.look(view);
    this.fit();
  }

  fit(name?: string): void {
    const part = name === undefined ? -1 : this.data.parts.findIndex((each) => each.name === name);
    const points = this.model.points;
    this.camera.fit(part < 0 ? points : points.filter((_, at) => this.model.part[Math.floor(at / 3)] === part));
    this.draw();
  }

  picture(): string {
    this.render();
    return this.renderer.domElement.toDataURL("image/png");
  }

  dispose(): void {
    cancelAnimationFrame(this.due);
    for (const end of this.ends) end();
    this.model.dispose();
    this.ghost?.dispose();
    this.rest?.dispose();
    this.arrows.dispose();
    this.target.dispose();
    this.camera.dispose();
    this.renderer.dispose();
    this.element.shadowRoot?.replaceChildren(document.createElement("slot"));
  }

  // What a person does.

  private choose(motion: Motion | null): void {
    this.player.choose(motion);
    if (motion) this.player.playing = true;
    if (this.player.travels) this.player.phase = 0;
    this.moved();
    for (const each of this.watchers) each(motion);
  }

  private toggle(what: Toggle): boolean {
    switch (what) {
      case "platform": this.ghostPlatform(!this.platformGhost); return this.platformGhost;
      case "names": this.overlay.showNames(!this.named); this.draw(); return this.named;
      case "energy": this.showEnergy(this.painted !== "energy"); return this.painted === "energy";
      case "stress": this.showStress(this.painted !== "stress"); return this.painted === "stress";
      case "section": return this.cut();
      case "unit": this.isolate(this.unit === null ? (this.part(this.picked)?.unit ?? null) : null); return this.unit !== null;
      case "keys": return this.overlay.toggleKeys();
    }
  }

  private get named(): boolean {
    return !(this.overlay.element.querySelector(".names") as HTMLElement).hidden;
  }

  private cut(): boolean {
    const next = this.cutAxis + 1;
    this.section(next > 2 ? null : (["x", "y", "z"] as const)[next]!);
    return this.cutAxis >= 0;
  }

  private turn(): void {
    this.look(VIEWS[(this.view + 1) % VIEWS.length]!);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const act = this.keys()[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  }

  private keys(): Readonly<Record<string, () => void>> {
    const modes = this.data.motions.filter((each) => each.group === "mode");
    const press = (what: Toggle) => () => (this.panel ? this.panel.press(what) : void this.toggle(what));
    const amplify = (step: number) => () => {
      const place = AMPLITUDES.findIndex((each) => each >= this.player.amplitude - 1e-9) + step;
      this.setAmplitude(AMPLITUDES[Math.max(0, Math.min(AMPLITUDES.length - 1, place))]!);
    };
    const choices = Object.fromEntries(modes.slice(0, 9).map((motion, at) => [String(at + 1), () => this.choose(motion)]));
    return {
      ...choices, "0": () => this.choose(null), " ": () => this.setPlaying(!this.player.playing), "[": amplify(-1), "]": amplify(1),
      "?": press("keys"), f: () => this.fit(), v: () => this.turn(), g: press("platform"), l: press("names"), e: press("energy"), t: press("stress"), s: press("section"), i: press("unit"),
      escape: () => this.pick([]),
    };
  }

  private click(x: number, y: number): void {
    if (this.pointer) this.pointer(this.pointAt(x, y));
    else this.pick(this.partsAt(x, y));
  }

  /** The first of the parts, or, where that is picked already, the next one behind it. */
  private pick(names: string[]): void {
    const at = this.picked === null ? -1 : names.indexOf(this.picked);
    const name = names[(at + 1) % Math.max(1, names.length)] ?? null;
    this.select(name);
    const index = this.data.parts.findIndex((each) => each.name === name);
    const part = this.data.parts[index];
    for (const each of this.pickers) each(part ? { part, index } : null);
  }

  private listen(canvas: HTMLCanvasElement): void {
    let down: [number, number] | null = null;
    this.on(canvas, "pointerdown", (event) => { down = event.isPrimary ? [event.offsetX, event.offsetY] : null; this.stage.focus({ preventScroll: true }); });
    this.on(canvas, "pointerup", (event) => {
      if (down && event.button === 0 && Math.hypot(event.offsetX - down[0], event.offsetY - down[1]) < HOVER) this.click(event.offsetX, event.offsetY);
      down = null;
    });
    this.on(this.options.globalKeys ? window : this.stage, "keydown", (event) => this.key(event));
    this.on(canvas, "webglcontextrestored", () => this.paint());
    if (this.options.controls !== false) this.leaveScrolling(canvas);
    const near = new IntersectionObserver(([entry]) => { this.seen = entry?.isIntersecting ?? true; if (this.seen) this.draw(); });
    near.observe(this.stage);
    this.ends.push(() => near.disconnect());
    this.on(this.dark, "change", () => { this.paintTheme(); this.paint(); });
    const watched = new ResizeObserver(() => this.resize());
    watched.observe(this.stage);
    this.ends.push(() => watched.disconnect());
  }

  /** In a page that scrolls, wheel and vertical strokes of a finger are the page's until the picture has the focus. */
  private leaveScrolling(canvas: HTMLCanvasElement): void {
    const { controls } = this.camera;
    canvas.style.touchAction = "pan-y";
    controls.enableZoom = false;
    this.on(this.stage, "focusin", () => { controls.enableZoom = true; });
    this.on(this.stage, "focusout", () => { controls.enableZoom = false; });
  }

  private on<Name extends keyof WindowEventMap>(target: EventTarget, name: Name, act: (event: WindowEventMap[Name]) => void): void;
  private on(target: EventTarget, name: "webglcontextrestored", act: () => void): void;
  private on(target: EventTarget, name: string, act: (event: never) => void): void {
    const listener = act as EventListener;
    target.addEventListener(name, listener);
    this.ends.push(() => target.removeEventListener(name, listener));
  }

  // What is drawn.

  private part(name: string | null) {
    return this.data.parts.find((each) => each.name === name);
  }

  private extent(axis: number): [number, number] {
    let [low, high] = [Infinity, -Infinity];
    for (let at = axis; at < this.model.points.length; at += 3) {
      low = Math.min(low, this.model.points[at]!);
      high = Math.max(high, this.model.points[at]!);
    }
    return [low, high];
  }

  private paintTheme(): void {
    const colours = theme(this.dark.matches);
    this.element.classList.toggle("dark", this.dark.matches);
    this.ink.set(...colours.ink);
    this.ghostInk.set(...colours.ghost);
    this.arrows.tint(colours.translation, colours.rotation);
    this.draw();
  }

  private paint(): void {
    const colours = theme(this.dark.matches), { parts, links } = this.data;
    const shares = new Map(this.shares ? links.map((part, at) => [part, this.shares![at]!]) : []);
    const most = this.painted === "stress" ? 1 : Math.max(1e-9, ...[...shares.values()].filter(Number.isFinite));
    const beyond = new Set(this.player.beyond);
    this.model.setPaints((number) => {
      const part = parts[number]!, share = shares.get(number);
      let colour = this.colours?.[part.name] ?? colours.kinds[part.kind];
      if (share !== undefined && !Number.isNaN(share)) colour = share > most ? colours.beyond : mixed(colours.cold, colours.hot, Math.sqrt(share / most));
      if (beyond.has(number)) colour = colours.hot;
      if (part.name === this.picked) colour = colours.chosen;
      return [...colour, this.opacityOf(part.kind, part.unit, part.name)] as const;
    });
    this.draw();
  }

  /** What the colours of the links mean. */
  private get meaning(): string {
    const { motion } = this.player;
    if (this.painted !== "stress" || !motion) return "";
    if (!this.shares) return "stress is known only for strokes and loads";
    const [most, at] = [...this.shares].reduce<[number, number]>((best, share, link) => (share > best[0] ? [share, link] : best), [0, 0]);
    const name = this.data.parts[this.data.links[at] ?? -1]?.name ?? "";
    return `colours: stress from zero to the limit; highest in ${name}, ${written(100 * most)} %, ${motion.stressed ?? ""}`;
  }

  private opacityOf(kind: Kind, unit: string | undefined, name: string): number {
    if (this.unit !== null && unit !== this.unit) return -1;
    return kind === "platform" && this.platformGhost && name !== this.picked ? PLATFORM_OPACITY : 1;
  }

  private moved(): void {
    const { motion, twists } = this.player;
    this.figures.show(this.player.curves);
    this.travelled();
    const known = this.painted && motion?.[this.painted];
    this.shares = known ? floats(known) : null;
    this.showRest(motion?.group === "deflection" || motion?.group === "drift");
    this.model.setTwists(twists ?? new Float32Array(6 * this.data.bodies.length));
    this.panel?.update(this.player, this.meaning);
    if (this.painted) this.paint();
    this.card();
    this.draw();
  }

  /** Cursor and colours follow the place on a path. */
  private travelled(): void {
    this.figures.place(this.player.place);
    if (this.player.happens) this.model.setTwists(this.player.twists!);
    const beyond = this.player.beyond.join();
    if (beyond === this.told) return;
    this.told = beyond;
    this.paint();
  }

  private card(): void {
    const part = this.part(this.picked) ?? null, more: [string, string][] = [];
    const link = part ? this.data.links.indexOf(this.data.parts.indexOf(part)) : -1;
    const { motion } = this.player, of = (packed: string | undefined): number => (packed && link >= 0 ? floats(packed)[link]! : NaN);
    const energy = of(motion?.energy), stress = of(motion?.stress);
    if (Number.isFinite(energy)) more.push(["strain energy", `${written(100 * energy)} %`]);
    if (Number.isFinite(stress)) more.push(["stress", `${written(100 * stress)} % of the limit, ${motion?.stressed ?? ""}`]);
    this.overlay.showCard(this.options.controls === false ? null : part, more); // a page with controls of its own has a card too
    this.draw();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.stage;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.resize(width / height);
    this.draw();
  }

  private draw(): void {
    if (this.due === 0) this.due = requestAnimationFrame((now) => this.tick(now));
  }

  private tick(now: number): void {
    this.due = 0;
    const moves = this.player.step(now);
    this.render();
    if (moves) this.panel?.update(this.player, this.meaning);
    if (moves) this.travelled();
    if (moves && this.seen && this.element.isConnected) this.draw();
  }

  private render(): void {
    this.place();
    this.renderer.setRenderTarget(null);
    this.paintPicture();
    const { clientWidth: width, clientHeight: height } = this.stage;
    this.overlay.update(this.camera, width, height, (label) => this.labelled(label));
    this.frames += 1;
  }

  private place(): void {
    const { platform, reference, size } = this.data, { twists, factor } = this.player;
    const { rows } = this.player;
    this.model.factor = factor;
    this.model.setPoses(rows && Route.aboutOrigin(rows, this.data));
    const own = twists && platform > 0 ? twists.subarray(6 * platform, 6 * platform + 6) : null;
    const point = new Vector3(...reference);
    this.arrows.show(own, point, size, this.player.sense);
  }

  private paintPicture(): void {
    this.renderer.setClearColor(0, 0);
    this.renderer.clear();
    this.renderer.render(this.model.scene, this.camera.eye);
    for (const each of [this.ghost, this.rest]) if (each) this.renderer.render(each.scene, this.camera.eye);
    this.renderer.render(this.over, this.camera.eye);
  }

  /** Where the point of a label is now, which moves with the mean of its bodies; null where what it names is not shown. */
  private labelled(label: Label): Vector3 | null {
    if (this.unit !== null && label.text !== this.unit && !label.text.startsWith(`${this.unit}/`)) return null;
    const rest = new Vector3(...label.point), { twists, factor } = this.player;
    const point = rest.clone(), { rows } = this.player;
    if (rows) {
      const [one, other] = label.bodies.map((body) => new Vector3(...movedPoint(rows, body, this.data.references[body]!, label.point)));
      point.addVectors(one!, other!).multiplyScalar(0.5);
    } else for (const body of twists ? label.bodies : []) {
      const [x, y, z, a, b, c] = twists!.subarray(6 * body, 6 * body + 6) as unknown as [number, number, number, number, number, number];
      point.addScaledVector(new Vector3(a, b, c).cross(rest).add(new Vector3(x, y, z)), 0.5 * factor);
    }
    return this.plane.x * point.x + this.plane.y * point.y + this.plane.z * point.z > this.plane.w ? null : point;
  }

  // What is where.

  private onePixel(x: number, y: number, draw: () => void): Uint8Array {
    const { clientWidth: width, clientHeight: height } = this.stage;
    const found = new Uint8Array(4);
    this.place();
    this.camera.eye.setViewOffset(width, height, x, y, 1, 1);
    this.renderer.setRenderTarget(this.target);
    this.renderer.setClearColor(0, 0);
    this.renderer.clear();
    draw();
    this.renderer.readRenderTargetPixels(this.target, 0, 0, 1, 1, found);
    this.renderer.setRenderTarget(null);
    this.camera.eye.clearViewOffset();
    return found;
  }

  private partAt(x: number, y: number): number {
    const found = this.onePixel(x, y, () => this.renderer.render(this.model.pickScene, this.camera.eye));
    return found[0]! + 256 * found[1]! - 1;
  }

  /** The parts at a place, the nearest first: each one is hidden to see the next. */
  private partsAt(x: number, y: number): string[] {
    const found: number[] = [], opacities: number[] = [];
    for (let part = this.partAt(x, y); part >= 0 && found.length < DEEP; part = this.partAt(x, y)) {
      found.push(part);
      opacities.push(this.model.opacity(part));
      this.model.setOpacity(part, -1);
    }
    found.forEach((part, at) => this.model.setOpacity(part, opacities[at]!));
    this.draw();
    return found.map((part) => this.data.parts[part]!.name);
  }

  /** The point of the undeformed stage at a place: on the nearest face of the part that is seen there, or its corner within a few pixels. */
  private pointAt(x: number, y: number): [number, number, number] | null {
    const part = this.partAt(x, y), { clientWidth: width, clientHeight: height } = this.stage;
    const { points, triangles, part: owners } = this.model, { eye } = this.camera;
    const ray = new Ray(new Vector3((2 * x) / width - 1, 1 - (2 * y) / height, -1).unproject(eye), eye.getWorldDirection(new Vector3()));
    const corner = (at: number): Vector3 => new Vector3().fromArray(points, 3 * triangles[at]!);
    const isSeen = (each: Vector3): boolean => this.plane.x * each.x + this.plane.y * each.y + this.plane.z * each.z <= this.plane.w + 1e-9;
    let found: Vector3 | null = null;
    const own: Vector3[] = [];
    for (let at = 0; at < triangles.length; at += 3) {
      if (owners[triangles[at]!] !== part) continue;
      const face = [corner(at), corner(at + 1), corner(at + 2)] as const;
      own.push(...face.filter(isSeen));
      const hit = ray.intersectTriangle(...face, false, new Vector3());
      if (hit && isSeen(hit) && (!found || ray.origin.distanceTo(hit) < ray.origin.distanceTo(found))) found = hit;
    }
    if (!found) return null;
    const reach = SNAP * this.camera.metresPerPixel(height), depth = ray.origin.distanceTo(found);
    const near = own.filter((each) => ray.distanceToPoint(each) < reach);
    const away = (each: Vector3): number => ray.distanceToPoint(each) + Math.abs(ray.direction.dot(each.clone().sub(ray.origin)) - depth);
    return (near.sort((one, other) => away(one) - away(other))[0] ?? found).toArray();
  }

  private makeProbe(canvas: HTMLCanvasElement): Probe {
    const viewer = this;
    return {
      webgl: true,
      get frames() { return viewer.frames; },
      get camera() {
        const { eye, controls } = viewer.camera;
        return { position: eye.position.toArray(), target: controls.target.toArray(), zoom: eye.zoom };
      },
      get picked() { return viewer.picked; },
      get motion() { const now = viewer.player.motion; return now ? { group: now.group, name: now.name } : null; },
      get phase() { return viewer.player.phase; },
      get factor() { return viewer.player.travels ? viewer.player.exaggeration : viewer.player.factor; },
      get place() { return viewer.player.place; },
      partAt: (x, y) => viewer.data.parts[viewer.partAt(x, y)]?.name ?? null,
      partsAt: (x, y) => viewer.partsAt(x, y),
      pixel: (x, y) => [...viewer.onePixel(x, y, () => viewer.paintPicture())] as [number, number, number, number],
      project: (point) => {
        const [right, down] = viewer.camera.project(new Vector3(...point));
        return [right * canvas.clientWidth, down * canvas.clientHeight];
      },
    };
  }
}
