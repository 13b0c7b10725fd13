"""Results: findings, curves and pages of what a command found."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._run import Call

if TYPE_CHECKING:
    import pandas as pd

#: What JSON has: None, bool, int, float, str, lists and dicts.
Json = Any


@dataclass(frozen=True)
class Finding:
    """A quantity that was found.

    Attributes:
        name: name of the quantity, such as ``mu`` or ``natural_frequency_hz``.
        value: value, in ``unit``.
        u: standard uncertainty, in ``unit``; ``None`` where the record does not determine the value.
        interval_95: ends of the 95 % interval, in ``unit``.
        unit: SI unit, ``1`` for a number without one.
        status: ``fitted``, ``derived``, ``fixed``, ``at_bound`` or ``undetermined``; ``None`` where it is not told.
        shares: shares of u² by source (1), the largest first; empty where they are not told.
    """

    name: str
    value: float
    u: float | None
    interval_95: tuple[float, float] | None
    unit: str
    status: str | None = None
    shares: Mapping[str, float] = field(default_factory=dict)

    def __float__(self) -> float:
        """The value alone."""
        return self.value

    def __str__(self) -> str:
        """Value, uncertainty and unit."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.value:.6g}{unit}" if self.u is None else f"({self.value:.6g} ± {self.u:.2g}){unit}"


class Findings(Mapping[str, Finding]):
    """Findings by name."""

    def __init__(self, findings: Mapping[str, Finding]) -> None:
        """The findings of a model."""
        self._findings = dict(findings)

    def __getitem__(self, name: str) -> Finding:
        """The finding of this name."""
        try:
            return self._findings[name]
        except KeyError:
            raise KeyError(f"there is no finding {name!r}; there are {', '.join(self._findings)}") from None

    def __iter__(self) -> Iterator[str]:
        """The names."""
        return iter(self._findings)

    def __len__(self) -> int:
        """The number of findings."""
        return len(self._findings)

    def __repr__(self) -> str:
        """One finding a line."""
        return "\n".join(f"{name} = {finding}" for name, finding in self._findings.items())

    def to_frame(self) -> pd.DataFrame:
        """A frame of pandas with one row a finding: value, u, low and high (ends of 95 %), unit, status."""
        import pandas as pd

        def row(finding: Finding) -> dict[str, Any]:
            low, high = finding.interval_95 or (float("nan"), float("nan"))
            u = float("nan") if finding.u is None else finding.u
            return {
                "value": finding.value,
                "u": u,
                "low": low,
                "high": high,
                "unit": finding.unit,
                "status": finding.status,
            }

        frame = pd.DataFrame([row(finding) for finding in self.values()], index=list(self))
        frame.index.name = "quantity"
        return frame


@dataclass(frozen=True)
class Curve:
    """A record and its fit, sample by sample; arrays of one length.

    Attributes:
        time: times, s.
        measured: measured values, in ``unit``.
        fitted: values of the preferred model, in ``unit``; NaN where it says nothing.
        unit: SI unit of both.
    """

    time: NDArray[np.float64]
    measured: NDArray[np.float64]
    fitted: NDArray[np.float64]
    unit: str

    @property
    def residuals(self) -> NDArray[np.float64]:
        """Measured less fitted, in ``unit``."""
        return self.measured - self.fitted


