"""Results are arrays, tables, pictures and files, and survive a pickle."""

import copy
import pickle

import numpy
import pytest

import pairwave


@pytest.fixture(scope="module")
def found():
    return pairwave.measure(sampler="jittered", n=64, k=10, stats=["pcf", "spectrum"], unit="mm")


def test_attributes(found):
    assert {"pcf", "spectrum", "spectrum_radial"} <= set(dir(found))
    assert "pcf" in found and "neighbor_functions" not in found
    assert found.pcf.errors["g"] is found.pcf.g_se
    assert not found.pcf.g.flags.writeable
    with pytest.raises(AttributeError, match="neighbor_functions was not measured"):
        found.neighbor_functions
    with pytest.raises(AttributeError, match="it has r_lo"):
        found.pcf.h
    assert "g(r)" in repr(found) or "n = 64" in repr(found)
    assert found.unit == "mm" and found.summary["k"] == 10 and found.html.startswith("<!DOCTYPE html>")
    assert "<svg" in found._repr_html_() and "<table>" in found.pcf._repr_html_()


def test_a_pickle_is_the_same(found, tmp_path):
    again = pickle.loads(pickle.dumps(found))
    numpy.testing.assert_array_equal(again.pcf.g, found.pcf.g)
    numpy.testing.assert_array_equal(again.spectrum, found.spectrum)
    assert repr(again) == repr(found) and again.file("pcf.csv") == found.file("pcf.csv")
    assert again.save(tmp_path / "kept")[-1].name == "summary.json" and copy.deepcopy(found) is found
    assert not again.pcf.g.flags.writeable and not pairwave.compare(found, again).differ
    verdict = pairwave.compare(found, pairwave.measure(sampler="random", n=64, k=10, stats="pcf,spectrum"))
    assert verdict.differ and verdict.save(tmp_path / "compared")
    assert again.summary == found.summary and again._repr_html_() == found._repr_html_()


def test_frames(found):
    pytest.importorskip("pandas")
    frame = found.pcf.to_pandas()
    assert list(frame.columns) == list(found.pcf) and len(frame) == found.pcf.rows
    pytest.importorskip("xarray")
    data = found.to_xarray()
    numpy.testing.assert_array_equal(data["pcf_g"], found.pcf.g)
    assert float(data["spectrum"].sel(m_x=0, m_y=0)) == 64.0


def test_plots(found):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    for name in (None, "spectrum", "spectrum_radial", "spectrum_angular"):
        axes = found.plot(name)
        assert axes.lines or axes.images
    with pytest.raises(KeyError):
        found.plot("nothing")


def test_what_there_is(found):
    assert any(entry["name"] == "disk" for entry in pairwave.integrands())
    assert pairwave.devices()[0]["device"] == "cpu"
    assert "device: " in pairwave.explain(sampler="random", n=100, k=3)
    seen = pairwave.survey(sampler="sobol", dim=4, n=64, k=2)
    assert seen.projections.rows >= 6
