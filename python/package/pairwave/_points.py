"""Whatever holds points, as arrays of shape (n, d)."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Sequence
from typing import Any, TypedDict

import numpy as np

#: Most numbers per point.
_MOST = 3


class Sets(TypedDict):
    """Realizations with their marks, as the Rust part takes them."""

    coordinates: list[np.ndarray[Any, Any]]
    digits: int | None
    weights: list[list[float]]
    labels: list[list[str]]
    columns: list[str]
    unused: list[str]
    first: int


def are_files(points: Any) -> bool:
    """Whether points are named, not given."""
    if isinstance(points, (str, os.PathLike)):
        return True
    return isinstance(points, (list, tuple)) and len(points) > 0 and all(isinstance(p, (str, os.PathLike)) for p in points)


def arrays(points: Any, columns: Sequence[str | int] | None = None) -> tuple[list[np.ndarray[Any, Any]], int | None]:
    """The realizations of points, and the binary digits of their numbers.

    Raises
    ------
    TypeError, ValueError
        What is no array of numbers with one row per point.
    """
    if hasattr(points, "columns") and hasattr(points, "to_numpy"):
        return _of_frames([points], columns)
    if isinstance(points, (list, tuple)) and points and all(hasattr(p, "columns") and hasattr(p, "to_numpy") for p in points):
        return _of_frames(points, columns)
    if isinstance(points, (list, tuple)) and points and all(isinstance(p, np.ndarray) and p.ndim in (1, 2) for p in points):
        # A list of arrays is one of realizations, but for points that are arrays themselves.
        if any(p.ndim == 2 for p in points):
            made = [_plane(p, f"realization {k}", columns) for k, p in enumerate(points)]
            return [array for array, _ in made], min((digits for _, digits in made if digits), default=None)
    if not isinstance(points, (np.ndarray, list, tuple)) and not hasattr(points, "__array__"):
        if isinstance(points, Iterable):
            return arrays(list(points), columns)
        raise TypeError(f"points: a {type(points).__name__}; expected arrays, files or a data frame")
    if hasattr(points, "toarray"):
        raise TypeError(f"points: a {type(points).__name__}, which is sparse; expected an array of coordinates")
    try:
        whole = np.ma.asarray(points)
    except (NotImplementedError, ValueError) as error:
        raise ValueError(f"points: {error}; expected (n, d), (K, n, d) or a list of arrays (n_k, d)") from None
    if whole.size == 0:
        raise ValueError(f"points: there are none (shape {whole.shape}); expected (n, d), (K, n, d) or a list of arrays (n_k, d)")
    if whole.ndim == 0:
        raise ValueError(f"points: {points!r} is one number; expected (n, d), (K, n, d) or a list of arrays (n_k, d)")
    if whole.ndim == 3:
        made = [_plane(whole, "", columns)]
        return list(made[0][0]), made[0][1]
    array, digits = _plane(whole, "", columns)
    return [array], digits


def _of_frames(frames: Sequence[Any], columns: Sequence[str | int] | None) -> tuple[list[np.ndarray[Any, Any]], int | None]:
    def of(frame: Any) -> np.ndarray[Any, Any]:
        return np.asarray(frame[_coordinates(list(frame.columns), columns)].to_numpy())

    made = [_plane(of(frame), f"realization {k}", None) for k, frame in enumerate(frames)]
    return [array for array, _ in made], made[0][1]


def _plane(array: np.ndarray[Any, Any], name: str, columns: Sequence[str | int] | None) -> tuple[np.ndarray[Any, Any], int | None]:
    """An array of float64 or float32 whose last axis has the coordinates."""
    place = f"points{', ' + name if name else ''}"
    if np.ma.is_masked(array):
        raise ValueError(f"{place}: has masked values; expected an array without, as array[~mask.any(axis=1)]")
    array = np.asarray(array)
    if array.dtype.kind == "O":
        raise TypeError(f"{place}: an array of objects; expected numbers, all realizations of a (K, n, d) array with equally many points")
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{place}: an array of {array.dtype}; expected real numbers")
    if array.ndim == 1:
        # Along a line.
        array = array.reshape(-1, 1)
    if array.ndim > 3:
        raise ValueError(f"{place}: shape {array.shape}; expected (n, d) or (K, n, d)")
    if columns is not None:
        array = array[..., [_position(c, array.shape[-1]) for c in columns]]
    if not 1 <= array.shape[-1] <= _MOST:
        raise ValueError(f"{place}: {array.shape[-1]} coordinates per point (shape {array.shape}); expected 1 to 3, the last axis")
    digits = {np.dtype(np.float32): 24, np.dtype(np.float16): 11}.get(array.dtype.newbyteorder("="))
    if array.dtype not in (np.dtype(np.float64), np.dtype(np.float32)):
        array = array.astype(np.float64)
    # What came out of a message may begin anywhere.
    return array if array.flags.aligned else array.copy(), digits


def _position(column: str | int, width: int) -> int:
    try:
        position = int(column) if isinstance(column, str) else operator.index(column)
    except (TypeError, ValueError):
        raise ValueError(f"columns {column}: an array has no names; expected numbers from 1 to {width}") from None
    if not 1 <= position <= width:
        raise ValueError(f"columns {column}: expected numbers from 1 to {width}")
    return position - 1


def marks(of: Any, sizes: Sequence[int], name: str) -> list[np.ndarray[Any, Any]]:
    """One mark per point: an array for all realizations, or one for each."""
    if isinstance(of, (list, tuple)) and len(of) == len(sizes) and all(isinstance(x, (np.ndarray, list, tuple)) for x in of):
        each = [np.ma.asarray(x) if isinstance(x, np.ma.MaskedArray) else np.asarray(x) for x in of]
    else:
        whole = of if isinstance(of, np.ma.MaskedArray) else np.asarray(of)
        if whole.ndim == 2 and whole.shape[0] == len(sizes):
            each = list(whole)
        elif whole.ndim == 1 and len(sizes) == 1:
            each = [whole]
        elif whole.ndim == 1 and len(whole) == sum(sizes):
            each = np.split(whole, np.cumsum(sizes)[:-1])
        else:
            raise ValueError(f"{name}: shape {whole.shape}; expected one per point, {sum(sizes)} in all")
    for k, (mark, n) in enumerate(zip(each, sizes)):
        if np.ma.is_masked(mark):
            raise ValueError(f"{name}, realization {k}: has masked values; expected one for each point")
        if mark.shape != (n,):
            raise ValueError(f"{name}, realization {k}: shape {mark.shape}; expected ({n},), one per point")
    return each


def _label(k: int, j: int, label: Any) -> str:
    if label is None or label != label:
        raise ValueError(f"classes, realization {k}, point {j}: {label}; expected a class for each point")
    return str(label)


def sets(
    points: Any,
    columns: Sequence[str | int] | None = None,
    weights: Any = None,
    classes: Any = None,
    first: int = 0,
    names: tuple[list[str], list[str]] = ([], []),
) -> Sets:
    """Points with their marks; `names` of columns that were taken and that were not."""
    coordinates, digits = arrays(points, columns)
    sizes = [len(array) for array in coordinates]
    of_weights: list[list[float]] = []
    labels: list[list[str]] = []
    if weights is not None:
        for k, mark in enumerate(marks(weights, sizes, "weights")):
            if mark.dtype.kind not in "fiub":
                raise TypeError(f"weights, realization {k}: an array of {mark.dtype}; expected numbers")
            values = mark.astype(float)
            bad = np.flatnonzero(~np.isfinite(values))
            if bad.size:
                raise ValueError(f"weights, realization {k}, point {bad[0]}: {values[bad[0]]}; expected finite numbers")
            of_weights.append(values.tolist())
    if classes is not None:
        labels = [[_label(k, j, label) for j, label in enumerate(mark.tolist())] for k, mark in enumerate(marks(classes, sizes, "classes"))]
    return Sets(
        coordinates=coordinates, digits=digits, weights=of_weights, labels=labels, columns=names[0], unused=names[1], first=first
    )


class Frames(TypedDict, total=False):
    """What a data frame holds besides coordinates."""

    weights: list[np.ndarray[Any, Any]]
    intensities: list[np.ndarray[Any, Any]]
    classes: list[np.ndarray[Any, Any]]
    names: tuple[list[str], list[str]]


def frames(points: Any, given: dict[str, Any]) -> tuple[Any, Frames]:
    """A data frame as its realizations and the marks that keywords name columns of; what they say is taken out of `given`."""
    if not (hasattr(points, "columns") and hasattr(points, "to_numpy")):
        for name in ("weight_column", "intensity_column", "class_column", "realization_column"):
            if given.get(name) is not None:
                raise ValueError(f"{name} {given[name]}: names a column of files or of a data frame; arrays have {_keyword(name)}")
        return points, {}
    names = {str(name): name for name in points.columns}

    def column(keyword: str) -> Any:
        name = given.pop(keyword, None)
        if name is not None and str(name) not in names:
            raise ValueError(f"{keyword} {name}: is no column of the data frame; it has {', '.join(names)}")
        return None if name is None else names[str(name)]

    realization = column("realization_column")
    if realization is not None and points[realization].isna().any():
        row = int(points[realization].isna().to_numpy().argmax())
        raise ValueError(f"realization_column {realization}: row {row} has none; expected one for each point")
    parts = [points] if realization is None else [part for _, part in points.groupby(realization, sort=False)]
    found: Frames = {}
    used = [] if realization is None else [realization]
    if (name := column("weight_column")) is not None:
        used.append(name)
        found["weights"] = [part[name].to_numpy() for part in parts]
    if (name := column("intensity_column")) is not None:
        used.append(name)
        found["intensities"] = [part[name].to_numpy() for part in parts]
    if (name := column("class_column")) is not None:
        used.append(name)
        found["classes"] = [part[name].to_numpy() for part in parts]
    asked = given.pop("columns", None)
    taken = _coordinates(list(points.columns), asked, used)
    found["names"] = ([str(name) for name in taken], [str(name) for name in points.columns if name not in taken and name not in used])
    return [np.asarray(part[taken].to_numpy()) for part in parts], found


def _named(names: list[Any], column: Any) -> Any:
    """A column of a data frame by its name, else by its number from 1."""
    if not isinstance(column, (bool, float)) and column in names:
        return column
    number = int(column) if str(column).isdigit() else 0
    if not 1 <= number <= len(names):
        raise ValueError(f"columns {column}: is no column of the data frame, nor a number from 1; it has {', '.join(map(str, names))}")
    return names[number - 1]


def _coordinates(names: list[Any], asked: Sequence[str | int] | str | None, used: Sequence[Any] = ()) -> list[Any]:
    """The columns of a data frame that hold coordinates."""
    if isinstance(asked, str):
        asked = [name.strip() for name in asked.split(",")]
    if asked is not None:
        return [_named(names, c) for c in asked]
    low = {str(name).lower(): name for name in names}
    axes = [low[axis] for axis in ("x", "y", "z") if axis in low]
    rest = [name for name in names if name not in used]
    if not axes and len(rest) > _MOST:
        raise ValueError(f"points: a data frame with columns {', '.join(map(str, names))}; columns names those of coordinates")
    return axes or rest


def _keyword(name: str) -> str:
    return {"weight_column": "weights", "intensity_column": "intensities", "class_column": "classes"}.get(
        name, "one array per realization"
    )


