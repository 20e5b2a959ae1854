"""What was found: arrays by the names of the files and columns of the command line."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from . import _pairwave

#: The tables and arrays that there may be, by what they are called.
_TABLES = tuple(name[:-4] for name in _pairwave.Analysis.file_names() if name.endswith(".csv"))
_ARRAYS = tuple(name[:-4] for name in _pairwave.Analysis.file_names() if name.endswith(".npy"))


class Table(Mapping[str, Any]):
    """Columns of equal length, as attributes and by name.

    Numbers are read-only arrays of float64 (NaN where undefined) or uint64, words are lists. A column ``g_se`` is the standard error of ``g``.

    Examples
    --------
    >>> import pairwave
    >>> table = pairwave.measure(sampler="jittered", n=64, stats="pcf", bins=4).pcf
    >>> table.r.shape, table["count"].dtype
    ((4,), dtype('uint64'))
    """

    def __init__(self, name: str, columns: Mapping[str, Any]) -> None:
        self._name = name
        self._columns = dict(columns)

    def __getitem__(self, name: str) -> Any:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return self._columns[name]
        except KeyError:
            raise AttributeError(f"{self._name} has no column {name!r}; it has {', '.join(self._columns)}") from None

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._columns})

    def __reduce__(self) -> tuple[Any, ...]:
        return _table, (self._name, self._columns)

    def __copy__(self) -> Table:
        return self

    def __deepcopy__(self, _: Any) -> Table:
        return self

    @property
    def rows(self) -> int:
        """The number of rows."""
        return max((len(column) for column in self._columns.values()), default=0)

    @property
    def errors(self) -> dict[str, Any]:
        """The standard errors, by the column they are of."""
        return {name[:-3]: column for name, column in self._columns.items() if name.endswith("_se")}

    def to_pandas(self) -> Any:
        """As a ``pandas.DataFrame``; needs pandas."""
        import pandas

        return pandas.DataFrame(self._columns)

    def __repr__(self) -> str:
        return f"<{self._name}: {self.rows} rows of {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{_plain(name)}</th>" for name in self._columns)
        shown = min(self.rows, 10)
        rows = "".join(
            "<tr>" + "".join(f"<td>{_plain(_short(column[k]))}</td>" for column in self._columns.values()) + "</tr>"
            for k in range(shown)
        )
        more = f"<caption>{_plain(self._name)}, {self.rows} rows</caption>"
        return f"<table>{more}<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _frozen(column: Any) -> Any:
    """What was measured is not written to."""
    if isinstance(column, np.ndarray):
        column.flags.writeable = False
    return column


def _table(name: str, columns: Mapping[str, Any]) -> Table:
    return Table(name, {column: _frozen(values) for column, values in columns.items()})


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _plain(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


class _Kept:
    """All of a result as it came out of a pickle."""

    def __init__(self, of: dict[str, Any]) -> None:
        self._of = of
        self.headline: str = of["headline"]
        self.warnings: list[str] = of["warnings"]
        self.device: str = of["device"]
        self.unit: str | None = of["unit"]

    def table(self, name: str) -> dict[str, Any] | None:
        found: dict[str, Any] | None = self._of["tables"].get(name)
        return found

    def array(self, name: str) -> Any | None:
        return self._of["arrays"].get(name)

    def file(self, name: str) -> bytes | None:
        found: bytes | None = self._of["files"].get(name)
        return found

    def save(self, out: Path, force: bool) -> list[Path]:
        """Writes the same files, the summary last."""
        if (out / "summary.json").exists() and not force:
            raise ValueError(f"out {out}: holds a result already; force replaces it")
        out.mkdir(parents=True, exist_ok=True)
        files: dict[str, bytes] = dict(self._of["files"])
        summary = json.loads(files.pop("summary.json"))
        summary["files"] = [*files, "summary.json"]
        files["summary.json"] = (json.dumps(summary, indent=2, ensure_ascii=False) + "\n").encode()
        for name, content in files.items():
            (out / name).write_bytes(content)
        return [out / name for name in files]


class Result:
    """What was found about points.

    Tables and arrays are attributes under the names of the command line's files: ``result.pcf.g``, ``result.spectrum``. What belongs to the
    main table of a function such as :func:`pair_correlation` is there under its own name too: ``pair_correlation(points).g``.

    Attributes
    ----------
    tables, arrays : dict
        All that there are.
    warnings : list of str
        What there is to know about the numbers.
    device : str
        What computed them.
    unit : str or None
        The name of the unit of lengths.
    summary : dict
        What ``summary.json`` holds.
    """

    def __init__(self, found: _pairwave.Analysis | _Kept, sums: _pairwave.Measurement | None = None, main: str | None = None) -> None:
        self._found = found
        self._sums = sums
        self._main = main
        self._known: dict[str, Any] = {}

    def _get(self, name: str) -> Any:
        """A table or an array; None where there is none."""
        if name not in self._known:
            made: Any = None
            if name in _TABLES:
                columns = self._found.table(name)
                made = None if columns is None else Table(name, columns)
            elif name in _ARRAYS:
                made = self._found.array(name)
            self._known[name] = made
        return self._known[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        found = self._get(name)
        if found is not None:
            return found
        if self._main is not None:
            main = self._get(self._main)
            if isinstance(main, Table) and name in main:
                return main[name]
        there = ", ".join([*self.tables, *self.arrays])
        if name in _TABLES or name in _ARRAYS:
            raise AttributeError(f"{name} was not measured; there are {there}")
        raise AttributeError(f"there is no {name!r}; there are {there}")

    def __getitem__(self, name: str) -> Any:
        found = self._get(name)
        main = self._get(self._main) if found is None and self._main else None
        if isinstance(main, Table):
            return main[name]
        if found is None:
            raise KeyError(name)
        return found

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self._get(name) is not None

    def __dir__(self) -> list[str]:
        main = self._get(self._main) if self._main else None
        return sorted({*super().__dir__(), *self.tables, *self.arrays, *(main or ())})

    @property
    def tables(self) -> dict[str, Table]:
        """All tables by name."""
        return {name: self._get(name) for name in _TABLES if self._get(name) is not None}

    @property
    def arrays(self) -> dict[str, np.ndarray[Any, Any]]:
        """All arrays by name."""
        return {name: self._get(name) for name in _ARRAYS if self._get(name) is not None}

    @property
    def warnings(self) -> list[str]:
        """What there is to know about the numbers."""
        return list(self._found.warnings)

    @property
    def device(self) -> str:
        """What computed them."""
        return self._found.device

    @property
    def unit(self) -> str | None:
        """The name of the unit of lengths."""
        return self._found.unit

    @property
    def summary(self) -> dict[str, Any]:
        """What ``summary.json`` holds, without the list of files."""
        found: dict[str, Any] = json.loads(self._found.file("summary.json") or b"{}")
        return found

    @property
    def html(self) -> str:
        """The page that the command line writes, which needs nothing beside it."""
        return (self._found.file("report.html") or b"").decode()

    def file(self, name: str) -> bytes:
        """The bytes of a file as the command line writes it, such as ``pcf.csv`` or ``spectrum.png``.

        Raises
        ------
        KeyError
            A file that this result does not have.
        """
        found = self._found.file(name)
        if found is None:
            raise KeyError(name)
        return found

    def save(
        self, out: str | os.PathLike[str], *, force: bool = False, keep_sums: bool = False, npz: bool = False
    ) -> list[Path]:
        """Writes the directory that the command line writes.

        Parameters
        ----------
        out : path
            To be created.
        force : bool
            Whether a result that is there is replaced.
        keep_sums : bool
            Whether the raw sums stand beside it, for ``pairwave merge`` and :class:`Measurement`.
        npz : bool
            Whether all numbers are in one file too.

        Returns
        -------
        list of Path
            The files.
        """
        if keep_sums and self._sums is None:
            raise ValueError("keep_sums True: the sums of this result are not here")
        if isinstance(self._found, _Kept):
            if npz:
                raise ValueError("npz True: what came out of a pickle has no such file; expected it to be saved before")
            return self._found.save(Path(out), force)
        sums = self._sums.write() if keep_sums and self._sums is not None else None
        return [Path(path) for path in self._found.write(os.fspath(out), force, sums, npz)]

    def to_pandas(self, name: str | None = None) -> Any:
        """A table as a ``pandas.DataFrame``, by default the main one; needs pandas."""
        table = self._get(name or self._main or next(iter(self.tables), ""))
        if not isinstance(table, Table):
            raise KeyError(name)
        return table.to_pandas()

    def to_xarray(self) -> Any:
        """All numbers as an ``xarray.Dataset``; needs xarray.

        A column ``g`` of the table ``pcf`` is the variable ``pcf_g`` along the dimension ``pcf``, whose coordinate is its first column of
        numbers. P on the grid has the coordinates ``m_x``, ``m_y``, ``m_z``.
        """
        import xarray

        variables: dict[str, Any] = {}
        coordinates: dict[str, Any] = {}
        for name, table in self.tables.items():
            first = next((column for column in table.values() if isinstance(column, np.ndarray)), None)
            if first is not None and len(np.unique(first)) == len(first):
                coordinates[name] = first
            for column, values in table.items():
                variables[f"{name}_{column}"] = (name, values)
        for name, array in self.arrays.items():
            if name.startswith("spectrum") and all(side % 2 for side in array.shape) and array.ndim <= 3:
                axes = [f"m_{axis}" for axis in "xyz"[: array.ndim]]
                for axis, side in zip(axes, array.shape):
                    coordinates.setdefault(axis, np.arange(side) - side // 2)
                variables[name] = (axes, array)
            else:
                variables[name] = ([f"{name}_{k}" for k in range(array.ndim)], array)
        attributes = {"unit": self.unit or "", "device": self.device, "program": f"pairwave {_pairwave.__version__}"}
        return xarray.Dataset(variables, coordinates, attributes)

    def plot(self, name: str | None = None, *, ax: Any = None) -> Any:
        """Draws a table or P by matplotlib, in the style of the page; needs matplotlib.

        Parameters
        ----------
        name : str, optional
            A table such as ``pcf`` or ``spectrum_radial``, or an array with two axes such as ``spectrum``; by default the main one.
        ax : matplotlib.axes.Axes, optional
            Where to.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from ._plot import draw

        return draw(self, name or self._main, ax)

    # It does not change.
    def __copy__(self) -> Result:
        return self

    def __deepcopy__(self, _: Any) -> Result:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        names = [*_pairwave.Analysis.file_names(), "summary.json", "report.html"]
        files = {name: self._found.file(name) for name in names}
        kept = {
            "tables": {name: dict(table) for name, table in self.tables.items()},
            "arrays": self.arrays,
            "files": {name: content for name, content in files.items() if content is not None},
            "headline": self._found.headline,
            "warnings": self.warnings,
            "device": self.device,
            "unit": self.unit,
        }
        return _unpickled, (kept, self._main)

    def __repr__(self) -> str:
        return self._found.headline.rstrip("\n")

    def _repr_html_(self) -> str:
        pictures = []
        for name in _pairwave.Analysis.file_names():
            if name.endswith(".svg") and (svg := self._found.file(name)):
                pictures.append(f'<div style="max-width:44em">{svg.decode()}</div>')
            elif name.endswith(".png") and name != "spectrum_grey.png" and (png := self._found.file(name)):
                import base64

                data = base64.b64encode(png).decode()
                pictures.append(f'<img alt="{name[:-4]}" style="max-width:32em" src="data:image/png;base64,{data}">')
        warned = "".join(f"<p>Warning: {_plain(text)}</p>" for text in self.warnings)
        return f"<pre>{_plain(repr(self))}</pre>{warned}{''.join(pictures)}"


