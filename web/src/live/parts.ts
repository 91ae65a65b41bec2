// Controls that the tools of the page share.
import { h } from "../dom";

let numbered = 0;

/// A label with its control behind it.
export function field(name: string, control: HTMLElement): HTMLElement {
  control.id ||= `field-${++numbered}`;
  return h("span", { class: "field" }, h("label", { for: control.id }, name), control);
}

export function select(options: [value: string, text: string][]): HTMLSelectElement {
  return h("select", {}, ...options.map(([value, text]) => h("option", { value }, text)));
}

export interface Slider {
  element: HTMLElement;
  input: HTMLInputElement;
  value(): number;
  set(value: number): void;
}

/// A slider that says its value beside its name.
export function slider(name: string, range: { min: number; max: number; step: number; value: number }, says: (value: number) => string): Slider {
  const id = `slider-${++numbered}`;
  const input = h("input", { type: "range", id, ...Object.fromEntries(Object.entries(range).map(([key, number]) => [key, String(number)])) });
  const output = h("output", { for: id });
  const value = () => Number(input.value);
  const say = () => {
    output.textContent = says(value());
    input.setAttribute("aria-valuetext", says(value()));
  };
  input.addEventListener("input", say);
  say();
  return { element: h("div", { class: "slider" }, h("label", { for: id }, name), output, input), input, value, set: (number) => { input.value = String(number); say(); } };
}

export function button(text: string, press: () => void, attributes: Record<string, string> = {}): HTMLButtonElement {
  const element = h("button", { type: "button", ...attributes }, text);
  element.addEventListener("click", press);
  return element;
}

/// Gives a file to whoever sits in front of the page.
export function save(name: string, data: Uint8Array | string, type = "application/octet-stream"): void {
  const address = URL.createObjectURL(new Blob([data as BlobPart], { type }));
  h("a", { href: address, download: name.split("/").at(-1)! }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000); // ms; the browser has taken it by then
}
