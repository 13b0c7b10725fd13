"""The same ring-down by this package and by SciPy: lines, time, answer, and what the latter does not say.

    python compare/scipy_fit.py [RECORD.csv]

The model of both is m x'' + c x' + k x + F sgn(x') = 0 with six unknowns: friction, damping and stiffness per mass,
initial position and velocity, and an offset of the sensor. SciPy integrates each half swing by ``solve_ivp``, whose
event is the reversal at which the mass sticks or turns, and minimises by ``least_squares``.
"""

from __future__ import annotations

import inspect
import sys
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

import fmm_friction as fmm

Array = NDArray[np.float64]

RECORD = Path(__file__).resolve().parents[2] / "examples/data/flexure/run_1.csv"
MASS, LOAD = 10.391, 14.0  # kg, N


def velocity(parameters: Array, t: Array) -> Array:
    """Velocity at the times by friction, damping and stiffness per mass, initial state and offset."""
    friction, damping, stiffness, x, v, offset = parameters
    found = np.zeros_like(t)
    now, end = t[0], t[-1]
    while now < end:
        # At rest it stays where the spring is weaker than the friction.
        if v == 0.0 and abs(stiffness * x) <= friction:
            break
        direction = np.sign(v) if v != 0.0 else -np.sign(x)

        def slide(_: float, y: Array, direction: float = direction) -> list[float]:
            return [y[1], -stiffness * y[0] - damping * y[1] - friction * direction]

        def turn(_: float, y: Array, direction: float = direction) -> float:
            return float(direction * y[1])

        turn.terminal, turn.direction = True, -1  # type: ignore[attr-defined]
        inside = (t >= now) & (t <= end)
        swing = solve_ivp(slide, (now, end), [x, v], t_eval=t[inside], events=turn, rtol=1e-9, atol=1e-12)
        found[inside.nonzero()[0][: len(swing.t)]] = swing.y[1]
        if not len(swing.t_events[0]):
            break
        now, x, v = swing.t_events[0][0], swing.y_events[0][0][0], 0.0
    shifted: Array = found + offset
    return shifted


def by_scipy(t: Array, v: Array) -> tuple[float, float]:
    """Coefficient of friction and its standard uncertainty."""
    # Start values by eye: the frequency from zero crossings, the amplitude from the largest velocity.
    crossings = t[:-1][np.diff(np.sign(v)) != 0]
    omega = np.pi / np.median(np.diff(crossings[:6]))
    start = np.array([0.3, 0.05, omega**2, abs(v).max() / omega * 1.1, v[0], 0.0])
    scale = np.array([0.1, 0.1, omega**2, 0.01, 0.01, 1e-4])
    fit = least_squares(lambda p: velocity(p, t) - v, start, x_scale=scale, xtol=1e-10, ftol=1e-10)
    variance = 2 * fit.cost / (len(t) - len(start)) * np.linalg.inv(fit.jac.T @ fit.jac)
    return float(fit.x[0]) * MASS / LOAD, float(np.sqrt(variance[0, 0])) * MASS / LOAD


def by_fmm(t: Array, v: Array) -> fmm.Identification:
    """Result of this package by the same law."""
    return fmm.identify(t, v, unit="m/s", law="coulomb_viscous", mass=MASS, normal_load=LOAD)


def main() -> None:
    """Prints both answers."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else RECORD
    t, v = np.loadtxt(path, delimiter=",", skiprows=1).T
    begun = time.perf_counter()
    mu, u = by_scipy(t, v)
    middle = time.perf_counter()
    found = by_fmm(t, v)
    end = time.perf_counter()
    lines = [sum(len(inspect.getsourcelines(part)[0]) for part in parts) for parts in ((velocity, by_scipy), (by_fmm,))]
    finding = found.findings["mu"]
    rms, correlation = found.model["rms_residual"], found.model["autocorrelation_time"]
    print(f"SciPy         {lines[0]:3} lines  {middle - begun:7.2f} s  mu = {mu:.5f}, u = {u:.5f}")
    print(f"fmm_friction  {lines[1]:3} lines  {end - middle:7.2f} s  mu = {finding.value:.5f}, u = {finding.u:.5f}")
    print(f"rms residual {rms:.3e} m/s, correlated over {correlation:.1f} samples, which SciPy takes as independent")
    print("what SciPy does not say:")
    said = [
        f"95 % interval with degrees of freedom: {finding.interval_95}",
        f"other laws: {fmm.compare(t, v, unit='m/s').summary}",
        *found.warnings,
    ]
    print("\n".join(f"  - {sentence}" for sentence in said))


if __name__ == "__main__":
    main()
