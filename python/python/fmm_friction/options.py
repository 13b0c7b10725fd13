"""Keywords of the commands: names of the program's options with underscores, ``from_`` for ``--from``.

``fmm COMMAND --help`` explains each in full; ``None`` and ``False`` are the same as leaving it out.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping
from typing import Any, TypedDict

Path = str | os.PathLike[str]


class RecordOptions(TypedDict, total=False):
    """Which channel of a file, what it measured, and which part of it is used."""

    channel: str | int
    """Name or number (from 0) of the channel with the motion; of files."""
    time: str | int
    """Name or number of the channel with the times; of files."""
    rate: float
    """Sampling rate (Hz), where there are no times."""
    rate_u: float
    """Relative standard uncertainty of the rate."""
    time_unit: str
    """Unit of the times, such as ``ms``."""
    skip: int
    """Lines to pass over at the top of a text."""
    table: int
    """Number of the table in the file, from 1."""
    repair: bool
    """Use a text around its damaged lines."""
    quantity: str
    """``displacement``, ``velocity`` or ``acceleration``."""
    unit: str
    """Unit of the values, such as ``mm/s``, ``rad`` or ``V``."""
    scale: float
    """Factor that turns the values into ``unit``."""
    from_: float
    """Begin of the part that is used (s)."""
    to: float
    """End of the part that is used (s)."""
    mode: int | str
    """The mode that is meant: 1 is the strongest, ``"150Hz"`` the one nearest to that frequency."""


class MachineOptions(TypedDict, total=False):
    """Machine, laws and sensor."""

    law: str | list[str]
    """Laws to compare, such as ``["coulomb", "berger+quadratic"]`` or ``"all"``; without it a search."""
    hold: Mapping[str, float]
    """Parameters to hold at a value, such as ``{"stribeck.exponent": 2}``."""
    time_limit: float
    """Time (s) after which a search begins no further law."""
    pendulum: bool | float
    """The machine is a pendulum; a number is the length (m) of the arc of one radian."""
    mass: float
    """Moving mass (kg)."""
    mass_u: float
    """Standard uncertainty of the mass (kg)."""
    stiffness: float
    """Stiffness (N/m)."""
    stiffness_u: float
    """Standard uncertainty of the stiffness (N/m)."""
    damping: float
    """The machine's own linear damping (N s/m)."""
    damping_u: float
    """Standard uncertainty of the damping (N s/m)."""
    steady: float
    """Relative standard uncertainty of the change of the friction with each half cycle."""
    normal_load: float
    """Normal load on the contact (N)."""
    normal_load_u: float
    """Standard uncertainty of the normal load (N)."""
    scale_u: float
    """Relative standard uncertainty of the scale of the values."""
    low_pass: int | str | tuple[int, float]
    """Order, or order and corner (Hz), of the low-pass filter of the sensor."""
    delay: float
    """Time (s) by which the sensor is late."""


class FreeOptions(RecordOptions, MachineOptions, total=False):
    """Keywords of a free vibration."""


class IdentifyOptions(FreeOptions, total=False):
    """Keywords of :func:`identify` and :func:`compare` beside arrays that drive the machine."""

    mobility: tuple[float, float]
    """Band (Hz) in which lines of the mobility are fitted in place of the motion after an impact."""
    posterior: bool
    """Draw from the posterior of the preferred law; in builds with the feature ``posterior``."""


class ForceOptions(TypedDict, total=False):
    """Keywords of :func:`force` beside its columns."""

    time: str | int
    """Name or number of the column of times; of files."""
    time_unit: str
    """Unit of the times, such as ``ms``."""
    rate: float
    """Sampling rate (Hz), where there are no times."""
    from_: float
    """Begin of the part that is used (s)."""
    to: float
    """End of the part that is used (s)."""
    turn_sign: bool
    """The force was measured as the reaction of the contact."""
    tare: float
    """Reading of the load without a load, in its unit."""
    average: float
    """Time (s) over which the channels are averaged."""
    position_unit: str
    """Unit of the positions, such as ``mm``; m unless given. That of velocities is this one per second."""
    force_unit: str
    """Unit of the forces, such as ``N m``; N unless given."""
    rest_speed: float
    """Speed (m/s) up to which the contact counts as at rest."""
    skip: int
    """Lines to pass over at the top of a text."""
    table: int
    """Number of the table in the file, from 1."""
    repair: bool
    """Use a text around its damaged lines."""
    model: str | list[str]
    """Models to fit, such as ``["coulomb+linear", "dahl"]``."""
    hold: Mapping[str, float]
    """Parameters to hold at a value."""
    longest_delay: float
    """Longest delay (s) between motion and force that is looked for."""
    time_limit: float
    """Time (s) after which the fits are stopped."""


class FrfOptions(TypedDict, total=False):
    """Keywords of :func:`frf` beside its channels."""

    quantity: str
    """``displacement``, ``velocity`` or ``acceleration`` of the response."""
    force_scale: float
    """Factor that turns the force into N."""
    response_scale: float
    """Factor that turns the response into SI units."""
    rate: float
    """Sampling rate (Hz), where there are no times."""
    skip: int
    """Lines to pass over at the top of a text."""
    table: int
    """Number of the table in the file, from 1."""
    repair: bool
    """Use a text around its damaged lines."""
    window: str
    """``none``, ``force``, ``exponential``, ``impact``, ``hann`` or ``symmetric-hann``."""
    exponential_end: float
    """Value of an exponential window at the end of the record (1)."""


def check(function: str, given: Mapping[str, Any], known: type) -> None:
    """Refuses keywords that a function does not have, with the nearest that it has.

    Raises:
        TypeError: a keyword is none of ``known``, a ``TypedDict``.
    """
    names = set(known.__annotations__)
    for base in getattr(known, "__orig_bases__", ()):
        names |= set(getattr(base, "__annotations__", {}))
    for name in given:
        if name not in names:
            near = difflib.get_close_matches(name, names, 1)
            hint = f"; did you mean {near[0]}?" if near else f"; there are {', '.join(sorted(names))}"
            raise TypeError(f"{function}() has no keyword {name}{hint}")
