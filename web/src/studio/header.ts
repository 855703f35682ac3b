// The head of the page: file, what changed, undo and save, the state of connection and engine, and what a person is told.

import type { Draft, Engine, State } from "../protocol";
import { byId, digits, fill, h } from "./dom";
import type { Editor } from "./editor";
import { fromGallery, openFile, saveAs } from "./files";
import type { Studio } from "./studio";

const TOLD = 6000; // ms that a notice stays

export class Header {
  private engine: Engine | null = null;
  private timer = 0;

  constructor(
    private readonly studio: Studio,
    private readonly editor: Editor,
  ) {
    byId("undo").addEventListener("click", () => void this.undo());
    byId("redo").addEventListener("click", () => void this.redo());
    byId("save").addEventListener("click", () => void this.save());
    for (const [id, act] of [["new", fromGallery], ["open", openFile], ["save-as", saveAs]] as const) byId(id).addEventListener("click", () => void this.settled().then(() => act(studio)));
    studio.state.watch((state) => state && this.show(state));
    for (const each of [studio.state, studio.figures, studio.verdicts, studio.connection.state]) each.watch(() => this.tell());
    studio.connection.on("engine", (said) => ((this.engine = said), this.tell()));
    studio.notice.watch(({ text, bad }) => this.say(text, bad));
    this.tell();
  }

  private show(state: State): void {
    fill(byId("file"), state.file.split(/[\\/]/).at(-1) ?? state.file);
    byId("file").title = `${state.name}: ${state.file}`;
    fill(byId("changed"), state.saved ? "saved" : state.changed ? `${state.changed} changed` : "text changed", state.unprotected && h("b", { className: "poor" }, ` not protected from a crash: ${state.unprotected}`));
    fill(byId("drafts"), ...state.drafts.map((each) => this.draft(each)));
    byId<HTMLButtonElement>("undo").disabled = !state.undo;
    byId<HTMLButtonElement>("redo").disabled = !state.redo;
    byId<HTMLButtonElement>("save").disabled = state.saved;
    document.title = `${state.saved ? "" : "• "}${state.name} – flexstage studio`;
  }

  /** Unsaved changes of a studio that ended: they are taken back, or discarded. */
  private draft(each: Draft): HTMLElement {
    const since = new Date(1000 * each.time).toLocaleString();
    const answer = (keep: boolean) => (): void => void this.studio.ask({ kind: "recover", draft: each.name, keep });
    const words = `Unsaved changes of ${since} were found${each.stale ? "; the file was changed since" : ""}. `;
    return h("p", {}, words, h("button", { type: "button", click: answer(true) }, "restore them"), " ", h("button", { type: "button", click: answer(false) }, "discard them"));
  }

  private tell(): void {
    const words = { opens: "connects…", open: "", lost: "connection lost; trying again", refused: "the server refuses this page: open the printed address" };
    const link = this.studio.connection.state.value;
    const engine = this.engine;
    const left = engine?.seconds ? `, ${digits(engine.seconds, 2)} s` : "";
    const { value: state } = this.studio.state;
    const isBusy = engine !== null && engine.state !== "ready";
    const idle = state && !state.sound ? "waits: the design has errors" : this.studio.isCurrent ? "ready" : "computes";
    const place = byId("engine");
    place.className = link !== "open" || engine?.state === "ended" || state?.sound === false ? "pill poor" : isBusy || idle !== "ready" ? "pill fair" : "pill good";
    fill(place, words[link] || (isBusy ? `${engine.text || engine.state}${left}` : idle));
  }

  private say(text: string, bad: boolean): void {
    const place = byId("notice");
    clearTimeout(this.timer);
    place.hidden = text === "";
    place.className = bad ? "poor" : "";
    fill(place, text);
    if (text) this.timer = setTimeout(() => this.studio.notice.set({ text: "", bad: false }), TOLD) as unknown as number;
  }

  /** Until what was typed and dragged has come to the server. */
  settled(): Promise<void> {
    this.editor.flush();
    return this.studio.connection.idle("edit", "rest");
  }

  async undo(): Promise<void> {
    await this.settled();
    await this.studio.ask({ kind: "undo" });
  }

  async redo(): Promise<void> {
    await this.settled();
    await this.studio.ask({ kind: "redo" });
  }

  async save(over = false): Promise<void> {
    await this.settled();
    const said = await this.studio.ask({ kind: "save", over, file: "" });
    if (said.kind === "refusal" && said.stale) this.differs();
    else if (said.kind !== "refusal") this.studio.tell("Saved.");
  }

  /** The file on disk changed since it was read. */
  private differs(): void {
    const place = byId("notice");
    clearTimeout(this.timer);
    const hide = (act: () => void) => (): void => ((place.hidden = true), act());
    place.hidden = false;
    fill(
      place,
      "Another program changed the file. ",
      h("button", { type: "button", click: hide(() => void this.save(true)) }, "overwrite it"),
      " ",
      h("button", { type: "button", click: hide(() => void this.studio.ask({ kind: "reload" })) }, "read the text of the file (undo restores your text)"),
    );
  }
}
