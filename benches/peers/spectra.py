"""Spectra of pairwave's nonuniform FFT and of FINUFFT on the same points: time, and whether they agree. See README.md."""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import finufft
import numpy as np


def pairwave(program, points, f, tolerance, folder):
    """|s|^2 of the stored modes (m_0 >= 0 outermost), and milliseconds per call."""
    file, out = folder / "points.f64", folder / "powers.f64"
    points.tofile(file)
    command = [program, "--points", file, "--max-frequency", ",".join(map(str, f))]
    command += ["--tolerance", repr(tolerance), "--out", out]
    ms = float(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)
    return np.fromfile(out).reshape([f[0] + 1] + [2 * g + 1 for g in f[1:]]), ms


def by_finufft(points, f, tolerance, seconds):
    """The same, one thread, the plan reused: `setpts` and `execute` are what a new realization takes."""
    plan = finufft.Plan(1, tuple(2 * g + 1 for g in f), 1, tolerance, -1, nthreads=1)
    angles = [np.ascontiguousarray(2.0 * np.pi * axis) for axis in points.T]
    ones = np.ones(len(points), complex)
    best, begin = np.inf, time.process_time()
    while time.process_time() - begin < seconds:
        start = time.process_time()
        plan.setpts(*angles)
        modes = plan.execute(ones)
        best = min(best, time.process_time() - start)
    return np.abs(modes[f[0] :]) ** 2, 1e3 * best


def by_numpy(points, f, seconds):
    """The definition as a product of two matrices of phases (2D), or as many rows of it as fit into the time; extrapolated."""
    phase = lambda axis, m: np.exp(-2j * np.pi * ((axis[:, None] * m) % 1.0))
    begin = time.process_time()
    columns = phase(points[:, 1], np.arange(-f[1], f[1] + 1))
    start, power = time.process_time(), []
    while len(power) <= f[0] and (len(power) < 2 or time.process_time() - start < seconds):
        power.append(np.abs(phase(points[:, 0], np.array([len(power)])).T @ columns) ** 2)
    end = time.process_time()
    return np.concatenate(power), 1e3 * (start - begin + (end - start) * (f[0] + 1) / len(power))


def error(found, truth):
    """Relative l2 error of amplitudes, as far as powers tell: |s| differ by at most as much as s. DC would hide the rest."""
    amplitudes, true = np.sqrt(found), np.sqrt(truth)
    away = np.ones(truth.shape, bool)
    away[0, truth.shape[1] // 2] = False
    return np.linalg.norm((amplitudes - true)[away]) / np.linalg.norm(true[away])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bench", help="the program, e.g. target/release/deps/nufft-...; built if not given")
    parser.add_argument("--repetitions", type=int, default=3, help="rounds; the least time of each program counts")
    parser.add_argument("--quick", action="store_true", help="small cases only")
    arguments = parser.parse_args()
    program = arguments.bench
    if program is None:
        root = Path(__file__).resolve().parents[2]
        command = ["cargo", "bench", "--bench", "nufft", "--no-run"]
        built = subprocess.run(command, cwd=root, check=True, stderr=subprocess.PIPE, text=True).stderr
        program = root / built.rsplit("(", 1)[1].split(")")[0]

    cases = [(4_096, 64)] if arguments.quick else [(4_096, 256), (65_536, 256), (1_000_000, 512)]
    names = ["case", "pairwave, ms", "FINUFFT, ms", "pairwave / FINUFFT", "numpy, ms", "error of pairwave", "of FINUFFT"]
    print("| " + " | ".join(names) + " |\n" + "|---" * len(names) + "|")
    wrong = []
    for n, m in cases:
        points, f = np.random.default_rng(n).random((n, 2)), (m, m)
        truth, numpy_ms = by_numpy(points, f, 3.0)
        for tolerance in (1e-6, 1e-9, 1e-12):
            ours, theirs = [], []
            with tempfile.TemporaryDirectory() as folder:
                # In turns, so that other load meets both.
                for _ in range(arguments.repetitions):
                    power, ms = pairwave(program, points, f, tolerance, Path(folder))
                    ours.append(ms)
                    peer, ms = by_finufft(points, f, tolerance, 1.0)
                    theirs.append(ms)
            errors = [error(p[: len(truth)], truth) for p in (power, peer)]
            case = f"2D, n = {n:,}, \\|m\\| <= {m}, tolerance {tolerance:g}"
            # The peer promises no more than the order of magnitude; the product of matrices rounds.
            if not errors[0] <= tolerance + 1e-11 or not errors[1] <= 10 * tolerance + 1e-11:
                wrong.append(f"{case}: errors {errors[0]:.1e} and {errors[1]:.1e}")
            row = [case, f"{min(ours):.2f}", f"{min(theirs):.2f}", f"{min(ours) / min(theirs):.2f}", f"{numpy_ms:.3g}"]
            print("| " + " | ".join(row + [f"{e:.1e}" for e in errors]) + " |", flush=True)
    if wrong:
        sys.exit("\n".join(wrong))
    print("\nBoth agree with the sum itself.")


if __name__ == "__main__":
    main()
