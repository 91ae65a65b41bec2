// The types of the data that a page is made from, out of the schema of reports: node types.mjs writes src/data.ts.
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { compileFromFile } from "json-schema-to-typescript";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const schemas = here("../schema");
const bannerComment = "// Made by node types.mjs from the schemas in schema/, which say what each key means. Not to be edited.";

/// Without what types cannot say, and would become other types by: words beside a reference, and which optional keys stand instead of each other.
function plain(schema) {
  if (Array.isArray(schema)) return schema.map(plain);
  if (typeof schema !== "object" || schema === null) return schema;
  if (schema.$ref) return { $ref: schema.$ref };
  const { oneOf, ...rest } = schema;
  return Object.fromEntries(Object.entries(rest).filter(([key, value]) => key !== "description" || typeof value !== "string").map(([key, value]) => [key, plain(value)]));
}

/// The text of src/data.ts.
export async function types() {
  const folder = mkdtempSync(join(tmpdir(), "types"));
  try {
    for (const file of readdirSync(schemas)) writeFileSync(join(folder, file), JSON.stringify(plain(JSON.parse(readFileSync(join(schemas, file), "utf8")))));
    const text = await compileFromFile(join(folder, "report.schema.json"), { cwd: folder, bannerComment, style: { printWidth: 160 } });
    return text.replace(/\n *\/\*\*.*?\*\//gs, "");
  } finally {
    rmSync(folder, { recursive: true });
  }
}

if (process.argv[1] === here("types.mjs")) writeFileSync(here("src/data.ts"), await types());
