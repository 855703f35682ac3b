// Colours, light and dark.

import type { Colour, Kind } from "./types";

export interface Theme {
  kinds: Readonly<Record<Kind, Colour>>;
  /** Edges, with their opacity. */
  ink: [number, number, number, number];
  chosen: Colour;
  ghost: [number, number, number, number];
  translation: Colour;
  rotation: Colour;
  /** Links without and with all of the strain energy. */
  cold: Colour;
  hot: Colour;
  /** Links beyond what is allowed. */
  beyond: Colour;
}

const colour = (hex: string): Colour => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255) as Colour;

const LIGHT: Theme = {
  kinds: {
    ground: colour("6b7580"), body: colour("c3cbd4"), platform: colour("7fb2dd"), hinge: colour("15998c"),
    drive: colour("f2a33c"), gauge: colour("c2395a"),
  },
  ink: [0.13, 0.17, 0.22, 0.75],
  chosen: colour("e5198a"),
  ghost: [0.75, 0.2, 0.45, 0.55],
  translation: colour("1d5fd1"),
  rotation: colour("b3261e"),
  cold: colour("d5dce3"),
  hot: colour("c81e1e"),
  beyond: colour("5b0a63"),
};

const DARK: Theme = {
  kinds: {
    ground: colour("5c6772"), body: colour("8f9baa"), platform: colour("5b93c4"), hinge: colour("2cc0b0"),
    drive: colour("f5ad4b"), gauge: colour("e8618a"),
  },
  ink: [0.93, 0.95, 0.97, 0.42],
  chosen: colour("ff4fb0"),
  ghost: [1.0, 0.55, 0.75, 0.5],
  translation: colour("7db1ff"),
  rotation: colour("ff8a80"),
  cold: colour("56616d"),
  hot: colour("ff5a4d"),
  beyond: colour("e58bff"),
};

export const theme = (dark: boolean): Theme => (dark ? DARK : LIGHT);
export const PLATFORM_OPACITY = 0.42;

/** From `first` to `second`. */
export const mixed = (first: Colour, second: Colour, share: number): Colour =>
  first.map((each, at) => each + (second[at as 0 | 1 | 2] - each) * share) as Colour;