class Result:
    """Result of a command: its document, figures and text. It pickles as its call, which is run again if more than the
    document is asked for."""

    def __init__(self, call: Call, answer: _core.Answer | None, document: str | None = None) -> None:
        """The result of a call, with the answer or, out of a pickle, with the document alone."""
        self._call = call
        self._answer = answer
        if document is None:
            document = self._answered.document(False)
        self._text = document
        self.document: dict[str, Json] = json.loads(document)
        """The document of ``fmm ... --json``; ``docs/json.md`` explains its keys."""

    @property
    def _answered(self) -> _core.Answer:
        if self._answer is None:
            self._answer = self._call.answer()
        return self._answer

    def __getstate__(self) -> dict[str, Any]:
        """The call and the document; an answer stays in its process."""
        return {"call": self._call, "document": self._text}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """The result out of a pickle."""
        Result.__init__(self, state["call"], None, state["document"])

    def to_json(self, full: bool = False) -> str:
        """The document of ``fmm ... --json``, character by character; ``full`` that of ``--json=full``."""
        return self._answered.document(True) if full else self._text

    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt the result, and faults of the file, in sentences."""
        return [*self.document.get("remarks", []), *self.document.get("warnings", [])]

    def figures(self) -> dict[str, str]:
        """Figures as SVG by the names of their files, as ``fmm ... --figures`` writes them."""
        return dict(self._answered.pictures())

    def save_figures(self, folder: str | os.PathLike[str]) -> list[str]:
        """Writes the figures into a folder, which is made, and returns their paths."""
        os.makedirs(folder, exist_ok=True)
        written = []
        for name, svg in self.figures().items():
            path = os.path.join(folder, name)
            with open(path, "w", encoding="utf-8") as file:
                file.write(svg)
            written.append(path)
        return written

    def report(self, path: str | os.PathLike[str]) -> None:
        """Writes a page of HTML with everything, which needs no network.

        Raises:
            TypeError: the result is of a command that has no page.
        """
        page = self._answered.page()
        if page is None:
            raise TypeError(f"{type(self).__name__} has no page; save_figures() and to_json() have what it found")
        with open(path, "w", encoding="utf-8") as file:
            file.write(page)

    def __str__(self) -> str:
        """The text that ``fmm`` prints."""
        return self._answered.text()

    def __repr__(self) -> str:
        """The text that ``fmm`` prints."""
        return str(self)

    def _repr_html_(self) -> str:
        """The text with its figures, for notebooks."""
        figures = "".join(f"<div>{_inline(svg, i)}</div>" for i, svg in enumerate(self.figures().values()))
        return f"<pre>{html.escape(str(self))}</pre>{figures}"


def _inline(svg: str, number: int) -> str:
    """A drawing whose ids differ from those of others on the page."""
    drawing = svg[max(svg.find("<svg"), 0) :]
    prefix = f"fmm{number}-"
    return (
        drawing.replace(' id="', f' id="{prefix}')
        .replace("url(#", f"url(#{prefix}")
        .replace('href="#', f'href="#{prefix}')
    )


def _numbers(values: list[float | None]) -> NDArray[np.float64]:
    """An array of the numbers, with NaN for none."""
    return np.array(values, dtype=np.float64)


def _finding(name: str, told: dict[str, Json]) -> Finding:
    """The finding that a document tells."""
    ends = told.get("interval_95")
    interval = None if ends is None else (ends[0], ends[1])
    parts = sorted(told.get("contributions", []), key=lambda part: part["share"], reverse=True)
    shares = {part["source"]: part["share"] for part in parts}
    return Finding(name, told["value"], told["u"], interval, told["unit"], told.get("status"), shares)


class _Fitted(Result):
    """A result with a preferred model."""

    _curves: list[Curve] | None = None

    @property
    def preferred(self) -> str:
        """Name of the preferred model."""
        return str(self.document["preferred"])

    @property
    def curves(self) -> list[Curve]:
        """Each record and the preferred fit; NaN where the model says nothing."""
        if self._curves is None:
            fits = self._answered.fits()
            self._curves = [Curve(time, measured, fitted, unit) for unit, (time, measured, fitted) in fits]
        return self._curves

    @property
    def curve(self) -> Curve:
        """The first record and the preferred fit."""
        return self.curves[0]

    @property
    def residuals(self) -> NDArray[np.float64]:
        """Measured less fitted of the first record, in its unit; NaN where the model says nothing."""
        return self.curve.residuals


class Identification(_Fitted):
    """Result of :func:`identify` and :func:`compare`."""

    @property
    def findings(self) -> Findings:
        """Findings of the preferred law by name."""
        return self.findings_of(self.preferred)

    def findings_of(self, law: str) -> Findings:
        """Findings of a law that was fitted."""
        parameters = self._model(law)["parameters"]
        return Findings({name: _finding(name, told) for name, told in parameters.items()})

    @property
    def model(self) -> dict[str, Json]:
        """The preferred law as the document has it: residuals, rank, outcome and the like."""
        return self._model(self.preferred)

    def _model(self, law: str) -> dict[str, Json]:
        models: dict[str, dict[str, Json]] = {model["law"]: model for model in self.document["models"]}
        if law not in models:
            raise KeyError(f"there is no model {law!r}; there are {', '.join(models)}")
        return models[law]

    @property
    def summary(self) -> str:
        """Result, its certainty, and the next step in two or three sentences."""
        return str(self.document["summary"])

    @property
    def friction_curve(self) -> dict[str, Json] | None:
        """Friction over the speed, no law assumed: ``speeds``, ``levels``, units and what speaks against it."""
        curve: dict[str, Json] | None = self.document.get("friction_curve")
        return curve


class Force(_Fitted):
    """Result of :func:`force`."""

    @property
    def findings(self) -> Findings:
        """Findings of the preferred model by name."""
        model = next(one for one in self.document["models"] if one["model"] == self.preferred)
        return Findings({told["name"]: _finding(told["name"], told) for told in model["findings"]})


class Backbone(Result):
    """Result of :func:`backbone`."""

    def to_frame(self) -> pd.DataFrame:
        """A frame of pandas with the points: time (s), amplitude, frequency (Hz), damping (1/s) and each u."""
        import pandas as pd

        def row(point: dict[str, Json]) -> dict[str, float | None]:
            columns: dict[str, float | None] = {"time": point["time"]}
            for key, pair in point.items():
                if key.endswith("_u"):
                    name = key.removesuffix("_u")
                    columns[name], columns[f"u_{name}"] = pair or (None, None)
            return columns

        return pd.DataFrame([row(point) for point in self.document["points"]])


class FrequencyResponse(Result):
    """Result of :func:`frf`."""

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """Frequencies of the lines, Hz."""
        return _numbers(self.document["frequencies_hz"])

    def _lines(self, key: str) -> NDArray[np.complex128]:
        lines = self.document[key]
        return _numbers(lines["real"]) + 1j * _numbers(lines["imag"])

    @property
    def h1(self) -> NDArray[np.complex128]:
        """H1 along the lines, in ``document["unit"]``."""
        return self._lines("h1")

    @property
    def h2(self) -> NDArray[np.complex128]:
        """H2 along the lines, in ``document["unit"]``."""
        return self._lines("h2")

    @property
    def coherence(self) -> NDArray[np.float64]:
        """Coherence along the lines, 1."""
        return _numbers(self.document["coherence"])


class Modes(Result):
    """Result of :func:`frf` with ``modes``."""

    @property
    def modes(self) -> list[Findings]:
        """``natural_frequency_hz`` (Hz) and ``damping_ratio`` (1) of each mode, each with u."""
        units = {"natural_frequency_hz": "Hz", "damping_ratio": "1"}

        def found(mode: dict[str, Json]) -> Findings:
            told = {name: mode[name] for name in units}
            return Findings(
                {name: Finding(name, one["value"], one["u"], None, units[name]) for name, one in told.items()}
            )

        return [found(mode) for mode in self.document["modes"]]

    def to_frame(self) -> pd.DataFrame:
        """A frame of pandas with one row a mode: natural frequency (Hz), damping ratio (1) and each u."""
        import pandas as pd

        def row(mode: Findings) -> dict[str, float | None]:
            columns: dict[str, float | None] = {}
            for name, finding in mode.items():
                columns[name], columns[f"u_{name}"] = finding.value, finding.u
            return columns

        return pd.DataFrame([row(mode) for mode in self.modes])


class Budget(Result):
    """Result of :func:`budget`."""

    @property
    def findings(self) -> Findings:
        """Results with u by derivatives and the interval of the trials; those of a sweep are in :attr:`rows`."""
        return self._findings(self.document)

    @property
    def rows(self) -> list[tuple[dict[str, float], Findings]]:
        """Values of the quantities in each row of a sweep, and its findings."""
        return [(dict(row["values"]), self._findings(row)) for row in self.document.get("sweep", [])]

    @property
    def conformity(self) -> dict[str, dict[str, Json]]:
        """Decision on each result with a tolerance: ``accepted``, ``probability`` and the like."""
        results = self.document["results"]
        return {one["budget"]["name"]: one["conformity"] for one in results if one.get("conformity")}

    @staticmethod
    def _findings(row: dict[str, Json]) -> Findings:
        def finding(result: dict[str, Json]) -> Finding:
            budget, interval = result["budget"], result["interval"]
            ends = (interval["low"], interval["high"])
            return Finding(budget["name"], budget["estimate"], budget["standard_uncertainty"], ends, budget["unit"])

        return Findings({result["budget"]["name"]: finding(result) for result in row["results"]})


class Motion(Result):
    """Result of :func:`simulate`."""

    def _samples(self, key: str) -> NDArray[np.float64]:
        return _numbers(self.document["samples"][key])

    @property
    def time(self) -> NDArray[np.float64]:
        """Times of the samples, s."""
        return self._samples("t")

    @property
    def position(self) -> NDArray[np.float64]:
        """Positions at the samples, m (rad for a pendulum)."""
        return self._samples("x")

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Velocities at the samples, m/s (rad/s for a pendulum)."""
        return self._samples("v")

    @property
    def events(self) -> list[dict[str, Json]]:
        """Events: time ``t`` (s), ``kind``, position ``x``, velocity ``v``, and what comes ``next``."""
        events: list[dict[str, Json]] = self.document["events"]
        return events


