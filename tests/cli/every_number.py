#!/usr/bin/python3
"""Every number of every sample, and every sample broken at random, through the commands that read it: every_number.py PROGRAM [numbers | broken]...

numbers  each number, one at a time, becomes 1e8, -1e8, 1e30, 1e308 and nan. No command may die, take 20 s, say "Error in function" or print nan or
         inf, and it ends with 0 only where ACCEPTED says why that number may be so.
broken   samples with bytes, numbers, columns and lines changed, doubled and dropped. No command may die, and what is refused names file and line.

A few hundred of each are drawn; PARACAL_EVERY_MACHINE: every number, and 20,000 broken samples. --of PATTERN: samples of these names alone; --every K: each
K-th number; --count N: so many broken samples; --seed N: others; --list: every run that does not hold, not the first ones.
"""

import argparse
import concurrent.futures
import fnmatch
import os
import random
import re
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EVERY = "PARACAL_EVERY_MACHINE" in os.environ
VALUES = ("1e8", "-1e8", "1e30", "1e308", "nan")
GCODE = {"1e8": "100000000", "-1e8": "-100000000", "1e30": "1" + 30 * "0", "1e308": "1" + 308 * "0"}  # which has no exponents
TIMEOUT_S = 20
JSON_NUMBERS_OF_A_KEY = 3

PREPARED = (
    "robot --template hexapod --out hexapod.toml",
    "calibrate --measurements measured.csv --out calibration.json",
    "calibrate --printer printer.cfg --out printer.json",
)

# A command, and those of its files whose numbers it is tried with; those of "options" are its own.
COMMANDS = (
    ("robot --robot robot.toml", "robot.toml"),
    ("robot --robot hexapod.toml", "hexapod.toml"),
    ("robot --robot driven.toml", "driven.toml"),
    ("robot --robot driven_linear.toml", "driven_linear.toml"),
    ("inverse --robot huang2016 --poses work.csv", "work.csv"),
    ("inverse --robot huang2016 --poses work.csv --errors offsets.toml", "offsets.toml"),
    ("forward --robot huang2016 --joints joints.csv --errors errors.toml", "joints.csv errors.toml"),
    ("error-model --robot huang2016 --pose 100,50,-900,10", "options"),
    ("sensitivity --robot huang2016 --pose 100,50,-900,10", "options"),
    ("poses --robot huang2016 --optimal 12 --candidates 200 --sigma-mm 0.02 --tracker 2500,0,-900 --facing 1,0,0 --acceptance-deg 70", "options"),
    ("simulate --robot huang2016 --poses work.csv --noise-mm 0.02 --rotation-noise-deg 0.01 --second 0,30,-40 --repeatability-mm 0.01", "options work.csv"),
    ("identifiability --poses plan.csv", "plan.csv"),
    ("identifiability --poses check_plan.csv --sigma-mm 0.02 --sigma-deg 0.01", "check_plan.csv options"),
    ("identifiability --poses body_plan.csv --measure pose", "body_plan.csv"),
    ("identifiability --poses bar_plan.csv --measure ball-bar --at 0,0,-1200", "bar_plan.csv options"),
    ("identifiability --poses dial_plan.csv --measure dial --at 0,0,1", "dial_plan.csv options"),
    ("calibrate --measurements distances.csv --poses poses.csv", "distances.csv poses.csv"),
    ("calibrate --measurements measured.csv --tolerances tolerances.toml", "measured.csv"),
    ("calibrate --measurements measured.csv --temperature-c 27 --scale-ppm 30 --tracker-um 15,6,10,0.3 --limit-mm 0.2", "options"),
    ("calibrate --measurements stated.csv", "stated.csv"),
    ("calibrate --measurements tracker.txt --poses plan.csv --columns name=3,x=4,y=5,z=6 --unit m", "tracker.txt plan.csv"),
    ("calibrate --measurements export.csv --poses plan.csv", "export.csv"),
    ("calibrate --measurements heights.csv home_distances.csv --poses heights_plan.csv --height-sigma-mm 0.01 --sigma-mm 0.02",
     "heights.csv home_distances.csv heights_plan.csv options"),
    ("calibrate --measurements bar.csv --poses bar_plan.csv --sigma-mm 0.005", "bar.csv"),
    ("calibrate --measurements heights.csv dial.csv --poses heights_plan.csv dial_plan.csv --height-sigma-mm 0.01", "dial.csv"),
    ("calibrate --measurements body.csv --reflectors end-effector", "body.csv"),
    ("validate --calibration calibration.json --measurements check.csv --limit-mm 0.15 --limit-deg 1", "check.csv options"),
    ("compensate --calibration calibration.json --poses work.csv", "calibration.json work.csv"),
    ("export --calibration calibration.json --target gcode --input part.ngc", "part.ngc"),
    ("export --calibration calibration.json --target csv --input targets.csv", "targets.csv"),
    ("sensitivity --robot huang2016 --tolerances tolerances.toml", "tolerances.toml"),
    ("sensitivity --robot huang2016 --tolerances drawing.toml", "drawing.toml"),
    ("tolerance allocate --robot huang2016 --max-tilt 1e-3", "options"),
    ("tolerance allocate --robot huang2016 --problem problem.toml", "problem.toml"),
    ("tolerance allocate --robot hexapod.toml --problem strut_problem.toml", "strut_problem.toml"),
    ("tolerance analyze --robot huang2016 --tolerances tolerances.toml --max-tilt 0.001 --max-machines 256 --failure-error 0.5", "options"),
    ("yield --robot huang2016 --machines 3 --max-distance-mm 1 --max-position-mm 1 --max-rotation-deg 1 --repeatability-mm 0.01", "options"),
    ("calibrate --printer printer.cfg", "printer.cfg"),
    ("calibrate --printer rotary_printer.cfg", "rotary_printer.cfg"),
    ("calibrate --printer config.g --firmware reprapfirmware --readings bed_heights.csv,bed_distances.csv", "config.g bed_heights.csv bed_distances.csv"),
    ("export --calibration printer.json --target gcode --input part.gcode", "part.gcode printer.json"),
)


