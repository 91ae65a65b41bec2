"""The command `paracal`: replaces this process with the program that the wheel carries."""

import os
import sys


def main():
    program = os.path.join(os.path.dirname(__file__), "bin", "paracal")
    os.execv(program, [program, *sys.argv[1:]])
