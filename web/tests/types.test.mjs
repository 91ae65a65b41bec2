// The page's types are those of the schemas that the program's outputs are held against.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { types } from "../types.mjs";

const text = readFileSync(new URL("../src/data.ts", import.meta.url), "utf8");

test("data.ts is what types.mjs makes of the schemas: node types.mjs", async () => {
  assert.equal(text, await types());
});

test("no type of a name is there twice, told apart by numbers alone", () => {
  const names = [...text.matchAll(/^export (?:type|interface) (\w+)/gm)].map(([, name]) => name);
  assert.ok(names.length > 50);
  assert.deepEqual(names.filter((name) => /\d$/.test(name) && name !== "Iso9283"), []);
});