@dataclass
class Accepted:
    """Numbers that may be anything, or what `values` has."""

    files: str
    keys: str
    why: str
    values: tuple[str, ...] = VALUES

    def holds(self, file: str, key: str, value: str) -> bool:
        return any(fnmatch.fnmatchcase(file, one) for one in self.files.split("|")) and re.fullmatch(self.keys, key) is not None and value in self.values


LARGE = ("1e8", "-1e8", "1e30", "1e308")
READ_OF_A_CALIBRATION = (
    r"\.\.value|\.\.std|\.\.limb|covariance|covariance_of_noise|noise_dof|joint_std_deg|joint_std_mm|visit_std_deg|visit_std_mm|drive_covariance|centre|spacing|coverage_factor|rank|readings|degrees_of_freedom|noise_mm|"
    "orientation_noise_deg|residual_rms_mm|unit_weight_std|distance_bias_std_mm|fit_probability|chance"
)
ACCEPTED = (
    Accepted("*.json", f"(?!({READ_OF_A_CALIBRATION})$).*", "what a fit reports besides, which no command reads again", LARGE),
    Accepted("*.json", r"(\.\.)?(text|file|sha256|program|build|name|assumed|notes|reasons|source|series|reading|lines|findings|likely_causes|bound|details|needs|advice|rung)", "within a text"),
    Accepted("*.json", "noise_dof|readings|degrees_of_freedom|rank", "a count", ("1e8",)),
    Accepted("*", "options", "within a text"),
    Accepted("tracker.txt|export.csv", "line|column 6", "a field that is no column asked for"),
    Accepted("problem.toml|strut_problem.toml", r"cost\..*\.(A|B|cost|grade)", "a cost, in any money", ("1e8", "-1e8")),
    Accepted("drawing.toml", r"tolerances\..*_deg", "the length over which a drawing states an orientation: the longer, the less it may turn", LARGE),
    Accepted("printer.cfg", r"delta_calibrate\.radius", "where the firmware probes: the readings say where that was", LARGE),
    Accepted("printer.cfg|rotary_printer.cfg", r"printer\.max_\w+", "of the firmware alone: no dimension"),
    Accepted("targets.csv", "step", "of no pose: passed on as it stands"),
    Accepted("*.gcode|*.ngc", "[NMGTSP]", "not of motion: passed on as it stands"),
    Accepted("*", "--seed|--threads|--machines|--candidates|--max-machines|--optimal", "a whole number", ("1e8",)),
)


@dataclass
class Number:
    """A number of a sample: its bytes from `begin` to `end`, and the column or key that it is of."""

    file: str
    line: int
    begin: int
    end: int
    key: str


