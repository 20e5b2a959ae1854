"""Functions as integrands, and what is known of those that have names."""

from __future__ import annotations

import json
import re
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _files
from ._pairwave import integrands as _integrands
from ._settings import whole

#: Cells per axis of a function in 1, 2 and 3 dimensions.
_CELLS = {1: 1 << 16, 2: 1024, 3: 128}


@dataclass(frozen=True)
class Tabulated:
    """A function as values on equal cells, each the value at the cell's centre.

    Attributes
    ----------
    spec : str
        What the keyword ``integrand`` takes.
    cells : int
        Cells per axis.
    error : float
        Largest difference between the function at a corner of a cell and the value of the cell.
    integral_error : float
        Difference between the means over centres and over corners.
    """

    spec: str
    cells: int
    error: float
    integral_error: float


def tabulate(f: Callable[[np.ndarray[Any, Any]], Any], dim: int, cells: int | None = None) -> Tabulated:
    """A function of coordinates as an integrand.

    What is integrated, and what its Fourier coefficients and its autocorrelation are of, is the table: constant on each of ``cells**dim``
    equal cells. ``error`` says how far that is from the function.

    Parameters
    ----------
    f : callable
        Takes an array of shape (N, dim) with coordinates as fractions of the box, in [0, 1), and returns N numbers.
    dim : int
        1, 2 or 3.
    cells : int, optional
        Cells per axis: by default 65536 in 1D, 1024 in 2D, 128 in 3D.

    Returns
    -------
    Tabulated

    Raises
    ------
    ValueError
        A dimension or a number of cells that cannot be; values of another shape, or that are not finite.

    Examples
    --------
    >>> import pairwave
    >>> hill = pairwave.tabulate(lambda x: (x * (1 - x)).prod(axis=1), dim=2, cells=256)
    >>> hill.integral_error < 1e-5
    True
    """
    if dim not in _CELLS:
        raise ValueError(f"dim {dim}: expected 1, 2 or 3")
    cells = _CELLS[dim] if cells is None else whole("cells", cells)
    if cells < 2 or cells**dim > 1 << 26:
        raise ValueError(f"cells {cells}: expected at least 2, and at most 2^26 in all")
    centers = _values(f, dim, cells, 0.5)
    corners = _values(f, dim, cells, 0.0)
    name = re.sub(r"\W+", "_", str(getattr(f, "__name__", "function")), flags=re.ASCII).strip("_")[:40] or "function"
    path = _files.stored(centers, name, ".npy")
    return Tabulated(
        spec=f"table:file={path}",
        cells=cells,
        error=float(np.max(np.abs(corners - centers))),
        integral_error=float(abs(np.mean(corners) - np.mean(centers))),
    )


_known: weakref.WeakKeyDictionary[Any, dict[int, Tabulated]] = weakref.WeakKeyDictionary()


def tabulated(f: Callable[[np.ndarray[Any, Any]], Any], dim: int) -> Tabulated:
    """The same by default cells, once for each function."""
    try:
        known = _known.setdefault(f, {})
    except TypeError:
        return tabulate(f, dim)
    if dim not in known:
        known[dim] = tabulate(f, dim)
    return known[dim]


def _values(f: Callable[[np.ndarray[Any, Any]], Any], dim: int, cells: int, offset: float) -> np.ndarray[Any, Any]:
    along = (np.arange(cells) + offset) / cells
    places = np.stack(np.meshgrid(*[along] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    found = np.ma.asarray(f(places))
    if found.dtype.kind not in "fiub" or np.ma.is_masked(found):
        raise ValueError(f"integrand: the function returned {'masked values' if np.ma.is_masked(found) else found.dtype}; expected real numbers")
    values = np.asarray(found, dtype=float)
    if values.shape not in ((len(places),), (len(places), 1)):
        raise ValueError(f"integrand: the function returned shape {values.shape} for {places.shape}; expected ({len(places)},)")
    values = values.reshape(-1)
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        where = ", ".join(repr(float(x)) for x in places[bad[0]])
        raise ValueError(f"integrand: the function is {values[bad[0]]} at ({where}); expected finite values")
    return values.reshape((cells,) * dim)


def integrands(spec: str | None = None, dim: int | None = None) -> list[dict[str, Any]]:
    """What there is to know about integrands that have names.

    Parameters
    ----------
    spec : str, optional
        One of them, ``NAME`` or ``NAME:key=value,...``: its integral, that of its square and its variance are in ``values`` then.
    dim : int, optional
        The dimension of that one, by default 2.

    Returns
    -------
    list of dict

    Examples
    --------
    >>> import pairwave
    >>> round(pairwave.integrands("disk:r=0.25")[0]["values"]["integral"], 6)
    0.19635
    """
    found: list[dict[str, Any]] = json.loads(_integrands(spec, dim))
    return found
