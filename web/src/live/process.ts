// One run of the program: a fresh instance of its WebAssembly, as a process is, with files of its own in memory.

export type Files = Record<string, Uint8Array>;

export interface Ran {
  code: number; ///< as of the program: 0 done, 1 the verdict is no, 2 wrong usage, 3 bad input file, 4 the mathematics says no
  stdout: string;
  stderr: string;
  files: Files; ///< that it wrote
}

interface FileSystem {
  ignorePermissions: boolean;
  init(input: () => null, output: (byte: number) => void, errors: (byte: number) => void): void;
  analyzePath(path: string): { exists: boolean };
  mkdir(folder: string): void;
  chdir(folder: string): void;
  rename(one: string, other: string): void;
  readdir(folder: string): string[];
  isDir(mode: number): boolean;
  stat(file: string): { mode: number };
  readFile(file: string): Uint8Array;
  writeFile(file: string, data: Uint8Array): void;
}
interface Instance {
  FS: FileSystem;
  callMain(words: string[]): number;
}
interface Settings {
  instantiateWasm(imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void): object;
  preRun: ((instance: Instance) => void)[];
  quit(code: number, thrown: unknown): never;
}

/// What emscripten makes of the program (live/emscripten.cmake).
export type Factory = (settings: Settings) => Promise<Instance>;

const kFolder = "/here";

const equal = (one: Uint8Array, other: Uint8Array | undefined) => other !== undefined && one.length === other.length && one.every((byte, k) => byte === other[k]);

/// All files of a folder and of the folders in it, by their names from here.
function filesOf(FS: FileSystem, folder: string, prefix = ""): [string, Uint8Array][] {
  return FS.readdir(folder).filter((name) => name !== "." && name !== "..").flatMap((name): [string, Uint8Array][] => {
    const path = `${folder}/${name}`;
    return FS.isDir(FS.stat(path).mode) ? filesOf(FS, path, `${prefix}${name}/`) : [[prefix + name, FS.readFile(path)]];
  });
}

function makeFolder(FS: FileSystem, folder: string): string {
  if (!FS.analyzePath(folder).exists) FS.mkdir(folder);
  return folder;
}

/// Files that were not given, or not so.
const written = ({ FS }: Instance, given: Files): Files => Object.fromEntries(filesOf(FS, kFolder).filter(([name, data]) => !equal(data, given[name])));

/// @param words  behind the program's name.
export async function run(factory: Factory, program: WebAssembly.Module, words: string[], files: Files): Promise<Ran> {
  const stdout: number[] = [], stderr: number[] = [];
  const instance = await factory({
    instantiateWasm(imports, done) {
      void WebAssembly.instantiate(program, imports).then(done);
      return {};
    },
    quit(_code, thrown) {
      throw thrown; // callMain knows it; Node.js would end by it
    },
    preRun: [({ FS }) => {
      FS.init(() => null, (byte) => stdout.push(byte), (byte) => stderr.push(byte));
      FS.rename("/proc/self", "/proc/none"); // emscripten's has files and no folders; where there is none the program does without
    }],
  });
  instance.FS.mkdir(kFolder);
  instance.FS.chdir(kFolder);
  for (const [name, data] of Object.entries(files)) {
    name.split("/").slice(0, -1).reduce((folder, part) => makeFolder(instance.FS, `${folder}/${part}`), kFolder);
    instance.FS.writeFile(`${kFolder}/${name}`, data);
  }
  const code = instance.callMain(words);
  instance.FS.ignorePermissions = true; // emscripten's umask forbids everything
  const text = (bytes: number[]) => new TextDecoder().decode(new Uint8Array(bytes));
  return { code, stdout: text(stdout), stderr: text(stderr), files: written(instance, files) };
}
