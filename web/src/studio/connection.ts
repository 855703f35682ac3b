// The socket: requests with their answers, what is pushed, and of requests that follow each other fast only the newest.

import { VERSION } from "../protocol";
import type { Hello, Refusal, Request, Said } from "../protocol";
import { Cell } from "./cell";

type Asked<T> = T extends { id: number } ? Omit<T, "id"> : never;
export type Question = Asked<Exclude<Request, Hello>>;
type Answer<K extends Said["kind"]> = Extract<Said, { kind: K }>;
type Act = (said: never) => void;

/** Requests of which only the newest counts: the one that waits, and what ends when all are answered. */
interface Lane {
  next: (() => Promise<void>) | null;
  done: Promise<void> | null;
}

export type Link = "opens" | "open" | "lost" | "refused";

const AGAIN = 1500;
const BEYOND = 4000; // codes of the server's own; 4003: this token opens nothing

/** The token of the address, which is taken out of the address bar and kept for this tab. */
function token(): string {
  const given = location.hash.replace(/^#(token=)?/, "");
  if (given) {
    sessionStorage.setItem("token", given);
    history.replaceState(null, "", location.pathname + location.search);
  }
  return given || (sessionStorage.getItem("token") ?? "");
}

export class Connection {
  readonly state = new Cell<Link>("opens");
  /** Messages and characters in both directions, for whoever measures. */
  readonly count = { sent: 0, received: 0, characters: 0 };
  private socket: WebSocket | null = null;
  private readonly token = token();
  private readonly acts = new Map<string, Act[]>();
  private readonly waiting = new Map<number, (said: Said) => void>();
  private readonly lanes = new Map<string, Lane>();
  private number = 0;

  /** Calls back at every message of a kind. */
  on<K extends Said["kind"]>(kind: K, act: (said: Answer<K>) => void): void {
    this.acts.set(kind, [...(this.acts.get(kind) ?? []), act as Act]);
  }

  open(): void {
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`);
    this.socket = socket;
    socket.addEventListener("open", () => socket.send(JSON.stringify({ kind: "hello", token: this.token, version: VERSION } satisfies Hello)));
    socket.addEventListener("message", (event: MessageEvent<string>) => this.hear(event.data));
    socket.addEventListener("close", (event) => this.lose(event.code));
  }

  private lose(code: number): void {
    this.state.set(code >= BEYOND || code === 1008 ? "refused" : "lost");
    for (const each of this.waiting.values()) each({ kind: "refusal", to: 0, problems: [], stale: false });
    this.waiting.clear();
    if (this.state.value === "lost") setTimeout(() => this.open(), AGAIN);
  }

  private hear(text: string): void {
    const said = JSON.parse(text) as Said;
    this.count.received += 1;
    this.count.characters += text.length;
    if (said.kind === "welcome") this.state.set("open");
    for (const act of this.acts.get(said.kind) ?? []) act(said as never);
    if (!("to" in said)) return;
    this.waiting.get(said.to)?.(said);
    this.waiting.delete(said.to);
  }

  /** Asks; the answer is also told to whoever listens to its kind. */
  ask(question: Question): Promise<Said> {
    const id = ++this.number;
    if (this.socket?.readyState !== WebSocket.OPEN) return Promise.resolve({ kind: "refusal", to: id, problems: [], stale: false } satisfies Refusal);
    this.count.sent += 1;
    this.socket.send(JSON.stringify({ ...question, id }));
    return new Promise((resolve) => this.waiting.set(id, resolve));
  }

  /** Asks when the one before in this lane is answered; of those that wait, only the newest is sent. */
  newest(lane: string, question: Question, then: (said: Said) => void = () => {}): void {
    const own = this.lanes.get(lane) ?? { next: null, done: null };
    this.lanes.set(lane, own);
    own.next = async () => then(await this.ask(question));
    own.done ??= drain(own);
  }

  /** Resolves when nothing of these lanes is under way or waits. */
  async idle(...lanes: string[]): Promise<void> {
    await Promise.all(lanes.map((lane) => this.lanes.get(lane)?.done));
  }

  /** Forgets what still waits in a lane. */
  drop(lane: string): void {
    const own = this.lanes.get(lane);
    if (own) own.next = null;
  }
}

async function drain(own: Lane): Promise<void> {
  while (own.next) {
    const send = own.next;
    own.next = null;
    await send();
  }
  own.done = null;
}
