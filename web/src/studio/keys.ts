// Keys, and the page that shows them.

import { byId, fill, h } from "./dom";

export interface Key {
  /** As `KeyboardEvent.key`, in small letters; `mod+` is Ctrl or Cmd, `shift+` the shift key. */
  keys: string[];
  shown: string;
  about: string;
  act: (key: string) => void;
  /** Whether it works while a person types. */
  always?: boolean;
}

/** Listens before anything else does, so that no key acts twice. */
export function listen(table: Key[]): void {
  window.addEventListener("keydown", (event) => heed(event, table), { capture: true });
  byId("help").addEventListener("click", () => help(table));
}

function heed(event: KeyboardEvent, table: Key[]): void {
  const name = spelled(event);
  const found = table.find((each) => each.keys.includes(name));
  if (!found || (isTyping(event) && !found.always) || (isSlider(event) && /arrow|page/.test(name)) || document.querySelector("dialog[open]")) return;
  if (name === "space" && event.composedPath()[0] instanceof HTMLButtonElement) return;
  event.preventDefault();
  event.stopImmediatePropagation();
  found.act(name);
}

function spelled(event: KeyboardEvent): string {
  const key = event.key === " " ? "space" : event.key.toLowerCase();
  const mod = event.ctrlKey || event.metaKey ? "mod+" : "";
  const shift = event.shiftKey && (key.length > 1 || mod) ? "shift+" : "";
  return `${mod}${event.altKey ? "alt+" : ""}${shift}${key}`;
}

function isTyping(event: KeyboardEvent): boolean {
  const target = event.composedPath()[0];
  if (!(target instanceof HTMLElement)) return false;
  const isField = target instanceof HTMLInputElement && !["range", "checkbox"].includes(target.type);
  return isField || target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement || target.isContentEditable;
}

function isSlider(event: KeyboardEvent): boolean {
  const target = event.composedPath()[0];
  return target instanceof HTMLInputElement && target.type === "range";
}

export function help(table: Key[]): void {
  const made = h("dialog", { className: "keys", ariaLabel: "Keys", close: () => made.remove() });
  const rows = table.filter((each) => each.shown).flatMap((each) => [h("dt", {}, h("kbd", {}, each.shown)), h("dd", {}, each.about)]);
  fill(made, h("h2", {}, "Keys"), h("dl", {}, ...rows), h("form", { method: "dialog" }, h("button", {}, "close")));
  document.body.append(made);
  made.showModal();
}
