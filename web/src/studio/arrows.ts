// Arrows over the picture: twists, screws, lost motion. They are drawn where the viewer sees their points, and follow as it turns.

import type { Studio } from "./studio";

export type Point = [number, number, number];

export interface Arrow {
  from: Point;
  to: Point;
  /** Name of its class: free, locked, ideal, real. */
  look: string;
  text?: string;
  /** Turning about the arrow rather than moving along it. */
  turns?: boolean;
}

const SVG = "http://www.w3.org/2000/svg";

export class Arrows {
  private readonly canvas = document.createElementNS(SVG, "svg");
  private readonly layers = new Map<string, Arrow[]>();
  private seen = "";

  constructor(
    parent: HTMLElement,
    private readonly studio: Studio,
  ) {
    this.canvas.setAttribute("class", "arrows");
    this.canvas.setAttribute("aria-hidden", "true");
    parent.append(this.canvas);
  }

  /** Shows these arrows in their layer; none take it away. */
  set(layer: string, arrows: Arrow[]): void {
    const wasStill = this.layers.size === 0;
    if (arrows.length) this.layers.set(layer, arrows);
    else this.layers.delete(layer);
    this.seen = "";
    if (wasStill && this.layers.size) this.follow();
    if (!this.layers.size) this.canvas.replaceChildren();
  }

  private follow(): void {
    if (!this.layers.size) return;
    const probe = this.studio.viewer.value?.probe;
    const seen = probe ? JSON.stringify([probe.camera, this.canvas.clientWidth, this.canvas.clientHeight]) : "";
    if (probe && seen !== this.seen) this.draw((point) => probe.project(point));
    this.seen = seen;
    requestAnimationFrame(() => this.follow());
  }

  private draw(place: (point: Point) => [number, number]): void {
    const made = [...this.layers.values()].flat().flatMap((arrow) => drawn(arrow, place(arrow.from), place(arrow.to)));
    this.canvas.replaceChildren(...made);
  }
}

function drawn(arrow: Arrow, from: [number, number], to: [number, number]): Element[] {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy) || 1;
  const [ux, uy] = [dx / length, dy / length];
  const back = (along: number, across: number): string => `${to[0] - along * ux - across * uy},${to[1] - along * uy + across * ux}`;
  const line = shape("path", arrow.look, `M${from[0]},${from[1]}L${to[0]},${to[1]}`);
  const heads = (arrow.turns ? [0, 7] : [0]).map((at) => shape("path", `${arrow.look} head`, `M${back(at, 0)}L${back(at + 9, 4)}L${back(at + 9, -4)}Z`));
  return arrow.text ? [line, ...heads, words(arrow, to)] : [line, ...heads];
}

function shape(tag: string, name: string, path: string): Element {
  const made = document.createElementNS(SVG, tag);
  made.setAttribute("class", name);
  made.setAttribute("d", path);
  return made;
}

function words(arrow: Arrow, at: [number, number]): Element {
  const made = document.createElementNS(SVG, "text");
  made.setAttribute("class", arrow.look);
  made.setAttribute("x", String(at[0] + 6));
  made.setAttribute("y", String(at[1] - 4));
  made.textContent = arrow.text ?? "";
  return made;
}

export const plus = (one: Point, other: readonly number[], times = 1): Point => [one[0] + times * (other[0] ?? 0), one[1] + times * (other[1] ?? 0), one[2] + times * (other[2] ?? 0)];

export const norm = (vector: readonly number[]): number => Math.hypot(...vector);
