// Tabs of the right pane, and the edges between panes, which can be drawn.

import { byId, fill, h } from "./dom";
import type { Studio } from "./studio";

const TABS = { figures: "Figures", part: "Part", freedom: "Freedom", gaps: "Gaps", build: "Build", specification: "Specification", jobs: "Jobs" };

export function tabs(studio: Studio): void {
  const show = (name: string): void => {
    for (const each of Object.keys(TABS)) byId(`pane-${each}`).hidden = each !== name;
    for (const each of buttons) each.setAttribute("aria-selected", String(each.dataset["tab"] === name));
  };
  const buttons = Object.entries(TABS).map(([name, text]) => {
    const made = h("button", { type: "button", role: "tab", "aria-controls": `pane-${name}`, click: () => studio.tab.set(name) }, text);
    made.dataset["tab"] = name;
    return made;
  });
  fill(byId("tabs"), ...buttons);
  byId("tabs").addEventListener("keydown", (event) => step(event, buttons));
  studio.tab.watch(show);
  show(studio.tab.value);
}

function step(event: KeyboardEvent, buttons: HTMLButtonElement[]): void {
  const at = buttons.indexOf(event.target as HTMLButtonElement);
  const sign = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
  if (sign === 0 || at < 0) return;
  event.stopPropagation();
  buttons.at((at + sign) % buttons.length)?.focus();
}

type Edge = { name: string; variable: string; axis: "x" | "y"; sign: 1 | -1 };

const EDGES: Edge[] = [
  { name: "left", variable: "--left", axis: "x", sign: 1 },
  { name: "right", variable: "--right", axis: "x", sign: -1 },
  { name: "bottom", variable: "--bottom", axis: "y", sign: -1 },
  { name: "middle", variable: "--middle", axis: "x", sign: 1 },
];

/** Edges between panes: drawn with the pointer, or moved by arrow keys. */
export function edges(): void {
  byId("studio").append(...EDGES.map(edge));
}

function edge(which: Edge): HTMLElement {
  const made = h("div", { className: `edge ${which.name}`, role: "separator", tabIndex: 0, ariaLabel: `edge of the ${which.name} pane`, ariaOrientation: which.axis === "x" ? "vertical" : "horizontal" });
  const panes = byId("studio");
  const grow = (by: number): void => {
    const now = Number.parseFloat(getComputedStyle(panes).getPropertyValue(which.variable));
    panes.style.setProperty(which.variable, `${Math.max(120, now + which.sign * by)}px`);
  };
  made.addEventListener("pointerdown", (event) => made.setPointerCapture(event.pointerId));
  made.addEventListener("pointermove", (event) => made.hasPointerCapture(event.pointerId) && grow(which.axis === "x" ? event.movementX : event.movementY));
  made.addEventListener("keydown", (event) => {
    const by = { ArrowLeft: -16, ArrowUp: -16, ArrowRight: 16, ArrowDown: 16 }[event.key];
    if (by) grow(by), event.stopPropagation();
  });
  return made;
}
