// The files of the page: dropped, chosen or from the samples, each with what it is taken for.
import { h, table } from "../dom";
import { kindOf, kinds, type Kind, type Taken } from "./kinds";
import { button } from "./parts";
import type { Files } from "./process";
import { strings } from "./strings";

interface File extends Taken {
  data: Uint8Array;
}

export class Cabinet {
  private files: File[] = [];
  private readonly listeners: (() => void)[] = [];
  readonly element = h("div", {}, h("p", { class: "muted" }, strings.noFiles));

  /// Of files with the same name the last one counts.
  add(files: Files): void {
    const came = Object.entries(files).map(([name, data]): File => ({ name, data, kind: kindOf(name, new TextDecoder().decode(data.subarray(0, 65536))) }));
    this.files = [...this.files.filter(({ name }) => !(name in files)), ...came];
    this.changed();
  }

  replace(files: Files): void {
    this.files = [];
    this.add(files);
  }

  taken(): Taken[] {
    return this.files;
  }

  contents(kind?: Kind): Files {
    return Object.fromEntries(this.files.filter((file) => kind === undefined || file.kind === kind).map(({ name, data }) => [name, data]));
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  private changed(): void {
    this.element.replaceChildren(this.files.length === 0 ? h("p", { class: "muted" }, strings.noFiles) : table(strings.files, this.files.map((file) => this.row(file)), strings.filesCaption, [1]));
    this.listeners.forEach((listener) => listener());
  }

  private row(file: File): (string | Node)[] {
    const kind = h("select", { "aria-label": strings.takenFor(file.name) }, ...kinds.map((one) => h("option", one === file.kind ? { value: one, selected: "" } : { value: one }, strings.kinds[one])));
    kind.addEventListener("change", () => {
      file.kind = kind.value as Kind;
      this.listeners.forEach((listener) => listener());
    });
    const forget = () => {
      this.files = this.files.filter((one) => one !== file);
      this.changed();
    };
    return [file.name, strings.bytes(file.data.length), kind, button(strings.forget, forget, { "aria-label": strings.forgetFile(file.name) })];
  }
}

/// The files of a drop or of a file chooser.
export async function read(list: FileList): Promise<Files> {
  return Object.fromEntries(await Promise.all([...list].map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())] as const)));
}
