// The program within the page: unpacked and compiled once, run by workers, so that the page answers while it computes.
import type { Answer, Order } from "./messages";
import type { Files, Ran } from "./process";

export interface Result extends Ran {
  words: string[];
  milliseconds: number;
}

const embedded = (id: string) => document.getElementById(id)!.textContent!;

async function compiled(): Promise<WebAssembly.Module> {
  const packed = Uint8Array.from(atob(embedded("program")), (character) => character.charCodeAt(0));
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(unpacked).arrayBuffer());
}

let compilation: Promise<WebAssembly.Module> | undefined;
export const ready = () => (compilation ??= compiled());

let address: string | undefined;
const workerAddress = () => (address ??= URL.createObjectURL(new Blob([embedded("worker")], { type: "text/javascript" })));

/// Commands one after another; what one says does not depend on those before.
export class Program {
  private worker: Promise<Worker> | undefined;
  private next = 0;
  private readonly waiting = new Map<number, { words: string[]; done: (result: Result) => void; failed: (error: Error) => void }>();

  /// Compiles the program, so that the first command need not wait for it.
  async start(): Promise<void> {
    await (this.worker ??= this.started());
  }

  async run(words: string[], files: Files): Promise<Result> {
    const worker = await (this.worker ??= this.started());
    const number = ++this.next;
    return new Promise((done, failed) => {
      this.waiting.set(number, { words, done, failed });
      worker.postMessage({ number, words, files } satisfies Order);
    });
  }

  /// Ends the command that runs, and all that wait.
  async stop(reason: string): Promise<void> {
    const worker = this.worker;
    this.worker = undefined;
    (await worker)?.terminate();
    for (const { failed } of this.waiting.values()) failed(new Error(reason));
    this.waiting.clear();
  }

  private async started(): Promise<Worker> {
    const program = await ready();
    const worker = new Worker(workerAddress());
    worker.addEventListener("message", ({ data }: MessageEvent<Answer>) => this.take(data));
    worker.postMessage({ program } satisfies Order);
    return worker;
  }

  private take(answer: Answer): void {
    const one = this.waiting.get(answer.number);
    if (one === undefined) return;
    this.waiting.delete(answer.number);
    if ("failure" in answer) one.failed(new Error(answer.failure));
    else one.done({ ...answer.ran, words: one.words, milliseconds: answer.milliseconds });
  }
}

/// Questions of a slider: while one is answered only the newest of the others is kept.
export class Newest<Question> {
  private busy = false;
  private waiting: Question | undefined;

  constructor(private readonly answer: (question: Question) => Promise<void>) {}

  ask(question: Question): void {
    if (this.busy) this.waiting = question;
    else void this.work(question);
  }

  private async work(question: Question): Promise<void> {
    this.busy = true;
    for (let next: Question | undefined = question; next !== undefined; ) {
      this.waiting = undefined;
      await this.answer(next);
      next = this.waiting;
    }
    this.busy = false;
  }
}
