"""Integration errors in numpy, as one would write them for a paper: jittered points in the plane, n = 1024, eight integrands, the variance
by power and by pairs, estimates as is and at 16 shifts. Milliseconds per realization, one thread.

pip install numpy scipy; OMP_NUM_THREADS=1 python benches/peers/integration.py; then `cargo bench --bench integration`.
"""

import time

import numpy as np
from scipy import fft

N, K, F, SHIFTS = 32, 8, 160, 16
RNG = np.random.default_rng(1)


def near(x):
    return x - np.round(x)


def gaussian(x, y, s=0.1):
    gx, gy = near(x - 0.4), near(y - 0.55)
    return np.exp(-(gx**2 + gy**2) / (2 * s * s))


def bump(x, y):
    d2 = near(x - 0.5) ** 2 + near(y - 0.5) ** 2
    return np.where(d2 < 0.09, (1 - d2 / 0.09) ** 2, 0.0)


F_OF = {
    "disk": lambda x, y: (near(x - 0.5) ** 2 + near(y - 0.5) ** 2 < 0.0625).astype(float),
    "box": lambda x, y: ((x >= 0.13) & (x < 0.58) & (y >= 0.21) & (y < 0.87)).astype(float),
    "half-plane": lambda x, y: (x * np.cos(0.6) + y * np.sin(0.6) < 0.5).astype(float),
    "gaussian": gaussian,
    "ramp": lambda x, y: x,
    "cosine": lambda x, y: np.cos(4 * np.pi * x + 0.3),
    "checker": lambda x, y: ((np.floor(4 * x) + np.floor(4 * y)) % 2 == 0).astype(float),
    "bump": bump,
}


def tables(side=1024):
    """Squares of Fourier coefficients and autocorrelations, from cell centres."""
    c = (np.arange(side) + 0.5) / side
    x, y = np.meshgrid(c, c, indexing="ij")
    squares, lags, means = [], [], []
    for f in F_OF.values():
        values = f(x, y)
        m = fft.fft2(values) / side**2
        s = np.abs(m) ** 2
        means.append(values.mean())
        lags.append(np.real(fft.ifft2(s)) * side**2 - values.mean() ** 2)
        at = np.arange(-F, F + 1) % side
        part = s[np.ix_(at, at)].copy()
        part[F, F] = 0
        squares.append(part.ravel())
    return np.array(squares), lags, np.array(means), side


def main():
    squares, lags, means, side = tables()
    m = np.arange(-F, F + 1)
    t = np.zeros(4)
    n = N * N
    alpha = np.arange(SHIFTS)[:, None] / SHIFTS * np.array([1.0, 5.0])
    spectral, spatial = [], []
    for _ in range(K):
        cells = np.stack(np.meshgrid(np.arange(N), np.arange(N), indexing="ij"), -1).reshape(-1, 2)
        x = (cells + RNG.random((n, 2))) / N
        start = time.perf_counter()
        ex = np.exp(-2j * np.pi * np.outer(m, x[:, 0]))
        ey = np.exp(-2j * np.pi * np.outer(x[:, 1], m))
        power = np.abs(ex @ ey) ** 2
        spectral.append(squares @ power.ravel() / n**2)
        t[0] += time.perf_counter() - start
        start = time.perf_counter()
        i, j = np.triu_indices(n, 1)
        d = ((x[i] - x[j]) % 1 * side).round().astype(int) % side
        flat = d[:, 0] * side + d[:, 1]
        spatial.append([2 * table.ravel()[flat].sum() / n**2 for table in lags])
        t[1] += time.perf_counter() - start
        start = time.perf_counter()
        for shift in (alpha + RNG.random(2)) % 1:
            moved = (x + shift) % 1
            for f in F_OF.values():
                f(moved[:, 0], moved[:, 1]).mean()
        t[2] += time.perf_counter() - start
        start = time.perf_counter()
        for f in F_OF.values():
            f(x[:, 0], x[:, 1]).mean()
        t[3] += time.perf_counter() - start
    t *= 1e3 / K
    print(f"n = {n}, {K} realizations of jittered points, 8 integrands: {t.sum():.1f} ms each")
    for part, what in zip(t, ["power, |m| <= 160, by products of phases", "all pairs, a looked up", "16 shifts", "as is"]):
        print(f"  {part:8.2f} ms  {100 * part / t.sum():4.0f} %  {what}")


if __name__ == "__main__":
    main()
