"""Sums that grow: realizations are added as they come, elsewhere too, and merged."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from . import _pairwave
from ._points import Sets, sets
from ._progress import Progress, told
from ._result import Result
from ._settings import call, request, whole

#: Keywords of all realizations, or of where they come from.
_OF_ALL: tuple[str, ...] = ("sampler", "files", "n", "weight_column", "intensity_column", "class_column", "inhomogeneous", "envelope", "envelope_from")
_OF_ALL += ("columns", "realization_column", "raw", "array", "keep_going")

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
        if k is not None and not 1 <= whole("k", k) < 1 << 63:
            raise ValueError(f"k {k}: expected 1 realization or more")
        if whole("first", first) < 0 or first % LEAF:
            raise ValueError(f"first {first}: expected a multiple of {LEAF}")
        if mean_points is not None and not (isinstance(mean_points, (int, float)) and 0 < mean_points <= 1e9):
            raise ValueError(f"mean_points {mean_points!r}: expected a number above 0 and at most 1e9")
        for name in _OF_ALL:
            if settings.get(name) is not None:
                raise ValueError(f"{name}: is of all realizations at once, or of where they come from, and here they are added; measure() takes it")
        self._settings = settings
        self._lock = threading.RLock()
        self._busy = False
        self._total = _MANY if k is None else k
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
        if not isinstance(points, (list, tuple, str)) and not hasattr(points, "__array__") and isinstance(points, Iterable):
            for one in points:
                if np.ndim(one) not in (2, 3) and not hasattr(one, "columns"):
                    raise ValueError(f"points: shape {np.shape(one)} was yielded; expected arrays (n, d) or (K, n, d)")
                self.add(one, progress=progress)
            return
        given = sets(points)
        with self._alone():
            self._add(given, progress)

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """One thread at a time; a callback of it is told that it cannot."""
        with self._lock:
            if self._busy:
                raise RuntimeError("this Measurement is at work: what it calls cannot use it")
            self._busy = True
            try:
                self._settle()
                yield
            finally:
                self._busy = False

    def _add(self, given: Sets, progress: bool | Progress | None) -> None:
        if self._dim and given["coordinates"][0].shape[-1] != self._dim:
            raise ValueError(f"points: {given['coordinates'][0].shape[-1]} coordinates; those before have {self._dim}")
        if self._at + len(self._waiting) + len(given["coordinates"]) > self._total:
            raise ValueError(f"k {self._total}: no more realizations can be added; expected k to be as many as there are")
        if not self._waiting and self._done % LEAF:
            raise ValueError(f"these sums end within {LEAF} realizations that are summed together (at {self._at}); nothing can be added to them")
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
        of = Sets(coordinates=here, digits=self._digits, weights=[], labels=[], columns=[], unused=[], first=self._at)
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
        self._settle()

    def _settle(self) -> None:
        """Lets go of what is in the sums: an interrupt may have come between."""
        count = 0 if self._sums is None else max(0, self._sums.reach[1] - self._at)
        self._most = max([self._most, *(len(array) for array in self._waiting[:count])])
        self._waiting, self._done = self._waiting[count:], self._done + count
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
        sums = _pairwave.Measurement.read("sums", self._sums.write())
        sums.absorb(rest)
        return sums

    def result(self, *, progress: bool | Progress | None = None) -> Result:
        """What is found so far; more can be added afterwards.

        Raises
        ------
        ValueError
            Before anything was added; where merged parts leave a gap.
        """
        with self._alone():
            sums = self._whole(progress)
        start, end = sums.reach
        if sums.realizations != end - start:
            gap = (sums.missing or "").split(", ")
            raise ValueError(f"no part has the realizations {gap[1 if start else 0]}; expected them to be merged before")
        found = sums.analysis(call("Measurement", self._settings))
        if found is None:
            raise ValueError("there are no realizations; expected add() before")
        return Result(found, sums)

    def merge(self, other: Measurement) -> None:
        """Adds the realizations of another, which was given the same settings.

        Raises
        ------
        ValueError
            Other settings; realizations that both hold; a part that ends within 16 realizations, with more after it.
        """
        if not isinstance(other, Measurement):
            raise TypeError(f"merge: a {type(other).__name__}; expected a Measurement")
        if other is self:
            raise ValueError("merge: both are the same")
        # In one order, so that two threads that merge the same two wait for each other and not for ever.
        one, two = sorted((self, other), key=id)
        with one._alone(), two._alone():
            self._merge(other)

    def _merge(self, other: Measurement) -> None:
        if (self._settings, self._total) != (other._settings, other._total) and not (self.realizations and other.realizations):
            raise ValueError(f"merge: of other settings: {other._settings}, against {self._settings}")
        if not other.realizations:
            return
        earlier, later = sorted((self, other), key=lambda part: part._first)
        end = earlier._at + len(earlier._waiting)
        if end % LEAF and later._first >= end:
            raise ValueError(f"merge: the realizations before {end} do not end at a multiple of {LEAF}; expected parts that do")
        last = max(self._at + len(self._waiting), other._at + len(other._waiting))
        theirs = other._whole(None)
        mine = self._whole(None) if self._sums is not None or self._waiting else None
        copy = _pairwave.Measurement.read("the other", theirs.write())
        if mine is None:
            self._sums = copy
        else:
            mine.absorb(copy)
            self._sums = mine
        self._waiting = []
        self._held = 0
        self._first = min(self._first, other._first) if mine is not None else other._first
        self._mean = self._mean if self._mean is not None else other._mean
        self._most, self._dim = max(self._most, other._most), self._dim or other._dim
        self._done = last - self._first

    def to_bytes(self) -> bytes:
        """The sums, in the documented form of the program (docs/sums.md)."""
        with self._alone():
            return self._whole(None).write()

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Writes the sums into a file, whole or not at all; ``pairwave merge`` reads it too."""
        target = Path(path)
        if target.is_dir():
            raise IsADirectoryError(f"{target}: is a directory; expected a file")
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
        made._lock, made._busy, made._held = threading.RLock(), False, 0
        made._first, made._sums, made._waiting, made._digits = sums.reach[0] // LEAF * LEAF, sums, [], None
        made._mean, made._most = sums.sizes[1], sums.sizes[2]
        made._total, made._dim = sums.total, sums.dim
        made._done = sums.reach[1] - made._first
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        state = dict(self.__dict__)
        del state["_lock"]
        state["_sums"] = None if self._sums is None else self._sums.write()
        return _unpickled, (state,)

    def __repr__(self) -> str:
        settings = ", ".join(f"{name}={value!r}" for name, value in self._settings.items())
        return f"<pairwave.Measurement of {self.realizations} realizations: {settings}>"


def _unpickled(state: dict[str, Any]) -> Measurement:
    made = Measurement.__new__(Measurement)
    content = state.pop("_sums")
    made.__dict__.update(state, _lock=threading.RLock(), _busy=False, _sums=None if content is None else _pairwave.Measurement.read("pickle", content))
    return made
