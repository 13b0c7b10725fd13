"""Keywords of the commands: names of the program's options with underscores, ``from_`` for ``--from``.

``fmm COMMAND --help`` explains each in full; ``None`` and ``False`` are the same as leaving it out.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Mapping, Sequence
from typing import Any, TypedDict

from .law import Laws

Path = str | os.PathLike[str]


class RecordOptions(TypedDict, total=False):
    """Which channel of a file, what it measured, and which part of it is used.

    Keys:
        channel: name or number (from 0) of the channel with the motion; of files.
        time: name or number of the channel with the times; of files.
        rate: sampling rate (Hz), where there are no times.
        rate_u: relative standard uncertainty of the rate.
        time_unit: unit of the times, such as ``ms``.
        skip: lines to pass over at the top of a text.
        table: number of the table in the file, from 1.
        repair: use a text around its damaged lines.
        quantity: ``displacement``, ``velocity`` or ``acceleration``.
        unit: unit of the values, such as ``mm/s``, ``rad`` or ``V``.
        scale: factor that turns the values into ``unit``.
        from_: begin of the part that is used (s).
        to: end of the part that is used (s).
        mode: The mode that is meant: 1 is the strongest, ``"150Hz"`` the one nearest to that frequency.
    """

    channel: str | int | None
    time: str | int | None
    rate: float | None
    rate_u: float | None
    time_unit: str | None
    skip: int | None
    table: int | None
    repair: bool | None
    quantity: str | None
    unit: str | None
    scale: float | None
    from_: float | None
    to: float | None
    mode: int | str | None


class MachineOptions(TypedDict, total=False):
    """Machine, laws and sensor.

    Keys:
        law: laws to compare, such as ``["coulomb", "berger+quadratic"]`` or ``"all"``, or a
            :class:`~fmm_friction.Law` of one's own; without it a search.
        hold: parameters to hold at a value, such as ``{"stribeck.exponent": 2}``.
        time_limit: time (s) after which a search begins no further law.
        pendulum: The machine is a pendulum; a number is the length (m) of the arc of one radian.
        run_down: The machine has no spring: a coast-down or a spin-down.
        mass: moving mass (kg), or moment of inertia (kg m²) for angles.
        mass_u: standard uncertainty of the mass (kg).
        stiffness: stiffness (N/m).
        stiffness_u: standard uncertainty of the stiffness (N/m).
        damping: The machine's own linear damping (N s/m).
        damping_u: standard uncertainty of the damping (N s/m).
        steady: relative standard uncertainty of the change of the friction with each half cycle.
        normal_load: normal load on the contact (N).
        normal_load_u: standard uncertainty of the normal load (N).
        scale_u: relative standard uncertainty of the scale of the values.
        low_pass: order, or order and corner (Hz), of the low-pass filter of the sensor.
        delay: time (s) by which the sensor is late.
    """

    law: Laws | None
    hold: Mapping[str, float] | None
    time_limit: float | None
    pendulum: bool | float | None
    run_down: bool | None
    mass: float | None
    mass_u: float | None
    stiffness: float | None
    stiffness_u: float | None
    damping: float | None
    damping_u: float | None
    steady: float | None
    normal_load: float | None
    normal_load_u: float | None
    scale_u: float | None
    low_pass: int | str | tuple[int, float] | None
    delay: float | None


class FreeOptions(RecordOptions, MachineOptions, total=False):
    """Keywords of a free vibration."""


class IdentifyOptions(FreeOptions, total=False):
    """Keywords of :func:`identify` and :func:`compare` beside arrays that drive the machine.

    Keys:
        normal_loads: normal load (N) in each of several records, in their order.
        mobility: band (Hz) in which lines of the mobility are fitted in place of the motion after an impact.
        posterior: draw from the posterior of the preferred law; in builds with the feature ``posterior``.
    """

    normal_loads: Sequence[float] | None
    mobility: tuple[float, float] | None
    posterior: bool | None


class ForceOptions(TypedDict, total=False):
    """Keywords of :func:`force` beside its columns.

    Keys:
        time: name or number of the column of times; of files.
        time_unit: unit of the times, such as ``ms``.
        rate: sampling rate (Hz), where there are no times.
        from_: begin of the part that is used (s).
        to: end of the part that is used (s).
        turn_sign: The force was measured as the reaction of the contact.
        tare: reading of the load without a load, in its unit.
        average: time (s) over which the channels are averaged.
        position_unit: unit of the positions, such as ``mm``; m unless given. That of velocities is this one per second.
        force_unit: unit of the forces, such as ``N m``; N unless given.
        rest_speed: speed (m/s) up to which the contact counts as at rest.
        skip: lines to pass over at the top of a text.
        table: number of the table in the file, from 1.
        repair: use a text around its damaged lines.
        model: models to fit, such as ``["coulomb+linear", "dahl"]``, or a :class:`~fmm_friction.Law` of one's own.
        hold: parameters to hold at a value.
        longest_delay: longest delay (s) between motion and force that is looked for.
        time_limit: time (s) after which the fits are stopped.
    """

    time: str | int | None
    time_unit: str | None
    rate: float | None
    from_: float | None
    to: float | None
    turn_sign: bool | None
    tare: float | None
    average: float | None
    position_unit: str | None
    force_unit: str | None
    rest_speed: float | None
    skip: int | None
    table: int | None
    repair: bool | None
    model: Laws | None
    hold: Mapping[str, float] | None
    longest_delay: float | None
    time_limit: float | None


class FrfOptions(TypedDict, total=False):
    """Keywords of :func:`frf` beside its channels.

    Keys:
        quantity: ``displacement``, ``velocity`` or ``acceleration`` of the response.
        force_scale: factor that turns the force into N.
        response_scale: factor that turns the response into SI units.
        rate: sampling rate (Hz), where there are no times.
        skip: lines to pass over at the top of a text.
        table: number of the table in the file, from 1.
        repair: use a text around its damaged lines.
        window: ``none``, ``force``, ``exponential``, ``impact``, ``hann`` or ``symmetric-hann``.
        exponential_end: value of an exponential window at the end of the record (1).
        responses: with ``modes``: The files hold measured responses, although no name of a column says so.
        averages: with ``modes``: number of averages behind the coherence in a file of responses.
        band: with ``modes``: lowest and highest frequency (Hz) of the lines that are fitted.
        order: with ``modes``: highest order of the stabilisation diagram, how many poles the band may hold.
        near: with ``modes``: frequencies (Hz) to which the poles that are fitted are nearest, in place of all that are
            stable.
        save_responses: with ``modes``: Universal File into which the responses that were fitted are written.
    """

    quantity: str | None
    force_scale: float | None
    response_scale: float | None
    rate: float | None
    skip: int | None
    table: int | None
    repair: bool | None
    window: str | None
    exponential_end: float | None
    responses: bool | None
    averages: float | None
    band: tuple[float, float] | None
    order: int | None
    near: float | Sequence[float] | None
    save_responses: Path | None


for _part in (RecordOptions, MachineOptions):
    for _whole in (FreeOptions, IdentifyOptions):
        _whole.__doc__ = f"{_whole.__doc__}\n\n    {_part.__doc__}"


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
