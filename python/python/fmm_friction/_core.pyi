"""Core of the package: arguments of the program in, answers out."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

class Watch:
    """Sees how far a command is, and stops it."""

    def __init__(self) -> None: ...
    @property
    def message(self) -> str: ...
    def stop(self) -> None: ...

class Answer:
    """What a command found."""

    def text(self) -> str: ...
    def document(self, full: bool) -> str: ...
    def pictures(self) -> list[tuple[str, str]]: ...
    def fits(self) -> list[tuple[str, list[NDArray[np.float64]]]]: ...
    def page(self) -> str | None: ...
    @property
    def remarks(self) -> list[str]: ...
    @property
    def failure(self) -> str | None: ...

class Law:
    """A law of friction of one's own."""

    def __init__(
        self,
        name: str,
        parameters: Sequence[tuple[str, str, str, float, tuple[float, float]]],
        coefficient: Callable[..., Any],
        derivatives: Callable[..., Any] | None,
    ) -> None: ...

def answer(
    arguments: Sequence[str], files: Sequence[tuple[str, bytes]], laws: Sequence[Law], watch: Watch
) -> Answer: ...
