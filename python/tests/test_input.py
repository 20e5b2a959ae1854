"""Whatever is given is measured as it is meant, or refused by an exception that names it."""

import os
import subprocess
import sys
import threading

import numpy
import pytest

import pairwave


def g(points, **settings):
    return pairwave.pair_correlation(points, bins=5, r_max=0.3, **settings).count.tolist()


def test_shapes_and_types_are_one(points):
    one = points[0]
    expected = g(one)
    strided = numpy.zeros((64, 5))
    strided[:, [1, 3]] = one
    frozen = one.copy()
    frozen.flags.writeable = False
    shifted = numpy.frombuffer(b" " + one.tobytes(), offset=1).reshape(64, 2)
    assert not shifted.flags.aligned and g(shifted) == expected
    for same in (one.tolist(), [tuple(row) for row in one], numpy.asfortranarray(one), strided[:, 1::2], frozen, one[::-1], [one]):
        assert g(same) == expected
    assert g(one.astype(">f8")) == expected
    assert g(one.astype(numpy.float32)) == g(one.astype(numpy.float32).astype(float))
    assert g(one.astype(numpy.float16)) == g(one.astype(numpy.float16).astype(float))
    assert g(numpy.array([[0, 1], [2, 3]]), box=[4, 4]) == g(numpy.array([[0.0, 1.0], [2.0, 3.0]]), box=[4, 4])
    assert g(strided, columns=[2, 4]) == expected
    assert g(iter(list(points))) == g(points) == g(list(points))
    assert pairwave.pair_correlation(one[:, 0], bins=5).count.sum() > 0


def test_edges_and_frequencies_are_arrays(points):
    edges = numpy.array([0.0, 0.05, 0.2])
    assert pairwave.pair_correlation(points, edges=edges).r_hi.tolist() == [0.05, 0.2]
    listed = pairwave.power_spectrum(points, frequencies=numpy.array([[1, 0], [2, 3]]))
    whole = pairwave.power_spectrum(points, max_frequency=3)
    numpy.testing.assert_allclose(listed.spectrum_list.p, [whole.spectrum[4, 3], whole.spectrum[5, 6]], rtol=1e-5)


def test_functions_are_integrands(points):
    found = pairwave.integrate(points, integrand=lambda x: x[:, 0] + x[:, 1])
    named = pairwave.integrate(points, integrand="formula:x+y")
    numpy.testing.assert_allclose(found.var_shifted, named.var_shifted, rtol=1e-2)
    hill = pairwave.tabulate(lambda x: x[:, 0], dim=2, cells=64)
    assert hill.error == pytest.approx(1 / 128)
    for wrong, reason in ((lambda x: x, "shape"), (lambda x: x[:, 0] / 0, "finite")):
        with pytest.raises(ValueError, match=reason), numpy.errstate(all="ignore"):
            pairwave.integrate(points, integrand=wrong)
    with pytest.raises(KeyboardInterrupt):
        pairwave.integrate(points, integrand=_interrupt)


def _interrupt(_):
    raise KeyboardInterrupt


BAD = [
    (numpy.array([[0.1, None]], dtype=object), TypeError, "objects"),
    (numpy.array([["a", "b"]]), TypeError, "real numbers"),
    (numpy.array([[1j, 0]]), TypeError, "real numbers"),
    ([[0.1, 0.2], [0.3]], ValueError, "expected"),
    ([], ValueError, "none"),
    (numpy.zeros((0, 2)), ValueError, "none"),
    (numpy.zeros((3, 0)), ValueError, "none"),
    (numpy.full((2, 4, 2), 0.5)[:, :, None], ValueError, "shape"),
    (numpy.zeros((4, 7)), ValueError, "1 to 3"),
    ([[0.1, float("nan")]], ValueError, "point 0"),
    ([[0.1, 0.2], [float("inf"), 0.2]], ValueError, "point 1"),
    ([[0.1, 0.2], [0.3, 1.5]], ValueError, "point 1"),
    (5, TypeError, "int"),
    (object(), TypeError, "object"),
    ([numpy.zeros((3, 2)), numpy.zeros((3, 3))], ValueError, "3 coordinates"),
]


@pytest.mark.parametrize("bad,kind,reason", BAD)
def test_what_is_no_points_is_refused(bad, kind, reason):
    with pytest.raises(kind, match=reason):
        pairwave.measure(bad)


def test_settings_are_named_as_keywords(points):
    for settings, reason in (
        ({"r_max": -1}, "^r_max -1"),
        ({"bins": 0}, "^bins 0"),
        ({"stats": "pfc"}, "^stats pfc"),
        ({"bandwidth": 0.1}, "kernel"),
        ({"box": [1, 2, 3]}, "^box"),
        ({"weight_column": "w"}, "weights"),
        ({"n": 5}, "^n 5"),
        ({"threads": 0}, "^threads 0"),
    ):
        with pytest.raises(ValueError, match=reason):
            pairwave.measure(points, **settings)
    with pytest.raises(TypeError, match="r_max"):
        pairwave.measure(points, rmax=1)
    with pytest.raises(FileNotFoundError):
        pairwave.measure("nowhere.csv")
    with pytest.raises(pairwave.DeviceError):
        pairwave.measure(points, device=97)
    for weights in ([1.0] * 3, numpy.full((20, 64), numpy.nan)):
        with pytest.raises(ValueError, match="weights"):
            pairwave.measure(points, weights=weights)


