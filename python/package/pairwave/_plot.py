"""Figures by matplotlib, in the colours of the page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._result import Result

#: Of curves one after the other (Okabe & Ito 2008).
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")

#: What is drawn of a table: abscissa, its label, curves.
_CURVES: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "pcf": ("r", "r", ("g", "g_smooth")),
    "k_function": ("r", "r", ("l_minus_r",)),
    "spectrum_radial": ("nu", "frequency \u03bd", ("p",)),
    "spectrum_angular": ("theta_lo", "direction (degrees)", ("p",)),
}


def draw(result: Result, name: str | None, ax: Any) -> Any:
    """Draws a table or an array."""
    from matplotlib import pyplot

    if name is None:
        name = next((known for known in _CURVES if known in result), None) or next(iter(result.tables), None)
    if name is None:
        raise ValueError("plot: there is nothing to draw")
    axes = pyplot.subplots()[1] if ax is None else ax
    found = result[name]
    if isinstance(found, np.ndarray):
        _picture(found, name, axes)
    else:
        _curves(found, name, result.unit, axes)
    return axes


def _picture(array: np.ndarray[Any, Any], name: str, axes: Any) -> None:
    if array.ndim != 2 or np.iscomplexobj(array):
        raise ValueError(f"plot: {name} has shape {array.shape} of {array.dtype}; expected two axes of real numbers")
    half = [(side - 1) / 2 for side in array.shape]
    extent = (-half[0] - 0.5, half[0] + 0.5, -half[1] - 0.5, half[1] + 0.5)
    top = float(np.nanpercentile(array, 99.5)) or 1.0
    image = axes.imshow(array.T, origin="lower", extent=extent, vmin=0.0, vmax=max(top, 1e-300), cmap="viridis")
    axes.set(xlabel="m_x", ylabel="m_y", title=name)
    axes.figure.colorbar(image, ax=axes)


def _curves(table: Any, name: str, unit: str | None, axes: Any) -> None:
    numbers = [column for column, values in table.items() if isinstance(values, np.ndarray)]
    x, label, wanted = _CURVES.get(name, (numbers[0], numbers[0], tuple(c for c in numbers[1:] if not c.endswith("_se"))))
    if x not in table:
        x = label = numbers[0]
    curves = [column for column in wanted if column in table] or [c for c in numbers if c != x and not c.endswith("_se")]
    for column, color in zip(curves, _COLORS):
        axes.plot(table[x], table[column], color=color, linewidth=1.3, label=column)
        error = table.errors.get(column)
        if error is not None:
            low, high = table[column] - error, table[column] + error
            axes.fill_between(table[x], low, high, color=color, alpha=0.25, linewidth=0)
    if name in ("pcf", "spectrum_radial", "spectrum_angular"):
        axes.axhline(1.0, color="#999999", linewidth=0.8)
    axes.set(xlabel=f"{label} ({unit})" if unit and x == "r" else label, title=name)
    if len(curves) > 1:
        axes.legend(frameon=False)
