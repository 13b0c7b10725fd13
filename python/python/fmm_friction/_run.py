"""Arguments of the program from keywords, files from arrays, and a call that can be interrupted."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from threading import Thread
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from .law import Law

#: Called with a sentence on how far a command is, a few times a second.
Progress = Callable[[str], None]

#: Seconds between two looks at a command that runs.
_LOOK = 0.1


@dataclass
class Call:
    """One call of the program: its arguments, files that are not on the disk, by name, and laws of one's own."""

    arguments: list[str]
    files: list[tuple[str, bytes]] = field(default_factory=list)
    laws: list[Law] = field(default_factory=list)

    def answer(self, progress: Progress | None = None) -> _core.Answer:
        """Runs the call in a thread of its own, so that Ctrl-C and ``progress`` are served meanwhile."""
        watch = _core.Watch()
        done: list[_core.Answer] = []
        failed: list[BaseException] = []

        def work() -> None:
            try:
                done.append(_core.answer(self.arguments, self.files, [law.core for law in self.laws], watch))
            except BaseException as error:
                failed.append(error)

        thread = Thread(target=work, name="fmm", daemon=True)
        thread.start()
        told = ""
        try:
            while thread.is_alive():
                thread.join(_LOOK)
                if progress is not None and watch.message != told:
                    told = watch.message
                    progress(told)
        except BaseException:
            watch.stop()
            raise
        if failed:
            raise failed[0]
        return done[0]


def options(keywords: Mapping[str, Any]) -> list[str]:
    """Options of the program: ``mass_u=0.1`` is ``--mass-u=0.1``; ``None`` and ``False`` are left out."""
    given = []
    for name, value in keywords.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            given.append(option)
        elif isinstance(value, Mapping):
            given.extend(f"{option}={key}={_text(one)}" for key, one in value.items())
        elif isinstance(value, (list, tuple, np.ndarray)):
            # Order and corner of a filter are the one pair that the program writes with a colon.
            sign = ":" if name == "low_pass" else ","
            given.append(f"{option}={sign.join(_text(one) for one in value)}")
        else:
            given.append(f"{option}={_text(value)}")
    return given


def _text(value: object) -> str:
    """The value as an option, with all digits."""
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)


def table(name: str, columns: Mapping[str, ArrayLike]) -> tuple[str, bytes]:
    """A file of NumPy in memory with these columns, all of one length."""
    arrays = {key: np.asarray(values, dtype=np.float64) for key, values in columns.items()}
    for key, values in arrays.items():
        if values.ndim != 1:
            raise ValueError(f"{key} must be an array of one dimension, but its shape is {values.shape}")
    lengths = {key: len(values) for key, values in arrays.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{key} has {length}" for key, length in lengths.items())
        raise ValueError(f"the arrays must be of one length, but {listed}")
    file = io.BytesIO()
    np.savez(file, **arrays)  # type: ignore[arg-type]
    return name, file.getvalue()


def document(name: str, content: object) -> tuple[str, list[tuple[str, bytes]]]:
    """Path, and files in memory, of a document that is a path, or a mapping that stands for a file of JSON."""
    if isinstance(content, (str, os.PathLike)):
        return os.fspath(content), []
    file = f"{name}.json"
    return file, [(file, json.dumps(content).encode())]


def is_path(given: object) -> bool:
    """True for the path of a file."""
    return isinstance(given, (str, os.PathLike))


def are_paths(given: object) -> bool:
    """True for paths of files."""
    return isinstance(given, (list, tuple)) and len(given) > 0 and all(is_path(one) for one in given)


def paths(files: object) -> list[str]:
    """One path or several as texts."""
    if isinstance(files, (str, os.PathLike)):
        return [os.fspath(files)]
    if isinstance(files, Sequence):
        return [os.fspath(file) for file in files]
    raise TypeError(f"give a path or a list of paths, not {type(files).__name__}")
