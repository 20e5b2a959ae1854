"""Keywords as settings: the text that the command line takes for each value."""

from __future__ import annotations

import enum
import operator
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _files
from ._pairwave import Request, settings as _settings

ROWS: dict[str, dict[str, Any]] = {row["name"]: row for row in _settings()}

#: Keywords whose value may be an array in place of the path of a file.
_ARRAYS = {"edges": ".csv", "frequencies": ".csv", "window_polygon": ".csv", "envelope_from": ".npy"}


def _word(name: str, value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        if not ROWS[name]["switch"]:
            raise TypeError(f"{name} {value}: expected no truth value")
        return "true" if value else "false"
    if isinstance(value, enum.Enum):
        value = value.value
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    if not isinstance(value, str):
        raise TypeError(f"{name}: a {type(value).__name__}; expected a number, a text or a list of them")
    return value


def whole(name: str, value: Any) -> int:
    """A keyword that counts."""
    try:
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{name} {value!r}: expected a whole number") from None


def _texts(name: str, value: Any, dim: int | None) -> list[str]:
    row = ROWS[name]
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if name in _ARRAYS and not _names_files(value):
        return [_files.stored(_numbers(name, value), name, _ARRAYS[name])]
    if name == "integrand" or name == "intensity":
        values = list(value) if isinstance(value, (list, tuple)) else [value]
        if not values:
            raise ValueError(f"{name} []: expected one or more")
        return [_spec(name, f, dim) for f in values]
    if name == "param" and isinstance(value, Mapping):
        return [f"{key}={_word(name, of)}" for key, of in value.items()]
    if isinstance(value, (list, tuple, np.ndarray)):
        words = [_word(name, of) for of in value]
        return words if row["repeated"] else [",".join(words)]
    return [_word(name, value)]


def _names_files(value: Any) -> bool:
    many = value if isinstance(value, (list, tuple)) and value else [value]
    return all(isinstance(one, (str, os.PathLike)) for one in many)


def _numbers(name: str, value: Any) -> np.ndarray[Any, Any]:
    """An array in place of a file."""
    try:
        array = np.ma.asarray(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: {error}; expected numbers, or the path of a file") from None
    dims = {"edges": (1,), "frequencies": (1, 2), "window_polygon": (2,), "envelope_from": (1, 2, 3)}[name]
    if array.dtype.kind not in "fiu" or array.ndim not in dims or array.size == 0:
        raise ValueError(f"{name}: shape {array.shape} of {array.dtype}; expected numbers along {' or '.join(map(str, dims))} axes, or the path of a file")
    if np.ma.is_masked(array):
        raise ValueError(f"{name}: has masked values; expected none")
    numbers = np.asarray(array, dtype=float)
    bad = np.argwhere(~np.isfinite(numbers))
    if bad.size:
        raise ValueError(f"{name}{bad[0].tolist()}: {numbers[tuple(bad[0])]}; expected finite numbers")
    return numbers


def _spec(name: str, f: Any, dim: int | None) -> str:
    if isinstance(f, str):
        return f
    if hasattr(f, "spec"):
        return str(f.spec)
    if not callable(f):
        raise TypeError(f"{name}: a {type(f).__name__}; expected a specification such as 'disk', a function, or a list of these")
    if dim is None:
        raise ValueError(f"{name}: of a function the number of coordinates must be known; pairwave.tabulate(f, dim) makes what is taken here")
    from ._integrands import tabulated

    return tabulated(f, dim).spec


def request(given: Mapping[str, Any], dim: int | None = None) -> Request:
    """The request of keywords; those that are None are left out.

    Raises
    ------
    TypeError
        A keyword that is no setting.
    ValueError
        A value that cannot be, or that does not go with the others.
    """
    for name in given:
        if name not in ROWS:
            raise TypeError(f"{name!r} is no setting{_nearest(name)}; pairwave.settings() lists them")
    left_out = [name for name, value in given.items() if value is None or value is False and ROWS[name]["switch"]]
    pairs = [(name, _texts(name, value, dim)) for name, value in given.items() if name not in left_out]
    return Request([(name, texts) for name, texts in pairs if texts])


def _nearest(name: str) -> str:
    import difflib

    near = difflib.get_close_matches(name, ROWS, n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def settings() -> list[dict[str, Any]]:
    """Every setting: keyword, flag of the command line, help, default, choices.

    Returns
    -------
    list of dict
        With the keys ``name``, ``flag``, ``group``, ``help``, ``default``, ``otherwise`` (what it is where it is left out), ``choices``,
        ``switch`` (whether it is True or False) and ``repeated`` (whether it may be a list).

    Examples
    --------
    >>> import pairwave
    >>> next(row["help"] for row in pairwave.settings() if row["name"] == "r_max")
    'Largest distance'
    """
    return [dict(row) for row in ROWS.values()]


def call(function: str, given: Mapping[str, Any]) -> str:
    """The call as a person would write it."""

    def shown(value: Any) -> str:
        if isinstance(value, np.ndarray):
            return f"<array {value.shape}>"
        text = repr(value)
        return text if len(text) <= 200 else text[:200] + "..."

    words = [f"{name}={shown(value)}" for name, value in given.items() if value is not None]
    return f"pairwave.{function}({', '.join(words)})"
