"""The thesis' ring-down, m x'' + c x' + k x + F sgn x' = 0 with rest where |k x| <= F, by whatever integrates it."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import NamedTuple

os.environ.setdefault("JAX_ENABLE_X64", "1")

import diffrax
import jax
import jax.numpy as jnp
import mpmath
import numba
import numpy as np
import optimistix
from numpy.typing import NDArray
from rows import Row
from scipy.integrate import solve_ivp
from sksundae.cvode import CVODE

import fmm_friction as fmm

Array = NDArray[np.float64]
#: One half swing: from a position (m), a velocity (m/s) and a direction of sliding, at times (s) from its start, to its
#: duration (s; None if the record ends first), the position at its end (m), and the velocities at the times (m/s).
Swing = Callable[[float, float, float, Array, float], tuple[float | None, float, Array]]


# As in src/lib.rs, without what falls or rises with the speed.
MASS, STIFFNESS, DAMPING, LOAD, MU = 10.391, 1982.0, 0.2005, 14.0, 0.228  # kg, N/m, N s/m, N, 1
RELEASE = 0.016  # m
INTERVAL, SAMPLES = 1e-3, 1751  # s
TIMES = np.arange(SAMPLES) * INTERVAL


class Motion(NamedTuple):
    """A machine per unit of mass, and how it starts."""

    friction: float = MU * LOAD / MASS
    """m/s²"""
    damping: float = DAMPING / MASS
    """1/s"""
    stiffness: float = STIFFNESS / MASS
    """1/s²"""
    position: float = RELEASE
    """m"""
    velocity: float = 0.0
    """m/s"""


#: The motion whose truth is known.
TRUE = Motion()


def truth() -> Array:
    """Velocities (m/s) at ``TIMES`` by the closed form of each half swing, in numbers of 256 bits."""
    with mpmath.workprec(256):
        m, k, c, mu, load, x, step = (
            mpmath.mpf(str(one)) for one in (MASS, STIFFNESS, DAMPING, MU, LOAD, RELEASE, INTERVAL)
        )
        rest, decay = mu * load / k, c / (2 * m)
        omega = mpmath.sqrt(k / m - decay**2)
        begun, half, velocities = mpmath.mpf(0), mpmath.pi / omega, []
        for index in range(SAMPLES):
            now = index * step
            while abs(x) > rest and now > begun + half:
                middle = rest * mpmath.sign(x)
                x, begun = middle - (x - middle) * mpmath.exp(-decay * half), begun + half
            if abs(x) <= rest:
                velocities.append(0.0)
                continue
            middle, since = rest * mpmath.sign(x), now - begun
            v = -(x - middle) * (k / m) / omega * mpmath.exp(-decay * since) * mpmath.sin(omega * since)
            velocities.append(float(v))
    return np.array(velocities)


def by_swings(swing: Swing, motion: Motion) -> Array:
    """Velocities (m/s) at ``TIMES``, half swing by half swing until the spring is weaker than the friction."""
    found = np.zeros(SAMPLES)
    begun, x, v = 0.0, motion.position, motion.velocity
    while v != 0.0 or abs(motion.stiffness * x) > motion.friction:
        inside = np.flatnonzero(TIMES >= begun)
        direction = float(np.sign(v) or -np.sign(x))
        duration, x, velocities = swing(x, v, direction, TIMES[inside] - begun, TIMES[-1] - begun)
        found[inside[: len(velocities)]] = velocities
        if duration is None:
            break
        begun, v = begun + duration, 0.0
    return found


def by_scipy(method: str, rtol: float, motion: Motion = TRUE) -> Array:
    """SciPy's ``solve_ivp``, whose event is the reversal."""
    friction, damping, stiffness = motion[:3]

    def swing(x: float, v: float, direction: float, times: Array, left: float) -> tuple[float | None, float, Array]:
        def slide(_: float, y: Array) -> list[float]:
            return [y[1], -stiffness * y[0] - damping * y[1] - friction * direction]

        def turn(_: float, y: Array) -> float:
            return direction * y[1]

        turn.terminal, turn.direction = True, -1
        found = solve_ivp(
            slide, (0.0, left), [x, v], method=method, t_eval=times, events=turn, rtol=rtol, atol=rtol * 1e-3
        )
        if not len(found.t_events[0]):
            return None, x, found.y[1]
        return found.t_events[0][0], found.y_events[0][0][0], found.y[1]

    return by_swings(swing, motion)


def by_sundials(rtol: float, motion: Motion = TRUE) -> Array:
    """SUNDIALS' CVODE with its root finder, by scikit-sundae."""
    friction, damping, stiffness = motion[:3]

    def swing(x: float, v: float, direction: float, times: Array, left: float) -> tuple[float | None, float, Array]:
        def slide(_: float, y: Array, rate: Array) -> None:
            rate[0] = y[1]
            rate[1] = -stiffness * y[0] - damping * y[1] - friction * direction

        def turn(_: float, y: Array, events: Array) -> None:
            events[0] = direction * y[1]

        turn.terminal, turn.direction = [True], [-1]
        solver = CVODE(slide, method="Adams", rtol=rtol, atol=rtol * 1e-3, eventsfn=turn, num_events=1)
        # The first of its times is the start.
        before = [] if times[0] == 0.0 else [0.0]
        found = solver.solve(np.concatenate((before, times)), np.array([x, v]))
        velocities = found.y[len(before) :, 1]
        if found.t_events is None:
            return None, x, velocities
        # The event is the last of the samples.
        return float(found.t_events[0]), float(found.y_events[0][0]), velocities[:-1]

    return by_swings(swing, motion)


