// A tool of the page: a question to the program that is asked again with every movement of a slider.
import { h } from "../dom";
import { section, type Section } from "../section";
import type { Files } from "./process";
import { Newest, type Program, type Result } from "./program";
import { strings } from "./strings";
import { join } from "./words";

export interface Question {
  words: string[];
  files: Files;
}

/// What the tools know of the page around them.
export interface Around {
  program: Program;
  /// The words that name the robot, and its file where it has one.
  robot(): Question;
  robotChanged(listener: () => void): void;
}

/// Where an answer stands; what is read aloud when it comes is its first line alone.
export class AnswerPlace {
  private readonly body = h("div", { class: "answer", "aria-busy": "true" });
  private readonly asked = h("code", { class: "command" });
  readonly element = h("div", {}, this.body, h("p", { class: "muted" }, strings.tools.asked), this.asked);

  constructor(private readonly show: (answer: unknown, result: Result) => Node[]) {}

  waits(words: string[]): void {
    this.body.setAttribute("aria-busy", "true");
    this.asked.textContent = `paracal ${join(words)}`;
  }

  take(result: Result): void {
    this.body.replaceChildren(...(result.code <= 1 ? this.show(JSON.parse(result.stdout), result) : [h("pre", { class: "said errors", tabindex: "0" }, result.stderr.trim())]));
    this.body.setAttribute("aria-busy", "false");
    this.body.dataset.milliseconds = String(Math.round(result.milliseconds));
  }
}

/// Asks the question of now, and again when one of the controls moves.
export function askedBy({ program, robotChanged }: Around, controls: HTMLElement[], place: AnswerPlace, question: () => Promise<Question> | Question): () => void {
  const newest = new Newest<null>(async () => {
    const { words, files } = await question();
    place.waits(words);
    try {
      place.take(await program.run(words, files));
    } catch (error) {
      place.take({ code: 2, stdout: "", stderr: strings.broke(String(error)), files: {}, words, milliseconds: 0 });
    }
  });
  const ask = () => newest.ask(null);
  for (const control of controls) control.addEventListener("input", ask);
  robotChanged(ask);
  return ask;
}

export const toolSection = (id: string, nav: string, heading: string, intro: string, ...content: Node[]): Section => section(id, nav, heading, intro, ...content);

export const text = (content: string): Uint8Array => new TextEncoder().encode(content);
