// The program of the live page as a command, on the files of this folder: node live_program.mjs BUILD WORDS... Tests compare it so with the
// program itself; the page runs it by the same src/live/process.ts.
import { mkdirSync, readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

/// process.ts as a module that Node.js takes.
async function processModule() {
  const { outputFiles } = await build({ entryPoints: [fileURLToPath(new URL("src/live/process.ts", import.meta.url))], bundle: true, format: "esm", write: false });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);
}

/// @returns a function from words and files to what the program makes of them.
export async function loaded(folder) {
  const { run } = await processModule();
  const factory = createRequire(import.meta.url)(resolve(folder, "bin/paracal.js"));
  const program = await WebAssembly.compile(readFileSync(resolve(folder, "bin/paracal.wasm")));
  return (words, files) => run(factory, program, words, files);
}

const filesHere = () => Object.fromEntries(readdirSync(".", { recursive: true }).filter((name) => statSync(name).isFile()).map((name) => [name, new Uint8Array(readFileSync(name))]));

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [folder, ...words] = process.argv.slice(2);
  const program = await loaded(folder);
  const { code, stdout, stderr, files } = await program(words, filesHere());
  for (const [name, data] of Object.entries(files)) {
    mkdirSync(dirname(name), { recursive: true });
    writeFileSync(name, data);
  }
  process.stdout.write(stdout);
  process.stderr.write(stderr);
  process.exitCode = code;
}
