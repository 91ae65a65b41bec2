// Equations of headers, set by KaTeX. Headers spell TeX as one reads it: names without backslashes, A_dd^-1, d.u, a line a line, several blanks
// between what stands in one.
import { createRequire } from "node:module";

export const katexFolder = "/usr/share/javascript/katex";
const katex = createRequire(import.meta.url)(`${katexFolder}/katex.min.js`);
const signs = new Map("alpha beta gamma delta theta lambda mu sigma chi sum min max arg exp cos sin".split(" ").map((name) => [name, `\\${name}`]));
signs.set("epsilon", "\\varepsilon");

function spelled(word) {
  if (word[0] === "\\" || word.length < 3) return signs.get(word) ?? word;
  return signs.get(word) ?? `\\mathrm{${word}}`;
}

const tex = (said) =>
  said
    .replace(/ {2,}(?=\S)/g, "\\quad ")
    .replace(/(?<=[\w)}])(?<!\\\w+) (?=[A-Za-z(])/g, "\\, ")
    .replace(/(?<=[\w)]) ?\. ?(?=[A-Za-z(])/g, " \\cdot ")
    .replace(/_(\w{2,})/g, "_{$1}")
    .replace(/\^-1/g, "^{-1}")
    .replace(/\\(begin|end)\{\w+\}|\\[A-Za-z]+|[A-Za-z]{2,}/g, spelled);

/** HTML of what stands in a display; throws where KaTeX does not know it. */
export function equation(said) {
  const lines = said.trim().split(/\n */).map(tex);
  return katex.renderToString(`\\begin{gathered} ${lines.join(" \\\\ ")} \\end{gathered}`, { displayMode: true, throwOnError: true, strict: "error" });
}
