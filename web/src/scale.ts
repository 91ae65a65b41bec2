// Scales of colour bands with round thresholds: one can read a value off them, in print and without red and green.

/// Viridis from light to dark, for small to large.
const kColours = ["#fde725", "#addc30", "#5ec962", "#28ae80", "#21918c", "#2c728e", "#3b528b", "#472d7b", "#440154"];

export interface Bands {
  thresholds: number[]; ///< upper ends of all bands but the last
  colours: string[];
  colourOf: (value: number) => string;
}

/// 1, 2, 5, 10, 20, ... for k = 0, 1, 2, 3, 4, ...
const step = (k: number) => Number(([1, 2, 5][((k % 3) + 3) % 3]! * 10 ** Math.floor(k / 3)).toPrecision(1));

/// 1-2-5 down from the largest value; what is smaller than all of them is in the first band.
function logarithmic(smallest: number, largest: number): number[] {
  let k = 3 * Math.floor(Math.log10(largest)) + 3;
  while (step(k) >= largest) --k;
  const thresholds: number[] = [];
  for (; thresholds.length < kColours.length - 1 && step(k) > smallest; --k) thresholds.unshift(step(k));
  return thresholds;
}

/// Equal steps of 1, 2 or 5, as few as leave no more bands than colours.
/// @param middle  part of a step by which the thresholds are moved: 0.5 has zero in the middle of a band
function linear(smallest: number, largest: number, middle = 0): number[] {
  let k = 3 * Math.floor(Math.log10((largest - smallest) / kColours.length));
  while ((largest - smallest) / step(k) > kColours.length - 1) ++k;
  const width = step(k), thresholds: number[] = [];
  for (let n = Math.floor(smallest / width) - 1; (n + middle) * width < largest; ++n) {
    if ((n + middle) * width > smallest) thresholds.push(Number(((n + middle) * width).toPrecision(12)));
  }
  return thresholds;
}

export function bandsFor(values: number[]): Bands {
  const positive = values.filter((value) => value > 0);
  const largest = Math.max(...positive, 0), smallest = Math.min(...positive, largest);
  const wide = largest > 8 * smallest, lowest = Math.min(...values);
  const thresholds = lowest < 0 ? linear(lowest, Math.max(...values), 0.5) : !(largest > smallest) ? [] : wide ? logarithmic(smallest, largest) : linear(smallest, largest);
  const count = thresholds.length + 1;
  const colours = Array.from({ length: count }, (_, k) => kColours[count === 1 ? 0 : Math.round((k * (kColours.length - 1)) / (count - 1))]!);
  return { thresholds, colours, colourOf: (value) => colours[thresholds.filter((t) => value > t).length]! };
}
