// Should a printer's new values be accepted?
import type { Printer, PrinterFigure } from "../data";
import { fixed } from "../numbers";
import { strings } from "../strings";
import { card, from, unitOf, type Verdict } from "./card";

const text = strings.verdict.printer;

export function ofPrinter(printer: Printer): Verdict {
  const isAccepted = printer.advice === "accept_new" || printer.advice === "accept_shift";
  const saved = printer.ladder[0]!, advised = printer.ladder.find((one) => one.rung === printer.rung) ?? saved;
  const compared = (name: string, of: (rung: typeof saved) => PrinterFigure, places: number, unit: string) => {
    const before = of(saved), after = of(advised);
    return card(name, [from(fixed(before.value, places)), fixed(after.value, places), unitOf(unit)], [text.interval(fixed(after.low, places), fixed(after.high, places), unit)]);
  };
  return {
    yes: isAccepted,
    says: text.says[printer.advice],
    sentence: text.sentence,
    reasons: printer.findings.slice(0, 1),
    cards: printer.advice === "check_input" ? [] : [
      compared(text.layer, (rung) => rung.first_layer_mm, 3, "mm"),
      compared(text.size, (rung) => rung.size_percent, 2, "%"),
    ],
    notes: [...printer.findings.slice(1), ...printer.details],
  };
}
