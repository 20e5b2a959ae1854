"""pairwave through Python beside freud, Corrfunc, SciPy, pointpats and FINUFFT on their own jobs, in one run, one thread each; what is not installed is left out.

    pip install ./python scipy finufft freud-analysis pointpats && python benches/peers/through_python.py

Times are the median of several, on the wall. Overheads of calls stand above.
"""

import argparse
import importlib.metadata
import os
import statistics
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import numpy

import pairwave


def seconds(work, least=0.3, most=15):
    """The median time of a call, after one to warm up."""
    work()
    taken, start = [], time.perf_counter()
    while len(taken) < 3 or (time.perf_counter() - start < least and len(taken) < most):
        begin = time.perf_counter()
        work()
        taken.append(time.perf_counter() - begin)
    return statistics.median(taken)


def corrfunc(points, edges):
    from Corrfunc.theory import DD

    x, y, z = points.T.copy()
    return lambda: DD(1, 1, edges, x, y, z, boxsize=1.0, periodic=True)


def freud(points, edges):
    import freud

    freud.parallel.set_num_threads(1)
    three = points if points.shape[1] == 3 else numpy.column_stack([points, numpy.full(len(points), 0.5)])
    box = freud.box.Box.cube(1) if points.shape[1] == 3 else freud.box.Box.square(1)
    return lambda: freud.density.RDF(bins=len(edges) - 1, r_max=edges[-1]).compute((box, three - 0.5))


def scipy(points, edges):
    from scipy.spatial import cKDTree

    def work():
        tree = cKDTree(points, boxsize=1)
        return numpy.diff(tree.count_neighbors(tree, edges))

    return work


def pointpats(points, edges):
    from pointpats import k

    return lambda: k(points, support=edges)


def finufft(points, reach):
    import finufft

    strengths, places = numpy.ones(len(points), complex), 2 * numpy.pi * points.T.copy()
    modes = (2 * reach + 1,) * 2
    plan = finufft.Plan(1, modes, eps=1e-6, isign=-1, nthreads=1)

    def work():
        plan.setpts(*places)
        return abs(plan.execute(strengths)) ** 2 / len(points)

    return work


def row(job, name, theirs, ours):
    print(f"| {job} | {name} | {1e3 * theirs:.3g} ms | {1e3 * ours:.3g} ms | {theirs / ours:.2f} |")


def version(name):
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small cases only, to see that it runs")
    quick = parser.parse_args().quick
    random = numpy.random.default_rng(1)
    print(f"pairwave {pairwave.__version__}, numpy {numpy.__version__}, {time.strftime('%Y-%m-%d')}\n")

    few = random.random((64, 2))
    call = seconds(lambda: pairwave.pair_correlation(few, bins=16, threads=1), 1.0, 400)
    print(f"a call for g of 64 points: {1e6 * call:.0f} µs")
    sets = random.random((100 if quick else 1000, 1024, 2))
    one = {"stats": "pcf,spectrum", "device": "cpu"}

    def grown():
        sums = pairwave.Measurement(**one)
        for points in sets:
            sums.add(points)
        return sums.result().pcf.g

    batch, loop = (seconds(work, 0, 3) for work in (lambda: pairwave.measure(sets, **one).pcf.g, grown))
    print(f"{len(sets)} sets of 1024 points, g and P: one call {batch:.3f} s, added one by one {loop:.3f} s: {loop / batch - 1:+.1%}\n")

    print("| job | beside | theirs | pairwave | factor |\n|---|---|---|---|---|")
    peers = {"Corrfunc": corrfunc, "freud-analysis": freud, "scipy": scipy, "pointpats": pointpats}
    for dim, n in ((2, 10_000), (3, 10_000)) if quick else ((2, 10_000), (2, 200_000), (3, 10_000), (3, 200_000)):
        points = random.random((n, dim))
        edges = numpy.linspace(0, 0.2 if n <= 10_000 else 0.02, 51)
        for name, made in peers.items():
            if version(name) is None or (name == "Corrfunc" and dim != 3) or (name == "pointpats" and (dim != 2 or n > 10_000)):
                continue
            if name == "pointpats":
                given = {"window": [0, 1, 0, 1], "correction": "none"}
                ours = seconds(lambda: pairwave.k_function(points, edges=edges, device="cpu", threads=1, **given).k)
            else:
                ours = seconds(lambda: pairwave.pair_correlation(points, edges=edges, device="cpu", threads=1).g)
            row(f"pairs of {n} points in {dim}D, r < {edges[-1]:g}, 50 bins", f"{name} {version(name)}", seconds(made(points, edges)), ours)
    if version("finufft"):
        for n, reach in ((4096, 64),) if quick else ((4096, 64), (4096, 256), (200_000, 256)):
            points = random.random((n, 2))
            theirs = seconds(finufft(points, reach))
            given = {"stats": "spectrum", "max_frequency": reach, "device": "cpu", "threads": 1}
            row(f"P of {n} points, |m| <= {reach}", f"finufft {version('finufft')}, 1e-6, plan kept", theirs, seconds(lambda: pairwave.measure(points, **given).spectrum))
    if version("scipy"):
        from scipy.stats import qmc

        work = seconds(lambda: qmc.Sobol(2, seed=1).random(4096))
        row("4096 scrambled Sobol' points", f"scipy {version('scipy')}", work, seconds(lambda: pairwave.sample("sobol", 4096, threads=1)))
        points = random.random((2048, 2))
        ours = seconds(lambda: pairwave.measure(points, stats="discrepancy", threads=1).discrepancy.star_l2)
        row("discrepancies of 2048 points", f"scipy {version('scipy')}, L2* alone", seconds(lambda: qmc.discrepancy(points, method="L2-star")), ours)


if __name__ == "__main__":
    main()
