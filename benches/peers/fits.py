"""The fit of one noisy ring-down by friction, damping, stiffness, initial state and an offset of the sensor."""

from __future__ import annotations

from collections.abc import Callable

import lmfit
import numpy as np
from ring_down import LOAD, MASS, MU, TIMES, Array, Motion, by_euler, by_scipy, truth
from rows import Row

import fmm_friction as fmm

NOISE = 1e-4  # m/s


def by_lmfit(model: Callable[[Motion], Array], measured: Array, method: str) -> tuple[float, float | None]:
    """Coefficient of friction, and its standard uncertainty if it is told."""
    # Start values by eye: the frequency from zero crossings, the amplitude from the largest velocity.
    crossings = TIMES[:-1][np.diff(np.sign(measured[:900])).nonzero()]
    omega = np.pi / np.median(np.diff(crossings[1:5]))
    parameters = lmfit.Parameters()
    parameters.add("friction", 0.2, min=0)
    parameters.add("damping", 0.05, min=0)
    parameters.add("stiffness", omega**2, min=0)
    parameters.add("position", abs(measured).max() / omega * 1.1)
    parameters.add("velocity", measured[0])
    parameters.add("offset", 0.0)

    def residuals(at: lmfit.Parameters) -> Array:
        *motion, offset = at.valuesdict().values()
        return model(Motion(*motion)) + offset - measured

    found = lmfit.minimize(residuals, parameters, method=method).params["friction"]
    return found.value * MASS / LOAD, found.stderr and found.stderr * MASS / LOAD


def by_fmm(measured: Array) -> tuple[float, float]:
    """Coefficient of friction and its standard uncertainty."""
    found = fmm.identify(TIMES, measured, unit="m/s", law="coulomb_viscous", mass=MASS, normal_load=LOAD)
    return found.findings["mu"].value, found.findings["mu"].u


def rows() -> list[Row]:
    """All tools at this task."""
    measured = truth() + NOISE * np.random.default_rng(1).standard_normal(len(TIMES))
    task = "fit of that ring-down, 6 parameters"
    lacks = "model and start values are the caller's; residuals count as independent"

    def error(found: tuple[float, float | None]) -> str:
        return f"{abs(found[0] - MU):.1e} in μ, " + ("no u" if found[1] is None else f"u = {found[1]:.1e}")

    return [
        Row(task, "`fmm_friction`", lambda: by_fmm(measured), error, gradient=True),
        Row(
            task,
            "lmfit on SciPy DOP853, rtol 1e-8",
            lambda: by_lmfit(lambda motion: by_scipy("DOP853", 1e-8, motion), measured, "leastsq"),
            error,
            lacks=lacks,
        ),
        Row(
            task,
            "lmfit, Nelder-Mead, on Numba's loop at 1e-4 s",
            lambda: by_lmfit(lambda motion: by_euler(10, motion), measured, "nelder"),
            error,
            lacks=f"{lacks}; the model's first order",
        ),
    ]
