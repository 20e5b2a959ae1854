"""How the samples of a pattern are correlated, and what that does to integration error.

>>> import pairwave
>>> found = pairwave.measure(sampler="jittered", n=256, k=10, stats=["pcf", "radial"])
>>> found.pcf.g, found.spectrum_radial.p  # doctest: +ELLIPSIS
(array(...), array(...))

A call measures (:func:`measure`, or one of its shorter names), a :class:`Measurement` grows, and ``pairwave.distributed`` runs on a cluster.
"""

import os as _os

from . import _pairwave
from ._integrands import Tabulated, integrands, tabulate
from ._measure import (
    compare,
    convergence,
    explain,
    integrate,
    intensity,
    k_function,
    measure,
    neighbors,
    pair_correlation,
    power_spectrum,
    survey,
)
from ._measurement import Measurement
from ._pairwave import DeviceError, __version__
from ._result import Found, Result, Table
from ._samplers import devices, sample, samplers
from ._settings import settings

# Threads do not survive a fork: a child opens devices anew.
if hasattr(_os, "register_at_fork"):
    _os.register_at_fork(after_in_child=_pairwave.forget_devices)

__all__ = [
    "DeviceError",
    "Found",
    "Measurement",
    "Result",
    "Table",
    "Tabulated",
    "__version__",
    "compare",
    "convergence",
    "devices",
    "explain",
    "integrands",
    "integrate",
    "intensity",
    "k_function",
    "measure",
    "neighbors",
    "pair_correlation",
    "power_spectrum",
    "sample",
    "samplers",
    "settings",
    "survey",
    "tabulate",
]
