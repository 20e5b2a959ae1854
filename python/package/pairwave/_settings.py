"""Keywords as settings: the text that the command line takes for each value."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from . import _files
from ._pairwave import Request, settings as _settings

ROWS: dict[str, dict[str, Any]] = {row["name"]: row for row in _settings()}

#: Keywords whose value may be an array in place of the path of a file.
_ARRAYS = {"edges": ".csv", "frequencies": ".csv", "window_polygon": ".csv", "envelope_from": ".npy"}


def _word(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    return str(value)


def _texts(name: str, value: Any, dim: int | None) -> list[str]:
    row = ROWS[name]
    if name in _ARRAYS and not isinstance(value, (str, os.PathLike)) and _is_numbers(value):
        return [_files.stored(np.asarray(value, dtype=float), name, _ARRAYS[name])]
    if name == "integrand" or name == "intensity":
        values = [value] if callable(value) or isinstance(value, str) or hasattr(value, "spec") else list(value)
        return [_spec(f, dim) for f in values]
    if name == "param" and isinstance(value, Mapping):
        return [f"{key}={_word(of)}" for key, of in value.items()]
    if isinstance(value, str) or not isinstance(value, Iterable):
        return [_word(value)]
    words = [_word(of) for of in value]
    return words if row["repeated"] else [",".join(words)]


def _is_numbers(value: Any) -> bool:
    try:
        return np.asarray(value).dtype.kind in "fiu"
    except ValueError:
        return False


def _spec(f: str | Callable[..., Any] | Any, dim: int | None) -> str:
    if isinstance(f, str):
        return f
    if hasattr(f, "spec"):
        return str(f.spec)
    if dim is None:
        raise ValueError("integrand: a function needs the number of coordinates; give points, or dim")
    from ._integrands import tabulate

    return tabulate(f, dim).spec


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
    pairs = [(name, _texts(name, value, dim)) for name, value in given.items() if value is not None and value is not False]
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
