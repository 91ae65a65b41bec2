// The program for arm64, started by qemu, against that of this machine: PARACAL=path/to/paracal ROOT=folder node --test arm64.test.mjs. ROOT is a Debian for arm64 with
// the packages of a release, unpacked, and with qemu-aarch64-static.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { countNumbers, differences, kCommands } from "../../web/tests/agreement.mjs";

const here = resolve(process.env.PARACAL), root = resolve(process.env.ROOT);
execFileSync(fileURLToPath(new URL("../../tools/samples.sh", import.meta.url)), [root]);
// Where numpy finds BLAS and LAPACK: unpacked packages have not chosen one.
const algebra = ["blas", "lapack"].map((name) => `/usr/lib/aarch64-linux-gnu/${name}`).join(":");
const onArm = (...command) => spawnSync("chroot", [root, "/qemu-aarch64-static", ...command], { encoding: "utf8", env: { PATH: process.env.PATH, LD_LIBRARY_PATH: algebra } });

for (const command of kCommands.map((line) => line.replace(/ --report \S+/, ""))) {
  test(`the same numbers, words and exit code: ${command}`, (t) => {
    const words = command.split(" ");
    const theirs = spawnSync(here, words, { cwd: root, encoding: "utf8" }), ours = onArm("/usr/bin/paracal", ...words);
    assert.equal(ours.status, theirs.status, ours.stderr);
    assert.equal(ours.stderr, theirs.stderr);
    if (theirs.stdout === "") return;
    const [one, other] = [theirs.stdout, ours.stdout].map(JSON.parse);
    t.diagnostic(`${countNumbers(one)} numbers`);
    assert.ok(countNumbers(one) > 10);
    assert.deepEqual(differences(one, other), []);
  });
}

test("the Python module", () => {
  const program = 'import paracal; c = paracal.calibrate(paracal.robot("huang2016"), paracal.read_measurements("measured.csv")); print(c.verdict)';
  const { status, stdout, stderr } = onArm("/usr/bin/python3", "-c", program);
  assert.equal(status, 0, stderr);
  assert.equal(stdout, "accepted\n");
});

test("the program is for arm64", () => assert.equal(readFileSync(join(root, "usr/bin/paracal")).readUInt16LE(18), 183));  // EM_AARCH64
