// What page and worker say to each other.
import type { Files, Ran } from "./process";

export type Order = { program: WebAssembly.Module } | { number: number; words: string[]; files: Files };
/// `failure`: the program ended in a way that it does not know, for want of memory for one.
export type Answer = { number: number; ran: Ran; milliseconds: number } | { number: number; failure: string };
