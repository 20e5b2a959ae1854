"""Everything that is returned is, to the byte, what the command line writes for the same request."""

import csv
import json
import pickle

import numpy
import pytest

import pairwave

CASES = [
    ({"stats": "pcf,spectrum,neighbors,k-function"}, []),
    ({"stats": ["pcf"], "r_max": 0.2, "bins": 7, "kernel": "epanechnikov"}, []),
    ({"stats": "spectrum,radial", "max_frequency": 6, "accuracy": "high"}, []),
    ({"stats": "pcf-vector,discrepancy,counts,intensity,covariance", "covariance_frequency": 2}, []),
    ({"stats": "pcf,k-function,neighbors", "window": [0, 1, 0, 1], "correction": "isotropic"}, []),
    ({"stats": "pcf", "envelope": 19, "seed": 3, "bins": 12}, []),
    ({"stats": "spectrum", "integrand": ["disk", "step"], "shifts": 4, "top": 5}, []),
]


def written(settings):
    """Settings as flags."""
    for name, value in settings.items():
        for one in value if name == "integrand" else [value]:
            text = ",".join(map(str, one)) if isinstance(one, list) else str(one)
            yield f"--{name.replace('_', '-')}={text}"


@pytest.mark.parametrize("settings,more", CASES, ids=lambda value: str(value)[:40])
def test_files_of_arrays_are_those_of_the_command_line(settings, more, points, program, tmp_path):
    numpy.save(tmp_path / "points.npy", points)
    program("analyze", "points.npy", *written(settings), "--device=cpu", "--quiet", "--out=out", cwd=tmp_path)
    found = pairwave.measure(points, device="cpu", **settings)
    names = json.loads((tmp_path / "out/summary.json").read_text())["files"]
    compared = [name for name in names if name not in ("report.html", "summary.json", "run.toml")]
    assert len(compared) > 1
    for name in compared:
        ours = found.file(name)
        theirs = (tmp_path / "out" / name).read_bytes()
        # Titles of pictures and a column name the points.
        if name.endswith(".svg") or name == "variance.csv":
            ours, theirs = (text.replace(b"points in memory", b"points.npy") for text in (ours, theirs))
        assert ours == theirs, name
    # The attributes are these files.
    for name in compared:
        stem = name.split(".")[0]
        if name.endswith(".npy"):
            array = numpy.load(tmp_path / "out" / name)
            assert array.dtype == found[stem].dtype
            numpy.testing.assert_array_equal(array, found[stem])
        elif name.endswith(".csv"):
            rows = list(csv.DictReader((tmp_path / "out" / name).open()))
            assert list(rows[0]) == list(found[stem])
            for column, values in found[stem].items():
                cells = [row[column] for row in rows]
                if isinstance(values, numpy.ndarray):
                    read = numpy.array([float(cell) if cell else numpy.nan for cell in cells])
                    numpy.testing.assert_array_equal(read, values.astype(float))
                else:
                    assert [cell.replace("points.npy", "points in memory") for cell in cells] == values
    theirs = json.loads((tmp_path / "out/summary.json").read_text())
    ours = found.summary
    for key in set(theirs) - {"subject", "input", "parameters", "files", "timings_seconds", "warnings"}:
        assert ours[key] == theirs[key], key


def test_saved_results_are_those_of_the_command_line(points, program, tmp_path):
    numpy.save(tmp_path / "points.npy", points)
    program("analyze", "points.npy", "--stats=pcf", "--device=cpu", "--quiet", "--npz", "--out=out", cwd=tmp_path)
    files = pairwave.measure(points, stats="pcf", device="cpu").save(tmp_path / "ours", npz=True)
    assert (tmp_path / "ours/pcf.csv").read_bytes() == (tmp_path / "out/pcf.csv").read_bytes()
    both = [numpy.load(tmp_path / where / "results.npz") for where in ("out", "ours")]
    assert both[0].files == both[1].files
    assert tmp_path / "ours" / "summary.json" in files
    with pytest.raises(ValueError, match="force"):
        pairwave.measure(points, stats="pcf").save(tmp_path / "ours")


