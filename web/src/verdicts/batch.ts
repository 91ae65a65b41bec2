// Is a batch good, and how much of a paper comes out?
import type { BeforeAndAfter, Reproduction, Spread, Yield } from "../data";
import { decimalsFor, digits, exact, fixed, milli, percent } from "../numbers";
import { strings } from "../strings";
import { assumptions, card, from, unitOf, type Verdict } from "./card";

const text = strings.verdict;

/// None where there are no machines.
function spreadCard(key: string, before: Spread, after: Spread): HTMLElement[] {
  if (before.p95 === null || after.p95 === null) return [];
  const cut = key.lastIndexOf("_"), { scale, unit } = milli(key.slice(cut + 1));
  const [low, high] = [scale * (after.p95_interval[0] ?? 0), after.p95_interval[1] === null ? null : scale * after.p95_interval[1]!];
  const decimals = decimalsFor(((high ?? scale * after.p95) - low) / 2);
  return [card(text.p95(strings.batch.quantities[key.slice(0, cut)] ?? key), [from(digits(scale * before.p95)), fixed(scale * after.p95, decimals), unitOf(unit)], [high === null ? text.unknown(fixed(low, decimals)) : text.after(fixed(low, decimals), fixed(high, decimals))])];
}

/// A verdict only where a share was asked for, as --min-yield does.
export function ofYield({ machines, partial, passed, min_yield: asked, yield: share, quantities, assumed }: Yield): Verdict {
  const reached = asked === undefined ? null : share !== null && share.low >= asked;
  return {
    yes: partial ? false : reached,
    says: partial ? text.no.yield : reached === null ? text.yes.yield : reached ? text.yes.reached(`${exact(100 * asked!)} %`) : text.no.reached(`${exact(100 * asked!)} %`),
    sentence: passed === null ? text.noLimits(String(machines)) : `${text.yield}: ${text.of(String(passed), String(machines))}.`,
    cards: [
      ...(share?.value != null ? [card(text.yield, [percent(share.value, 4)], [text.interval(percent(share.low), percent(share.high), share.confidence)])] : []),
      ...(Object.entries(quantities) as [string, BeforeAndAfter | null][]).flatMap(([key, both]) => (both ? spreadCard(key, both.before, both.after) : [])),
    ],
    notes: assumptions(assumed),
  };
}

/// A finding, not a verdict on the machine or the program: numbers that do not come out are results too.
export function ofReproduction({ rows, counts }: Reproduction): Verdict {
  return { yes: null, says: text.reproduced(counts.reproduced, rows.length), sentence: text.counts(counts.not_contradicted, counts.not_reproduced, counts.cannot_be_tested), cards: [] };
}