class Design(Result):
    """Result of :func:`design`."""

    @property
    def chosen(self) -> list[tuple[str, int]]:
        """Tests of the best set, and how often each is made."""
        tests = self.document["tests"]
        return [(tests[place]["name"], count) for place, count in self.document["best"]["chosen"]]


class Campaign(Result):
    """Result of :func:`batch`."""

    @property
    def consensus(self) -> Findings:
        """Consensus of the records for each quantity; that of forces at several loads has one for each load."""
        found = {}
        for told in self.document["summary"]["quantities"]:
            name = told["name"] if told["loads"] is None else "{} at {:g} N".format(told["name"], told["loads"][0])
            low, high = told["interval_95"]
            found[name] = Finding(name, told["mean"], told["u"], (low, high), told["unit"])
        return Findings(found)

    def to_frame(self) -> pd.DataFrame:
        """A frame of pandas with one row a record: file, law, each finding and its ``u_``, warnings, ``refused``."""
        import pandas as pd

        def row(record: dict[str, Json]) -> dict[str, Json]:
            columns = {"file": record["file"], **record["description"]}
            found = record.get("found")
            if found is None:
                return {**columns, "refused": record["refused"]}
            columns.update(law=found["law"], warnings=len(found["warnings"]), doubtful=bool(found["doubts"]))
            for told in found["findings"]:
                columns[told["name"]], columns[f"u_{told['name']}"] = told["value"], told["u"]
            return columns

        return pd.DataFrame([row(record) for record in self.document["records"]])
