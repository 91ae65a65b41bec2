// Runs commands one after another, off the page's own thread. The program's loader stands before this text (web/build_live.mjs).
import type { Answer, Order } from "./messages";
import { run, type Factory } from "./process";

declare const paracal: Factory;

let program: WebAssembly.Module;
let last: Promise<unknown> = Promise.resolve();

async function answer(number: number, words: string[], files: Record<string, Uint8Array>): Promise<Answer> {
  const start = performance.now();
  try {
    const ran = await run(paracal, program, words, files);
    return { number, ran, milliseconds: performance.now() - start };
  } catch (error) {
    return { number, failure: String(error) };
  }
}

addEventListener("message", ({ data }: MessageEvent<Order>) => {
  if ("program" in data) {
    program = data.program;
    return;
  }
  last = last.then(async () => postMessage(await answer(data.number, data.words, data.files)));
});
