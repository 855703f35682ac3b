// The viewer of a stage: `flexstage.view(element, data, options)`, and all `<div data-flexstage="ID">` of a page, which it finds by itself:
// ID is that of a `<script type="application/json">` with the stage's data, `data-motion="mode 1"` the motion that is shown first, `data-ghost` the
// ID of another stage that is shown as its ghost. An element whose viewer has begun says so by a "flexstage" event.

import type { Controller, MotionGroup, MotionKey, Options, Probe, StageData } from "./types";
import { Viewer } from "./viewer";

export type * from "./types";

declare global {
  interface HTMLElement {
    flexstage?: Controller;
  }
}

/** A viewer in an element. Where there is no WebGL what the element holds stays as it is, and a line says so. */
export function view(element: HTMLElement, data: StageData, options: Options = {}): Controller {
  let made: Controller;
  try {
    made = new Viewer(element, data, options);
  } catch (error) {
    made = still(element, error);
  }
  element.flexstage = made;
  return made;
}

const NOWHERE: Probe = {
  webgl: false, frames: 0, camera: { position: [0, 0, 0], target: [0, 0, 0], zoom: 1 }, picked: null, motion: null, phase: 0, factor: 0, place: 0,
  partAt: () => null, partsAt: () => [], pixel: () => [0, 0, 0, 0], project: () => [0, 0],
};

/** What stands in for a viewer where there can be none. */
function still(element: HTMLElement, error: unknown): Controller {
  const line = document.createElement("p");
  line.className = "flexstage-still";
  line.textContent = "This browser draws no 3-D pictures here (no WebGL 2): the picture is static.";
  line.title = String(error);
  element.append(line);
  const nothing = (): void => undefined, ends = () => nothing;
  return {
    element, alive: false, curves: document.createElement("div"), probe: NOWHERE, replace: nothing, replaceMotions: nothing, select: nothing, onPick: ends, onPoint: nothing, onMotion: ends, setMotion: nothing,
    setPose: nothing, setPlaying: nothing, setPhase: nothing, setAmplitude: nothing, setColours: nothing, showEnergy: nothing, showStress: nothing, showGhost: nothing,
    ghostPlatform: nothing, isolate: nothing, showLabels: nothing, section: nothing, look: nothing, fit: nothing, picture: () => "",
    dispose: () => line.remove(),
  };
}

function motionOf(text: string | undefined): MotionKey | undefined {
  const [group, ...name] = (text ?? "").split(" ");
  return name.length ? { group: group as MotionGroup, name: name.join(" ") } : undefined;
}

function stageOf(id: string): StageData | null {
  const text = document.getElementById(id)?.textContent;
  return text ? (JSON.parse(text) as StageData) : null;
}

/** Begins the viewers of a page, each when it comes near the window: a browser gives a page few pictures at a time. */
export function start(): void {
  const near = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (!isIntersecting || !(target instanceof HTMLElement) || target.flexstage) continue;
      near.unobserve(target);
      const data = stageOf(target.dataset["flexstage"] ?? ""), motion = motionOf(target.dataset["motion"]), ghost = stageOf(target.dataset["ghost"] ?? "");
      if (data) view(target, data, { ...(motion ? { motion } : {}), ...(ghost ? { ghost } : {}) });
      target.dispatchEvent(new Event("flexstage", { bubbles: true }));
    }
  }, { rootMargin: "200px" });
  for (const each of document.querySelectorAll("[data-flexstage]")) near.observe(each);
}

if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
else start();
