#!/usr/bin/python3
"""Checks the intervals of batches and compares them with exact machines alone: the table of docs/scale.md.

    batch_intervals.py PROGRAM [ROBOT ...]    about 3 minutes per robot on two cores

Compares five batches of 100,000 machines with 20,000 exact ones of another seed. It counts the intervals that overlap, have
no upper end or no width. For each percentile it prints by what factor a count of exact machines alone would need more of
them for the same interval.
"""

import json
import math
import statistics
import subprocess
import sys

PERCENTILES = ("p50", "p90", "p95", "p99", "p99_73", "p99_9")
BATCHES = [["--machines", "100000", "--seed", str(seed)] for seed in range(1, 6)]
EXACT_MACHINES = 20000
EXACT = ["--machines", str(EXACT_MACHINES), "--seed", "99", "--exact"]


def batch(program, robot, options):
    command = [program, "yield", "--robot", robot, "--json", *options]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def intervals(result):
    """(quantity, when, percentile) -> low, high."""
    for quantity, both in result["quantities"].items():
        for when, spread in (both or {}).items():
            for percentile in PERCENTILES:
                low, high = spread["intervals"][percentile]
                yield (quantity, when, percentile), (low, math.inf if high is None else high)


def compare(program, robot):
    exact = dict(intervals(batch(program, robot, EXACT)))
    seen = {"overlap": 0, "without an upper end": 0, "without a width": 0, "in all": 0}
    gains = {}
    for options in BATCHES:
        result = batch(program, robot, options)
        for key, (low, high) in intervals(result):
            exact_low, exact_high = exact[key]
            seen["in all"] += 1
            seen["overlap"] += low <= exact_high and exact_low <= high
            seen["without an upper end"] += math.isinf(high)
            seen["without a width"] += low >= high
            gains.setdefault(key, []).append(EXACT_MACHINES * ((exact_high - exact_low) / (high - low)) ** 2 / result["produced"])
    print(f"{robot}: intervals " + ", ".join(f"{count} {what}" for what, count in seen.items()))
    for quantity, when in dict.fromkeys(key[:2] for key in gains):
        print(f"| {quantity} {when} | " + " | ".join(f"{statistics.median(gains[quantity, when, one]):.1f}" for one in PERCENTILES) + " |")


for name in sys.argv[2:] or ["huang2016", "rotary_delta", "linear_delta"]:
    compare(sys.argv[1], name)
