"""What a million sets of 4,096 points cost on 1, 10 and 100 workers: rates measured here, and a simulation of the tasks by them.

    python python/benches/scale.py            # a minute; one thread
"""

import argparse
import heapq
import os
import statistics
import tempfile
import time

import numpy

import pairwave
from pairwave import _pairwave
from pairwave.distributed import _ARITY, _merged, _of_sampler, _shards

N, SETS = 4096, 1_000_000
#: Of a network and of a file system that all workers share, in bytes per second, and of the scheduler for each task, in seconds.
NETWORK, DISK, SCHEDULER = 1e9, 1e9, 1e-3


def seconds(work, times):
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        taken.append(time.perf_counter() - start)
    return statistics.median(taken)


def human(time_s):
    return f"{time_s / 60:.0f} min" if time_s >= 600 else f"{time_s:.0f} s" if time_s >= 20 else f"{time_s:.2f} s"


def measured(stats, quick):
    """Seconds of a set, bytes of sums, seconds of a merge of two, seconds to read a set."""
    settings = {"sampler": "jittered", "n": N, "stats": stats, "device": "cpu", "threads": 1}
    sets = 16 if quick else 64
    given = {**settings, "k": 2 * sets}
    parts = []
    one = seconds(lambda: parts.append(_of_sampler(given, (0, sets))), 1) / sets
    parts.append(_of_sampler(given, (sets, 2 * sets)))
    merge = seconds(lambda: _merged(*parts[:2]), 3)
    with tempfile.TemporaryDirectory() as room:
        path = os.path.join(room, "points.npy")
        numpy.save(path, pairwave.sample("jittered", N, sets))
        read = seconds(lambda: numpy.load(path).sum(), 3) / sets
    return one, len(parts[0]), merge, read


def simulated(workers, one, size, merge, reads):
    """Wall seconds of all tasks: measuring, then merging as the tree of `pairwave.distributed`."""
    free = [0.0] * workers
    disk = scheduler = 0.0
    random = numpy.random.default_rng(1)

    def task(ready, work, nbytes=0, moved=0):
        nonlocal disk, scheduler
        scheduler = max(scheduler, ready) + SCHEDULER
        start = max(heapq.heappop(free), scheduler)
        if nbytes:
            disk = max(disk, start) + nbytes / DISK
            start = max(start, disk)
        end = start + moved / NETWORK + work
        heapq.heappush(free, end)
        return end

    shards = _shards(SETS, 4 * workers)
    ends = []
    for start, stop in shards:
        count = stop - start
        ends.append(task(0.0, count * one * random.uniform(0.9, 1.1), count * N * 16 if reads else 0))
    computed = max(ends)
    while len(ends) > 1:
        groups = [ends[k : k + _ARITY] for k in range(0, len(ends), _ARITY)]
        ends = [task(max(group), (len(group) - 1) * merge, 0, len(group) * size) for group in groups]
    return len(shards), computed, ends[0] - computed


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer sets, to see that it runs")
    quick = parser.parse_args().quick
    print(f"pairwave {_pairwave.__version__}, {time.strftime('%Y-%m-%d')}, one thread per worker, {SETS:,} sets of {N:,} points\n")
    print("| statistics | a set | sums | a merge of two | reading a set |\n|---|---|---|---|---|")
    rates = {stats: measured(stats, quick) for stats in ("pcf", "pcf,spectrum,neighbors", "spectrum,radial")}
    for stats, (one, size, merge, read) in rates.items():
        print(f"| {stats} | {1e3 * one:.2f} ms | {size / 1e6:.3f} MB | {1e3 * merge:.2f} ms | {1e6 * read:.0f} µs |")
    print("\n| statistics | points | workers | shards | measuring | merging after it | whole | share of merging |")
    print("|---|---|---|---|---|---|---|---|")
    for stats, (one, size, merge, _) in rates.items():
        for reads in (False, True):
            for workers in (1, 10, 100, 1000):
                shards, computed, merging = simulated(workers, one, size, merge, reads)
                whole = computed + merging
                print(
                    f"| {stats} | {'read, 1 GB/s for all' if reads else 'drawn'} | {workers} | {shards} | {human(computed)} "
                    f"| {human(merging)} | {human(whole)} | {merging / whole:.2%} |"
                )


if __name__ == "__main__":
    main()
