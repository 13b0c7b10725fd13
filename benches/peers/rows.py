"""Rows of the table: how long a tool takes, how far it is from the truth, and what it does not do."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Row:
    """One tool at one task.

    Attributes:
        task: what is asked.
        tool: who answers, and how.
        work: the call that is timed.
        error: distance of what ``work`` returns from the truth, as a text with its unit.
        gradient: derivatives by the parameters come with the answer.
        lacks: what the tool does not do of the task, or of what usually follows.
    """

    task: str
    tool: str
    work: Callable[[], Any]
    error: Callable[[Any], str]
    gradient: bool = False
    lacks: str = ""


def measured(rows: list[Row], calls: int) -> list[tuple[Row, float, str]]:
    """The rows with the median of so many calls (s) and the error; the tools take turns, call by call."""
    # The first call compiles, where a tool does so, and is not timed.
    answers = [row.work() for row in rows]
    times: list[list[float]] = [[] for _ in rows]
    for _ in range(calls):
        for row, taken in zip(rows, times, strict=True):
            begun = time.perf_counter()
            row.work()
            taken.append(time.perf_counter() - begun)
    return [
        (row, statistics.median(taken), row.error(answer))
        for row, taken, answer in zip(rows, times, answers, strict=True)
    ]


def lines(found: list[tuple[Row, float, str]]) -> list[str]:
    """The rows of Markdown, quickest first."""
    in_order = sorted(found, key=lambda one: one[1])
    return [
        f"| {row.task} | {row.tool} | {_duration(taken)} | {error} | {'yes' if row.gradient else 'no'} | {row.lacks} |"
        for row, taken, error in in_order
    ]


def _duration(taken: float) -> str:
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if taken >= size:
            return f"{taken / size:.2g} {unit}" if taken < 100 * size else f"{taken / size:.0f} {unit}"
    return f"{taken / 1e-9:.0f} ns"
