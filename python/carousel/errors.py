"""The program's errors as exceptions."""

import re
from dataclasses import dataclass
from typing import Optional


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong, and where it stands. Lines and columns count from 1."""

    message: str
    file: Optional[str] = None
    line: Optional[int] = None
    column: Optional[int] = None

    def __str__(self):
        return ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None) + (
            ": " if self.file else "") + self.message


class CarouselError(Exception):
    """The program ended with an error: `status` is its exit status, `problems` what it said."""

    def __init__(self, status, text):
        self.status = status
        self.text = text
        self.problems = parse_problems(text)
        super().__init__("\n".join(str(p) for p in self.problems) or f"carousel ended with exit status {status}")


class ConfigError(CarouselError):
    """Configuration, scene, option or file is wrong (exit status 2)."""


class RunFailed(CarouselError):
    """A simulation broke, a verification failed, or the run was interrupted."""


def parse_problems(text):
    """The lines `error: file:line:column: message` of the program."""
    problems = []
    for line in text.splitlines():
        line = re.sub(r"\x1b\[[0-9;]*m", "", line)
        if not line.startswith("error: "):
            continue
        line = line[len("error: "):]
        placed = re.match(r"(.+?):(\d+):(\d+): (.*)", line)
        if placed:
            problems.append(Problem(placed[4], placed[1], int(placed[2]), int(placed[3])))
        else:
            problems.append(Problem(line))
    return problems


def error_of(status, text):
    return (ConfigError if status == 2 else RunFailed)(status, text)
