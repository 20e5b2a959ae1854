"""Sums that grow are those of one call."""

import pickle

import numpy
import pytest

import pairwave


@pytest.mark.parametrize("stats", ["pcf", "pcf,spectrum,neighbors,k-function", "counts,discrepancy"])
def test_added_one_by_one_is_one_call(stats, points):
    sums = pairwave.Measurement(k=20, stats=stats, device="cpu")
    for one in points:
        sums.add(one)
    whole, grown = pairwave.measure(points, stats=stats, device="cpu"), sums.result()
    assert sums.realizations == 20
    for name in whole.tables:
        assert whole.file(f"{name}.csv") == grown.file(f"{name}.csv"), name
    for name, array in whole.arrays.items():
        numpy.testing.assert_array_equal(array, grown[name])


def test_what_is_yielded_is_not_held(points):
    def endless():
        for k in range(10_000):
            if k == 300:
                raise RuntimeError("the detector is off")
            yield points[k % 20]

    sums = pairwave.Measurement(stats="pcf", bins=9)
    with pytest.raises(RuntimeError, match="detector"):
        sums.add(endless())
    assert sums.realizations == 300 and sums.result().summary["k"] == 300


def test_more_can_be_added_after_a_result(points):
    sums = pairwave.Measurement(stats="pcf,spectrum", device="cpu")
    sums.add(points[:7])
    first = sums.result()
    assert first.file("pcf.csv") == pairwave.measure(points[:7], stats="pcf,spectrum", device="cpu").file("pcf.csv")
    sums.add(points[7:])
    whole = pairwave.measure(points, stats="pcf,spectrum", device="cpu")
    assert sums.result().file("pcf.csv") == whole.file("pcf.csv")
    numpy.testing.assert_array_equal(sums.result().spectrum, whole.spectrum)


@pytest.mark.parametrize("turned", [False, True])
def test_parts_merge(points, turned, tmp_path):
    one = pairwave.Measurement(stats="pcf", bins=9, r_max=0.3)
    two = pairwave.Measurement(first=16, stats="pcf", bins=9, r_max=0.3)
    one.add(points[:16])
    two.add(points[16:])
    two = pickle.loads(pickle.dumps(two))
    path = two.save(tmp_path / "two.sums")
    two = pairwave.Measurement.load(path)
    both = (two, one) if turned else (one, two)
    both[0].merge(both[1])
    assert both[0].result().file("pcf.csv") == pairwave.measure(points, stats="pcf", bins=9, r_max=0.3).file("pcf.csv")
    with pytest.raises(ValueError, match="both parts hold realizations"):
        both[0].merge(one if turned else two)


def test_what_does_not_fit_is_refused_and_changes_nothing(points):
    sums = pairwave.Measurement(stats="pcf", bins=9)
    sums.add(points)
    other = pairwave.Measurement(first=32, stats="pcf", bins=8)
    other.add(points[:16])
    with pytest.raises(ValueError, match="before 20 do not end at a multiple of 16"):
        sums.merge(other)
    even = pairwave.Measurement(stats="pcf", bins=9)
    even.add(points[:16])
    with pytest.raises(ValueError, match="not of the same measurement"):
        even.merge(other)
    with pytest.raises(ValueError, match="3"):
        sums.add(numpy.zeros((4, 3)))
    bad = points[0].copy()
    bad[5, 1] = 1.5
    with pytest.raises(ValueError, match="point 5"):
        sums.add(bad)
    assert sums.realizations == 20
    assert sums.result().file("pcf.csv") == pairwave.measure(points, stats="pcf", bins=9).file("pcf.csv")
    gap = pairwave.Measurement(stats="pcf", bins=9)
    gap.add(points[:16])
    gap.merge(pickle.loads(pickle.dumps(_of(points, 32))))
    with pytest.raises(ValueError, match="17-32"):
        gap.result()
    for wrong, why in (({"k": 1.5}, "k 1.5"), ({"mean_points": float("nan")}, "mean_points nan"), ({"columns": [1, 2]}, "columns")):
        with pytest.raises((TypeError, ValueError), match=why):
            pairwave.Measurement(stats="pcf", **wrong)
    with pytest.raises(ValueError, match="of other settings"):
        pairwave.Measurement(stats="pcf", bins=7).merge(sums)
    with pytest.raises(TypeError, match="NoneType"):
        sums.merge(None)


