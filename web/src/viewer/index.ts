// The viewer of a stage: `flexstage.view(element, data, options)`.

import { Scene } from "three";
import type { Controller, Options, StageData } from "./types";

export type * from "./types";

export function view(element: HTMLElement, data: StageData, options: Options = {}): Controller {
  element.dataset["stage"] = data.name;
  element.dataset["controls"] = String(options.controls ?? true);
  return { element, scene: new Scene() } as unknown as Controller;
}
