// What changed since the last message of a kind, put into that message: nothing that stays is sent again, or made anew.

/** `=` and the new value; by key or place, with keys that are gone; of texts, what stands between two places. */
export type Change = ["=", unknown] | ["@", Record<string, Change>, string[]] | ["~", [number, number, string][]] | null;

export function patched(held: unknown, change: Change | undefined): unknown {
  if (!change) return held;
  if (change[0] === "=") return change[1];
  if (change[0] === "~") return spliced(held as string, change[1]);
  if (Array.isArray(held)) return held.map((each, at) => patched(each, change[1][at]));
  const was = held as Record<string, unknown>;
  const made: Record<string, unknown> = { ...was };
  for (const key of change[2]) delete made[key];
  for (const [key, each] of Object.entries(change[1])) made[key] = patched(was[key], each);
  return made;
}

function spliced(held: string, pieces: [number, number, string][]): string {
  let last = 0;
  const found = pieces.flatMap(([from, to, text]) => {
    const before = held.slice(last, from);
    last = to;
    return [before, text];
  });
  return found.join("") + held.slice(last);
}
