// Should a printer's new values be accepted?
import type { Printer } from "../data";
import { digits } from "../numbers";
import { strings } from "../strings";
import { card, from, unitOf, type Verdict } from "./card";

const text = strings.verdict.printer;

function predicted(name: string, saved: number, ours: number, firmware: number): HTMLElement[] {
  return ours > 0 ? [card(name, [from(digits(saved, 2)), digits(ours, 2), unitOf("mm")], [text.byFirmware(digits(firmware, 2))])] : [];
}

export function ofPrinter(printer: Printer): Verdict {
  const { left_out_saved: saved, left_out: ours, left_out_firmware: firmware } = printer;
  const isAccepted = printer.advice !== "keep_saved" && printer.advice !== "check_input";
  const lost = printer.accuracy_new.shape_rms_mm;
  return {
    yes: isAccepted,
    says: text.says[printer.advice],
    sentence: text.sentence,
    reasons: isAccepted ? [] : printer.findings.slice(0, 1),
    cards: [
      card(text.shape, [from(digits(printer.expected_shape_saved_mm, 2)), digits(printer.judged_new.expected_shape_mm, 2), unitOf("mm")], [text.saved, text.lost(digits(lost, 2))]),
      ...(ours && firmware && saved
        ? [...predicted(text.height, saved.height_mm, ours.height_mm, firmware.height_mm), ...predicted(text.distance, saved.distance_mm, ours.distance_mm, firmware.distance_mm)]
        : []),
    ],
    notes: printer.findings,
  };
}
