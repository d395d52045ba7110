"""Machines of a map beside one another, paired by seed."""
import math
import statistics


class Ratio:
    """Of a value of two machines over the same seeds: the geometric mean, and the ends of the 95 % interval of Student's t of
    its logarithm (4 degrees of freedom with five seeds)."""

    T = {2: 12.71, 3: 4.30, 4: 3.18, 5: 2.78}

    def __init__(self, above, below):
        logs = [math.log(a / b) for a, b in zip(above, below, strict=True)]
        self.mean = self.low = self.high = math.exp(statistics.mean(logs))
        if len(logs) == 1:
            return
        half = self.T[len(logs)] * statistics.stdev(logs) / math.sqrt(len(logs))
        self.low, self.high = self.mean * math.exp(-half), self.mean * math.exp(half)

    def __str__(self):
        return f"{self.mean:.2f}" + (f" ({self.low:.2f} to {self.high:.2f})" if self.low < self.high else "")


def fastest(kinds, values):
    return max(kinds, key=lambda kind: statistics.mean(values[kind]))
