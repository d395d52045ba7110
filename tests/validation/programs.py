"""Programs of primitives, a second time (docs/reference/instructions.md): an interpreter that walks the text as a tree
of blocks and computes each instruction in exact arithmetic, rounded once to 32 bits. It shares no line with the
product."""
import ctypes
import math
from fractions import Fraction

INPUTS = ["ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax"]
CLASS = {"mul": "product", "fma": "product", "div": "divide", "sqrt": "divide"}
BRANCHES = {"loop", "if", "else", "end", "break", "stop"}
LATENCY = {"simple": 4, "product": 4, "divide": 16, "branch": 2}
MOST_HITS = 8


def single(x):
    """The float nearest to a double, which of a sum, product, quotient or root of floats is the one rounded once (S.
    Figueroa, When is double rounding innocuous?, SIGNUM Newsletter 30, 1995)."""
    return ctypes.c_float(x).value


def fma(a, b, c):
    if not all(map(math.isfinite, (a, b, c))):
        return single(a * b + c)  # infinities and NaN come from the operands alone
    exact = Fraction(a) * Fraction(b) + Fraction(c)
    if exact == 0:
        return single(a * b + c)  # for its sign
    near = float(exact)  # rounded to odd, then to 32 bits: S. Boldo, G. Melquiond, IEEE Trans. Computers 57 (2008)
    if Fraction(near) != exact:
        if abs(Fraction(near)) > abs(exact):
            near = math.nextafter(near, 0)
        if int(near.hex().split("p")[0].split(".")[1][-1], 16) % 2 == 0:
            near = math.nextafter(near, math.copysign(math.inf, near))
    return single(near)


def divided(a, b):
    if b != 0 or math.isnan(a) or math.isnan(b):
        return single(a / b) if b != 0 else math.nan
    if a == 0:
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1, b)


VALUES = {
    "mov": lambda a: a,
    "add": lambda a, b: single(a + b),
    "sub": lambda a, b: single(a - b),
    "mul": lambda a, b: single(a * b),
    "fma": fma,
    "div": divided,
    "sqrt": lambda a: math.nan if a < 0 or math.isnan(a) else single(math.sqrt(a)),
    "min": lambda a, b: a if a < b else b,
    "max": lambda a, b: a if a > b else b,
    "abs": lambda a: abs(a),
    "neg": lambda a: -a,
    "floor": lambda a: a if not math.isfinite(a) or a == 0 else math.copysign(math.floor(a), a),
    "lt": lambda a, b: 1.0 if a < b else 0.0,
    "le": lambda a, b: 1.0 if a <= b else 0.0,
    "eq": lambda a, b: 1.0 if a == b else 0.0,
    "select": lambda a, b, c: b if a != 0 else c,
}


class Break(Exception):
    pass


class Stop(Exception):
    pass


def tree(lines):
    """The blocks: a list of instructions as (words,), of loops as (words, body), of ifs as (words, then, otherwise)."""
    lines = iter([line.replace(",", " ").split() for line in lines])

    def block():
        out = []
        for words in lines:
            if words[0] in ("end", "else"):
                return out, words[0]
            if words[0] == "loop":
                out.append((words, block()[0]))
            elif words[0] == "if":
                then, closed = block()
                out.append((words, then, block()[0] if closed == "else" else None))
            else:
                out.append((words,))
        return out, None

    return block()[0]


class Run:
    """A ray's test: `hits` as (t, nx, ny, nz), `cycles`, and `count` of instructions by class."""

    def __init__(self, body, parameters, ray, latency=None):
        self.value = dict(zip(INPUTS, map(single, ray)))
        self.parameters = parameters
        self.latency = latency or LATENCY
        self.ready = {}
        self.hits, self.cycles = [], 0
        self.count = dict.fromkeys(LATENCY, 0)
        try:
            self.block(body)
        except Stop:
            pass

    def issue(self, kind, registers, to=None):
        self.count[kind] += 1
        at = max([self.cycles] + [self.ready.get(name, 0) for name in registers + ([to] if to else [])])
        self.cycles = at + (self.latency[kind] if kind == "branch" else 1)
        if to:
            self.ready[to] = at + self.latency[kind]

    def block(self, body):
        for words, *blocks in body:
            name, operands = words[0], words[1:]
            if name == "loop":
                self.issue("branch", [])
                for _ in range(int(operands[0])):
                    try:
                        self.block(blocks[0])
                    except Break:
                        break
                    self.issue("branch", [])
            elif name == "if":
                self.issue("branch", operands)
                if self.value[operands[0]] != 0:
                    self.block(blocks[0])
                    if blocks[1] is not None:
                        self.issue("branch", [])  # over what is behind the else
                elif blocks[1] is not None:
                    self.block(blocks[1])
            elif name in ("break", "stop"):
                self.issue("branch", operands)
                if not operands or self.value[operands[0]] != 0:
                    raise Break if name == "break" else Stop
            elif name == "hit":
                self.issue("simple", operands)
                if len(self.hits) < MOST_HITS:
                    self.hits.append(tuple(self.value[operand] for operand in operands))
            elif name == "load":
                self.issue("simple", [], operands[0])
                text = operands[1]
                self.value[operands[0]] = single(float(self.parameters.get(text, text)))
            else:
                self.issue(CLASS.get(name, "simple"), operands[1:], operands[0])
                self.value[operands[0]] = VALUES[name](*(self.value[operand] for operand in operands[1:]))


def run(lines, parameters, ray, latency=None):
    return Run(tree(lines), parameters, ray, latency)
