// Arrays out of base64.

import type { Packed } from "./types";

function bytes(text: Packed): ArrayBuffer {
  const raw = atob(text);
  const found = new Uint8Array(raw.length);
  for (let place = 0; place < raw.length; place++) found[place] = raw.charCodeAt(place);
  return found.buffer;
}

export const floats = (text: Packed): Float32Array => new Float32Array(bytes(text));
export const numbers = (text: Packed): Uint16Array => new Uint16Array(bytes(text));
export const indices = (text: Packed, form: "u2" | "u4"): Uint16Array | Uint32Array =>
  form === "u2" ? new Uint16Array(bytes(text)) : new Uint32Array(bytes(text));
