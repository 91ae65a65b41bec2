// Elements from text and nodes. Text always becomes text: nothing in this page parses markup.

export type Child = Node | string | null;

export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children.filter((child): child is Node | string => child !== null));
  return element;
}

export function svg(tag: string, attributes: Record<string, string | number> = {}, ...children: (Node | string)[]): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

/// A table with a header row; columns of numbers are set flush right.
export function table(header: string[], rows: (string | Node)[][], caption: string, numeric: number[] = []): HTMLElement {
  const cell = (tag: "td" | "th", content: string | Node, column: number) =>
    h(tag, { ...(numeric.includes(column) ? { class: "number" } : {}), ...(tag === "th" ? { scope: "col" } : {}) }, content);
  return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption },
    h("table", {},
      h("caption", { class: "hidden" }, caption),
      h("thead", {}, h("tr", {}, ...header.map((text, column) => cell("th", text, column)))),
      h("tbody", {}, ...rows.map((row) => h("tr", {}, ...row.map((content, column) => cell("td", content, column)))))));
}
