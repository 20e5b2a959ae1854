"""What a cluster finds is, to the bit, what one machine finds; whatever dies on the way."""

import os
import signal

import numpy
import pytest

import pairwave

dask = pytest.importorskip("dask")
cluster = pytest.importorskip("pairwave.distributed")

SETTINGS = {"stats": "pcf,spectrum", "bins": 16, "r_max": 0.2, "max_frequency": 5, "device": "cpu", "threads": 1}


def same(one, other):
    assert one.file("pcf.csv") == other.file("pcf.csv")
    numpy.testing.assert_array_equal(one.spectrum, other.spectrum)


@pytest.fixture(scope="module")
def many():
    return numpy.random.default_rng(2).random((100, 50, 2))


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed")
    with dask.config.set({"distributed.scheduler.allowed-failures": 3}):
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as local:
            with distributed.Client(local) as client:
                yield client


def test_without_a_client(many):
    whole = pairwave.measure(many, **SETTINGS)
    same(cluster.measure(None, many, shards=3, scheduler="processes", **SETTINGS), whole)
    sampler = {"sampler": "jittered", "n": 49, "k": 40, **SETTINGS}
    same(cluster.measure(None, shards=2, scheduler="threads", **sampler), pairwave.measure(**sampler))


def test_sources(client, many, tmp_path):
    whole = pairwave.measure(many, **SETTINGS)
    array = pytest.importorskip("dask.array").from_array(many, chunks=(30, 50, 2))
    told = []
    same(cluster.measure(client, array, progress=lambda *what: told.append(what), **SETTINGS), whole)
    assert told[-1][1:3] == (told[-1][2], told[-1][2])
    same(cluster.measure(client, list(many), shards=5, **SETTINGS), whole)
    bag = pytest.importorskip("dask.bag").from_sequence(list(many), npartitions=7)
    same(cluster.measure(client, bag, **SETTINGS), whole)
    paths = [tmp_path / f"{k:02}.npy" for k in range(4)]
    for path, part in zip(paths, numpy.split(many, 4)):
        numpy.save(path, part)
    same(cluster.measure(client, paths, **SETTINGS), whole)


def bump(x):
    return numpy.exp(-9 * ((x - 0.4) ** 2).sum(axis=1))


def test_functions_and_arrays_are_settings(client, many):
    settings = {"stats": "pcf,spectrum", "integrand": bump, "edges": numpy.linspace(0, 0.2, 9), "device": "cpu", "max_frequency": 5}
    found = cluster.measure(client, many, **settings)
    same(found, pairwave.measure(many, **settings))
    numpy.testing.assert_array_equal(found.variance.var_shifted, pairwave.measure(many, **settings).variance.var_shifted)


def test_partial_results_grow(client):
    seen = []
    found = cluster.measure(client, sampler="random", n=20, k=320, shards=16, partial=lambda r: seen.append(r.summary["k"]), **SETTINGS)
    assert seen == sorted(seen) and len(seen) >= 7 and found.summary["k"] == 320


def test_errors_are_those_of_one_machine(client, many):
    with pytest.raises(ValueError, match="^r_max"):
        cluster.measure(client, many, **{**SETTINGS, "r_max": -1})
    for wrong, kind, reason in (
        ((many, {}), TypeError, "client: a ndarray"),
        ((None, {"source": many, "scheduler": "proceses"}), ValueError, "scheduler 'proceses'"),
        ((None, {"source": many, "shards": 0}), ValueError, "shards 0"),
        ((None, {"source": many, "weights": many[..., 0]}), ValueError, "weights: needs all"),
        ((None, {"source": ""}), ValueError, "source ''"),
    ):
        with pytest.raises(kind, match=reason):
            cluster.measure(wrong[0], **wrong[1], **SETTINGS)
    one = cluster.measure(None, many[0].tolist(), scheduler="synchronous", **SETTINGS)
    same(one, pairwave.measure(many[0].tolist(), **SETTINGS))
    bag = pytest.importorskip("dask.bag").from_sequence(list(many), npartitions=4).map_partitions(lambda p: p[:0] if p[0][0, 0] == many[0, 0, 0] else p)
    same(cluster.measure(client, bag, **SETTINGS), pairwave.measure(many[25:], **SETTINGS))
    bad = many.copy()
    bad[77, 3, 0] = 2.0
    with pytest.raises(ValueError, match="realization 77, point 3"):
        cluster.measure(client, bad, **SETTINGS)


def test_a_worker_that_dies_changes_nothing(client):
    sampler = {"sampler": "random", "n": 1500, "k": 384, "stats": "pcf,spectrum", "device": "cpu", "threads": 1, "max_frequency": 20}
    whole = pairwave.measure(**sampler)
    workers = client.run(os.getpid)
    killed = []

    def tell(stage, done, total, share):
        if done >= 4 and not killed:
            killed.append(list(workers.values())[0])
            os.kill(killed[0], signal.SIGKILL)

    found = cluster.measure(client, shards=24, progress=tell, **sampler)
    assert killed
    same(found, whole)