def test_weights_and_classes_are_columns(points, program, tmp_path):
    random = numpy.random.default_rng(8)
    one = points[0]
    weights, labels = random.random(64), random.choice(["oak", "ash"], 64)
    rows = [f"{x!r},{y!r},{w!r},{c}" for (x, y), w, c in zip(one.tolist(), weights.tolist(), labels)]
    (tmp_path / "points.csv").write_text("x,y,w,c\n" + "\n".join(rows) + "\n")
    flags = ["--stats=pcf", "--bins=6", "--device=cpu", "--quiet"]
    program("analyze", "points.csv", *flags, "--class-column=c", "--out=of_classes", cwd=tmp_path)
    program("analyze", "points.csv", *flags, "--weight-column=w", "--out=of_weights", cwd=tmp_path)
    of_classes = pairwave.measure(one, classes=labels, stats="pcf", bins=6, device="cpu")
    of_weights = pairwave.measure(one, weights=weights, stats="pcf", bins=6, device="cpu")
    assert of_classes.file("pcf_cross.csv") == (tmp_path / "of_classes/pcf_cross.csv").read_bytes()
    assert of_weights.file("pcf.csv") == (tmp_path / "of_weights/pcf.csv").read_bytes()
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"x": one[:, 0], "y": one[:, 1], "w": weights, "c": labels})
    assert pairwave.measure(frame, class_column="c", stats="pcf", bins=6).file("pcf_cross.csv") == of_classes.file("pcf_cross.csv")
    assert of_classes.summary["input"]["columns"] == []
    read = pairwave.measure(frame, class_column="c", stats="pcf", bins=6).summary["input"]
    assert (read["columns"], read["unused_columns"]) == (["x", "y"], ["w"])
    assert pairwave.measure(frame, weight_column="w", stats="pcf", bins=6).file("pcf.csv") == of_weights.file("pcf.csv")


def test_samples_are_those_of_the_command_line(program, tmp_path):
    program("sample", "jittered", "-n", 16, "-k", 3, "--seed", 5, "--out", "points.npy", "--quiet", cwd=tmp_path)
    numpy.testing.assert_array_equal(pairwave.sample("jittered", 16, 3, seed=5), numpy.load(tmp_path / "points.npy"))
    assert {type(array) for array in pairwave.sample("poisson", 20, 3)} == {numpy.ndarray}


def test_convergence_prediction_and_comparison(program, tmp_path):
    flags = ["--sampler=jittered", "-n=16,64", "-k=10", "--integrand=disk", "--device=cpu", "--quiet", "--out=out"]
    program("convergence", *flags, cwd=tmp_path)
    found = pairwave.convergence(sampler="jittered", n=[16, 64], k=10, integrand="disk", device="cpu")
    found.save(tmp_path / "ours")
    again = pickle.loads(pickle.dumps(found))
    assert repr(again) == repr(found) and again.slopes.slope.tolist() == found.slopes.slope.tolist()
    for name in ("convergence.csv", "slopes.csv", "convergence.svg"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "ours" / name).read_bytes()
    program("integrate", "--p=jittered", "-n=64", "--integrand=disk", "--quiet", "--out=p", cwd=tmp_path)
    pairwave.integrate(p="jittered", n=64, integrand="disk").save(tmp_path / "q")
    assert (tmp_path / "p/variance.csv").read_bytes() == (tmp_path / "q/variance.csv").read_bytes()
    one = pairwave.measure(sampler="jittered", n=64, k=9, stats="pcf", bins=8)
    one.save(tmp_path / "one")
    same = pairwave.compare(tmp_path / "one", pairwave.measure(sampler="jittered", n=64, k=9, seed=2, stats="pcf", bins=8))
    assert same.differ is False and same.comparison.rows > 0
