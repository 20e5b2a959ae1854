"""What the pages, notebooks and docstrings say runs as it stands."""

import doctest
import importlib
import importlib.util
import json
import pathlib
import re
import warnings

import pytest

import pairwave

HERE = pathlib.Path(__file__).resolve().parents[1]
MODULES = ["", "._integrands", "._measure", "._measurement", "._result", "._samplers", "._settings"]


@pytest.mark.parametrize("module", MODULES)
def test_docstrings(module):
    found = doctest.testmod(importlib.import_module("pairwave" + module))
    assert found.failed == 0


def test_everything_public_says_what_it_is():
    for name in pairwave.__all__:
        assert (getattr(pairwave, name).__doc__ or "").strip(), name


def blocks(text):
    """Pieces of Python with the program that each needs; those that are not run are left out."""
    for need, code in re.findall(r"(?:<!-- (.*?) -->\n)?```python\n(.*?)```", text, re.S):
        if need != "not run":
            yield need.removeprefix("needs ").strip(), code


@pytest.mark.parametrize("page", ["README.md", "docs/tutorial.md", "docs/coming-from.md", "docs/cluster.md"])
def test_pages(page, tmp_path, monkeypatch):
    if page == "docs/cluster.md":
        pytest.importorskip("dask")
    monkeypatch.chdir(tmp_path)
    names, ran = {}, 0
    for need, code in blocks((HERE / page).read_text()):
        if need and importlib.util.find_spec(need) is None:
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            exec(compile(code, f"{page}: {code[:40]!r}", "exec"), names)
        ran += 1
    assert ran


@pytest.mark.parametrize("notebook", sorted((HERE / "notebooks").glob("*.ipynb")), ids=lambda path: path.name)
def test_notebooks(notebook, tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    names = {}
    for cell in json.loads(notebook.read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), notebook.name, "exec"), names)


def test_links_lead_somewhere():
    for page in [HERE / "README.md", *(HERE / "docs").glob("*.md")]:
        for link in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
            assert link.startswith("http") or (page.parent / link).exists(), f"{page.name}: {link}"


def test_stubs():
    mypy = pytest.importorskip("mypy.api")
    text, errors, code = mypy.run(["--config-file", str(HERE / "pyproject.toml"), "--package", "pairwave", "--cache-dir", "/dev/null"])
    assert code == 0, text + errors
    stubtest = pytest.importorskip("mypy.stubtest")
    assert stubtest.test_stubs(stubtest.parse_options(["pairwave", "--ignore-missing-stub", "--mypy-config-file", str(HERE / "pyproject.toml")])) == 0