def comment_of(file: str, line: str) -> int:
    """Where the comment of a line begins, or its end."""
    marks = {"csv": "#", "toml": "#", "cfg": "#;", "g": ";", "gcode": ";", "ngc": ";(", "txt": "", "json": ""}[file.rsplit(".", 1)[1]]
    if line.startswith("#*#"):
        return len(line)
    return min((at for mark in marks if (at := line.find(mark)) >= 0), default=len(line))


NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?(?![\w.])")
PLAIN = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.])")
WORD = re.compile(r"(?<=[A-Z])[-+]?\d+(?:\.\d+)?")


def numbers_of(file: str, text: str) -> list[Number]:
    kind = file.rsplit(".", 1)[1]
    found: list[Number] = []
    header: list[str] = []
    separator, section, at = ",", "", 0
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        told = line[: comment_of(file, line)]
        if kind == "csv" and told.strip() and not any(re.fullmatch(r"[a-z0-9_]*", one) is None for one in told.strip().split(",")) and not header:
            header = told.strip().split(",")
            at += len(line)
            continue
        if kind == "csv" and ";" in told:
            separator = ";"
        if heading := re.search(r"^(?:#\*# )?\[+([\w .]+)\]", told):
            section = heading[1]
        pattern = WORD if kind in ("g", "gcode", "ngc") else NUMBER if separator == ";" else PLAIN
        json_keys = list(re.finditer(r'"(\w+)":', told)) if kind == "json" else []
        level = "" if re.match(r"  ?\S", told) else ".."  # of an object within the file's
        for one in pattern.finditer(told):
            if told.startswith("#*# <") or (kind == "cfg" and re.match(r"(#\*# )?\[", told)):
                continue
            if kind == "csv":
                field = told[: one.start()].count(separator)
                key = header[field] if field < len(header) else f"column {field + 1}"
            elif kind in ("g", "gcode", "ngc"):
                key = told[one.start() - 1]
            elif kind == "json":
                before = [key[1] for key in json_keys if key.start() < one.start()]
                key = level + before[-1] if before else section
            elif kind == "txt":
                key = "line"
            else:
                name = re.split(r"[:=]", re.sub(r"^#\*# ", "", told))[0].strip()
                key = f"{section}.{name}"
            found.append(Number(file, number, at + one.start(), at + one.end(), key))
        if json_keys:
            section = level + json_keys[-1][1]
        at += len(line)
    return found


def options_of(command: str) -> list[Number]:
    found: list[Number] = []
    for one in PLAIN.finditer(command):
        names = re.findall(r"--[\w-]+", command[: one.start()])
        if names:
            found.append(Number("options", 0, one.start(), one.end(), names[-1]))
    return found


@dataclass
class Run:
    command: str
    file: str
    what: str
    key: str
    value: str
    text: Callable[[], str]  # of the file, or of the command: all of them at once would fill the memory


@dataclass
class Result:
    run: Run
    code: int
    said: str = ""  # its first line
    complaints: list[str] = field(default_factory=list)
    lacks: str = ""  # a refusal of what the file holds without "file", or without "line"; of a file as a "whole"


LOCAL = threading.local()


def run(program: str, samples: dict[str, str], folders: list[Path], one: Run) -> Result:
    if not hasattr(LOCAL, "folder"):
        LOCAL.folder = folders.pop()
    text = one.text()
    command = text if one.file == "options" else one.command
    if one.file != "options":
        (LOCAL.folder / one.file).write_bytes(text.encode("utf-8", "surrogateescape"))
    try:
        done = subprocess.run([program, *command.split(), "--threads", "1"], cwd=LOCAL.folder, capture_output=True, timeout=TIMEOUT_S, stdin=subprocess.DEVNULL)
        code, out, err = done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")
    except subprocess.TimeoutExpired:
        code, out, err = -99, "", ""
    if one.file != "options":
        (LOCAL.folder / one.file).write_text(samples[one.file], encoding="utf-8", newline="")
    return judged(one, text, code, out, err)


NOT_A_NUMBER = re.compile(r"(?<![A-Za-z_])(?:nan|inf(?:inity)?)(?![A-Za-z_])", re.IGNORECASE)


