// Numbers as a metrologist writes them: the uncertainty with two digits, the value to the same place.

const minus = (text: string) => text.replace("-", "\u2212");

/// Decimals that show two digits of an uncertainty.
export function decimalsFor(uncertainty: number): number {
  if (!(uncertainty > 0) || !Number.isFinite(uncertainty)) return 3;
  return Math.min(9, Math.max(0, 1 - Math.floor(Math.log10(uncertainty))));
}

export const fixed = (value: number, decimals: number) => minus(value.toFixed(decimals));

/// "0.206 ± 0.024"
export function withUncertainty(value: number, uncertainty: number): string {
  const decimals = decimalsFor(uncertainty);
  return `${fixed(value, decimals)} ± ${uncertainty.toFixed(decimals)}`;
}

/// So many significant digits, without an exponent where people would not use one; of what is not known a dash.
export function digits(value: number | null, count = 3): string {
  if (value === null || !Number.isFinite(value)) return "\u2013";
  if (Math.abs(value) < 1e-12) return "0"; // rounding
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  if (magnitude >= count) return fixed(value, 0);
  if (magnitude < -5) return minus(value.toExponential(count - 1));
  return fixed(value, count - 1 - magnitude);
}

/// A nominal dimension or commanded coordinate: all that was said, nothing more.
export const exact = (value: number) => minus(String(Number(value.toFixed(3))));

/// Angles of a thousandth of a rad and less are read in mrad.
export const milli = (unit: string) => (unit === "rad" ? { scale: 1e3, unit: "mrad" } : { scale: 1, unit });

/// A small probability: "< 0.0001".
export const probability = (p: number) => (p < 1e-4 ? "< 0.0001" : digits(p, 2));

export const percent = (share: number, count = 3) => `${digits(100 * share, count)} %`;

/// Quantile of the standard normal distribution, relative error below 1.2e-9 (Acklam's rational approximation).
export function normalQuantile(p: number): number {
  const a = [-39.69683028665376, 220.9460984245205, -275.9285104469687, 138.357751867269, -30.66479806614716, 2.506628277459239];
  const b = [-54.47609879822406, 161.5858368580409, -155.6989798598866, 66.80131188771972, -13.28068155288572, 1];
  const c = [-0.007784894002430293, -0.3223964580411365, -2.400758277161838, -2.549732539343734, 4.374664141464968, 2.938163982698783];
  const d = [0.007784695709041462, 0.3224671290700398, 2.445134137142996, 3.754408661907416, 1];
  const polynomial = (coefficients: number[], x: number) => coefficients.reduce((sum, k) => sum * x + k, 0);
  if (p > 0.97575) return -normalQuantile(1 - p);
  if (p < 0.02425) {
    const q = Math.sqrt(-2 * Math.log(p));
    return polynomial(c, q) / polynomial(d, q);
  }
  const q = p - 0.5;
  return (polynomial(a, q * q) * q) / polynomial(b, q * q);
}
