"""How often the error that ends a run holds (docs/batches.md): simulated runs of means of values of known laws.

    python3 benches/until_error.py          needs numpy

For each law and number of realizations that a target takes: the share of 4,000 runs whose interval of 1.96 errors about the mean holds the truth, looked
at every 16 realizations by the plain standard error, and as pairwave looks: from 64 on, an eighth more each time, by s.e. (1 + 2 / sqrt(2 K)).
"""

import numpy as np

RUNS = 4000
rng = np.random.default_rng(1)
LAWS = {
    "normal": (lambda shape: rng.standard_normal(shape), 0.0, 1.0),
    "exponential": (lambda shape: rng.exponential(size=shape), 1.0, 1.0),
    "counts of mean 0.2": (lambda shape: rng.poisson(0.2, shape).astype(float), 0.2, 0.2**0.5),
    "lognormal, sigma 1": (lambda shape: np.exp(rng.standard_normal(shape)), np.exp(0.5), np.sqrt((np.e - 1) * np.e)),
}


def looks(first, share, most):
    """Numbers of realizations, whole leaves of 16."""
    all = [first]
    while all[-1] < most:
        all.append(-(-(all[-1] + max(int(all[-1] * share), 1)) // 16) * 16)
    return np.array([k for k in all if k <= most])


def coverage(values, truth, target, at, correction):
    k = at.astype(float)
    mean = np.cumsum(values, 1)[:, at - 1] / k
    square = np.cumsum(values * values, 1)[:, at - 1] / k
    error = np.sqrt((square - mean * mean) / (k - 1)) * (1 + correction / np.sqrt(2 * k))
    small = (error <= target) & (error > 0)
    stop = np.where(small.any(1), small.argmax(1), len(at) - 1)
    run = np.arange(len(values))
    held = np.abs(mean[run, stop] - truth) <= 1.96 * error[run, stop]
    return held.mean(), at[stop].mean()


for name, (draw, truth, deviation) in LAWS.items():
    for needed in (24, 64, 200, 800):
        most = 6 * needed + 400
        values = draw((RUNS, most))
        target = deviation / np.sqrt(needed)
        plain, plain_k = coverage(values, truth, target, looks(16, 0.0, most), 0.0)
        ours, our_k = coverage(values, truth, target, looks(64, 0.125, most), 2.0)
        print(f"{name}, {needed} needed: plain {plain:.3f} at K = {plain_k:.0f}, pairwave {ours:.3f} at K = {our_k:.0f}")