def test_nothing_is_passed_over(points, tmp_path):
    one = points[0]
    window = {"window": [0, 1, 0, 1], "stats": "pcf", "bins": 5}
    random = numpy.random.default_rng(3).random((19, 64, 2))
    assert "envelope" in pairwave.measure(one, envelope_from=random, **window)
    with pytest.raises(FileNotFoundError):
        pairwave.measure(one, envelope_from="nowhere.npy", **window)
    masked = numpy.ma.array(one, mask=numpy.arange(128).reshape(64, 2) == 5)
    labels = ["a", None] * 32
    for wrong, kind, reason in (
        ((masked, {}), ValueError, "masked"),
        ((one, {"weights": numpy.ma.masked_less(one[:, 0], 0.5)}), ValueError, "weights.*masked"),
        ((one, {"classes": labels}), ValueError, "classes, realization 0, point 1: None"),
        ((one, {"bins": b"3"}), TypeError, "bins"),
        ((one, {"bins": True}), TypeError, "bins True"),
        ((one, {"box": {1, 2}}), TypeError, "box: a set"),
        ((one, {"stats": {"pcf": False}}), TypeError, "stats: a dict"),
        ((one, {"integrand": []}), ValueError, "integrand"),
        ((one, {"integrand": 5}), TypeError, "integrand: a int"),
        ((one, {"integrand": lambda x: x[:, 0] + 1j}), ValueError, "integrand.*complex"),
        ((one, {"edges": [[1, 2], [3, 4]]}), ValueError, "edges: shape"),
        ((one, {"edges": [0, float("nan")]}), ValueError, r"edges\[1\]"),
        ((one, {"until_error": 5}), TypeError, r"until_error \[5\]"),
        ((one, {"time_limit": "5"}), TypeError, "time_limit"),
        ((numpy.float64(0.5), {}), ValueError, "one number"),
    ):
        with pytest.raises(kind, match=reason):
            pairwave.measure(wrong[0], **wrong[1])
    assert pairwave.pair_correlation(one, bins=numpy.array(3)).g.shape == (3,)

    def odd(x):
        return x[:, 0]

    odd.__name__ = "../../" + "a/" * 200
    assert pairwave.tabulate(odd, 1, 16).error < 0.1
    with pytest.raises(TypeError, match="n 4.9"):
        pairwave.sample("random", 4.9)


def test_frames_are_read_as_they_say(points):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"x": points[0, :, 0], "y": points[0, :, 1], "run": [0, 1] * 32, "w": numpy.arange(64.0)})
    by_column = pairwave.power_spectrum(frame, realization_column="run", weight_column="w", max_frequency=3)
    sets = [frame[frame.run == k] for k in (0, 1)]
    by_hand = pairwave.power_spectrum([s[["x", "y"]].to_numpy() for s in sets], weights=[s.w.to_numpy() for s in sets], max_frequency=3)
    numpy.testing.assert_array_equal(by_column.spectrum, by_hand.spectrum)
    assert g(pandas.DataFrame(points[0]), columns=[0, 1]) == g(points[0]) == g(frame, columns="1,2")
    for settings, reason in (
        ({"weights": frame.w.to_numpy(), "realization_column": "run"}, "weights: cannot be used with realization_column"),
        ({"weights": frame.w.to_numpy(), "weight_column": "w"}, "weights: cannot be used with weight_column"),
        ({"columns": [-1, 2]}, "columns -1"),
        ({"columns": [5, 1]}, "columns 5"),
    ):
        with pytest.raises(ValueError, match=reason):
            pairwave.measure(frame, **settings)
    frame.loc[3, "run"] = None
    with pytest.raises(ValueError, match="realization_column run: row 3"):
        pairwave.measure(frame, realization_column="run")


def test_every_setting_is_a_keyword():
    rows = {row["name"]: row for row in pairwave.settings()}
    assert len(rows) == 64 and all(row["help"] for row in rows.values())
    assert rows["r_max"]["flag"] == "--r-max" and rows["stats"]["choices"] and rows["wrap"]["switch"]


def test_threads_may_call_at_once(points):
    expected = g(points)
    found = []
    threads = [threading.Thread(target=lambda: found.append(g(points))) for _ in range(6)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert found == [expected] * 6


def test_other_threads_run_meanwhile(points):
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(1)
            done.wait(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    pairwave.measure(sampler="random", n=2000, k=40)
    done.set()
    thread.join()
    assert len(ticks) > 10


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_fork_opens_devices_anew():
    code = """
import os, pairwave
first = pairwave.pair_correlation(sampler="random", n=99, bins=4).count.tolist()
child = os.fork()
if child == 0:
    os._exit(0 if pairwave.pair_correlation(sampler="random", n=99, bins=4).count.tolist() == first else 1)
assert os.waitpid(child, 0)[1] == 0
"""
    assert subprocess.run([sys.executable, "-W", "ignore", "-c", code], timeout=100).returncode == 0


def test_an_interrupt_ends_at_once():
    code = """
import _thread, threading, time, pairwave
threading.Timer(1.0, _thread.interrupt_main).start()
start = time.monotonic()
try:
    pairwave.measure(sampler="random", n=300_000, k=100, stats="pcf", r_max=0.5)
except KeyboardInterrupt:
    raise SystemExit(0)
raise SystemExit(1)
"""
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 0


def test_what_a_callback_raises_is_raised(points):
    def tell(stage, done, total, share):
        assert 0 <= share <= 1 and done <= total
        raise ZeroDivisionError(stage)

    with pytest.raises(ZeroDivisionError):
        pairwave.measure(sampler="random", n=5000, k=200, progress=tell)
    told = []
    pairwave.measure(points, progress=lambda *what: told.append(what))
    assert told
