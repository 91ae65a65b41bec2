// Light or dark, as the reader's system says until the reader says otherwise; paper is always light.
import { h } from "./dom";
import { strings } from "./strings";

type Listener = () => void;
const listeners: Listener[] = [];
const system = matchMedia("(prefers-color-scheme: dark)");
let chosen: boolean | null = null;
let printing = false;

const dark = () => !printing && (chosen ?? system.matches);

function apply(): void {
  document.documentElement.dataset.theme = dark() ? "dark" : "light";
  for (const listener of listeners) listener();
}

/// Called after every change; what is styled by CSS alone needs no call.
export const onThemeChange = (listener: Listener) => listeners.push(listener);

/// The value of a CSS colour, for what CSS does not reach.
export const colour = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export function startTheme(): void {
  system.addEventListener("change", apply);
  addEventListener("beforeprint", () => { printing = true; apply(); });
  addEventListener("afterprint", () => { printing = false; apply(); });
  apply();
}

export function themeButton(): HTMLElement {
  const button = h("button", { type: "button", title: strings.theme.change });
  const name = () => button.replaceChildren(dark() ? strings.theme.light : strings.theme.dark);
  button.addEventListener("click", () => { chosen = !dark(); apply(); });
  onThemeChange(name);
  name();
  return button;
}
