// The viewer's own style: within its shadow, so that no page's style reaches it and none of it reaches the page.

export const STYLE = `
:host { display: block; container-type: inline-size; color-scheme: light dark; font: 13px/1.4 system-ui, sans-serif;
  --ink: #1f2933; --muted: #5d6b78; --paper: #ffffff; --ground: #f4f6f8; --line: #d5dce3; --accent: #0f766e; --chosen: #d9117f; color: var(--ink); }
:host(.dark) { --ink: #e6ebf0; --muted: #9aa7b4; --paper: #1c2229; --ground: #14181d; --line: #343d47; --accent: #35c4b4; --chosen: #ff4fb0; }
:host([hidden]) { display: none; }
.viewer { display: grid; grid-template-columns: minmax(0, 1fr); gap: 0; border: 1px solid var(--line); border-radius: 8px; overflow: hidden;
  background: var(--paper); height: var(--viewer-height, auto); }
.bare { border: 0; border-radius: 0; height: 100%; }
.stage { position: relative; background: var(--ground); min-height: 240px; aspect-ratio: 4 / 3; max-height: 78vh; width: 100%; outline-offset: -3px; }
.bare .stage { aspect-ratio: auto; max-height: none; height: 100%; }
.stage:focus-visible { outline: 2px solid var(--accent); }
canvas { display: block; width: 100%; height: 100%; touch-action: none; cursor: grab; }
canvas:active { cursor: grabbing; }
.overlay { position: absolute; inset: 0; overflow: hidden; pointer-events: none; }
.name { position: absolute; left: 0; top: 0; padding: 0 4px; border-radius: 4px; background: color-mix(in srgb, var(--paper) 78%, transparent);
  font-size: 11px; font-weight: 600; white-space: nowrap; }
.name.drive { color: #b36a00; } .name.gauge { color: #b02a50; }
:host(.dark) .name.drive { color: #f5ad4b; } :host(.dark) .name.gauge { color: #ff8aab; }
.triad { position: absolute; left: 4px; bottom: 4px; width: 68px; height: 68px; overflow: visible; }
.triad line { stroke-width: 2; stroke: var(--muted); } .triad .x { stroke: #d03b3b; } .triad .y { stroke: #2f9e44; } .triad .z { stroke: #3b6fd0; }
.triad text { fill: var(--muted); font-size: 11px; text-anchor: middle; font-style: italic; }
.scale { position: absolute; right: 12px; bottom: 8px; border: 1px solid var(--muted); border-top: 0; height: 5px; color: var(--muted); font-size: 11px;
  text-align: center; line-height: 0; white-space: nowrap; padding-top: 0; box-sizing: border-box; }
.scale { display: flex; justify-content: center; align-items: flex-end; padding-bottom: 9px; height: 6px; }
.card { position: absolute; left: 10px; top: 10px; max-width: min(280px, 70%); padding: 8px 10px; border-radius: 6px; background: color-mix(in srgb, var(--paper) 92%, transparent);
  border: 1px solid var(--line); border-left: 3px solid var(--chosen); font-size: 12px; max-height: 60%; overflow: auto; pointer-events: auto; }
.card strong { margin-right: 6px; } .what, .card small { color: var(--muted); } .card small { display: block; margin-top: 4px; overflow-wrap: anywhere; }
.fact { display: flex; justify-content: space-between; gap: 12px; } .fact dt { color: var(--muted); } .fact dd { margin: 0; text-align: right; font-variant-numeric: tabular-nums; }
.keys { left: auto; right: 10px; border-left-color: var(--accent); }
.play [hidden], .card[hidden], .names[hidden], .name[hidden] { display: none; }
.panel { display: flex; flex-direction: column; min-width: 0; min-height: 0; border-top: 1px solid var(--line); }
.motions { list-style: none; margin: 0; padding: 4px 0; overflow: auto; max-height: 172px; }
.motions li.head { padding: 6px 12px 2px; color: var(--muted); font-size: 11px; }
.motions button { all: unset; display: block; box-sizing: border-box; width: 100%; padding: 4px 12px; cursor: pointer; white-space: pre; overflow: hidden; text-overflow: ellipsis;
  font-variant-numeric: tabular-nums; border-left: 3px solid transparent; }
.motions button:hover { background: var(--ground); }
.motions button[aria-pressed="true"] { background: var(--ground); border-left-color: var(--accent); font-weight: 600; }
.motions button:focus-visible, .tools button:focus-visible { outline: 2px solid var(--accent); outline-offset: -2px; }
.tools { display: flex; flex-wrap: wrap; gap: 4px; padding: 6px 8px; border-top: 1px solid var(--line); align-items: center; }
.tools button { font: inherit; font-size: 12px; color: inherit; background: var(--paper); border: 1px solid var(--line); border-radius: 5px; padding: 3px 8px; cursor: pointer; }
.tools button[aria-pressed="true"] { border-color: var(--accent); color: var(--accent); }
.play { display: grid; grid-template-columns: auto 1fr; gap: 4px 8px; padding: 6px 12px; align-items: center; border-top: 1px solid var(--line); }
.play label { color: var(--muted); font-size: 12px; } .play input { width: 100%; min-width: 0; accent-color: var(--accent); margin: 0; }
.words { grid-column: 1 / -1; color: var(--muted); font-size: 12px; font-variant-numeric: tabular-nums; }
.words.red { color: #d03b3b; } :host(.dark) .words.red { color: #ff8a80; }
.viewer > .curves { grid-column: 1 / -1; border-top: 1px solid var(--line); }
.note { margin: 0; padding: 4px 12px; color: var(--muted); font-size: 12px; }
slot { display: none; }
@container (min-width: 700px) {
  .viewer:not(.bare) { grid-template-columns: minmax(0, 1fr) 300px; }
  .viewer:not(.bare) .stage { aspect-ratio: auto; height: 520px; }
  .panel { border-top: 0; border-left: 1px solid var(--line); max-height: min(520px, 78vh); } .motions { max-height: none; flex: 1; }
}
@media print { .viewer { display: none; } slot { display: block; } }
`;
