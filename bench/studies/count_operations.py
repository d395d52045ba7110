#!/usr/bin/env python3
"""Counts the arithmetic of our own shading code by kind of ray, for the built-in shader programs
(core/program/built_in_shaders.cpp).

    count_operations.py CAROUSEL [ROW...]

The functions of PathTracer run an instruction at a time under ptrace, and objdump says what each instruction does.
Counted are operations on floating point numbers, and products of integers (random numbers). Sums of integers are left
out, since most are addresses. Sine, power and such are functions of our own and counted as they run.

What follows from lights and from a bounce ray is told apart by runs without them: with one surface a path there are no
bounce rays, and with the sky as the only light no shadow rays. An any-hit call does without its lookup, which is a
texture instruction.
"""
import collections
import ctypes
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SIMPLE = re.compile(r"v?(add|sub|min|max|ucomi|comi|cmp\w*|cvt\w*|and|andn|or|xor|round)(ss|sd|ps|pd|si)?\w*$")
KEPT = re.compile(r"(ss|sd|ps|pd)$|^v?cvt")


def class_of(mnemonic):
    if re.match(r"v?(div|sqrt)[sp][sd]$", mnemonic):
        return "divide"
    if re.match(r"v?mul[sp][sd]$|(i?mul)[lqw]?$|mulx", mnemonic):
        return "product"
    if SIMPLE.match(mnemonic) and KEPT.search(mnemonic):
        return "simple"
    return None


def classes(carousel):
    """By address."""
    text = subprocess.run(["objdump", "-d", "--no-show-raw-insn", carousel], capture_output=True, text=True,
                          check=True).stdout
    out = {}
    for address, mnemonic, operands in re.findall(r"^\s*([0-9a-f]+):\t(\S+) *(.*)$", text, re.M):
        kind = class_of(mnemonic)
        registers = operands.split(",")
        if kind == "simple" and "xor" in mnemonic and len(set(registers)) == 1:
            kind = None  # sets a register to 0
        if kind:
            out[int(address, 16)] = kind
    return out


LIBC = ctypes.CDLL(None, use_errno=True)
LIBC.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
LIBC.ptrace.restype = ctypes.c_long
TRACEME, PEEK, POKE, CONT, STEP, GETREGS, SETREGS, OPTIONS = 0, 1, 4, 7, 9, 12, 13, 0x4200
PASSED = 3  # calls at first, which fill tables that later ones look up
RIP, RSP = 16, 19  # in user_regs_struct
WALL, TRACE_CLONE = 0x40000000, 8


class Stepper:
    """Runs a program, and within some of its functions an instruction at a time (x86-64, Linux)."""

    def __init__(self, arguments, folder, entries):
        self.pid = os.fork()
        if self.pid == 0:
            os.chdir(folder)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            LIBC.ptrace(TRACEME, 0, None, None)
            os.execv(arguments[0], arguments)
        os.waitpid(self.pid, 0)
        LIBC.ptrace(OPTIONS, self.pid, None, TRACE_CLONE)
        maps = Path(f"/proc/{self.pid}/maps").read_text().splitlines()
        self.base = int(next(line for line in maps if line.endswith(arguments[0])).split("-")[0], 16)
        self.first = {self.base + entry: None for entry in entries}  # by address: the word that stood there
        for at in self.first:
            self.first[at] = LIBC.ptrace(PEEK, self.pid, at, None)
            self.arm(self.pid, at)

    def arm(self, thread, at):
        LIBC.ptrace(POKE, thread, at, (self.first[at] & ~0xff) | 0xcc)

    def run(self, note):
        """Calls note(address) for each instruction of the functions and of what they call; returns their calls."""
        registers = (ctypes.c_ulonglong * 27)()
        calls = passed = 0
        LIBC.ptrace(CONT, self.pid, None, None)
        while True:
            thread, status = os.waitpid(-1, WALL)
            if os.WIFEXITED(status) or os.WIFSIGNALED(status):
                if thread == self.pid:
                    return calls
                continue
            signal = os.WSTOPSIG(status)
            LIBC.ptrace(GETREGS, thread, None, registers)
            at = registers[RIP] - 1
            if signal == 5 and at in self.first:
                passed += 1
                calls += passed > PASSED
                self.step_through(thread, at, registers, note if passed > PASSED else None)
                signal = 0
            elif signal in (5, 19):  # a thread was made, or begins
                signal = 0
            LIBC.ptrace(CONT, thread, None, signal)

    def step_through(self, thread, at, registers, note):
        for entry, word in self.first.items():
            LIBC.ptrace(POKE, thread, entry, word)
        registers[RIP] = at
        LIBC.ptrace(SETREGS, thread, None, registers)
        top = registers[RSP]
        while registers[RSP] <= top:
            if note:
                note(registers[RIP] - self.base)
            LIBC.ptrace(STEP, thread, None, None)
            os.waitpid(thread, WALL)
            if note is None:
                break
            LIBC.ptrace(GETREGS, thread, None, registers)
        for entry in self.first:
            self.arm(thread, entry)


def entries_of(carousel, function):
    text = subprocess.run(["nm", "-C", carousel], capture_output=True, text=True, check=True).stdout
    return [int(line.split()[0], 16) for line in text.splitlines() if re.search(r"\b" + function + r"\b", line)
            and line.split()[1] in "TtWw" and "(*" not in line and "::*" not in line]


def run(carousel, config, function, of):
    """Operations by class within the function, in all; its calls, and the report."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "own.json").write_text(json.dumps(config))
        counts = collections.Counter()

        def note(address):
            if address in of:
                counts[of[address]] += 1

        calls = Stepper([carousel, "run", "own.json", "--out", "out", "--quiet", "--no-html"], folder,
                        entries_of(carousel, function)).run(note)
        return counts, calls, json.loads((Path(folder) / "out/report.json").read_text())


def main():
    carousel = str(Path(sys.argv[1]).resolve())
    of = classes(carousel)
    base = {"scene": {"builtin": "spheres", "triangles": 2000}, "engine": {"kind": "native", "threads": 1},
            "topology": {"resources": 1}, "verify": "none",
            "image": {"width": 4, "height": 3, "samples": 1, "max_depth": 4, "seed": 1}}
    once = dict(base, image=dict(base["image"], max_depth=1))
    dark = dict(base, shading={"effects": ["reflection", "mirror", "sky", "bounce_rays"]})
    leaves = dict(base, scene={"builtin": "foliage", "triangles": 600})
    for name, config, function, rays in (
            ("miss", base, "shade_miss", None), ("shadow", base, "shade_shadow", None),
            ("camera", base, "generate", lambda rays: rays["by_kind"]["camera"]),
            ("surface", base, "shade_surface", None), ("light alone", once, "shade_surface", None),
            ("bounce alone", dark, "shade_surface", None),
            ("any hit", leaves, "AlphaTest::accepts", None), ("its lookup", leaves, "shading::lookup_alpha", None)):
        if sys.argv[2:] and name not in sys.argv[2:]:
            continue
        name_of = function if "::" in function else "PathTracer::" + function
        counts, calls, report = run(carousel, config, name_of, of)
        number = rays(report["rays"]) if rays else calls
        print(f"{name:14}", *(f"{kind} {counts[kind] / number:7.1f} " for kind in ("simple", "product", "divide")),
              f" {number} rays", {key: sum(one[key] for one in report["rays"]["by_bounce"])
                                  for key in ("hit", "escaped", "went_on", "shadow")})


if __name__ == "__main__":
    main()
