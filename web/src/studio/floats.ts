// Arrays out of messages.

import type { Floats } from "../protocol";

function bytes(text: string): ArrayBuffer {
  const raw = atob(text);
  const held = new Uint8Array(raw.length);
  for (let at = 0; at < raw.length; at += 1) held[at] = raw.charCodeAt(at);
  return held.buffer;
}

export function floats(packed: Floats): number[] {
  return [...new Float64Array(bytes(packed.data))];
}

/** The viewer's arrays. */
export function singles(text: string): Float32Array {
  return new Float32Array(bytes(text));
}
