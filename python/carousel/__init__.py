"""Runs the simulator Carousel and reads what it writes.

    import carousel
    report = carousel.run({"scene": {"builtin": "cornell"}}, engine={"kind": "cycle"})
    rows = carousel.sweep("machine.yaml", vary={"topology.resources": [2, 4, 8]})
    carousel.frame(rows)["cycles"]

Pure Python. NumPy and pandas are imported only by the functions that return their types. The program is the one that
the environment variable CAROUSEL names, or `carousel` on the PATH.
"""

from carousel.errors import CarouselError, ConfigError, Problem, RunFailed
from carousel.program import Report, load_report, run, sweep
from carousel.tables import frame, picture, time_series

__all__ = ["CarouselError", "ConfigError", "Problem", "Report", "RunFailed", "frame", "load_report", "picture", "run",
           "sweep", "time_series"]
