"""Sums that grow: realizations are added as they come, elsewhere too, and merged."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from . import _pairwave
from ._points import Sets, sets
from ._progress import Progress, told
from ._result import Result
from ._settings import call, request

#: Realizations whose sums are one step of every sum: parts begin at multiples of it.
LEAF = 16
#: Coordinates that wait until they are measured together, 8 MiB of them.
_WAITING = 1 << 20
#: Realizations that a measurement is planned for where nobody says how many there will be.
_MANY = 1 << 20


class Measurement:
    """The raw sums of realizations that are added as they come.

    What is found in the end is, to the bit, what one call of :func:`measure` finds of all of them, whatever came when, in whatever order
    parts of it were merged: counts are integers, and other sums are added in a fixed order. Where the plan depends on how many there are
    (nearest neighbours, counts, intensity, covariance, integrals), that holds with ``k`` alone.

    Parameters
    ----------
    k : int, optional
        Realizations that there will be. The probes of nearest-neighbour functions, the balls of counts and some ways of summing follow from
        that number; by default it is thought to be large (at most 2^20 can be added then).
    first : int
        The number of the first realization that is added: a multiple of 16, where several are measured apart and merged.
    mean_points : float, optional
        Points per realization, about: the defaults of ``r_max`` and ``max_frequency`` follow from it. By default the mean of what is
        added first, which parts that are to be merged must agree on.
    **settings
        As for :func:`measure`. Weights and classes are relative to all realizations, and are taken only by :func:`measure`.

    Raises
    ------
    ValueError, TypeError
        As for :func:`measure`.

    Examples
    --------
    >>> import numpy, pairwave
    >>> random = numpy.random.default_rng(1)
    >>> sums = pairwave.Measurement(stats="pcf", bins=8, r_max=0.2)
    >>> for _ in range(40):
    ...     sums.add(random.random((100, 2)))
    >>> sums.realizations
    40
    >>> int(sums.result().pcf.count.sum()) > 0
    True
    """

    def __init__(self, *, k: int | None = None, first: int = 0, mean_points: float | None = None, **settings: Any) -> None:
        if k is not None and k < 1:
            raise ValueError(f"k {k}: expected 1 realization or more")
        if first < 0 or first % LEAF:
            raise ValueError(f"first {first}: expected a multiple of {LEAF}")
        for name in ("sampler", "files", "n", "weight_column", "intensity_column", "class_column", "inhomogeneous", "envelope"):
            if settings.get(name) is not None:
                raise ValueError(f"{name}: is of all realizations at once, and here they are added; measure() takes it")
        self._settings = settings
        self._total = _MANY if k is None else int(k)
        self._first = first
        self._mean = None if mean_points is None else float(mean_points)
        self._most = 0
        self._sums: _pairwave.Measurement | None = None
        self._waiting: list[np.ndarray[Any, Any]] = []
        self._digits: int | None = None
        self._done = 0
        # What is wrong with settings is said here, not at the first points.
        if not any(callable(value) for value in settings.values()):
            request(settings, 2)

    def add(self, points: Any, *, progress: bool | Progress | None = None) -> None:
        """Adds realizations: an array (n, d) or (K, n, d), a list of arrays, a data frame, or what yields these one after the other.

        What is wrong with them is said here, and nothing of them is added then; of what is yielded, what came before is. After Ctrl-C what
        was added stays, and is measured later.
        """
        if hasattr(points, "__next__"):
            for one in points:
                self.add(one, progress=progress)
            return
        given = sets(points)
        if self._dim and given["coordinates"][0].shape[-1] != self._dim:
            raise ValueError(f"points: {given['coordinates'][0].shape[-1]} coordinates; those before have {self._dim}")
        if self._at + len(self._waiting) + len(given["coordinates"]) > self._total:
            raise ValueError(f"k {self._total}: no more realizations can be added; expected k to be as many as there are")
        self._check(given)
        self._dim = given["coordinates"][0].shape[-1]
        if self._mean is None:
            self._mean = _pairwave.sizes_of([len(array) for array in given["coordinates"]])[1]
        self._digits = given["digits"]
        # The caller may write into arrays that wait.
        self._waiting += [array.copy() for array in given["coordinates"]]
        self._held += sum(array.size for array in given["coordinates"])
        if self._held >= _WAITING:
            self._measure(len(self._waiting) // LEAF * LEAF, progress)

    _dim = _held = 0

    def _check(self, given: Sets) -> None:
        """Whether points can be used, before they are kept."""
        asked = request(self._settings, given["coordinates"][0].shape[-1])
        _pairwave.Points.check(asked, {**given, "first": self._at + len(self._waiting)})

    @property
    def _at(self) -> int:
        return self._first + self._done

    def _part(self, count: int) -> _pairwave.Measurement:
        """The first of what waits, to be measured."""
        here = self._waiting[:count]
        asked = request(self._settings, self._dim)
        end = self._at + count
        most = max([self._most, *(len(array) for array in here)])
        of = Sets(coordinates=here, digits=self._digits, weights=[], labels=[], first=self._at)
        sizes = (self._total, self._mean or 0.0, most)
        points = _pairwave.Points.of_stream(asked, "added", of, self._at, sizes)
        return _pairwave.Measurement(asked, points, (self._at, end))

    def _measure(self, count: int, progress: bool | Progress | None) -> None:
        if count == 0:
            return
        part = self._part(count)
        with told(progress) as tell:
            part.measure(tell)
        if self._sums is None:
            self._sums = part
        else:
            self._sums.absorb(part)
        self._most = max([self._most, *(len(array) for array in self._waiting[:count])])
        self._done += count
        del self._waiting[:count]
        self._held = sum(array.size for array in self._waiting)

    @property
    def realizations(self) -> int:
        """How many were added, merged ones included."""
        return (0 if self._sums is None else self._sums.realizations) + len(self._waiting)

    def _whole(self, progress: bool | Progress | None) -> _pairwave.Measurement:
        """All sums; those of a leaf that is not full are not kept, so that realizations can be added to it."""
        self._measure(len(self._waiting) // LEAF * LEAF, progress)
        if not self._waiting:
            if self._sums is None:
                raise ValueError("there are no realizations; expected add() before")
            return self._sums
        rest = self._part(len(self._waiting))
        with told(progress) as tell:
            rest.measure(tell)
        if self._sums is None:
            return rest
        whole = _pairwave.Measurement.read("sums", self._sums.write())
        whole.absorb(rest)
        return whole

    def result(self, *, progress: bool | Progress | None = None) -> Result:
        """What is found so far; more can be added afterwards.

        Raises
        ------
        ValueError
            Before anything was added; where merged parts leave a gap.
        """
        whole = self._whole(progress)
        gap = whole.missing
        if self._first == 0 and gap is not None and not gap.startswith((f"{whole.realizations + 1}-", str(whole.total))):
            raise ValueError(f"no part has the realizations {gap.rpartition(', ')[0] or gap}; expected them to be merged before")
        found = whole.analysis(call("Measurement", self._settings))
        if found is None:
            raise ValueError("there are no realizations; expected add() before")
        return Result(found, whole)

    def merge(self, other: Measurement) -> None:
        """Adds the realizations of another, which was given the same settings.

        Raises
        ------
        ValueError
            Other settings; realizations that both hold; a part that ends within 16 realizations, with more after it.
        """
        earlier, later = sorted((self, other), key=lambda part: part._first)
        end = earlier._at + len(earlier._waiting)
        if end % LEAF and later._first >= end:
            raise ValueError(f"merge: the realizations before {end} do not end at a multiple of {LEAF}; expected parts that do")
        theirs = other._whole(None)
        mine = self._whole(None) if self._sums is not None or self._waiting else None
        copy = _pairwave.Measurement.read("the other", theirs.write())
        if mine is None:
            self._sums = copy
        else:
            mine.absorb(copy)
            self._sums = mine
        self._waiting = []
        self._first = min(self._first, other._first)
        self._mean = self._mean if self._mean is not None else other._mean
        self._most, self._dim = max(self._most, other._most), self._dim or other._dim
        self._done = max(self._at, other._at) - self._first

    def to_bytes(self) -> bytes:
        """The sums, in the documented form of the program (docs/sums.md)."""
        return self._whole(None).write()

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Writes the sums into a file, whole or not at all; ``pairwave merge`` reads it too."""
        target = Path(path)
        if target.exists() and not force:
            raise FileExistsError(f"{target}: is there already; force replaces it")
        part = target.with_name(f".{target.name}.{os.getpid()}")
        part.write_bytes(self.to_bytes())
        os.replace(part, target)
        return target

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Measurement:
        """The sums of a file, or of a result that was saved with ``keep_sums``."""
        return cls._of(_pairwave.Measurement.load(os.fspath(path)))

    @classmethod
    def from_bytes(cls, content: bytes) -> Measurement:
        """What :meth:`to_bytes` wrote."""
        return cls._of(_pairwave.Measurement.read("sums", content))

    @classmethod
    def _of(cls, sums: _pairwave.Measurement) -> Measurement:
        made = cls.__new__(cls)
        made._settings = dict(sums.settings)
        made._first, made._sums, made._waiting, made._digits = 0, sums, [], None
        made._mean, made._most = sums.sizes[1], sums.sizes[2]
        made._total, made._dim = sums.total, sums.dim
        made._done = sums.end
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        state = dict(self.__dict__)
        state["_sums"] = None if self._sums is None else self._sums.write()
        return _unpickled, (state,)

    def __repr__(self) -> str:
        settings = ", ".join(f"{name}={value!r}" for name, value in self._settings.items())
        return f"<pairwave.Measurement of {self.realizations} realizations: {settings}>"


def _unpickled(state: dict[str, Any]) -> Measurement:
    made = Measurement.__new__(Measurement)
    content = state.pop("_sums")
    made.__dict__.update(state, _sums=None if content is None else _pairwave.Measurement.read("pickle", content))
    return made
