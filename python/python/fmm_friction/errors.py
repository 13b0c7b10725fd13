"""The exception of this package."""

from __future__ import annotations

import re


class FmmError(ValueError):
    """Input that is refused, in the words of the program ``fmm``, with its options written as keywords.

    Attributes:
        code: kind of the refusal, to act on: ``usage``, ``option``, ``document``, ``unreadable``, ``unwritable``,
            ``unclear``, ``contradiction``, ``channel``, ``time``, ``values``, ``record``, ``name``, ``fit``,
            ``simulation``, ``uncertainty``, ``stopped`` or ``refused``; ``docs/json.md`` explains them.
        message: what is wrong.
        remedy: what would be right, if it is known apart from the message.
    """

    def __init__(self, code: str, message: str, remedy: str | None = None) -> None:
        """An error of this kind."""
        super().__init__(code, message, remedy)
        self.code = code
        self.message = _in_keywords(message)
        self.remedy = None if remedy is None else _in_keywords(remedy)

    def __str__(self) -> str:
        """The message and its remedy."""
        return self.message if self.remedy is None else f"{self.message}; {self.remedy}"


def _in_keywords(sentence: str) -> str:
    """The sentence with each option, such as ``--time-unit``, as the keyword ``time_unit=``."""
    return re.sub(r"(?<![\w-])--([a-z][a-z-]*[a-z])=?", lambda option: option[1].replace("-", "_") + "=", sentence)