def _unpickled(kept: dict[str, Any], main: str | None) -> Result:
    for values in (kept["arrays"], *kept["tables"].values()):
        for column in values.values():
            _frozen(column)
    return Result(_Kept(kept), None, main)


class Found:
    """What a run over several batches found: its tables as attributes.

    Attributes
    ----------
    tables : dict of Table
        By the names of the command line's files.
    warnings : list of str
        What there is to know about them.
    differ : bool or None
        Of :func:`compare`, whether any result differs from the first.
    """

    def __init__(self, found: _pairwave.Found, command: str, room: Any = None) -> None:
        self._found: _pairwave.Found | None = found
        self._room = room
        self._command = command
        self._text = found.text
        self.tables = {name: Table(name, columns) for name, columns in found.tables().items()}
        self.warnings = list(found.warnings)
        self.differ = found.differ

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or "tables" not in self.__dict__:
            raise AttributeError(name)
        if name in self.tables:
            return self.tables[name]
        raise AttributeError(f"there is no {name!r}; there are {', '.join(self.tables)}")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.tables})

    def save(self, out: str | os.PathLike[str], *, force: bool = False) -> list[Path]:
        """Writes the directory that the command line writes, and returns its files."""
        if self._found is None:
            raise ValueError("save: this came out of a pickle; save it before")
        return [Path(path) for path in self._found.write(os.fspath(out), force, self._command)]

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_found": None, "_room": None}

    def __repr__(self) -> str:
        return self._text.rstrip("\n")