def test_sums_go_on_where_they_are(points, tmp_path):
    whole = pairwave.measure(numpy.concatenate([points[:16], points]), stats="pcf", bins=9).file("pcf.csv")
    one = pairwave.Measurement(stats="pcf", bins=9)
    one.add(points[:16])
    two = _of(points[:16], 16)
    # The later takes the earlier, and goes on after itself.
    two.merge(one)
    two.add(points[16:])
    assert two.realizations == 36
    four = pairwave.Measurement(stats="pcf", bins=9)
    four.add(points[:16])
    four.add(points)
    assert four.result().file("pcf.csv") == whole
    # A part that was kept is one: it has a result, and is added to where it ends with a leaf.
    part = pairwave.Measurement.load(_of(points[:16], 16).save(tmp_path / "part"))
    assert part.result().summary["k"] == 16
    part.add(points)
    one.merge(part)
    assert one.realizations == 52 and one.result().summary["k"] == 52
    ended = pairwave.Measurement.from_bytes(_of(points[:5], 0).to_bytes())
    with pytest.raises(ValueError, match="nothing can be added"):
        ended.add(points)
    with pytest.raises(IsADirectoryError):
        one.save(tmp_path, force=True)


def test_an_interrupt_counts_nothing_twice(points):
    sums = pairwave.Measurement(stats="pcf", bins=9)
    sums.add(points)
    # As if it came when the first sums were there, and what is in them still waited.
    sums._sums = sums._part(16)
    sums._sums.measure()
    assert sums.result().file("pcf.csv") == pairwave.measure(points, stats="pcf", bins=9).file("pcf.csv")
    assert sums.realizations == 20


def test_two_that_merge_each_other_end(points, monkeypatch):
    import contextlib
    import threading
    import time

    alone = pairwave.Measurement._alone

    @contextlib.contextmanager
    def slowly(self):
        with alone(self):
            time.sleep(0.1)
            yield

    one, two = _of(points[:16], 0), _of(points[:16], 16)
    monkeypatch.setattr(pairwave.Measurement, "_alone", slowly)
    ended = []

    def merged(a, b):
        try:
            a.merge(b)
            ended.append("merged")
        except ValueError:
            ended.append("twice")

    threads = [threading.Thread(target=merged, args=pair, daemon=True) for pair in ((one, two), (two, one))]
    [thread.start() for thread in threads]
    [thread.join(20) for thread in threads]
    assert sorted(ended) == ["merged", "twice"]


def test_threads_add_one_after_the_other(points, monkeypatch):
    import threading

    from pairwave import _measurement

    monkeypatch.setattr(_measurement, "_WAITING", 64 * 16)
    sums = pairwave.Measurement(stats="pcf", bins=9)
    threads = [threading.Thread(target=lambda: [sums.add(one) for one in points]) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert sums.realizations == 80 and sums.result().summary["k"] == 80
    with pytest.raises(RuntimeError, match="at work"):
        sums.add(numpy.concatenate([points] * 2), progress=lambda *_: sums.result())


def _of(points, first):
    part = pairwave.Measurement(first=first, stats="pcf", bins=9)
    part.add(points)
    return part


def test_nothing_is_an_error():
    with pytest.raises(ValueError, match="no realizations"):
        pairwave.Measurement(stats="pcf").result()
    with pytest.raises(ValueError, match="envelope"):
        pairwave.Measurement(stats="pcf", envelope=9)
    with pytest.raises(ValueError, match="multiple of 16"):
        pairwave.Measurement(first=5)
    full = pairwave.Measurement(k=2, stats="pcf")
    full.add(numpy.full((2, 3, 2), 0.5))
    with pytest.raises(ValueError, match="k 2"):
        full.add(numpy.full((3, 2), 0.5))


def test_numbers_of_points_may_differ():
    random = numpy.random.default_rng(3)
    sets = [random.random((n, 2)) for n in random.integers(40, 90, 50)]
    mean = sum(map(len, sets)) / len(sets)
    sums = pairwave.Measurement(stats="pcf,spectrum", r_max=0.2, max_frequency=5, mean_points=mean)
    for one in sets:
        sums.add(one)
    whole = pairwave.measure(sets, stats="pcf,spectrum", r_max=0.2, max_frequency=5)
    assert sums.result().file("pcf.csv") == whole.file("pcf.csv")
    numpy.testing.assert_array_equal(sums.result().spectrum, whole.spectrum)
