// The design file: an editor with the findings at their lines. It stands in a shadow root, whose style sheets need no permission of the page's policy.

import { defaultKeymap, indentWithTab } from "@codemirror/commands";
import { HighlightStyle, StreamLanguage, bracketMatching, syntaxHighlighting } from "@codemirror/language";
import { toml } from "@codemirror/legacy-modes/mode/toml";
import { lintGutter, setDiagnostics } from "@codemirror/lint";
import type { Diagnostic } from "@codemirror/lint";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import { EditorState, StateEffect, StateField, Transaction } from "@codemirror/state";
import { Decoration, EditorView, drawSelection, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import type { DecorationSet, ViewUpdate } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import type { Place, Problem, State } from "../protocol";
import { byId, fill, h, rested, sentence } from "./dom";
import type { Studio } from "./studio";

const TYPED = 150; // ms without a key, then the text is checked
const SEEN = 120; // ms at a line, then its part is looked for

const colours = HighlightStyle.define([
  { tag: tags.comment, color: "var(--quiet)", fontStyle: "italic" },
  { tag: tags.string, color: "var(--string)" },
  { tag: [tags.number, tags.bool, tags.atom], color: "var(--literal)" },
  { tag: [tags.propertyName, tags.variableName], color: "var(--ink)" },
  { tag: [tags.keyword, tags.tagName, tags.heading], color: "var(--accent)", fontWeight: "600" },
]);

// What would be pictures out of data addresses are letters and lines here.
const look = EditorView.theme({
  "&": { height: "100%", fontSize: "12px", color: "var(--ink)", backgroundColor: "var(--paper)" },
  ".cm-scroller": { fontFamily: "var(--mono)", lineHeight: "1.45" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-gutters": { backgroundColor: "var(--panel)", color: "var(--quiet)", border: "none" },
  ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "var(--hover)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": { background: "var(--mark) !important" },
  ".cm-lit": { backgroundColor: "var(--mark)" },
  ".cm-lintRange-error": { backgroundImage: "none", textDecoration: "underline wavy var(--poor)" },
  ".cm-lintRange-warning": { backgroundImage: "none", textDecoration: "underline dotted var(--fair)" },
  ".cm-lint-marker": { width: "0.9em", textAlign: "center" },
  ".cm-lint-marker-error": { content: '"●"', color: "var(--poor)" },
  ".cm-lint-marker-warning": { content: '"▲"', color: "var(--fair)" },
  ".cm-tooltip": { backgroundColor: "var(--panel)", color: "var(--ink)", border: "1px solid var(--edge)", maxWidth: "60ch" },
  ".cm-panels": { backgroundColor: "var(--panel)", color: "var(--ink)" },
  ".cm-searchMatch": { backgroundColor: "var(--mark)" },
});

const light = StateEffect.define<number[]>();

/** Lines that belong to what is selected. */
const lit = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(held, change) {
    for (const effect of change.effects) if (effect.is(light)) return bands(change.state, effect.value);
    return held.map(change.changes);
  },
  provide: (field) => EditorView.decorations.from(field),
});

function bands(state: EditorState, lines: number[]): DecorationSet {
  const sound = [...new Set(lines)].filter((line) => line >= 1 && line <= state.doc.lines).sort((one, other) => one - other);
  return Decoration.set(sound.map((line) => Decoration.line({ class: "cm-lit" }).range(state.doc.line(line).from)));
}

export class Editor {
  private readonly view: EditorView;
  private readonly problems = h("ul", { id: "problems", ariaLive: "polite" });
  private readonly send = rested(TYPED, () => this.edit());
  private readonly look = rested(SEEN, () => this.lookUp());
  private revision = 0;
  private isOurs = true;
  private line = 0;
  private known = "";
  private isBack = false;

  constructor(
    private readonly studio: Studio,
    private readonly found: (place: Place) => void,
  ) {
    const host = h("div", { id: "editor" });
    fill(byId("text"), h("div", { className: "bar" }, h("h2", {}, "Design file"), h("span", { id: "sound", className: "pill" })), host, this.problems);
    const root = host.attachShadow({ mode: "open" });
    this.view = new EditorView({ parent: root as unknown as HTMLElement, root, state: this.fresh() });
    studio.state.watch((state) => state && this.take(state));
    for (const each of [studio.figures, studio.verdicts]) each.watch(() => this.judge());
    studio.connection.state.watch((link) => (this.isBack = link === "open" && !this.isOurs));
    studio.connection.on("warnings", (said) => this.warn(said.revision, said.warnings));
    studio.line.watch(({ line, focus }) => this.goto(line, focus));
  }

  private fresh(): EditorState {
    const keys = keymap.of([...searchKeymap, ...defaultKeymap, indentWithTab]);
    const label = EditorView.contentAttributes.of({ "aria-label": "design file" });
    const watched = EditorView.updateListener.of((update) => this.heed(update));
    const marks = [lit, lintGutter(), lineNumbers(), drawSelection(), highlightActiveLine(), bracketMatching(), highlightSelectionMatches(), search({ top: true })];
    return EditorState.create({ extensions: [marks, StreamLanguage.define(toml), syntaxHighlighting(colours), look, keys, label, watched] });
  }

