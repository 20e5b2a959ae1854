"""Measuring points: one call, one result."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from . import _pairwave
from ._points import are_files, frames, sets
from ._progress import Progress, told
from ._result import Found, Result
from ._settings import call, request, whole


def prepared(
    points: Any,
    given: dict[str, Any],
    weights: Any = None,
    classes: Any = None,
    intensities: Any = None,
    integrals_alone: bool = False,
) -> tuple[_pairwave.Request, _pairwave.Points]:
    """The request of keywords, and its points."""
    given = {name: value for name, value in given.items() if value is not None}
    if points is None or are_files(points):
        marks = ((weights, "weights", "weight_column"), (classes, "classes", "class_column"), (intensities, "intensities", "intensity_column"))
        for value, name, column in marks:
            if value is not None:
                raise ValueError(f"{name}: are of points that are arrays; files have columns of them ({column})")
        if points is not None:
            files = [points] if isinstance(points, (str, os.PathLike)) else list(points)
            given["files"] = [os.fspath(file) for file in files]
        asked = request(given, _dim_of(given))
        asked = asked.integrals_alone() if integrals_alone else asked
        return asked, _pairwave.Points.open(asked)
    apart = given.get("realization_column")
    points, of = frames(points, given)
    for value, name, column in ((weights, "weights", "weight_column"), (classes, "classes", "class_column"), (intensities, "intensities", "intensity_column")):
        if value is not None and name in of:
            raise ValueError(f"{name}: cannot be used with {column}, which names them too")
        if value is not None and apart is not None:
            raise ValueError(f"{name}: cannot be used with realization_column, which sorts points anew; expected {column}")
    weights, classes = of.get("weights", weights), of.get("classes", classes)
    intensities = of.get("intensities", intensities)
    if weights is not None and intensities is not None:
        raise ValueError("weights: cannot be used with intensities, whose inverses are weights")
    columns = given.pop("columns", None)
    if isinstance(columns, str):
        columns = [c.strip() for c in columns.split(",")]
    elif columns is not None and not isinstance(columns, Sequence):
        columns = [columns]
    held = sets(points, columns, weights if intensities is None else intensities, classes, names=of.get("names", ([], [])))
    if weights is not None:
        given["weight_column"] = "weights"
    if intensities is not None:
        given["intensity_column"] = "intensities"
    if classes is not None:
        given["class_column"] = "classes"
    asked = request(given, held["coordinates"][0].shape[-1])
    asked = asked.integrals_alone() if integrals_alone else asked
    return asked, _pairwave.Points.held(asked, held)


def _dim_of(given: Mapping[str, Any]) -> int | None:
    if "dim" in given:
        return whole("dim", given["dim"])
    if "sampler" in given:
        return 2
    for name, of in (("box", 1), ("window", 2)):
        if name in given and isinstance(given[name], Sequence) and not isinstance(given[name], str):
            return len(given[name]) // of
    return None


def _measured(
    function: str,
    points: Any,
    marks: Mapping[str, Any],
    progress: bool | Progress | None,
    given: dict[str, Any],
    main: str | None = None,
    integrals_alone: bool = False,
) -> Result:
    command = call(function, {"points": points, **marks, **given})
    until = given.pop("until_error", None) or []
    limit = given.pop("time_limit", None)
    asked, opened = prepared(points, given, integrals_alone=integrals_alone, **marks)
    sums = _pairwave.Measurement(asked, opened)
    until = [until] if isinstance(until, str) else list(until) if isinstance(until, (list, tuple)) else [until]
    if not all(isinstance(target, str) for target in until):
        raise TypeError(f"until_error {until!r}: expected texts such as 'pcf@0.05:0.01'")
    if limit is not None and not isinstance(limit, (int, float)):
        raise TypeError(f"time_limit {limit!r}: expected a number of seconds")
    with told(progress) as tell:
        found = sums.finish(command, tell, until, limit)
        return Result(found, sums, main)


def measure(
    points: Any = None,
    *,
    weights: Any = None,
    classes: Any = None,
    intensities: Any = None,
    progress: bool | Progress | None = None,
    **settings: Any,
) -> Result:
    """Measures points: everything that is asked for, in one pass.

    Parameters
    ----------
    points : array_like, data frame, path or list of these, optional
        One realization of shape (n, d), several of equal n of shape (K, n, d), or a list of arrays (n_k, d), which together are one batch;
        a data frame with columns x, y, z (or ``columns=``); what yields such arrays, which are then all held; files as the command line reads them. Without points a ``sampler`` draws them.
        Coordinates are in the unit of the domain, by default the unit torus.
    weights, classes, intensities : array_like, optional
        One per point: weights of P (and of g and K, where none is below 0), class labels, or the intensity at each point, by whose
        inverse it is weighted.
    progress : bool or callable, optional
        True for a bar (by tqdm, where that is installed), or what is called with the stage, realizations done, how many there are, and
        the part of the work that is done.
    **settings
        Every setting of ``pairwave analyze``, with ``_`` for ``-``: ``stats``, ``r_max``, ``bins``, ``box``, ``window``,
        ``max_frequency``, ``device``, ``accuracy``, ... :func:`settings` lists them. ``edges``, ``frequencies`` and ``window_polygon``
        take arrays as well as files, ``integrand`` also functions (see :func:`tabulate`). Beside them ``until_error`` (as
        ``"pcf@0.05:0.01"``: ends when g there is known to that error) and ``time_limit`` (seconds), as of the command line.

    Returns
    -------
    Result

    Raises
    ------
    ValueError
        A value that cannot be, by its keyword; points outside the domain, by their place.
    TypeError
        A keyword that is none, what is no array of numbers.
    OSError
        A file that cannot be read.
    DeviceError
        A device that is not there, or failed.
    KeyboardInterrupt
        After Ctrl-C, at once.

    Notes
    -----
    The definitions are those of the program: pairs are ordered, bins half-open, ``P(m) = |sum_j exp(-2 pi i m.x_j / L)|^2 / n`` with the
    integer wave vector m in cycles per side (of several realizations the mean of the squares over the mean of n); DC is not removed.
    See docs/conventions.md.

    Examples
    --------
    >>> import numpy, pairwave
    >>> points = numpy.random.default_rng(1).random((20, 256, 2))
    >>> found = pairwave.measure(points, stats=["pcf", "spectrum"], r_max=0.2, bins=10)
    >>> found.pcf.g.shape, found.spectrum.shape[0] % 2
    ((10,), 1)
    >>> bool(abs(found.pcf.g[5] - 1) < 5 * found.pcf.g_se[5])
    True
    """
    return _measured("measure", points, {"weights": weights, "classes": classes, "intensities": intensities}, progress, settings)


def _of_one(
    function: str,
    statistics: str,
    main: str,
    points: Any,
    weights: Any,
    classes: Any,
    intensities: Any,
    progress: bool | Progress | None,
    settings: dict[str, Any],
) -> Result:
    if "stats" in settings:
        raise TypeError(f"{function} takes no stats; measure(points, stats=...) measures several at once")
    marks = {"weights": weights, "classes": classes, "intensities": intensities}
    return _measured(function, points, marks, progress, {"stats": statistics, **settings}, main)


def pair_correlation(
    points: Any = None,
    *,
    weights: Any = None,
    classes: Any = None,
    intensities: Any = None,
    progress: bool | Progress | None = None,
    **settings: Any,
) -> Result:
    """The pair correlation function g(r).

    Parameters and errors are those of :func:`measure`; of use here are ``r_max``, ``bins``, ``edges``, ``kernel``, ``correction``.

    Returns
    -------
    Result
        With the columns of ``pcf``: ``r`` (middle of the bin, in the unit of the domain), ``r_lo``, ``r_hi``, ``count`` (ordered pairs, exact), ``g``
        (1 for random points) and ``g_se``.

    References
    ----------
    Illian, Penttinen, Stoyan & Stoyan (2008), Statistical Analysis and Modelling of Spatial Point Patterns, 4.3.

    Examples
    --------
    >>> import pairwave
    >>> found = pairwave.pair_correlation(sampler="jittered", n=256, k=20, bins=16)
    >>> bool(found.g[0] < 0.5 < found.g[-1])
    True
    """
    return _of_one("pair_correlation", "pcf", "pcf", points, weights, classes, intensities, progress, settings)


def k_function(
    points: Any = None,
    *,
    weights: Any = None,
    classes: Any = None,
    intensities: Any = None,
    progress: bool | Progress | None = None,
    **settings: Any,
) -> Result:
    """Ripley's K(r), and Besag's L(r) - r.

    Parameters and errors are those of :func:`measure`.

    Returns
    -------
    Result
        With the columns of ``k_function``: ``r``, ``k`` (in the unit of the domain to the power of its dimension), ``k_se``, ``l``, ``l_se``,
        ``l_minus_r`` and others.

    References
    ----------
    Ripley (1977), J. R. Stat. Soc. B 39; Besag (1977), ibid.

    Examples
    --------
    >>> import pairwave
    >>> found = pairwave.k_function(sampler="random", n=256, k=8, bins=8)
    >>> len(found.k) == len(found.r)
    True
    """
    return _of_one("k_function", "k-function", "k_function", points, weights, classes, intensities, progress, settings)


def power_spectrum(
    points: Any = None,
    *,
    weights: Any = None,
    progress: bool | Progress | None = None,
    **settings: Any,
) -> Result:
    """The power spectrum P(m), with its radial mean and anisotropy.

    Parameters and errors are those of :func:`measure`; of use here are ``max_frequency``, ``frequencies``, ``accuracy``, ``taper``.

    Returns
    -------
    Result
        With P on the grid as ``spectrum``, of shape (2F+1,) * d, index ``m + F`` along each axis, and the columns of ``spectrum_radial``: ``nu``
        (cycles per unit length), ``p`` (1 for random points), ``p_se``, ``anisotropy_db`` and others.

    References
    ----------
    Ulichney (1987), Digital Halftoning; Lagae & Dutré (2008), Comput. Graph. Forum 27(1).

    Examples
    --------
    >>> import pairwave
    >>> found = pairwave.power_spectrum(sampler="jittered", n=64, k=20, max_frequency=8)
    >>> found.spectrum.shape, float(found.spectrum[8, 8])
    ((17, 17), 64.0)
    """
    return _of_one("power_spectrum", "spectrum", "spectrum_radial", points, weights, None, None, progress, settings)


def neighbors(
    points: Any = None, *, classes: Any = None, progress: bool | Progress | None = None, **settings: Any
) -> Result:
    """Distances to nearest neighbours, and the functions G, F and J.

    Parameters and errors are those of :func:`measure`.

    Returns
    -------
    Result
        With the columns of ``neighbor_functions``: ``r``, ``g_function``, ``f_function``, ``j_function`` with errors; scalars such as the mean
        distance are in ``summary``.

    References
    ----------
    Clark & Evans (1954), Ecology 35; van Lieshout & Baddeley (1996), Stat. Neerl. 50.

    Examples
    --------
    >>> import pairwave
    >>> found = pairwave.neighbors(sampler="random", n=100, k=4)
    >>> bool((found.g_function >= 0).all())
    True
    """
    return _of_one("neighbors", "neighbors", "neighbor_functions", points, None, classes, None, progress, settings)


def intensity(points: Any = None, *, progress: bool | Progress | None = None, **settings: Any) -> Result:
    """The intensity on a grid, by a Gaussian kernel.

    Parameters and errors are those of :func:`measure`; of use here are ``intensity_grid`` and ``intensity_bandwidth``.

    Returns
    -------
    Result
        With the arrays ``intensity`` (points per unit of measure) and, of several realizations, ``intensity_se``.

    References
    ----------
    Diggle (1985), J. R. Stat. Soc. C 34.

    Examples
    --------
    >>> import pairwave
    >>> pairwave.intensity(sampler="random", n=500, k=4, intensity_grid=16)["intensity"].shape
    (16, 16)
    """
    return _of_one("intensity", "intensity", "intensity", points, None, None, None, progress, settings)


def integrate(
    points: Any = None,
    *,
    integrand: Any = None,
    p: str | os.PathLike[str] | None = None,
    weights: Any = None,
    intensities: Any = None,
    progress: bool | Progress | None = None,
    **settings: Any,
) -> Result | Found:
    """Bias and variance of Monte Carlo integration, predicted and observed.

    Parameters
    ----------
    points : optional
        As for :func:`measure`.
    integrand : str, callable, Tabulated or list of these
        What is integrated: ``NAME`` or ``NAME:key=value,...`` as :func:`integrands` lists them, or functions of an array of shape (N, d)
        with coordinates as fractions of the box, see :func:`tabulate`.
    p : str or path, optional
        Predict without points: from the spectrum of a result, by its directory, or from a sampler's formula.
    weights, intensities, progress, **settings
        As for :func:`measure`; of use here are ``estimator``, ``shifts``, ``spatial``, ``top``, ``by``, and ``intensity`` (the density that
        points are placed by).

    Returns
    -------
    Result, or Found with ``p``
        With the columns of ``variance``, a row per integrand: variances are in the unit of f squared.

    References
    ----------
    Pilleboue, Singh, Coeurjolly, Kazhdan & Ostromoukhov (2015), ACM Trans. Graph. 34(4); Öztireli (2016), ACM Trans. Graph. 35(4).

    Raises
    ------
    ValueError, TypeError, OSError, DeviceError, KeyboardInterrupt
        As for :func:`measure`.

    Examples
    --------
    >>> import pairwave
    >>> found = pairwave.integrate(sampler="jittered", n=64, k=50, integrand="disk")
    >>> bool(0 < found.var_spectral[0] < found.var_random[0])
    True
    """
    if integrand is None:
        raise ValueError("integrand (none): expected one such as 'disk', or a function; pairwave.integrands() lists them")
    given = {"integrand": integrand, **settings}
    if p is not None:
        if points is not None or weights is not None or intensities is not None:
            raise ValueError("p: predicts without points; expected none beside it")
        asked = request(given, _dim_of({"sampler": "", **settings}))
        return Found(_pairwave.predict(os.fspath(p), asked.integrals_alone()), call("integrate", {"p": p, **given}))
    alone = settings.get("stats") is None
    return _measured("integrate", points, {"weights": weights, "intensities": intensities}, progress, given, "variance", alone)


def explain(points: Any = None, *, weights: Any = None, classes: Any = None, intensities: Any = None, **settings: Any) -> str:
    """The plan of a measurement with its cost; nothing is measured.

    Parameters are those of :func:`measure`.

    Returns
    -------
    str
    """
    for name in ("until_error", "time_limit"):
        settings.pop(name, None)
    return _pairwave.Measurement.explain(*prepared(points, settings, weights, classes, intensities))


def convergence(
    points: Sequence[str | os.PathLike[str]] | str | None = None,
    *,
    sampler: str | Sequence[str] | None = None,
    n: str | Sequence[int] | None = None,
    prefixes: str | Sequence[int] | None = None,
    progress: bool | Progress | None = None,
    **settings: Any,
) -> Found:
    """The variance of integrals against the number of points, with fitted slopes.

    Parameters
    ----------
    points : path or list of paths, optional
        A file or folder per number of points, or files for ``prefixes``.
    sampler : str or list of str, optional
        ``NAME`` or ``NAME:key=value,...``.
    n : str or list of int, optional
        Numbers of points of samplers, ``"2^4..2^12"`` (doubled) or a list.
    prefixes : str or list of int, optional
        Of the realizations in the files the first so many points.
    **settings
        ``integrand`` (needed), ``k``, ``dim``, ``seed``, ``param``, ``estimator``, ``shifts``, ``device``, ...

    Returns
    -------
    Found
        With the tables ``convergence``, ``slopes`` and ``ranks``.

    Examples
    --------
    >>> import pairwave
    >>> found = pairwave.convergence(sampler=["random", "jittered"], n=[16, 64, 256], k=20, integrand="disk")
    >>> sorted(set(found.slopes.subject))
    ['jittered', 'random']
    """
    command = call("convergence", {"points": points, "sampler": sampler, "n": n, "prefixes": prefixes, **settings})
    given = dict(settings)
    if points is not None:
        files = [points] if isinstance(points, (str, os.PathLike)) else list(points)
        given["files"] = [os.fspath(file) for file in files]
    samplers = [] if sampler is None else [sampler] if isinstance(sampler, str) else list(sampler)
    if bool(samplers) == (points is not None):
        raise ValueError("convergence: expected either points (files) or sampler")
    if samplers and n is None:
        raise ValueError("n (none): sampler needs numbers of points such as '2^4..2^10'")

    asked = request(given, _dim_of({"sampler": "", **settings}))
    with told(progress) as tell:
        return Found(_pairwave.convergence(asked, samplers, _listed("n", n), _listed("prefixes", prefixes), tell), command)


def _listed(name: str, numbers: str | int | Sequence[int] | None) -> str | None:
    """Numbers of points as they are typed."""
    if numbers is None or isinstance(numbers, str):
        return numbers
    many = numbers if isinstance(numbers, Sequence) else [numbers]
    return ",".join(str(whole(name, number)) for number in many)


def survey(
    points: Any = None,
    *,
    prefixes: str | Sequence[int] | None = None,
    progress: bool | Progress | None = None,
    **settings: Any,
) -> Found:
    """Every pair of axes of points with 2 to 16 coordinates, or the first points of every realization.

    Parameters
    ----------
    points : path or list of paths, optional
        Files; without them a ``sampler`` draws points.
    prefixes : str or list of int, optional
        Numbers of points, ``"2^4..2^12"`` or a list; without them pairs of axes are measured.

    Returns
    -------
    Found
        With the tables ``projections`` or ``prefixes`` and those of g and P.
    """
    command = call("survey", {"points": points, "prefixes": prefixes, **settings})
    given = dict(settings)
    if points is not None:
        if not are_files(points):
            raise TypeError("points: arrays are not taken here; expected files or a sampler")
        given["files"] = [points] if isinstance(points, (str, os.PathLike)) else list(points)
    with told(progress) as tell:
        return Found(_pairwave.survey(request(given), _listed("prefixes", prefixes), tell), command)


def compare(*results: str | os.PathLike[str] | Result, alpha: float = 0.01) -> Found:
    """Whether results differ by more than chance from the first of them.

    Parameters
    ----------
    *results : path or Result
        Directories of results, or results, two or more.
    alpha : float
        Level of significance of the test over everything.

    Returns
    -------
    Found
        With ``differ`` and the table ``comparison`` of all values.

    Examples
    --------
    >>> import pairwave
    >>> one, other = (pairwave.measure(sampler=s, n=64, k=20, stats="pcf", bins=8) for s in ("random", "jittered"))
    >>> pairwave.compare(one, other).differ
    True
    """
    import tempfile

    # As long as what is found, which reads them again where it is saved.
    room = tempfile.TemporaryDirectory(prefix="pairwave-")
    dirs = []
    for k, result in enumerate(results):
        if isinstance(result, Result):
            dirs.append(os.path.join(room.name, f"result-{k + 1}"))
            result.save(dirs[-1])
        else:
            dirs.append(os.fspath(result))
    if not isinstance(alpha, (int, float)):
        raise TypeError(f"alpha {alpha!r}: expected a number")
    command = f"pairwave.compare({', '.join(map(repr, map(str, dirs)))})"
    return Found(_pairwave.compare(dirs, float(alpha)), command, room)
