"""Batches on a cluster, by Dask: shards as tasks, their sums merged as a tree.

What is found is, to the bit, what one machine of the same kind finds alone: a task returns sums and changes nothing else, so that it may run
twice, and a worker may die at any time.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from . import _pairwave
from ._measure import _dim_of
from ._measurement import LEAF
from ._points import are_files, sets
from ._progress import Progress, told
from ._result import Result
from ._settings import call, request, whole

#: Sums that one task merges.
_ARITY = 8
#: What a worker's device is named by: one GPU per worker.
DEVICE = "PAIRWAVE_DEVICE"


def _settings_here(settings: dict[str, Any]) -> dict[str, Any]:
    device = os.environ.get(DEVICE)
    return {**settings, "device": device} if device and settings.get("device") is None else settings


def _finished(asked: _pairwave.Request, points: _pairwave.Points, span: tuple[int, int]) -> bytes:
    part = _pairwave.Measurement(asked, points, span)
    part.measure()
    return part.write()


def _of_sampler(settings: dict[str, Any], span: tuple[int, int]) -> bytes:
    """The sums of some realizations of a sampler, or of files that every worker sees."""
    asked = request(_settings_here(settings), _dim_of(settings))
    return _finished(asked, _pairwave.Points.open(asked), span)


def _of_arrays(settings: dict[str, Any], first: int, sizes: tuple[int, float, int], *pieces: Any) -> bytes:
    """The sums of realizations from `first` on, in one piece or more."""
    held = [array for piece in pieces for array in _realizations(piece)]
    given = sets(held, first=first)
    asked = request(_settings_here(settings), held[0].shape[-1])
    points = _pairwave.Points.of_stream(asked, "distributed", given, first, sizes)
    return _finished(asked, points, (first, first + len(held)))


def _is_remote(piece: Any) -> bool:
    """Whether it is a task, or the result of one."""
    return hasattr(type(piece), "__dask_graph__") or type(piece).__name__ == "Future"


def _realizations(piece: Any) -> list[np.ndarray[Any, Any]]:
    """Those of a piece; a part of a bag may be empty."""
    if isinstance(piece, list):
        if not piece:
            return []
        if all(np.ndim(one) < 2 and not hasattr(one, "columns") for one in piece):
            raise ValueError(f"source: a part holds {type(piece[0]).__name__} of shape {np.shape(piece[0])}; expected arrays (n, d)")
    return sets(piece)["coordinates"]


def _cut(piece: Any, start: int, stop: int) -> list[np.ndarray[Any, Any]]:
    """Some realizations of a piece."""
    return _realizations(piece)[start:stop]


def _sizes_of(piece: Any) -> list[int]:
    return [len(array) for array in _realizations(piece)]


def _merged(*parts: bytes) -> bytes:
    sums = _pairwave.Measurement.read("part 1", parts[0])
    for k, part in enumerate(parts[1:]):
        sums.absorb(_pairwave.Measurement.read(f"part {k + 2}", part))
    return sums.write()


def _shards(total: int, shards: int) -> list[tuple[int, int]]:
    """Ranges of realizations, of whole leaves but for the last."""
    leaves = -(-total // LEAF)
    shards = max(1, min(shards, leaves))
    cuts = [leaves * k // shards * LEAF for k in range(shards)] + [total]
    return list(zip(cuts, cuts[1:]))


def _as_pieces(source: Any) -> list[Any] | None:
    """What a Dask collection or a list is made of, one piece after the other; None for a sampler or files."""
    if source is None or are_files(source):
        if isinstance(source, (str, os.PathLike)) and not os.fspath(source):
            raise ValueError("source '': expected the path of a file or a folder")
        return None
    if type(source).__name__ == "Delayed":
        return [source]
    if hasattr(source, "to_delayed"):
        if hasattr(source, "ndim"):
            if source.ndim != 3:
                raise ValueError(f"source: a Dask array of shape {source.shape}; expected (K, n, d)")
            source = source.rechunk({1: -1, 2: -1})
            return [piece for piece in source.to_delayed().ravel()]
        return list(source.to_delayed())
    if isinstance(source, np.ndarray) or hasattr(source, "columns"):
        return [source]
    if isinstance(source, Iterable):
        pieces = list(source)
        # Numbers in a list are one set, as they are for pairwave.measure.
        remote = any(_is_remote(piece) for piece in pieces)
        return pieces if remote or any(np.ndim(piece) > 1 or hasattr(piece, "columns") for piece in pieces) else [np.asarray(pieces)]
    raise TypeError(f"source: a {type(source).__name__}; expected a Dask array or bag, arrays, files, or settings of a sampler")


class _Engine:
    """Who carries tasks out: a client of `distributed`, or a scheduler of Dask alone."""

    def __init__(self, client: Any, scheduler: str | None, retries: int) -> None:
        self.client, self.scheduler, self.retries = client, scheduler, retries

    def scatter(self, piece: Any) -> Any:
        return self.client.scatter([piece], hash=False)[0] if self.client is not None else piece

    def submit(self, work: Callable[..., Any], *arguments: Any) -> Any:
        if self.client is not None:
            from distributed import Future

            ready = [self.client.compute(a) if hasattr(a, "dask") and not isinstance(a, Future) else a for a in arguments]
            return self.client.submit(work, *ready, retries=self.retries, pure=False)
        from dask.delayed import delayed

        return delayed(work, pure=False)(*arguments)

    def gathered(self, tasks: Sequence[Any]) -> list[Any]:
        if self.client is not None:
            found: list[Any] = self.client.gather(list(tasks))
            return found
        from dask.base import compute

        return list(compute(*tasks, scheduler=self.scheduler))


def measure(
    client: Any,
    source: Any = None,
    *,
    shards: int | None = None,
    scheduler: str | None = None,
    retries: int = 2,
    progress: bool | Progress | None = None,
    partial: Callable[[Result], Any] | None = None,
    **settings: Any,
) -> Result:
    """Measures a batch on a cluster.

    Parameters
    ----------
    client : distributed.Client or None
        Of any cluster: a ``LocalCluster``, dask-jobqueue's ``SLURMCluster``, Kubernetes. None to run by Dask alone, see `scheduler`.
    source : dask.array (K, n, d), dask.bag or list of arrays or delayed arrays, path or list of paths, optional
        The realizations. Files are read by the workers, which must see them. Without a source a ``sampler`` draws points.
    shards : int, optional
        Tasks; by default four for each thread of the workers. Realizations are cut at multiples of 16.
    scheduler : str, optional
        Without a client: ``"processes"`` (by default), ``"threads"`` or ``"synchronous"``.
    retries : int
        How often a task that failed is tried again. A task whose worker dies runs again in any case.
    progress : bool or callable, optional
        As for :func:`pairwave.measure`.
    partial : callable, optional
        Is called with the result of what is there so far, whenever another eighth of the shards has come in. Needs a client.
    **settings
        As for :func:`pairwave.measure`; weights, classes and envelopes need all realizations at once, and are refused here but for files.
        A worker with the environment variable ``PAIRWAVE_DEVICE`` computes by that device: one GPU each.

    Returns
    -------
    Result
        To the bit that of one machine of the same kind.

    Raises
    ------
    ValueError, TypeError, OSError
        As for :func:`pairwave.measure`, from the task that it happened in.
    distributed.KilledWorker
        A task whose workers died too often (``distributed.scheduler.allowed-failures``).

    Examples
    --------
    >>> import pairwave.distributed
    >>> found = pairwave.distributed.measure(None, scheduler="synchronous", sampler="jittered", n=64, k=40, stats="pcf", bins=8)
    >>> alone = pairwave.measure(sampler="jittered", n=64, k=40, stats="pcf", bins=8)
    >>> bool((found.pcf.g == alone.pcf.g).all())
    True
    """
    if settings.get("envelope") is not None or settings.get("envelope_from") is not None:
        raise ValueError("envelope: needs all realizations at once; pairwave.measure takes it")
    if client is not None and not hasattr(client, "submit"):
        raise TypeError(f"client: a {type(client).__name__}; expected a distributed.Client, or None to run by Dask alone")
    if scheduler not in (None, "processes", "threads", "synchronous", "sync", "single-threaded", "multiprocessing", "threading"):
        raise ValueError(f"scheduler {scheduler!r}: expected 'processes', 'threads' or 'synchronous'")
    for name in ("weights", "classes", "intensities", "until_error", "time_limit"):
        if settings.get(name) is not None:
            raise ValueError(f"{name}: needs all realizations at once; pairwave.measure takes it, and files with columns of marks")
    if shards is not None and whole("shards", shards) < 1:
        raise ValueError(f"shards {shards}: expected 1 or more")
    whole("retries", retries)
    if partial is not None and client is None:
        raise ValueError("partial: needs a client; without one there is only the whole")
    command = call("distributed.measure", {"source": source, **settings})
    engine = _Engine(client, scheduler or "processes", retries)
    wanted = shards if shards is not None else 4 * _threads(client)
    pieces = _as_pieces(source)
    with told(progress) as tell:
        if pieces is None:
            tasks = _whole_tasks(engine, source, settings, wanted)
        else:
            tasks = _piece_tasks(engine, pieces, settings, wanted)
        content = _gathered(engine, tasks, tell, partial, command)
    sums = _pairwave.Measurement.read("shards", content)
    found = sums.analysis(command)
    if found is None or sums.missing is not None:
        raise ValueError(f"source: realizations {sums.missing} are missing")
    return Result(found, sums)


def _threads(client: Any) -> int:
    if client is None:
        return os.cpu_count() or 1
    return max(1, sum(int(threads) for threads in client.nthreads().values()))


def _whole_tasks(engine: _Engine, source: Any, settings: dict[str, Any], shards: int) -> list[Any]:
    """Tasks that open the batch themselves."""
    given = dict(settings)
    if source is not None:
        files = [source] if isinstance(source, (str, os.PathLike)) else list(source)
        given["files"] = [os.path.abspath(os.fspath(file)) for file in files]
    # What is wrong is said here, once.
    total = _pairwave.Points.open(request(given, _dim_of(given))).sizes[0]
    return [engine.submit(_of_sampler, given, span) for span in _shards(total, shards)]


def _piece_tasks(engine: _Engine, pieces: list[Any], settings: dict[str, Any], shards: int) -> list[Any]:
    """Tasks that are handed the arrays that hold their realizations."""
    if not pieces:
        raise ValueError("source: there are no realizations")
    if not any(_is_remote(piece) for piece in pieces):
        held = [array for piece in pieces for array in sets(piece)["coordinates"]]
        # What is wrong is said here, once.
        request(settings, held[0].shape[-1])
        sizes = _pairwave.sizes_of([len(array) for array in held])
        spans = _shards(sizes[0], shards)
        return [engine.submit(_of_arrays, settings, start, sizes, engine.scatter(held[start:stop])) for start, stop in spans]
    numbers = engine.gathered([engine.submit(_sizes_of, piece) for piece in pieces])
    sizes = _pairwave.sizes_of([n for piece in numbers for n in piece])
    starts = np.cumsum([0, *map(len, numbers)])
    tasks = []
    for start, stop in _shards(sizes[0], shards):
        parts = []
        for k, piece in enumerate(pieces):
            low, high = max(start, int(starts[k])), min(stop, int(starts[k + 1]))
            if low < high:
                uncut = (low, high) == (starts[k], starts[k + 1])
                at = (low - int(starts[k]), high - int(starts[k]))
                parts.append(piece if uncut else engine.submit(_cut, piece, *at))
        tasks.append(engine.submit(_of_arrays, settings, start, sizes, *parts))
    return tasks


def _gathered(
    engine: _Engine,
    tasks: list[Any],
    tell: Progress | None,
    partial: Callable[[Result], Any] | None,
    command: str,
) -> bytes:
    """The sums of all tasks, merged as a tree."""
    total = len(tasks)
    if engine.client is not None and (tell is not None or partial is not None):
        _watched(engine, tasks, tell, partial, command)
    while len(tasks) > 1:
        tasks = [engine.submit(_merged, *tasks[k : k + _ARITY]) for k in range(0, len(tasks), _ARITY)]
    if tell is not None and engine.client is None:
        tell("shards", 0, total, 0.0)
    content: bytes = engine.gathered(tasks)[0]
    if tell is not None:
        tell("shards", total, total, 1.0)
    return content


def _watched(
    engine: _Engine, tasks: list[Any], tell: Progress | None, partial: Callable[[Result], Any] | None, command: str
) -> None:
    """Tells of tasks as they end."""
    from distributed import as_completed

    ready: list[Any] = []
    sums: _pairwave.Measurement | None = None
    every = max(1, len(tasks) // 8)
    for done, task in enumerate(as_completed(tasks), 1):
        if task.status == "error":
            task.result()
        if tell is not None:
            tell("shards", done, len(tasks), done / len(tasks))
        if partial is None:
            continue
        ready.append(task)
        if done % every == 0 and done < len(tasks):
            content = engine.gathered([engine.submit(_merged, *ready)])[0]
            ready = []
            part = _pairwave.Measurement.read("shards", content)
            if sums is None:
                sums = part
            else:
                sums.absorb(part)
            found = sums.analysis(command)
            if found is not None:
                partial(Result(found, sums))


__all__ = ["DEVICE", "measure"]
