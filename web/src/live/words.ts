// A command line as its words, and back: what a shell would make of it, as far as names of files need it.

/// Words between blanks; quotation marks of either kind keep blanks.
export function split(line: string): string[] {
  return [...line.matchAll(/(?:[^\s"']+|"[^"]*"|'[^']*')+/g)].map(([word]) => word.replace(/"([^"]*)"|'([^']*)'/g, (_all, double?: string, single?: string) => double ?? single ?? ""));
}

const quoted = (word: string) => (/^[\w@%+=:,./-]+$/.test(word) ? word : word.includes("'") ? `"${word}"` : `'${word}'`);

export const join = (words: string[]) => words.map(quoted).join(" ");
