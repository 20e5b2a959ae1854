"""Pair counts of pairwave and of its peers on the same points: time, and whether the counts agree. See README.md."""

import argparse
import contextlib
import csv
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import freud
import numpy as np
from Corrfunc.theory.DD import DD
from scipy.spatial import cKDTree

LIMIT = 60.0  # seconds a call may be expected to take
F64 = ("Corrfunc f64", "cKDTree")


def pairwave(program, points, r_max, bins, folder):
    """Ordered pairs per bin, seconds of the counting stage, CPU seconds of the whole command."""
    file, out = folder / "points.npy", folder / "result"
    np.save(file, points)
    command = [program, "analyze", file, "--stats", "pcf", "--device", "cpu", "--threads", "1"]
    command += ["--r-max", repr(r_max), "--bins", str(bins), "--out", out, "--force"]
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{program} failed: {command}")
    with open(out / "pcf.csv") as table:
        counts = np.array([int(row["count"]) for row in csv.DictReader(table)])
    stage = json.loads((out / "summary.json").read_text())["timings_seconds"]["pair_counts"]
    return counts, stage, usage.ru_utime + usage.ru_stime


@contextlib.contextmanager
def quiet():
    """Corrfunc warns from C that all z are equal."""
    kept, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(null)


def corrfunc(points, r_max, bins, dtype):
    n, dim = points.shape
    x, y, z = np.zeros((3, n), dtype)
    for axis, values in zip((x, y, z), points.T):
        axis[:] = values
    edges = np.linspace(0.0, r_max, bins + 1)

    def run(refine):
        start = time.process_time()
        with quiet():
            found = DD(
                1, 1, edges, x, y, z, periodic=True, boxsize=1.0, xbin_refine_factor=refine, ybin_refine_factor=refine
            )
        return found["npairs"].astype(np.int64), time.process_time() - start

    (counts, one), (_, two) = run(1), run(2)
    # A point is its own neighbour where a bin begins at 0.
    counts[0] -= n
    return counts, min(one, two)


def freud_rdf(points, r_max, bins):
    n, dim = points.shape
    box = freud.box.Box.square(1.0) if dim == 2 else freud.box.Box.cube(1.0)
    centred = np.zeros((n, 3), np.float32)
    centred[:, :dim] = points - 0.5
    rdf = freud.density.RDF(bins, r_max)
    start = time.process_time()
    rdf.compute((box, centred))
    return rdf.bin_counts.astype(np.int64), time.process_time() - start


def ckdtree(points, r_max, bins):
    start = time.process_time()
    tree = cKDTree(points, boxsize=1.0)
    edges = np.linspace(0.0, r_max, bins + 1)
    found = tree.count_neighbors(tree, edges[1:], cumulative=False)
    seconds = time.process_time() - start
    found[0] -= len(points)
    return found.astype(np.int64), seconds


PEERS = {
    "Corrfunc f32": lambda *case: corrfunc(*case, np.float32),
    "Corrfunc f64": lambda *case: corrfunc(*case, np.float64),
    "freud": freud_rdf,
    "cKDTree": ckdtree,
}


def measured(call, repetitions):
    """The counts and the least time, of fewer repetitions where one takes long."""
    counts, best = call()
    for _ in range(repetitions - 1 if best < 5.0 else 0):
        best = min(best, call()[1])
    return counts, best


def main():
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairwave", default=root / "target/release/pairwave", help="the program")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--quick", action="store_true", help="small cases only")
    arguments = parser.parse_args()
    freud.parallel.set_num_threads(1)

    shapes = [(0.05, 256), (0.25, 256), (0.45, 256), (0.25, 32)]
    sizes = [2_000, 6_000] if arguments.quick else [10_000, 100_000]
    print("| case | pairwave, s (whole command) |" + "".join(f" {name}, s | ratio |" for name in PEERS) + " f32 pairs misplaced |")
    print("|---" * (3 + 2 * len(PEERS)) + "|")
    known = {}  # (peer, dim, r_max, bins) -> (n, seconds)
    wrong = []
    for dim in (2, 3):
        for n in sizes:
            points = np.random.default_rng(n + dim).random((n, dim))
            for r_max, bins in shapes:
                case = f"{dim}D, n = {n:,}, r < {r_max}, {bins} bins"
                with tempfile.TemporaryDirectory() as folder:
                    runs = [pairwave(arguments.pairwave, points, r_max, bins, Path(folder))]
                    for _ in range(arguments.repetitions - 1 if runs[0][1] < 5.0 else 0):
                        runs.append(pairwave(arguments.pairwave, points, r_max, bins, Path(folder)))
                counts, whole = runs[0][0], min(r[2] for r in runs)
                # On a busy machine the wall time of the stage may exceed the CPU time of everything.
                ours = min(whole, *(r[1] for r in runs))
                cells, misplaced = [], []
                for name, peer in PEERS.items():
                    before = known.get((name, dim, r_max, bins))
                    if before and before[1] * (n / before[0]) ** 2 > LIMIT:
                        cells += ["> 60", "–"]
                        continue
                    found, seconds = measured(lambda: peer(points, r_max, bins), arguments.repetitions)
                    known[name, dim, r_max, bins] = (n, seconds)
                    cells += [f"{seconds:.3g}", f"{seconds / ours:.1f}"]
                    # Pairs in the wrong bin are missed once and found once; a pair is counted twice.
                    off = int(np.abs(np.cumsum(found) - np.cumsum(counts)).sum()) // 2
                    if name in F64 and off:
                        wrong.append(f"{case}: {name} and pairwave differ by {off} pairs")
                    if name not in F64:
                        misplaced.append(f"{name} {off}")
                row = [case, f"{ours:.3g} ({whole:.3g})", *cells, ", ".join(misplaced)]
                print("| " + " | ".join(row) + " |", flush=True)
    if wrong:
        sys.exit("\n".join(wrong))
    print("\nCounts equal in every bin: " + ", ".join(F64) + ".")


if __name__ == "__main__":
    main()