def judged(one: Run, text: str, code: int, out: str, err: str) -> Result:
    result = Result(one, code, next(iter((err.strip() or out.strip()).splitlines()), ""))
    say = result.complaints.append
    if code == -99:
        say(f"takes more than {TIMEOUT_S} s")
    elif code not in range(5):
        say(f"dies with {code}")
    if "Error in function" in out + err:
        say("says Error in function")
    # What is refused is quoted.
    said = out + ("" if code > 1 and one.value in ("nan", "") else err)
    if NOT_A_NUMBER.search(said) and not (one.value in ("nan", "") and NOT_A_NUMBER.search(text)):
        say("prints nan or inf")
    if code in (3, 4) or (code == 2 and one.file != "options"):
        first = next((line for line in err.splitlines() if line.startswith("paracal: ")), "")
        if one.file != "options":
            names_file = re.match(r"paracal: [^: ]+\.[a-z]+: ", first) is not None
            is_missing = re.search(r"expected .*, got (none|no line|nothing)\b|--robot: expected a robot", first) is not None
            result.lacks = "" if re.match(r"paracal: [^:]+:\d+: ", first) else "whole" if is_missing else "line" if names_file else "file"
    return result


def replaced(text: str, begin: int, end: int, by: str) -> str:
    return text[:begin] + by + text[end:]


def of_numbers(samples: dict[str, str], options: argparse.Namespace) -> list[Run]:
    runs: list[Run] = []
    for command, files in COMMANDS:
        for file in files.split():
            if not fnmatch.fnmatchcase(file, options.of):
                continue
            text = command if file == "options" else samples[file]
            found = options_of(command) if file == "options" else numbers_of(file, text)
            if file.endswith(".json"):  # of a key that comes again, as an entry of a matrix, the first ones
                seen: Counter[str] = Counter()
                found = [one for one in found if seen.update([one.key]) or seen[one.key] <= JSON_NUMBERS_OF_A_KEY]
            for number in found:
                for value in VALUES:
                    written = GCODE.get(value, value) if file.endswith((".g", ".gcode", ".ngc")) else value
                    changed = partial(replaced, text, number.begin, number.end, written)
                    runs.append(Run(command, file, f"{file}:{number.line}", number.key, value, changed))
    return runs


def broken(text: str, seed: str) -> str:
    """A text with one thing wrong, or two."""
    draw = random.Random(seed)
    for _ in range(draw.choice((1, 1, 1, 2))):
        lines = text.splitlines(keepends=True) or [""]
        k = draw.randrange(len(lines))
        at = draw.randrange(len(text) + 1)
        kind = draw.choice(("flip", "drop", "insert", "line twice", "no line", "swap", "number", "number", "number", "cut", "CR LF", "BOM", "blank", "letter", "sign"))
        if kind == "flip":
            text = text[:at] + chr(draw.randrange(1, 127)) + text[at + 1 :]
        elif kind == "drop":
            text = text[:at] + text[at + draw.randrange(1, 9) :]
        elif kind == "insert":
            text = text[:at] + draw.choice(("\udcff", "\x00", "\n", ",", ";", "-", ".", "e", '"', "[", "}", "#", " ", "\t", "é")) + text[at:]
        elif kind == "line twice":
            text = "".join(lines[: k + 1] + lines[k:])
        elif kind == "no line":
            text = "".join(lines[:k] + lines[k + 1 :])
        elif kind == "swap":
            fields = lines[k].rstrip("\n").split(",")
            a, b = draw.randrange(len(fields)), draw.randrange(len(fields))
            fields[a], fields[b] = fields[b], fields[a]
            text = "".join(lines[:k] + [",".join(fields) + "\n"] + lines[k + 1 :])
        elif kind in ("number", "sign"):
            found = list(re.finditer(r"[-+]?\d+(?:\.\d+)?", text))
            if found:
                one = draw.choice(found)
                value = "-" + one[0] if kind == "sign" else draw.choice(("0", "-1", "1e9", "1e-9", "1e400", "nan", "inf", "", one[0] + one[0], one[0] + "000", one[0].replace(".", ",")))
                text = text[: one.start()] + value + text[one.end() :]
        elif kind == "cut":
            text = text[:at]
        elif kind == "CR LF":
            text = text.replace("\n", "\r\n")
        elif kind == "BOM":
            text = "\ufeff" + text
        elif kind == "blank":
            text = "".join([*lines[:k], "\n", *lines[k:]])
        elif kind == "letter":
            found = [one.start() for one in re.finditer(r"[a-z]", text)]
            if found:
                at = draw.choice(found)
                text = text[:at] + draw.choice("abcxyzXYZ_") + text[at + 1 :]
    return text


