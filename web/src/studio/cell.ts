// A value that tells when it changes.

export class Cell<T> {
  private readonly watchers = new Set<(value: T, before: T) => void>();

  constructor(private held: T) {}

  get value(): T {
    return this.held;
  }

  set(value: T): void {
    const before = this.held;
    this.held = value;
    if (value !== before) for (const each of this.watchers) each(value, before);
  }

  /** Calls back at every change; returns what ends it. */
  watch(act: (value: T, before: T) => void): () => void {
    this.watchers.add(act);
    return () => this.watchers.delete(act);
  }
}
