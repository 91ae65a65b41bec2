// A part of the page with its place in the navigation.
import { h, type Child } from "./dom";

export interface Section {
  id: string;
  nav: string;
  element: HTMLElement;
}

export function section(id: string, nav: string, heading: string, intro: string | null, ...content: Child[]): Section {
  return { id, nav, element: h("section", { id, "aria-labelledby": `${id}-heading` }, h("h2", { id: `${id}-heading` }, heading), intro === null ? null : h("p", { class: "muted" }, intro), ...content) };
}
