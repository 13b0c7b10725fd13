"""Time of ``identify`` on 1500 samples over that of the Rust code in it, from the arguments to the document.

python compare/overhead.py
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

import fmm_friction as fmm
from fmm_friction import _core
from fmm_friction._run import Call


def least(*works: Callable[[], object], repeats: int = 40) -> list[float]:
    """Least times of the works, s, which take turns: other programs only ever add."""
    times: list[list[float]] = [[] for _ in works]
    for _ in range(repeats):
        for work, taken in zip(works, times, strict=True):
            begun = time.perf_counter()
            work()
            taken.append(time.perf_counter() - begun)
    return [min(taken) for taken in times]


def main() -> None:
    """Prints the times of both, by one law and by a search, and their ratio."""
    motion = fmm.simulate(
        {
            "oscillator": {"mass": 10.391, "stiffness": 1982},
            "law": {"coulomb": {"mu": 0.25}},
            "normal_load": 14,
            "initial": {"position": 0.016},
            "duration": 1.499,
            "output": {"rate": 1000},
        }
    )
    noise = 1e-4 * np.random.default_rng(1).standard_normal(len(motion.time))
    t, v = motion.time, motion.velocity + noise
    for what, law in (("coulomb_viscous", "coulomb_viscous"), ("a search", None)):

        def python_too(law: str | None = law) -> fmm.Identification:
            return fmm.identify(t, v, unit="m/s", mass=10.391, normal_load=14, law=law)

        call = python_too()._call

        def rust_alone(call: Call = call) -> str:
            return _core.answer(call.arguments, call.files, [], _core.Watch()).document(False)

        rust, python = least(rust_alone, python_too)
        print(
            f"{what:16} {len(t)} samples: Rust {1e3 * rust:.1f} ms, Python {1e3 * python:.1f} ms, {python / rust:.3f}"
        )


if __name__ == "__main__":
    main()
