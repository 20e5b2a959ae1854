"""What tests share: the program of the command line, to compare with."""

import os
import pathlib
import shutil
import subprocess

import numpy
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def _program() -> str | None:
    named = os.environ.get("PAIRWAVE_PROGRAM")
    built = [str(ROOT / "target" / profile / "pairwave") for profile in ("debug", "release")]
    return next((path for path in [named, *built, shutil.which("pairwave")] if path and os.path.exists(path)), None)


@pytest.fixture(scope="session")
def program():
    """Runs the command line in a directory."""
    path = _program()
    if path is None:
        pytest.skip("the command line is not built; PAIRWAVE_PROGRAM names it")

    def run(*arguments, cwd):
        done = subprocess.run([path, *map(str, arguments)], cwd=cwd, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture
def points():
    """20 realizations of 64 points in the plane."""
    return numpy.random.default_rng(7).random((20, 64, 2))
