"""The package ``fmm_friction`` beside what else is used for the same tasks, in one run, as a table of Markdown.

    pip install -r benches/peers/requirements.txt ./python
    python benches/peers/peers.py

The tools take turns, call by call, and each has the median of its calls after a first that is not timed. The times of
``fmm_friction`` are those of calls from Python: they include what the document of its answer costs.
"""

from __future__ import annotations

import argparse
import os
import platform
from importlib.metadata import version

import fits
import responses
import ring_down
import trials
from rows import lines, measured

#: Modules of tasks, and the number of calls of each tool.
TASKS = {"ring_down": (ring_down, 15), "fits": (fits, 5), "trials": (trials, 5), "responses": (responses, 5)}
PACKAGES = "fmm_friction numpy scipy numba scikit-sundae diffrax jax lmfit suncal pyFRF".split()


def processor() -> str:
    """Name of the processor, where the system tells it."""
    try:
        with open("/proc/cpuinfo") as file:
            return next(line.split(":")[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()


def main() -> None:
    """Prints the table of the tasks that are named, or of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tasks", nargs="*", help=", ".join(TASKS))
    asked = parser.parse_args().tasks or list(TASKS)
    rows = [line for task in asked for line in lines(measured(TASKS[task][0].rows(), TASKS[task][1]))]
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    print(f"{processor()}, {os.cpu_count()} processors{load}; Python {platform.python_version()}, ", end="")
    print(", ".join(f"{package} {version(package)}" for package in PACKAGES) + "\n")
    print("| task | tool | time | error | gradient | what it does not do |\n|---|---|---|---|---|---|")
    print("\n".join(rows))


if __name__ == "__main__":
    main()
