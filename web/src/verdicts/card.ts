// What a verdict is made of.
import { h, type Child } from "../dom";
import { strings } from "../strings";

export interface Verdict {
  yes: boolean | null; ///< null: nobody asked for a verdict
  says: string;
  sentence: string;
  reasons?: string[];
  cards: HTMLElement[];
  notes?: string[];
}

/// What was taken without being stated, as notes.
export const assumptions = (assumed: string[]) => assumed.map((one) => strings.verdict.assumed(one));

export function card(name: string, value: Child[], notes: (string | null)[] = []): HTMLElement {
  return h("div", { class: "card" }, h("dt", {}, name), h("dd", {}, h("div", { class: "value" }, ...value), ...notes.map((note) => (note === null ? null : h("div", { class: "note" }, note)))));
}

export const unitOf = (unit: string) => h("span", { class: "unit" }, ` ${unit}`);

/// The number that calibration left behind.
export const from = (value: string) => h("span", { class: "from" }, `${value} \u2192 `);
