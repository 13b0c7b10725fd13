"""A law of friction of one's own, as a function of the speed."""

from __future__ import annotations

import math
import pickle
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core

#: Role of a parameter in the force.
Role = Literal["level", "excess", "slope", "shape"]


@dataclass(frozen=True)
class Parameter:
    """A parameter of a law.

    Attributes:
        name: name, as an identifier. A level called ``coefficient`` is found as ``mu``, ``friction_force`` and
            ``friction_per_mass``, as far as mass and load are known, one called ``rising_coefficient`` as ``rising_mu``
            and so on, and one called ``rise`` in another unit than 1 as ``contact_rise``; see ``findings``.
        role: ``level``: the friction is proportional to it, as to a coefficient; ``excess``: the same, of a part that
            vanishes with speed; ``slope``: proportional to it and to the speed, like viscous friction; ``shape``: all
            else, such as a speed at which the law bends, or an exponent.
        unit: unit, made of m, s, rad and deg with prefixes and powers; ``1`` for a number, ``s/m`` for a slope unless
            given. Loads are no part of it: levels are coefficients.
        start: where a fit begins, over the size that the record shows (1): its Coulomb friction for a level, its top
            speed for a speed, its amplitude for a length, and 1 for an exponent. A fit tries others as well.
        bounds: least and greatest value in ``unit``; ``None`` for none.
    """

    name: str
    role: Role
    unit: str | None = None
    start: float = 1.0
    bounds: tuple[float | None, float | None] = (0.0, None)

    @property
    def stated(self) -> tuple[str, str, str, float, tuple[float, float]]:
        """The parameter as the core takes it."""
        low, high = self.bounds
        ends = (-math.inf if low is None else float(low), math.inf if high is None else float(high))
        unit = self.unit or ("s/m" if self.role == "slope" else "1")
        return self.name, unit, self.role, float(self.start), ends


class Law:
    """A law of one's own, for the keyword ``law`` of identify, compare, batch and simulate, and ``model`` of force.

    It is slow: Python is asked at every step of every simulation, so that a fit takes seconds where a law of the list
    takes milliseconds. It is right: the engine is that of all laws, with stick and slip in between, and its derivatives
    are yours or central differences of nine digits.

    Args:
        name: name, as an identifier, that is none of the list.
        function: coefficient of friction (force over normal load) at speeds ``v`` >= 0 (m/s, or rad/s) and values of
            the parameters: ``function(v, *values)``. All arguments are arrays of one length, and so is the result; it
            must be finite and not negative where the motion comes by. At rest the contact holds up to ``function(0)``.
        parameters: the parameters in the order in which the function takes them.
        derivatives: derivatives of the function by the speed and by each parameter, a sequence of arrays, of the same
            arguments; without it differences.

    Raises:
        ValueError: a name that is taken or no identifier, or bounds without a value.

    A function that is defined at the top of a module pickles, and with it the law and its results; a lambda does not.
    The functions are freed with the law and its results.

    >>> def function(v, level, rise): return level + rise * np.sqrt(v)
    >>> law = Law("root", function, [Parameter("coefficient", "level"), Parameter("rise", "level", "(s/m)^0.5", 0.1)])
    >>> law([0, 0.25], 0.2, 0.1).tolist()
    [0.2, 0.25]
    """

    def __init__(
        self,
        name: str,
        function: Callable[..., Any],
        parameters: Sequence[Parameter],
        *,
        derivatives: Callable[..., Any] | None = None,
    ) -> None:
        """A law of this name."""
        for one in (name, *(parameter.name for parameter in parameters)):
            if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", one):
                raise ValueError(f"{one!r} is no name of a law or a parameter: take letters, digits and underscores")
        self.name = name
        self.function = function
        self.parameters = tuple(parameters)
        self.derivatives = derivatives
        self.core = _core.Law(name, [parameter.stated for parameter in self.parameters], function, derivatives)
        """The law as the core has it."""
        self._terms: tuple[str, ...] = ()

    def beside(self, *terms: str) -> Law:
        """The same law with terms of the machine beside it, such as ``"linear"`` or ``"quadratic"`` damping."""
        law = object.__new__(Law)
        law.__dict__.update(self.__dict__)
        law._terms = (*self._terms, *terms)
        return law

    def __call__(self, v: ArrayLike, *values: float) -> NDArray[np.float64]:
        """Coefficients at speeds (m/s), by these values of the parameters."""
        speeds = np.asarray(v, dtype=np.float64)
        return np.broadcast_to(np.asarray(self.function(speeds, *values), dtype=np.float64), speeds.shape)

    def __str__(self) -> str:
        """Name with the terms beside it, as options take it."""
        return "+".join((self.name, *self._terms))

    def __repr__(self) -> str:
        """Name and parameters."""
        return f"Law({str(self)!r}, {', '.join(parameter.name for parameter in self.parameters)})"

    def __copy__(self) -> Law:
        """The same law: nothing of it changes."""
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Law:
        """The same law: nothing of it changes."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """The functions, by their names."""
        for function in (self.function, self.derivatives):
            place = getattr(function, "__qualname__", "")
            if "<" in place:
                what = "a lambda" if place.endswith("<lambda>") else "defined inside of another function"
                raise pickle.PicklingError(
                    f"the law {self.name!r} cannot be pickled, as its function is {what}: define it by def at the top "
                    "of a module; what else it needs goes into functools.partial of such a function"
                )
        return _again, (self.name, self.function, self.parameters, self.derivatives, self._terms)


def _again(
    name: str,
    function: Callable[..., Any],
    parameters: Sequence[Parameter],
    derivatives: Callable[..., Any] | None,
    terms: tuple[str, ...],
) -> Law:
    """A law out of a pickle."""
    return Law(name, function, parameters, derivatives=derivatives).beside(*terms)


#: Laws by name, of one's own, or several of them.
Laws = str | Law | Sequence[str | Law]


def own(laws: Laws | None) -> list[Law]:
    """Those of the laws that are of one's own."""
    if laws is None or isinstance(laws, str):
        return []
    return [laws] if isinstance(laws, Law) else [law for law in laws if isinstance(law, Law)]