@jax.jit
def _swing_of_jax(
    x: jax.Array, v: jax.Array, direction: jax.Array, times: jax.Array, rtol: jax.Array, motion: Motion
) -> tuple[jax.Array, ...]:
    def slide(_: jax.Array, y: jax.Array, __: None) -> jax.Array:
        return jnp.array([y[1], -motion.stiffness * y[0] - motion.damping * y[1] - motion.friction * direction])

    def turn(t: jax.Array, y: jax.Array, args: None, **_: object) -> jax.Array:
        return direction * y[1]

    found = diffrax.diffeqsolve(
        diffrax.ODETerm(slide),
        diffrax.Dopri8(),
        0.0,
        TIMES[-1],
        None,
        jnp.array([x, v]),
        saveat=diffrax.SaveAt(t1=True, dense=True),
        stepsize_controller=diffrax.PIDController(rtol=rtol, atol=rtol * 1e-3),
        event=diffrax.Event(turn, optimistix.Newton(1e-12, 1e-12), direction=False),
    )
    end = found.ts[-1]
    inside = (times >= 0.0) & (times <= end)
    velocities = jax.vmap(lambda t: found.evaluate(t)[1])(jnp.clip(times, 0.0, end))
    return end, found.ys[-1, 0], jnp.where(inside, velocities, 0.0)


def by_diffrax(rtol: float, motion: Motion = TRUE) -> Array:
    """Diffrax' method of order 8 with an event, compiled once for all half swings."""

    # Arrays of one length, so that it is compiled once.
    def swing(x: float, v: float, direction: float, times: Array, left: float) -> tuple[float | None, float, Array]:
        padded = np.concatenate((times, np.full(SAMPLES - len(times), -1.0)))
        end, at_end, velocities = _swing_of_jax(x, v, direction, padded, rtol, motion)
        return (None if end > left else float(end)), float(at_end), np.asarray(velocities)[: len(times)]

    return by_swings(swing, motion)


@numba.njit
def by_euler(every: int, motion: Motion = TRUE) -> Array:
    """The loop of the thesis' appendix A3, ``every`` steps a sample, compiled by Numba."""
    step, hold = INTERVAL / every, motion.friction / motion.stiffness
    found = np.empty(SAMPLES)
    x, v, before = motion.position, motion.velocity, 1.0
    for index in range(SAMPLES * every):
        if index % every == 0:
            found[index // every] = v
        sliding = v * before > 0.0
        before = v
        if not sliding and -hold < x < hold:
            v = 0.0
            continue
        sign = np.sign(v) if sliding else -np.sign(x)
        v += (-motion.stiffness * x - motion.damping * v - sign * motion.friction) * step
        x += v * step
    return found


SCENARIO = {
    "oscillator": {"mass": MASS, "stiffness": STIFFNESS, "damping": {"linear": DAMPING}},
    "law": {"coulomb": {"mu": MU}},
    "normal_load": LOAD,
    "initial": {"position": RELEASE},
    "duration": TIMES[-1],
    "output": {"rate": 1 / INTERVAL},
}


def rows() -> list[Row]:
    """All tools at this task."""
    exact = truth()
    task = f"ring-down, {SAMPLES} samples"

    def error(found: Array) -> str:
        return f"{np.max(np.abs(found - exact)):.1e} m/s"

    by_hand = "rest and restart are the caller's"
    table = [
        Row(
            task,
            "`fmm_friction`, closed form",
            lambda: fmm.simulate(SCENARIO).velocity,
            error,
            lacks="derivatives in Rust only; the time is that of a document with all channels and energies",
        )
    ]
    for rtol in (1e-6, 1e-10):
        at = f"rtol {rtol:.0e}".replace("e-0", "e-")
        for method in ("RK45", "DOP853", "LSODA"):
            table.append(
                Row(task, f"SciPy {method}, {at}", lambda m=method, r=rtol: by_scipy(m, r), error, lacks=by_hand)
            )
        table.append(Row(task, f"SUNDIALS CVODE Adams, {at}", lambda r=rtol: by_sundials(r), error, lacks=by_hand))
        table.append(
            Row(
                task,
                f"diffrax Dopri8, {at}",
                lambda r=rtol: by_diffrax(r),
                error,
                gradient=True,
                lacks=f"{by_hand}, and a gradient needs them traced",
            )
        )
    for every in (1, 10, 100):
        name = f"Numba, the thesis' loop at {INTERVAL / every:.0e} s".replace("e-0", "e-")
        table.append(Row(task, name, lambda n=every: by_euler(n), error, lacks="order 1; jumps with its parameters"))
    return table