  private heed(update: ViewUpdate): void {
    const isTyped = update.transactions.some((each) => each.annotation(Transaction.remote) !== true && each.docChanged);
    if (isTyped) {
      this.isOurs = false;
      this.send();
    } else if (update.selectionSet && !update.docChanged && this.view.hasFocus) this.look();
  }

  /** Sends what was typed and not sent yet; true if there was any. */
  flush(): boolean {
    return this.send.now();
  }

  private edit(): void {
    const text = this.view.state.doc.toString();
    this.studio.connection.newest("edit", { kind: "edit", text, revision: this.revision }, (said) => {
      if (said.kind === "refusal" && said.stale) this.differ();
    });
  }

  /** Another page changed the text while this one typed. */
  private differ(): void {
    const mine = h("button", { type: "button", click: () => (this.edit(), fill(this.problems)) }, "keep mine");
    const theirs = h("button", { type: "button", click: () => ((this.isOurs = true), this.studio.state.value && this.take(this.studio.state.value)) }, "take theirs");
    fill(this.problems, h("li", { className: "error" }, "Another page changed the text. ", mine, " ", theirs));
  }

  private take(state: State): void {
    this.revision = state.revision;
    const now = this.view.state.doc.toString();
    const isSame = this.known === state.text || state.text === now;
    this.known = state.text;
    const isTyping = !this.isOurs && state.text !== now;
    if (state.text === now) this.isOurs = true;
    if (!isTyping) this.replace(state.text);
    this.mark(state);
    if (this.isBack) this.resume(isSame);
  }

  /** The connection is back: what was typed meanwhile is sent, unless the server has another text than before. */
  private resume(isSame: boolean): void {
    this.isBack = false;
    if (isSame) this.send();
    else this.differ();
  }

  /** Puts another text in by its smallest change, so that the cursor and what is seen stay. */
  private replace(text: string): void {
    const now = this.view.state.doc.toString();
    if (text === now) return;
    const least = Math.min(now.length, text.length);
    let start = 0;
    while (start < least && now[start] === text[start]) start += 1;
    let end = 0;
    while (end < least - start && now[now.length - 1 - end] === text[text.length - 1 - end]) end += 1;
    const changes = { from: start, to: now.length - end, insert: text.slice(start, text.length - end) };
    this.view.dispatch({ changes, annotations: Transaction.remote.of(true) });
  }

  private mark(state: State): void {
    const found: [Problem, Diagnostic["severity"]][] = [...state.problems.map((each) => [each, "error"] as [Problem, "error"]), ...state.warnings.map((each) => [each, "warning"] as [Problem, "warning"])];
    this.view.dispatch(setDiagnostics(this.view.state, found.filter(([each]) => each.line !== null).map(([each, severity]) => this.diagnostic(each, severity))));
    fill(this.problems, ...found.map(([each, severity]) => this.item(each, severity)));
    this.judge();
  }

  /** Whether the text has errors, and what the results next to it are of. */
  private judge(): void {
    const { state, figures } = this.studio;
    if (!state.value) return;
    const { sound, problems } = state.value;
    const count = `${problems.length} error${problems.length === 1 ? "" : "s"}`;
    const results = figures.value === null ? "no results" : this.studio.isPresent(figures.value.revision) ? "results may be incomplete" : "results belong to the last text without errors";
    const badge = byId("sound");
    badge.className = sound ? (this.studio.isCurrent ? "pill good" : "pill") : "pill poor";
    fill(badge, sound ? "sound" : `${count}: ${results}`);
    document.body.classList.toggle("unsound", !sound);
  }

  private warn(revision: number, warnings: Problem[]): void {
    const { value: state } = this.studio.state;
    if (state?.revision === revision && state.sound) this.mark({ ...state, warnings });
  }

  private diagnostic(each: Problem, severity: Diagnostic["severity"]): Diagnostic {
    const { doc } = this.view.state;
    const line = doc.line(Math.max(1, Math.min(each.line ?? 1, doc.lines)));
    const from = each.column ? Math.min(line.from + each.column - 1, line.to) : line.from + (line.text.length - line.text.trimStart().length);
    return { from, to: line.to, severity, message: sentence(each) };
  }

  private item(each: Problem, severity: string): HTMLElement {
    const where = each.line === null ? each.where : `line ${each.line}: ${each.where}`;
    return h("li", { className: severity }, h("button", { type: "button", disabled: each.line === null, click: () => this.goto(each.line ?? 0, true) }, where), ` ${sentence(each)}`);
  }

  /** Lights the lines of what is selected and shows the first. */
  lighten(lines: number[]): void {
    this.view.dispatch({ effects: light.of(lines) });
    if (lines[0]) this.goto(lines[0], false);
  }

  private goto(line: number, focus: boolean): void {
    const { doc } = this.view.state;
    if (line < 1 || line > doc.lines) return;
    const { from } = doc.line(line);
    this.line = line;
    this.view.dispatch({ selection: { anchor: from }, effects: EditorView.scrollIntoView(from, { y: "center" }), annotations: Transaction.remote.of(true) });
    if (focus) this.view.focus();
  }

  private async lookUp(): Promise<void> {
    const line = this.view.state.doc.lineAt(this.view.state.selection.main.head).number;
    if (line === this.line) return;
    this.line = line;
    const said = await this.studio.ask({ kind: "line", line });
    if (said.kind === "place" && said.line === this.line) this.found(said);
  }
}
