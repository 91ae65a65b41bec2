// Should a printer's new values be accepted?
import type { Printer } from "../data";
import { digits } from "../numbers";
import { strings } from "../strings";
import { card, from, unitOf, type Verdict } from "./card";

const text = strings.verdict.printer;

function predicted(name: string, ours: number, firmware: number): HTMLElement[] {
  return ours > 0 ? [card(name, [digits(ours, 2), unitOf("mm")], [text.byFirmware(digits(firmware, 2))])] : [];
}

export function ofPrinter(printer: Printer): Verdict {
  const { accuracy_saved: before, accuracy_new: after, left_out: ours, left_out_firmware: firmware } = printer;
  return {
    yes: printer.advice === "accept_new",
    says: text.says[printer.advice],
    sentence: text.sentence,
    reasons: printer.advice === "accept_new" ? [] : printer.findings.slice(-1),
    cards: [
      card(text.shape, [from(digits(before.shape_rms_mm, 2)), digits(after.shape_rms_mm, 2), unitOf("mm")], [text.saved, text.absolute(digits(before.absolute_rms_mm, 2), digits(after.absolute_rms_mm, 2))]),
      ...(ours && firmware ? [...predicted(text.height, ours.height_mm, firmware.height_mm), ...predicted(text.distance, ours.distance_mm, firmware.distance_mm)] : []),
    ],
    notes: printer.findings,
  };
}
