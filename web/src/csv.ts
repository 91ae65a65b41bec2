// The data of a figure as a file.
import { h } from "./dom";

export type Cell = string | number | null;
export interface Sheet {
  columns: string[];
  rows: Cell[][];
}

/// RFC 4180. Text that a spreadsheet would take for a formula gets an apostrophe in front.
function field(cell: Cell): string {
  if (cell === null) return "";
  if (typeof cell === "number") return String(cell);
  const text = /^[=+\-@\t\r]/.test(cell) ? `'${cell}` : cell;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export const csvText = (sheet: Sheet) => [sheet.columns, ...sheet.rows].map((row) => row.map(field).join(",") + "\n").join("");

export function download(name: string, sheet: Sheet): void {
  const url = URL.createObjectURL(new Blob([csvText(sheet)], { type: "text/csv" }));
  h("a", { href: url, download: `${name}.csv` }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
