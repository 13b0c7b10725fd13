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

    channel: str | int | None
    """Name or number (from 0) of the channel with the motion; of files."""
    time: str | int | None
    """Name or number of the channel with the times; of files."""
    rate: float | None
    """Sampling rate (Hz), where there are no times."""
    rate_u: float | None
    """Relative standard uncertainty of the rate."""
    time_unit: str | None
    """Unit of the times, such as ``ms``."""
    skip: int | None
    """Lines to pass over at the top of a text."""
    table: int | None
    """Number of the table in the file, from 1."""
    repair: bool | None
    """Use a text around its damaged lines."""
    quantity: str | None
    """``displacement``, ``velocity`` or ``acceleration``."""
    unit: str | None
    """Unit of the values, such as ``mm/s``, ``rad`` or ``V``."""
    scale: float | None
    """Factor that turns the values into ``unit``."""
    from_: float | None
    """Begin of the part that is used (s)."""
    to: float | None
    """End of the part that is used (s)."""
    mode: int | str | None
    """The mode that is meant: 1 is the strongest, ``"150Hz"`` the one nearest to that frequency."""


class MachineOptions(TypedDict, total=False):
    """Machine, laws and sensor."""

    law: str | list[str] | None
    """Laws to compare, such as ``["coulomb", "berger+quadratic"]`` or ``"all"``; without it a search."""
    hold: Mapping[str, float] | None
    """Parameters to hold at a value, such as ``{"stribeck.exponent": 2}``."""
    time_limit: float | None
    """Time (s) after which a search begins no further law."""
    pendulum: bool | float | None
    """The machine is a pendulum; a number is the length (m) of the arc of one radian."""
    mass: float | None
    """Moving mass (kg)."""
    mass_u: float | None
    """Standard uncertainty of the mass (kg)."""
    stiffness: float | None
    """Stiffness (N/m)."""
    stiffness_u: float | None
    """Standard uncertainty of the stiffness (N/m)."""
    damping: float | None
    """The machine's own linear damping (N s/m)."""
    damping_u: float | None
    """Standard uncertainty of the damping (N s/m)."""
    steady: float | None
    """Relative standard uncertainty of the change of the friction with each half cycle."""
    normal_load: float | None
    """Normal load on the contact (N)."""
    normal_load_u: float | None
    """Standard uncertainty of the normal load (N)."""
    scale_u: float | None
    """Relative standard uncertainty of the scale of the values."""
    low_pass: int | str | tuple[int, float] | None
    """Order, or order and corner (Hz), of the low-pass filter of the sensor."""
    delay: float | None
    """Time (s) by which the sensor is late."""


class FreeOptions(RecordOptions, MachineOptions, total=False):
    """Keywords of a free vibration."""


class IdentifyOptions(FreeOptions, total=False):
    """Keywords of :func:`identify` and :func:`compare` beside arrays that drive the machine."""

    mobility: tuple[float, float] | None
    """Band (Hz) in which lines of the mobility are fitted in place of the motion after an impact."""
    posterior: bool | None
    """Draw from the posterior of the preferred law; in builds with the feature ``posterior``."""


class ForceOptions(TypedDict, total=False):
    """Keywords of :func:`force` beside its columns."""

    time: str | int | None
    """Name or number of the column of times; of files."""
    time_unit: str | None
    """Unit of the times, such as ``ms``."""
    rate: float | None
    """Sampling rate (Hz), where there are no times."""
    from_: float | None
    """Begin of the part that is used (s)."""
    to: float | None
    """End of the part that is used (s)."""
    turn_sign: bool | None
    """The force was measured as the reaction of the contact."""
    tare: float | None
    """Reading of the load without a load, in its unit."""
    average: float | None
    """Time (s) over which the channels are averaged."""
    position_unit: str | None
    """Unit of the positions, such as ``mm``; m unless given. That of velocities is this one per second."""
    force_unit: str | None
    """Unit of the forces, such as ``N m``; N unless given."""
    rest_speed: float | None
    """Speed (m/s) up to which the contact counts as at rest."""
    skip: int | None
    """Lines to pass over at the top of a text."""
    table: int | None
    """Number of the table in the file, from 1."""
    repair: bool | None
    """Use a text around its damaged lines."""
    model: str | list[str] | None
    """Models to fit, such as ``["coulomb+linear", "dahl"]``."""
    hold: Mapping[str, float] | None
    """Parameters to hold at a value."""
    longest_delay: float | None
    """Longest delay (s) between motion and force that is looked for."""
    time_limit: float | None
    """Time (s) after which the fits are stopped."""


class FrfOptions(TypedDict, total=False):
    """Keywords of :func:`frf` beside its channels."""

    quantity: str | None
    """``displacement``, ``velocity`` or ``acceleration`` of the response."""
    force_scale: float | None
    """Factor that turns the force into N."""
    response_scale: float | None
    """Factor that turns the response into SI units."""
    rate: float | None
    """Sampling rate (Hz), where there are no times."""
    skip: int | None
    """Lines to pass over at the top of a text."""
    table: int | None
    """Number of the table in the file, from 1."""
    repair: bool | None
    """Use a text around its damaged lines."""
    window: str | None
    """``none``, ``force``, ``exponential``, ``impact``, ``hann`` or ``symmetric-hann``."""
    exponential_end: float | None
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
