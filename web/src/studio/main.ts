// The studio's page: its panes and how they speak with each other.

import "./studio.css";
import type { Card, Place } from "../protocol";
import type { Picked } from "../viewer/types";
import { BuildPane } from "./build";
import { Connection } from "./connection";
import { Editor } from "./editor";
import { FigureTable, VerdictTable } from "./figures";
import { FreedomPane } from "./freedom";
import { GapsPane } from "./gaps";
import { Header } from "./header";
import { Jog } from "./jog";
import { JobsPane } from "./jobs";
import { help, listen } from "./keys";
import type { Key } from "./keys";
import { edges, tabs } from "./layout";
import { ModeBar, motionStrip } from "./modes";
import { Numbers } from "./numbers";
import { PartCard } from "./part";
import { Responses } from "./response";
import { SpecificationPane } from "./specification";
import { StageView } from "./stage";
import { Studio } from "./studio";
import { Travel } from "./travel";

const studio = new Studio(new Connection());
tabs(studio);
edges();
const stage = new StageView(studio, picked);
const numbers = new Numbers(studio);
const editor = new Editor(studio, found);
const header = new Header(studio, editor);
const card = new PartCard(studio, belongs);
const modes = new ModeBar(studio, stage);
const jog = new Jog(studio, stage);
const jobs = new JobsPane(studio);
const strip = motionStrip(studio, modes, jog, new Travel(studio));
new VerdictTable(studio);
new FigureTable(studio);
new FreedomPane(studio, stage);
new GapsPane(studio);
new BuildPane(studio);
new SpecificationPane(studio, () => header.settled());
new Responses(studio);

/** A part of the picture was clicked: a link has a card, the rest has its line. */
function picked(found: Picked | null): void {
  const name = found?.part.name ?? null;
  const isLink = name !== null && name in (studio.state.value?.links ?? {});
  studio.link.set(isLink ? name : null);
  if (found && !isLink) card.other(found);
}

/** What belongs to a selected part: its lines, its numbers. */
function belongs(said: Card): void {
  editor.lighten(said.lines);
  numbers.reveal(said.addresses);
}

/** What stands at the cursor's line. */
function found(place: Place): void {
  numbers.reveal(place.addresses);
  const [first] = place.links;
  if (!first) return;
  studio.viewer.value?.select(first);
  studio.viewer.value?.setColours(place.links.length > 1 ? Object.fromEntries(place.links.map((each) => [each, [0.95, 0.6, 0.1] as [number, number, number]])) : null);
}

function nudge(axis: string, sign: number): void {
  strip("jog");
  jog.nudge(axis, sign);
}

function play(number: number): void {
  strip("modes");
  studio.mode.set(number || null);
}

const KEYS: Key[] = [
  { keys: ["mod+z"], shown: "Ctrl+Z", about: "undo", act: () => void header.undo(), always: true },
  { keys: ["mod+shift+z", "mod+y"], shown: "Ctrl+Shift+Z", about: "redo", act: () => void header.redo(), always: true },
  { keys: ["mod+s"], shown: "Ctrl+S", about: "save", act: () => void header.save(), always: true },
  { keys: ["/"], shown: "/", about: "find a number", act: () => numbers.find() },
  { keys: ["1", "2", "3", "4", "5", "6", "7", "8", "9", "0"], shown: "1 … 9, 0", about: "play a mode; show the stage at rest", act: (key) => play(Number(key)) },
  { keys: ["space"], shown: "space", about: "play or pause", act: () => modes.toggle() },
  { keys: ["[", "]"], shown: "[  ]", about: "smaller, larger amplitude", act: (key) => modes.louder(key === "]" ? 1.25 : 0.8) },
  { keys: ["arrowright", "arrowleft"], shown: "← →", about: "platform along x; with shift about y", act: (key) => nudge("x", key === "arrowright" ? 1 : -1) },
  { keys: ["arrowup", "arrowdown"], shown: "↑ ↓", about: "platform along y; with shift about x", act: (key) => nudge("y", key === "arrowup" ? 1 : -1) },
  { keys: ["pageup", "pagedown"], shown: "PgUp PgDn", about: "platform along z; with shift about z", act: (key) => nudge("z", key === "pageup" ? 1 : -1) },
  { keys: ["shift+arrowright", "shift+arrowleft"], shown: "", about: "", act: (key) => nudge("ry", key.endsWith("right") ? 1 : -1) },
  { keys: ["shift+arrowup", "shift+arrowdown"], shown: "", about: "", act: (key) => nudge("rx", key.endsWith("up") ? -1 : 1) },
  { keys: ["shift+pageup", "shift+pagedown"], shown: "", about: "", act: (key) => nudge("rz", key.endsWith("up") ? 1 : -1) },
  { keys: ["f"], shown: "F", about: "fit the stage, or the selected part", act: () => stage.fit() },
  { keys: ["g"], shown: "G", about: "translucent platform", act: () => stage.press("platform") },
  { keys: ["l"], shown: "L", about: "names of parts", act: () => stage.press("names") },
  { keys: ["c"], shown: "C", about: "exchange solid and ghost of the old and the new design", act: () => stage.press("old") },
  { keys: ["r"], shown: "R", about: "report", act: () => jobs.offer("analyse") },
  { keys: ["escape"], shown: "Esc", about: "clear the selection", act: () => studio.link.set(null) },
  { keys: ["?"], shown: "?", about: "these keys", act: () => help(KEYS) },
];

listen(KEYS);
// What tests and whoever measures may ask.
Object.assign(window, { studio });
window.addEventListener("hashchange", () => location.reload()); // another token in the same tab
studio.connection.open();
