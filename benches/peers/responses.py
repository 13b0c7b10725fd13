"""H1, H2 and coherence of ten blows on a machine of one mode, with noise on the response."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from pyFRF import FRF
from rows import Row
from scipy import signal

import fmm_friction as fmm

RATE, SAMPLES, BLOWS = 2048.0, 16_384, 10  # Hz
MASS, FREQUENCY, RATIO = 10.0, 20.0, 0.02  # kg, Hz, 1
PULSE = 2e-3  # s
NOISE = 1e-3  # over the largest response
HIGHEST = 200.0  # Hz, up to which errors count

Array = NDArray[np.float64]
Lines = NDArray[np.complex128]
#: H1, H2 (m/N) and coherence (1) along the lines.
Found = tuple[Lines, Lines, Array]


def receptance(frequencies: Array) -> Lines:
    """Displacement over force (m/N) at frequencies (Hz)."""
    omega, natural = 2 * np.pi * frequencies, 2 * np.pi * FREQUENCY
    return 1 / (MASS * (natural**2 - omega**2 + 2j * RATIO * natural * omega))


def blows() -> tuple[Array, Array]:
    """Forces (N) and displacements (m), one row a blow; the response has died out at the end of the record."""
    rng = np.random.default_rng(1)
    t = np.arange(SAMPLES) / RATE
    pulse = np.where(t < PULSE, np.sin(np.pi * t / PULSE), 0.0)
    forces = rng.uniform(500, 1500, (BLOWS, 1)) * pulse
    answers = np.fft.irfft(np.fft.rfft(forces) * receptance(np.fft.rfftfreq(SAMPLES, 1 / RATE)), SAMPLES)
    return forces, answers + NOISE * abs(answers).max() * rng.standard_normal(answers.shape)


def by_fmm(forces: Array, answers: Array) -> Found:
    """Of the package."""
    found = fmm.frf(force=forces, response=answers, rate=RATE, quantity="displacement")
    return found.h1, found.h2, found.coherence


def by_pyfrf(forces: Array, answers: Array) -> Found:
    """Of pyFRF."""
    found = FRF(int(RATE), exc=forces, resp=answers, exc_type="f", resp_type="d")
    return found.get_H1()[0, 0], found.get_H2()[0, 0], found.get_coherence()[0]


def by_scipy(forces: Array, answers: Array) -> Found:
    """Of SciPy's ``csd``."""
    options = {"fs": RATE, "window": "boxcar", "nperseg": SAMPLES, "detrend": False}
    across = signal.csd(forces, answers, **options)[1].mean(axis=0)
    force, answer = (signal.welch(one, **options)[1].mean(axis=0) for one in (forces, answers))
    return across / force, answer / across.conj(), abs(across) ** 2 / (force * answer)


def rows() -> list[Row]:
    """All tools at this task."""
    given = blows()
    frequencies = np.fft.rfftfreq(SAMPLES, 1 / RATE)
    counted = (frequencies > 0) & (frequencies <= HIGHEST)
    exact = receptance(frequencies)
    task = f"H1, H2, coherence of {BLOWS} blows of {SAMPLES} samples"

    def error(found: Found) -> str:
        departure = abs(found[0] - exact)[counted] / abs(exact).max()
        return f"{departure.max():.2e} of the peak"

    unsure = "no uncertainty, no check of blows"
    return [
        Row(task, "`fmm_friction`", lambda: by_fmm(*given), error),
        Row(task, "pyFRF", lambda: by_pyfrf(*given), error, lacks=unsure),
        Row(task, "SciPy, `csd` and `welch`", lambda: by_scipy(*given), error, lacks=unsure),
    ]
