"""A million trials of a Monte Carlo: four normal inputs (JCGM 101:2008, 9.2.2), and a gauge block (9.5).

The gauge block's limits are exact ones here, as in the GUM's example H.1: rectangles stand for curvilinear trapezoids.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rows import Row
from suncal import Model

import fmm_friction as fmm

TRIALS = 1_000_000
#: Standard uncertainty and, where it has a closed form, upper end of the 95 % interval.
Truth = tuple[float, float | None]

#: Means, scales and degrees of freedom of the four that were observed (nm).
OBSERVED = {"s": (50_000_623.0, 25.0, 18), "d": (215.0, 6.0, 24), "r": (0.0, 4.0, 5), "f": (0.0, 7.0, 8)}
#: Limits of the rectangular ones: expansion (1/K), difference of expansions (1/K), of temperatures (K).
LIMITS = {"a": (9.5e-6, 13.5e-6), "b": (-1e-6, 1e-6), "c": (-0.05, 0.05)}
MEAN = (-0.1, 0.2)  # temperature, K
CYCLE = 0.5  # its cycle, K
LENGTH = "s + d + r + f - s * (b * (t + w) + a * c)"


def gauge_block_truth() -> Truth:
    """Standard uncertainty (nm) out of the moments of the inputs, which are independent."""
    variance = {name: scale**2 * nu / (nu - 2) for name, (_, scale, nu) in OBSERVED.items()}
    square = {name: (low**2 + low * high + high**2) / 3 for name, (low, high) in LIMITS.items()}
    temperature = MEAN[0] ** 2 + MEAN[1] ** 2 + CYCLE**2 / 2
    standard = OBSERVED["s"][0] ** 2 + variance["s"]
    thermal = standard * (square["b"] * temperature + square["a"] * square["c"])
    return float(np.sqrt(sum(variance.values()) + thermal)), None


def by_numpy(draw: Callable[[np.random.Generator], NDArray[np.float64]]) -> tuple[float, float]:
    """Standard uncertainty, and upper end of the 95 % interval."""
    values = draw(np.random.default_rng())
    values.mean()
    return float(values.std(ddof=1)), float(np.quantile(values, [0.025, 0.975])[1])


def additive_by_numpy(rng: np.random.Generator) -> NDArray[np.float64]:
    """Values of the sum."""
    return sum(rng.standard_normal(TRIALS) for _ in range(4))


def gauge_block_by_numpy(rng: np.random.Generator) -> NDArray[np.float64]:
    """Values of the length (nm)."""
    s, d, r, f = (mean + scale * rng.standard_t(nu, TRIALS) for mean, scale, nu in OBSERVED.values())
    a, b, c = (rng.uniform(low, high, TRIALS) for low, high in LIMITS.values())
    t = rng.normal(*MEAN, TRIALS)
    w = CYCLE * np.sin(2 * np.pi * rng.random(TRIALS))
    return s + d + r + f - s * (b * (t + w) + a * c)


def by_fmm(inputs: list[dict[str, Any]], formula: str) -> tuple[float, float]:
    """Standard uncertainty, and upper end of the 95 % interval, of the trials."""
    measurement = {"input": inputs, "result": [{"name": "y", "unit": inputs[0]["unit"], "formula": formula}]}
    found = fmm.budget(measurement, trials=TRIALS).document["results"][0]["trials"]
    return found["standard_uncertainty"], found["interval"]["high"]


def additive_by_fmm() -> tuple[float, float]:
    """The sum."""
    return by_fmm([{"name": name, "unit": "1", "value": 0.0, "u": 1.0} for name in "pqrs"], "p + q + r + s")


def gauge_block_by_fmm() -> tuple[float, float]:
    """The length."""
    units = {"a": "1/K", "b": "1/K", "c": "K"}
    inputs: list[dict[str, Any]] = [
        {"name": name, "unit": "nm", "value": mean, "u": scale, "degrees_of_freedom": nu}
        for name, (mean, scale, nu) in OBSERVED.items()
    ]
    inputs += [{"name": name, "unit": units[name], "limits": list(limits)} for name, limits in LIMITS.items()]
    inputs.append({"name": "t", "unit": "K", "value": MEAN[0], "u": MEAN[1]})
    inputs.append({"name": "w", "unit": "K", "limits": [-CYCLE, CYCLE], "distribution": "arc sine"})
    return by_fmm(inputs, LENGTH)


def by_suncal(model: Model) -> tuple[float, float]:
    """Standard uncertainty, and upper end of the 95 % interval, of the trials, after a budget by derivatives."""
    found = model.calculate(samples=TRIALS).montecarlo
    return float(found.uncertainty["y"]), float(found.expand("y", conf=0.95).high)


def additive_by_suncal() -> tuple[float, float]:
    """The sum."""
    model = Model("y = p + q + r + s")
    for name in "pqrs":
        model.var(name).measure(0.0).typeb(dist="normal", std=1.0)
    return by_suncal(model)


def gauge_block_by_suncal() -> tuple[float, float]:
    """The length."""
    model = Model(f"y = {LENGTH}")
    for name, (mean, scale, nu) in OBSERVED.items():
        model.var(name).measure(mean).typeb(dist="t", scale=scale, df=nu)
    for name, (low, high) in LIMITS.items():
        model.var(name).measure((low + high) / 2).typeb(dist="uniform", a=(high - low) / 2)
    model.var("t").measure(MEAN[0]).typeb(dist="normal", std=MEAN[1])
    model.var("w").measure(0.0).typeb(dist="arcsine", a=CYCLE)
    return by_suncal(model)


def of(task: str, truth: Truth, tools: list[tuple[str, Callable[[], tuple[float, float]], bool, str]]) -> list[Row]:
    """Rows of a task."""

    def error(found: tuple[float, float]) -> str:
        of_end = "" if truth[1] is None else f", {abs(found[1] / truth[1] - 1):.1e} of the interval's end"
        return f"{abs(found[0] / truth[0] - 1):.1e} of u{of_end}"

    return [Row(task, tool, work, error, gradient, lacks) for tool, work, gradient, lacks in tools]


def rows() -> list[Row]:
    """All tools at both tasks."""
    bare = "no budget, units or statement of how sure the digits are"
    unsure = "does not say how sure its digits are"
    inexact = "limits that are inexact in Rust only"
    numpy = [lambda: by_numpy(additive_by_numpy), lambda: by_numpy(gauge_block_by_numpy)]
    additive = [
        ("`fmm_friction`, with its budget", additive_by_fmm, True, ""),
        ("NumPy, vectorised", numpy[0], False, bare),
        ("suncal, with its budget", additive_by_suncal, True, unsure),
    ]
    gauge_block = [
        ("`fmm_friction`, with its budget", gauge_block_by_fmm, True, inexact),
        ("NumPy, vectorised", numpy[1], False, bare),
        ("suncal, with its budget", gauge_block_by_suncal, True, unsure),
    ]
    return [
        *of("a million trials, four normal inputs", (2.0, 2 * 1.9599639845400545), additive),
        *of("a million trials, gauge block", gauge_block_truth(), gauge_block),
    ]
