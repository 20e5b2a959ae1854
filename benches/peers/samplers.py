"""Millions of points a second by the generators of scipy.stats.qmc and QMCPy: n = 4096, 2D, one thread.

pip install scipy qmcpy; python benches/peers/samplers.py; then `cargo bench --bench samplers`.
"""

import time

import numpy as np
from scipy.stats import qmc


def rate(draw, n=4096, sets=200):
    draw(0)
    best = float("inf")
    for _ in range(3):
        start = time.perf_counter()
        for seed in range(sets):
            draw(seed)
        best = min(best, time.perf_counter() - start)
    return n * sets / best / 1e6


def main():
    n = 4096
    rows = {
        "numpy random": lambda s: np.random.default_rng(s).random((n, 2)),
        "scipy Sobol, Owen (LMS + shift)": lambda s: qmc.Sobol(2, scramble=True, rng=s).random(n),
        "scipy Sobol, plain": lambda s: qmc.Sobol(2, scramble=False).random(n),
        "scipy Halton, scrambled": lambda s: qmc.Halton(2, scramble=True, rng=s).random(n),
        "scipy LatinHypercube": lambda s: qmc.LatinHypercube(2, rng=s).random(n),
        "scipy PoissonDisk, radius 0.012": lambda s: qmc.PoissonDisk(2, radius=0.012, rng=s).random(n),
    }
    try:
        import qmcpy

        rows["QMCPy DigitalNetB2, Owen"] = lambda s: qmcpy.DigitalNetB2(2, randomize="OWEN", seed=s).gen_samples(n)
        rows["QMCPy DigitalNetB2, shift"] = lambda s: qmcpy.DigitalNetB2(2, randomize="DS", seed=s).gen_samples(n)
        rows["QMCPy Lattice"] = lambda s: qmcpy.Lattice(2, seed=s).gen_samples(n)
        rows["QMCPy Halton"] = lambda s: qmcpy.Halton(2, seed=s).gen_samples(n)
    except ImportError:
        print("QMCPy is not installed")
    for name, draw in rows.items():
        sets = 1 if "Poisson" in name else 200
        print(f"{name:34} {rate(draw, n, sets):8.2f} M points/s")


if __name__ == "__main__":
    main()
