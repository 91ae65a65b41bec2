// The live page: files in, a command, its verdict, and tools that answer while they are dragged.
import { h } from "../dom";
import { startTheme, themeButton } from "../theme";
import { Cabinet, read } from "./files";
import { commandFor } from "./kinds";
import { button, field, select } from "./parts";
import { plan } from "./plan";
import type { Files } from "./process";
import { Program, ready } from "./program";
import { endOf, show } from "./result";
import { seen } from "./seen";
import { strings } from "./strings";
import { tolerances } from "./tolerances";
import { text, type Around, type Question } from "./tool";
import { join, split } from "./words";

interface Sample {
  robot: string; ///< "": the files say it
  files: Record<string, string>;
}

const commands = new Program(), questions = new Program(); // a command that takes long must not hold up a slider
const cabinet = new Cabinet();
const samples = JSON.parse(document.getElementById("samples")!.textContent!) as Record<string, Sample>;

const status = h("p", { id: "status", role: "status", "aria-live": "polite" }, strings.loading);
const result = h("section", { id: "result", "aria-label": strings.result });
const line = h("input", { type: "text", id: "command", autocomplete: "off", spellcheck: "false", "aria-describedby": "command-hint" });
const robot = select([["", strings.robotBy]]);
const runButton = h("button", { type: "submit", class: "first" }, strings.run);
const stopButton = button(strings.stop, () => void commands.stop(strings.stopped), { disabled: "" });

async function run(words: string[]): Promise<void> {
  status.textContent = strings.running(`paracal ${join(words)}`);
  stopButton.disabled = false;
  try {
    const ended = await commands.run(words, cabinet.contents());
    result.replaceChildren(...show(ended));
    status.textContent = endOf(ended);
    result.dataset.milliseconds = String(Math.round(ended.milliseconds));
  } catch (error) {
    const why = (error as Error).message;
    status.textContent = why === strings.stopped ? why : strings.broke(why);
  }
  stopButton.disabled = true;
}

/// The command that the files ask for stands in its line and runs.
function follow(): void {
  const words = commandFor(cabinet.taken(), robot.value === "" ? [] : ["--robot", robot.value]);
  line.value = words === null ? "" : join(words);
  if (words !== null) void run(words);
  else if (cabinet.taken().length > 0) status.textContent = strings.nothingToDo;
}

const bytesOf = ({ files }: Sample): Files => Object.fromEntries(Object.entries(files).map(([name, content]) => [name, text(content)]));

function drop(): HTMLElement {
  const chooser = h("input", { type: "file", multiple: "", id: "chooser" });
  chooser.addEventListener("change", async () => {
    cabinet.add(await read(chooser.files!));
    chooser.value = "";
  });
  const element = h("div", { class: "drop" }, h("p", {}, strings.drop), field(strings.choose, chooser));
  const over = (is: boolean) => (event: DragEvent) => {
    event.preventDefault();
    element.classList.toggle("over", is);
  };
  addEventListener("dragover", over(true)); // all of the page takes files: a browser would open those that miss
  addEventListener("dragleave", over(false));
  addEventListener("drop", async (event) => {
    over(false)(event);
    if (event.dataTransfer?.files.length) cabinet.add(await read(event.dataTransfer.files));
  });
  return element;
}

function sampleRow(): HTMLElement {
  const choice = select(Object.keys(samples).map((name) => [name, strings.sample[name]!]));
  const load = () => {
    const sample = samples[choice.value]!;
    robot.value = sample.robot;
    cabinet.replace(bytesOf(sample));
  };
  return h("div", { class: "row" }, field(strings.samples, choice), button(strings.take, load, { id: "load-sample" }));
}

function form(): HTMLElement {
  const element = h("form", { class: "row" }, field(strings.command, line), runButton, stopButton);
  element.addEventListener("submit", (event) => {
    event.preventDefault();
    void run(split(line.value));
  });
  return element;
}

/// Words for the tools: the chosen robot, else the last that was dropped, else the first of the catalogue.
function robotOfTools(): Question {
  const own = cabinet.contents("robot"), name = robot.value || Object.keys(own).at(-1) || [...robot.options].map(({ value }) => value).find((value) => value !== "")!;
  return { words: ["--robot", name], files: name in own ? { [name]: own[name]! } : {} };
}

const robotListeners: (() => void)[] = [];
const around: Around = { program: questions, robot: robotOfTools, robotChanged: (listener) => robotListeners.push(listener) };
const planning = plan(around), seeing = seen(around, planning, () => cabinet.contents("poses")), tolerating = tolerances(around);

/// What tools stand on, when it is another.
let stoodOn = "";
function tellTools(): void {
  const now = JSON.stringify([robotOfTools().words, Object.keys(cabinet.contents("poses"))]);
  if (now === stoodOn) return;
  stoodOn = now;
  robotListeners.forEach((listener) => listener());
  seeing.tablesChanged();
}

function navigation(): HTMLElement {
  const link = (id: string, name: string) => h("li", {}, h("a", { href: `#${id}` }, name));
  return h("nav", { "aria-label": strings.sections }, h("div", {}, h("ul", {}, link("files", strings.nav.files), ...[planning, seeing, tolerating].map(({ id, nav }) => link(id, nav))), themeButton()));
}

function build(): void {
  document.title = strings.title;
  startTheme();
  document.getElementById("live")!.append(
    h("a", { class: "skip", href: "#files" }, strings.skip),
    navigation(),
    h("main", {},
      h("header", {}, h("h1", {}, strings.title), h("p", {}, strings.intro), h("p", {}, strings.stays)),
      h("section", { id: "files", tabindex: "-1", "aria-labelledby": "files-heading" }, h("h2", { id: "files-heading" }, strings.heading), drop(), sampleRow(), cabinet.element,
        h("div", { class: "row" }, field(strings.robot, robot)), form(), h("p", { class: "muted", id: "command-hint" }, strings.commandHint), status),
      result, planning.element, seeing.element, tolerating.element));
}

async function listRobots(): Promise<void> {
  const { stdout } = await questions.run(["robot", "--list", "--json"], {});
  const { robots } = JSON.parse(stdout) as { robots: string[] };
  robot.append(...robots.map((name) => h("option", { value: name }, name)));
}

async function start(): Promise<void> {
  const begin = performance.now();
  try {
    await ready();
    await Promise.all([commands.start(), questions.start()]);
    await listRobots();
  } catch (error) {
    status.textContent = strings.failed((error as Error).message);
    return;
  }
  if (cabinet.taken().length === 0) status.textContent = strings.readyIn(performance.now() - begin);
  robot.addEventListener("change", () => {
    follow();
    tellTools();
  });
  cabinet.onChange(tellTools);
  tellTools();
}

build();
cabinet.onChange(follow);
void start();