def of_broken(samples: dict[str, str], options: argparse.Namespace) -> list[Run]:
    draw = random.Random(options.seed)
    pairs = [(command, file) for command, files in COMMANDS for file in files.split() if file != "options" and fnmatch.fnmatchcase(file, options.of)]
    runs: list[Run] = []
    while pairs and len(runs) < options.count:
        command, file = draw.choice(pairs)
        seed = f"{options.seed} {len(runs)}"
        runs.append(Run(command, file, f"seed {seed}", file, "", partial(broken, samples[file], seed)))
    return runs


def prepare(program: str, folder: Path) -> None:
    subprocess.run([ROOT / "tools/samples.sh", folder], check=True)
    for one in (ROOT / "tests/corpus/files").iterdir():
        (folder / one.name).write_bytes(one.read_bytes())
    for command in PREPARED:
        subprocess.run([program, *command.split()], cwd=folder, check=True, capture_output=True)


def shown(result: Result) -> str:
    one = result.run
    return f"{one.what} {one.key} = {one.value}: {', '.join(result.complaints)} [{result.code}] {result.said[:200]}   ({one.command})"


def report(mode: str, results: list[Result], options: argparse.Namespace) -> bool:
    if mode == "numbers":
        for one in results:
            allowed = any(rule.holds(one.run.file, one.run.key, one.run.value) for rule in ACCEPTED)
            if one.code == 0 and not allowed:
                one.complaints.append("is accepted")
    wrong = [one for one in results if one.complaints]
    refused = [one for one in results if one.code in (3, 4) and one.run.file != "options"]
    whole = [one for one in results if one.lacks == "whole"]
    lacking = [one for one in refused if one.lacks in ("file", "line")]
    usage = [one for one in results if one.code == 2 and one.run.file != "options" and one.lacks != "whole"]
    kinds = Counter(said for one in wrong for said in one.complaints)
    codes = Counter(one.code for one in results)
    print(f"{mode}: {len(results)} runs, exit codes {dict(sorted(codes.items()))}; {len(wrong)} do not hold: {dict(kinds)}")
    refused = [one for one in refused if one.lacks != "whole"]
    named = 100.0 * (1.0 - len(lacking) / max(len(refused), 1))
    print(f"  {len(refused)} refusals of what a file holds, {named:.2f} % with file and line; without line {sum(one.lacks == 'line' for one in lacking)}, "
          f"without file {sum(one.lacks == 'file' for one in lacking)}; wrong usage {len(usage)}; {len(whole)} of something that is missing, which has no line")
    places: dict[tuple[str, str, str], list[Result]] = {}
    for one in wrong:
        places.setdefault((one.run.file, one.run.key, ", ".join(one.complaints)), []).append(one)
    for of_place in sorted(places.values(), key=len, reverse=True)[: None if options.list else 20]:
        print(f"  {len(of_place)} times: {shown(of_place[0])}")
    without: dict[str, list[Result]] = {}
    for one in lacking + usage:
        without.setdefault(re.sub(r'[-+\d.e]+|"[^"]*"', "N", one.said), []).append(one)
    for of_text in sorted(without.values(), key=len, reverse=True)[: None if options.list else 10]:
        print(f"  {len(of_text)} without {of_text[0].lacks or 'bad input'}: {shown(of_text[0])}")
    return not wrong and named >= 99.5


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("modes", nargs="*", default=["numbers", "broken"])
    parser.add_argument("--of", default="*")
    parser.add_argument("--every", type=int, default=0)
    parser.add_argument("--count", type=int, default=20000 if EVERY else 300)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    program, processes = str(Path(options.program).resolve()), 2
    good = True
    with tempfile.TemporaryDirectory() as scratch:
        folders = [Path(scratch) / str(k) for k in range(processes)]
        for folder in folders:
            folder.mkdir()
            prepare(program, folder)
        samples = {one.name: one.read_bytes().decode() for one in folders[0].iterdir()}
        with concurrent.futures.ThreadPoolExecutor(processes) as workers:
            for mode in options.modes:
                runs = of_numbers(samples, options) if mode == "numbers" else of_broken(samples, options)
                if mode == "numbers" and options.every:
                    runs = [one for k, one in enumerate(runs) if k % (len(VALUES) * options.every) < len(VALUES)]
                elif mode == "numbers" and not EVERY:
                    runs = random.Random(options.seed).sample(runs, min(300, len(runs)))
                results = list(workers.map(lambda one: run(program, samples, folders, one), runs))
                good = report(mode, results, options) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
