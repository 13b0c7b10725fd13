"""The commands of the program ``fmm`` as functions of arrays or files."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from . import results
from ._run import Call, Progress, are_paths, document, is_path, options, paths, table
from .law import Law, own
from .options import ForceOptions, FreeOptions, FrfOptions, IdentifyOptions, Path, RecordOptions, check

if TYPE_CHECKING:
    import pandas as pd
    from typing_extensions import Unpack

#: Name of the file in memory that holds the arrays of a call.
_ARRAYS = "arrays"


def _told(progress: Progress | bool) -> Progress | None:
    """How progress is told: by a function, on standard error, or not at all."""
    if progress is True:
        return lambda message: print(f"\r{message}\x1b[K", end="", file=sys.stderr, flush=True)
    return progress or None


#: Several records: paths, or times and values, by name or in their order.
Records = Sequence[Path] | Sequence[tuple[ArrayLike, ArrayLike]] | Mapping[str, tuple[ArrayLike, ArrayLike]]


def _tables(records: Mapping[str, tuple[ArrayLike, ArrayLike]]) -> list[tuple[str, bytes]]:
    """Files in memory of several records that are arrays."""
    return [table(name, {"time": t, "y": y}) for name, (t, y) in records.items()]


def _are_pairs(given: object) -> bool:
    """True for pairs of arrays, such as times and values of several records."""
    if not isinstance(given, (list, tuple)):
        return False
    is_pair = [isinstance(one, (list, tuple)) and len(one) == 2 and np.ndim(one[0]) == 1 for one in given]
    return bool(is_pair) and all(is_pair)


def _record(
    function: str, t: ArrayLike | Path | Records | None, y: ArrayLike | None, others: Mapping[str, tuple[str, Any]]
) -> tuple[list[str], list[tuple[str, bytes]], list[str]]:
    """Paths, files and options of a record that is a path, arrays, or the bundled one, or of several records.

    ``others`` are further channels: option, and name of a column or array with the name of its column.
    """
    given: list[str] = []
    columns: dict[str, ArrayLike] = {}
    for option, (name, channel) in others.items():
        if channel is None:
            continue
        if isinstance(channel, (str, int)):
            given.append(f"--{option}={channel}")
        else:
            columns[name] = channel
            given.append(f"--{option}={name}")
    pairs = isinstance(t, Mapping) or (y is None and _are_pairs(t))
    if (t is None and y is None) or is_path(t) or are_paths(t) or pairs:
        if y is not None or columns:
            raise TypeError(f"{function}() takes files or arrays, and channels of a file are named, not given")
        if t is None or not pairs:
            return ([] if t is None else paths(t)), [], given
        files = _tables(t if isinstance(t, Mapping) else {f"record {i}": one for i, one in enumerate(t, 1)})  # type: ignore[misc, arg-type]
        return [name for name, _ in files], files, [*given, "--channel=y", "--time=time"]
    if y is None:
        raise TypeError(f"{function}() needs y, the measured values, beside the times")
    columns["y"] = y
    given.append("--channel=y")
    if t is not None:
        columns["time"] = t  # type: ignore[assignment]
        given.append("--time=time")
    return [_ARRAYS], [table(_ARRAYS, columns)], given


def identify(
    t: ArrayLike | Path | Records | None = None,
    y: ArrayLike | None = None,
    *,
    force: ArrayLike | str | int | None = None,
    base: ArrayLike | str | int | None = None,
    base_unit: str | None = None,
    impact: ArrayLike | str | int | None = None,
    progress: Progress | bool = False,
    **keywords: Unpack[IdentifyOptions],
) -> results.Identification:
    """Finds the friction, damping and frequency of a machine from the record of its vibration.

    Args:
        t: times in s, shape (n,), or the path of a file, or ``None`` for values at a ``rate``. With neither ``t`` nor
            ``y`` the bundled record of a bicycle fork is taken. Several records of one machine are fitted together: a
            list of paths, or, without ``y``, of pairs of times and values, or pairs by name.
        y: displacement, velocity or acceleration in ``unit``, shape (n,). Give ``quantity``, ``unit`` or both.
        force: measured force that drives the machine in N, shape (n,), or the channel of the file.
        base: measured motion of the base that drives the machine in ``base_unit``, shape (n,), or the channel.
        base_unit: unit of ``base`` as an array, such as ``"m/s^2"``.
        impact: force of a hammer in N, shape (n,), or the channel of the file.
        progress: called with a sentence on how far it is, or ``True`` for a line on standard error.
        **keywords: those of :class:`~fmm_friction.options.IdentifyOptions`, such as ``mass`` (kg), ``normal_load``
            (N), ``law`` and ``from_`` (s).

    Returns:
        Findings with uncertainties, the fitted curve, and what the record could not tell.

    Raises:
        FmmError: the record or a keyword is refused, in the words of the program.
        KeyboardInterrupt: Ctrl-C; the search ends at its next step.

    >>> found = identify("run.csv", mass=10.391, normal_load=14)  # doctest: +SKIP
    >>> found.findings["mu"].value, found.findings["mu"].u  # doctest: +SKIP
    """
    return _identified("identify", t, y, force, base, base_unit, impact, progress, keywords)


def compare(
    t: ArrayLike | Path | Records | None = None,
    y: ArrayLike | None = None,
    *,
    force: ArrayLike | str | int | None = None,
    base: ArrayLike | str | int | None = None,
    base_unit: str | None = None,
    impact: ArrayLike | str | int | None = None,
    progress: Progress | bool = False,
    **keywords: Unpack[IdentifyOptions],
) -> results.Identification:
    """Compares laws of friction by one record: those of ``law``, or viscous, dry and both.

    Arguments, result and exceptions are those of :func:`identify`.
    """
    return _identified("compare", t, y, force, base, base_unit, impact, progress, keywords)


def _identified(
    command: str,
    t: ArrayLike | Path | Records | None,
    y: ArrayLike | None,
    force: ArrayLike | str | int | None,
    base: ArrayLike | str | int | None,
    base_unit: str | None,
    impact: ArrayLike | str | int | None,
    progress: Progress | bool,
    keywords: IdentifyOptions,
) -> results.Identification:
    check(command, keywords, IdentifyOptions)
    name = "base" if base_unit is None else f"base [{base_unit}]"
    others = {"force": ("force [N]", force), "base": (name, base), "impact": ("impact [N]", impact)}
    record, files, channels = _record(command, t, y, others)
    call = Call([command, *channels, *options(keywords), "--", *record], files, own(keywords.get("law")))
    return results.Identification(call, call.answer(_told(progress)))


def backbone(
    t: ArrayLike | Path | None = None,
    y: ArrayLike | None = None,
    *,
    cycles: float | None = None,
    progress: Progress | bool = False,
    **keywords: Unpack[RecordOptions],
) -> results.Backbone:
    """Modes of a decay, and how frequency and damping of one go with its amplitude.

    Args:
        t: times in s, shape (n,), or the path of a file, or ``None`` for values at a ``rate``.
        y: displacement, velocity or acceleration in ``unit``, shape (n,).
        cycles: cycles in each window.
        progress: called with a sentence on how far it is, or ``True`` for a line on standard error.
        **keywords: those of :class:`~fmm_friction.options.RecordOptions`.

    Raises:
        FmmError: the record or a keyword is refused.
    """
    check("backbone", keywords, RecordOptions)
    record, files, channels = _record("backbone", t, y, {})
    call = Call(["backbone", *channels, *options({**keywords, "cycles": cycles}), "--", *record], files)
    return results.Backbone(call, call.answer(_told(progress)))


def force(
    t: ArrayLike | Path | Sequence[Path] | None = None,
    *,
    position: ArrayLike | str | int | None = None,
    velocity: ArrayLike | str | int | None = None,
    force: ArrayLike | str | int | None = None,
    load: ArrayLike | str | int | None = None,
    channels: Mapping[str, ArrayLike] | Sequence[str] | None = None,
    validate: Path | Sequence[Path] | None = None,
    progress: Progress | bool = False,
    **keywords: Unpack[ForceOptions],
) -> results.Force:
    """Fits friction to a measured force along a measured motion.

    Args:
        t: times in s, shape (n,), or a path or a list of paths, whose records are fitted together. Without it, arrays
            are values at a ``rate``, or steady states.
        position: positions in ``position_unit``, shape (n,), or the column of the files.
        velocity: velocities in ``position_unit`` per second, shape (n,), or the column of the files.
        force: forces or torques in ``force_unit``, shape (n,), or the column of the files.
        load: normal loads in N, shape (n,), or the column of the files, so that levels are coefficients.
        channels: what else was measured, by name, each of shape (n,), or columns of the files.
        validate: files to which nothing is fitted, but whose forces are predicted.
        progress: called with a sentence on how far it is, or ``True`` for a line on standard error.
        **keywords: those of :class:`~fmm_friction.options.ForceOptions`, such as ``model``.

    Raises:
        FmmError: a record or a keyword is refused.
    """
    check("force", keywords, ForceOptions)
    named = {"position": position, "velocity": velocity, "force": force, "load": load}
    others = paths(validate) if validate is not None else []
    given = [*options(keywords), *(f"--validate={other}" for other in others)]
    laws = own(keywords.get("model"))
    if is_path(t) or are_paths(t):
        for name, column in named.items():
            if column is not None and not isinstance(column, (str, int)):
                raise TypeError(f"force() takes files or arrays: name the column of {name}")
        given += options({**named, "channels": None if channels is None else list(channels)})
        call = Call(["force", *given, "--", *paths(t)], laws=laws)
        return results.Force(call, call.answer(_told(progress)))
    columns: dict[str, ArrayLike] = {}
    if t is not None:
        columns["time"] = t  # type: ignore[assignment]
        given.append("--time=time")
    for name, values in named.items():
        if values is not None:
            columns[name] = values
            given.append(f"--{name}={name}")
    if channels is not None:
        if not isinstance(channels, Mapping):
            raise TypeError("force() takes channels of arrays by name, as in channels={'brake': values}")
        columns.update(channels)
        given.append(f"--channels={','.join(channels)}")
    call = Call(["force", *given, "--", _ARRAYS], [table(_ARRAYS, columns)], laws)
    return results.Force(call, call.answer(_told(progress)))


@overload
def frf(
    files: Path | Sequence[Path] | None = None,
    *,
    force: ArrayLike | Sequence[ArrayLike] | str | int | None = None,
    response: ArrayLike | Sequence[ArrayLike] | str | int | None = None,
    modes: Literal[False] = False,
    progress: Progress | bool = False,
    **keywords: Unpack[FrfOptions],
) -> results.FrequencyResponse: ...


@overload
def frf(
    files: Path | Sequence[Path] | None = None,
    *,
    force: ArrayLike | Sequence[ArrayLike] | str | int | None = None,
    response: ArrayLike | Sequence[ArrayLike] | str | int | None = None,
    modes: Literal[True],
    progress: Progress | bool = False,
    **keywords: Unpack[FrfOptions],
) -> results.Modes: ...


def frf(
    files: Path | Sequence[Path] | None = None,
    *,
    force: ArrayLike | Sequence[ArrayLike] | str | int | None = None,
    response: ArrayLike | Sequence[ArrayLike] | str | int | None = None,
    modes: bool = False,
    progress: Progress | bool = False,
    **keywords: Unpack[FrfOptions],
) -> results.FrequencyResponse | results.Modes:
    """Frequency response of a machine from impact tests, or all modes of it at once.

    Args:
        files: one file or several, each a trial; with ``modes`` also files of measured responses.
        force: force in N, shape (trials, n) or (n,), or the channel of the files.
        response: response in SI units of ``quantity``, of the same shape, or the channel of the files.
        modes: fit all modes to all lines at once.
        progress: called with a sentence on how far it is, or ``True`` for a line on standard error.
        **keywords: those of :class:`~fmm_friction.options.FrfOptions`; of arrays ``rate`` (Hz) and ``quantity``.

    Raises:
        FmmError: a trial or a keyword is refused.
    """
    check("frf", keywords, FrfOptions)
    band, near = keywords.pop("band", None), keywords.pop("near", None)
    given = options({**keywords, "modes": modes})
    if near is not None:
        given += [f"--near={float(one)!r}" for one in np.atleast_1d(np.asarray(near, dtype=np.float64))]
    if band is not None:
        given += ["--band", *(repr(float(end)) for end in band)]
    result = results.Modes if modes else results.FrequencyResponse
    if files is not None:
        call = Call(["frf", *given, *options({"force": force, "response": response}), "--", *paths(files)])
        return result(call, call.answer(_told(progress)))
    if force is None or response is None or isinstance(force, (str, int)) or isinstance(response, (str, int)):
        raise TypeError("frf() takes files, or arrays of force and response")
    blows, answers = (np.atleast_2d(np.asarray(values, dtype=np.float64)) for values in (force, response))
    if blows.shape != answers.shape:
        raise ValueError(f"force and response must be of one shape, but have {blows.shape} and {answers.shape}")
    trials = [
        table(f"trial {number}", {"force": blow, "response": answer})
        for number, (blow, answer) in enumerate(zip(blows, answers, strict=True), 1)
    ]
    given += ["--force=force", "--response=response"]
    call = Call(["frf", *given, "--", *(name for name, _ in trials)], trials)
    return result(call, call.answer(_told(progress)))


def budget(
    measurement: Path | Mapping[str, Any],
    *,
    level: float | None = None,
    trials: int | None = None,
    seed: int | None = None,
    progress: Progress | bool = False,
) -> results.Budget:
    """Uncertainty of a result that follows from others by a formula.

    Args:
        measurement: path of TOML or JSON, or its content: ``input`` (list of ``name``, ``unit``, ``value``, ``u`` and
            the like), ``result`` (list of ``name``, ``unit``, ``formula``) and ``correlation``.
        level: coverage probability of intervals, 0.95 unless given.
        trials: number of trials of the Monte Carlo, 1 000 000 unless given.
        seed: seed of the trials, 1 unless given.
        progress: called with a sentence on how far it is, or ``True`` for a line on standard error.

    Raises:
        FmmError: the measurement is refused.
    """
    path, files = document("budget", measurement)
    call = Call(["budget", *options({"level": level, "trials": trials, "seed": seed}), "--", path], files)
    return results.Budget(call, call.answer(_told(progress)))


def simulate(
    scenario: Path | Mapping[str, Any],
    *,
    law: Law | Sequence[Law] | None = None,
    record: Path | None = None,
    noise: float | None = None,
    seed: int | None = None,
    progress: Progress | bool = False,
) -> results.Motion:
    """Motion of a machine with a sliding contact.

    Args:
        scenario: path of JSON, or its content: ``oscillator``, ``law``, ``normal_load``, ``initial``, ``duration`` and
            the like, as ``fmm simulate --help`` lists them; all in SI units.
        law: laws of one's own that the scenario names, as in ``{"law": {"root": {"coefficient": 0.1, "rise": 0.2}}}``
            with ``Law("root", ...)``. Terms beside them are parts of the oscillator.
        record: table of CSV into which time, displacement and velocity are written.
        noise: noise in that table over the largest value of each column (1).
        seed: which noise.
        progress: called with a sentence on how far it is, or ``True`` for a line on standard error.

    Raises:
        FmmError: the scenario is refused, or the engine has no answer.
    """
    path, files = document("scenario", scenario)
    laws = own(law)
    for one in laws:
        if str(one) != one.name:
            raise ValueError(
                f"simulate() takes the terms of {str(one)!r} from the oscillator: give the law {one.name!r} alone"
            )
    given = options({"record": record, "noise": noise, "seed": seed})
    call = Call(["simulate", *given, "--", path], files, laws)
    return results.Motion(call, call.answer(_told(progress)))


def design(
    plan: Path | Mapping[str, Any] | None = None,
    *,
    from_: Path | results.Identification | results.Campaign | None = None,
    progress: Progress | bool = False,
) -> results.Design:
    """Which tests to make next.

    Args:
        plan: path of TOML or JSON, or its content: ``machine``, ``guess``, ``sensor``, ``candidates`` and ``choose``.
        from_: a campaign or an identification, or the path of its document, from which the plan is made.
        progress: called with a sentence on how far it is, or ``True`` for a line on standard error.

    Raises:
        FmmError: the plan is refused.
    """
    if (plan is None) == (from_ is None):
        raise TypeError("design() takes a plan, or a result as from_")
    if plan is not None:
        path, files = document("plan", plan)
        call = Call(["design", "--", path], files)
    else:
        content = from_.document if isinstance(from_, (results.Identification, results.Campaign)) else from_
        assert content is not None
        path, files = document("campaign", content)
        call = Call(["design", f"--from={path}"], files)
    return results.Design(call, call.answer(_told(progress)))


def batch(
    records: Path | Sequence[Path] | Mapping[str, tuple[ArrayLike, ArrayLike]] | None = None,
    *,
    manifest: Path | pd.DataFrame | None = None,
    out: Path | None = None,
    group: str | None = None,
    joint: bool = False,
    count_doubtful: bool = False,
    against: Sequence[str] = (),
    search: bool = False,
    curves: bool = True,
    jobs: int | None = None,
    progress: Progress | bool = False,
    **keywords: Unpack[FreeOptions],
) -> results.Campaign:
    """Identifies many records of free vibrations, each by itself and all together.

    Args:
        records: files, folders, or arrays by name: times in s and values in ``unit``, each of shape (n,).
        manifest: table with a column ``file``, paths from the folder of the manifest, or from the working directory for
            a frame of pandas; columns called like a keyword set it for their record, others describe it.
        out: folder for one file a record, and for ``campaign.csv``, ``campaign.json`` and ``campaign.html``.
        group: column of the manifest that says which records belong together.
        joint: fit all records together as one machine with one law, too.
        count_doubtful: count records whose fit is doubted by warnings.
        against: columns of the manifest against which friction is set.
        search: search a law for each record instead of fitting ``coulomb_viscous``.
        curves: find the friction curve of each record, which takes most of the time.
        jobs: records at a time, as many as there are processors unless given.
        progress: called with a sentence on how far it is, or ``True`` for a line on standard error.
        **keywords: those of :class:`~fmm_friction.options.FreeOptions`, for all records.

    Raises:
        FmmError: the list is refused; a record that is refused is a row with its reason.
    """
    check("batch", keywords, FreeOptions)
    files: list[tuple[str, bytes]] = []
    columns: list[str] = []
    if isinstance(records, Mapping):
        files = _tables(records)
        columns = ["--channel=y", "--time=time"]
        given = list(records)
    else:
        given = [] if records is None else paths(records)
    if manifest is not None and not is_path(manifest):
        files.append(("manifest.csv", manifest.to_csv(index=False).encode()))  # type: ignore[union-attr]
        manifest = "manifest.csv"
    of_all = options(
        {
            "manifest": manifest,
            "out": out,
            "group": group,
            "joint": joint,
            "count_doubtful": count_doubtful,
            "search": search,
            "no_curves": not curves,
            "jobs": jobs,
        }
    )
    of_all += [f"--against={column}" for column in against]
    laws = own(keywords.get("law"))
    call = Call(["batch", *of_all, *given, "--", *columns, *options(keywords)], files, laws)
    return results.Campaign(call, call.answer(_told(progress)))


def laws() -> list[dict[str, Any]]:
    """The laws of friction with their parameters."""
    found: list[dict[str, Any]] = json.loads(Call(["laws"]).answer().document(False))["laws"]
    return found


def formats() -> list[dict[str, Any]]:
    """The file formats that are read."""
    found: list[dict[str, Any]] = json.loads(Call(["formats"]).answer().document(False))["formats"]
    return found
