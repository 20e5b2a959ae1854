"""Samplers."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from . import _pairwave
from ._settings import whole


def sample(
    name: str,
    n: int,
    k: int | None = None,
    *,
    dim: int = 2,
    seed: int = 1,
    param: Mapping[str, Any] | Sequence[str] = (),
    nearest: bool = False,
    threads: int | None = None,
) -> Any:
    """Points of a sampler on the unit torus.

    The same arguments draw the same points on every machine, and the same as ``pairwave sample``.

    Parameters
    ----------
    name : str
        As :func:`samplers` lists them.
    n : int
        Points; where their number is drawn, its expectation.
    k : int, optional
        Realizations; without it one, as an array (n, d).
    dim : int
        Dimension: 1 to 3, of some samplers up to 16.
    seed : int
        Seed.
    param : mapping or list of str
        Parameters of the sampler.
    nearest : bool
        Take the nearest number of points that the sampler can make.
    threads : int, optional
        Threads; the points do not depend on them.

    Returns
    -------
    numpy.ndarray of shape (n, d) or (k, n, d), or a list of arrays where n is drawn

    Raises
    ------
    ValueError
        A name, number or parameter that cannot be.

    Examples
    --------
    >>> import pairwave
    >>> pairwave.sample("jittered", 16, 3).shape
    (3, 16, 2)
    """
    words = [f"{key}={of}" for key, of in param.items()] if isinstance(param, Mapping) else list(param)
    given = {"n": n, "k": 1 if k is None else k, "dim": dim, "seed": seed}
    for label, value in given.items():
        if not 0 <= whole(label, value) < 1 << 64:
            raise ValueError(f"{label} {value}: expected a number from 0 to 2^64 - 1")
    n = _pairwave.nearest_size(name, n, dim) if nearest else n
    found = _pairwave.sample(name, n, given["k"], dim, seed, words, threads)
    if k is None:
        return found[0]
    if found and all(array.shape == found[0].shape for array in found) and samplers(name)[0]["fixed_n"]:
        return np.stack(found)
    return found


def samplers(name: str | None = None) -> list[dict[str, Any]]:
    """What there is to know about samplers: names, parameters, numbers of points, sources, formulas.

    Parameters
    ----------
    name : str, optional
        One of them.

    Returns
    -------
    list of dict

    Examples
    --------
    >>> import pairwave
    >>> "jittered" in [sampler["name"] for sampler in pairwave.samplers()]
    True
    """
    found: list[dict[str, Any]] = json.loads(_pairwave.samplers(name))
    return found


def devices() -> list[dict[str, str]]:
    """What can compute here.

    Returns
    -------
    list of dict
        With ``device`` (what the keyword of that name takes), ``name``, and ``verdict``: what a self-check found.
    """
    return [{"device": device, "name": name, "verdict": verdict} for device, name, verdict in _pairwave.devices()]
