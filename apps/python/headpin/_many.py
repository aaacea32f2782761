"""Many replays: trials under a table of conditions, on all cores."""

import json
import os
import sys
from pathlib import Path

import numpy as np

from . import _headpin


def replay_many(trials, table, threads=0, progress=None):
    """Replays every trial under every condition of a table, in threads of C++.

    trials: paths or Trial objects; one, or a list. Each item of the list has its rows, in that
        order: also a trial that is there twice, which counts twice in a mean over the rows.
        (`headpin sweep` refuses one.)
    table: the conditions. A dict of columns (a key and its values; a single value stands for all
        rows), a list of dicts, a structured array or a pandas data frame. The keys are those of
        `headpin sweep`: elasticity, friction, shape, response, detection, iterations, and every key
        of a scenario, such as ball.mass.
    threads: how many at most; 0: one for each core. With fewer, if no more can be made.
    progress: a function (done, total), called ten times a second; None: a line on a terminal or in
        a notebook; False: nothing.

    Returns a structured array of one row per replay; all trials under the first condition come
    first. Its columns are trial (its name), the keys, and the results with the names and units of
    `headpin sweep` (docs/guides/sweeps.md), equal to them bit for bit. A number that a replay does
    not have is NaN. A replay that fails has its reason in the column error, which is empty else.

    Raises ValueError for a key that is none. Ctrl-C stops it.
    """
    trials = [trials] if _is_one(trials) else list(trials)
    keys, conditions = _conditions(table)
    for key in keys:
        if not isinstance(key, str):
            raise ValueError(f"table: expected texts as keys, found {key!r}")
    line = _Line() if progress is None else None
    try:
        results = _headpin._replay_many(
            [_path(trial, "_file") for trial in trials],
            keys,
            [[_of_key(*pair) for pair in zip(keys, values)] for values in conditions],
            threads,
            line or progress or None,
        )
    finally:
        if line:
            line.erase()
    columns = {"trial": [Path(_path(trial, "path")).stem for trial in trials] * len(conditions)}
    for i, key in enumerate(keys):
        columns[key] = np.repeat(_column([values[i] for values in conditions]), len(trials))
    columns.update(results)
    return _structured(columns)


def _is_one(trials):
    return isinstance(trials, (str, bytes, os.PathLike)) or hasattr(trials, "path")


def _path(trial, which):
    """The path of a trial; of a Trial, `path` is as it was named, `_file` is whole."""
    return os.fsdecode(getattr(trial, which, getattr(trial, "path", trial)))


def _conditions(table):
    """The keys of a table, and the values of each row."""
    if hasattr(table, "to_records"):
        table = {name: list(table[name]) for name in table.columns}
    names = getattr(getattr(table, "dtype", None), "names", None)
    if names:
        table = {name: table[name] for name in names}
    if isinstance(table, dict):
        return list(table), _rows(table)
    rows = list(table)
    for number, row in enumerate(rows):
        if not hasattr(row, "keys"):
            raise ValueError(f"table: row {number}: expected a dict of keys and values, found {row!r}")
    keys = list(rows[0]) if rows else []
    for number, row in enumerate(rows):
        if set(row) != set(keys):
            raise ValueError(
                f"table: row {number}: expected the keys {', '.join(keys)}, found {', '.join(row)}"
            )
    return keys, [[row[key] for key in keys] for row in rows]


def _rows(columns):
    lengths = {key: len(column) for key, column in columns.items() if _is_column(column)}
    if len(set(lengths.values())) > 1:
        found = ", ".join(f"{key} {length}" for key, length in lengths.items())
        raise ValueError(f"table: expected columns of one length, found {found}")
    length = next(iter(lengths.values()), 1)
    full = [column if key in lengths else [column] * length for key, column in columns.items()]
    return [list(row) for row in zip(*full)] if full else [[]]


def _is_column(values):
    is_single = isinstance(values, (str, bytes)) or getattr(values, "ndim", 1) == 0
    return hasattr(values, "__len__") and not is_single


def _of_key(key, value):
    """A value as `headpin sweep` has it: of these keys a name, of all others in TOML."""
    value = _plain(value)
    return value if key in ("shape", "response", "detection") and isinstance(value, str) else _text(value)


def _plain(value):
    """A single value of numpy as one of Python."""
    if value is np.ma.masked:
        raise ValueError("table: expected numbers, texts, truth values or lists of them, found a masked value")
    if isinstance(value, np.generic) or (isinstance(value, np.ndarray) and value.ndim == 0):
        return value.item()
    return value


def _text(value):
    """A value in TOML."""
    value = _plain(value)
    if isinstance(value, str):
        # TOML's and JSON's texts are written alike, but TOML takes no halves of a letter, and no U+007F.
        # A half that the text has itself stays one, which TOML refuses.
        text = json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        return text.encode("utf-8", "backslashreplace").decode()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):  # also an enum, which has other words for its number
        return int.__repr__(value) if isinstance(value, int) else float.__repr__(value)
    if _is_column(value):
        return "[" + ", ".join(_text(one) for one in value) + "]"
    raise ValueError(f"table: expected numbers, texts, truth values or lists of them, found {value!r}")


def _column(values):
    """Values as an array of one dimension; lists become texts."""
    if any(_is_column(value) for value in values):
        return np.array([_text(value) for value in values], dtype=object)
    return np.asarray(values)


def _structured(columns):
    arrays = {
        name: np.asarray(column, dtype=str if isinstance(column, list) else None)
        for name, column in columns.items()
    }
    for name, array in arrays.items():
        if array.dtype.kind == "U" and array.dtype.itemsize == 0:
            arrays[name] = array.astype("U1")
    length = len(arrays["trial"])
    table = np.empty(length, dtype=[(name, array.dtype) for name, array in arrays.items()])
    for name, array in arrays.items():
        table[name] = array
    return table


class _Line:
    """A progress line: on a terminal, and under the cell of a notebook; nothing elsewhere."""

    def __init__(self):
        self._handle = None
        self._width = 0
        self._show = self._nothing
        if "ipykernel" in sys.modules:
            self._show = self._in_notebook
        elif sys.stderr.isatty():
            self._show = self._on_terminal

    def __call__(self, done, total):
        self._show(f"{done} of {total} replays")

    def erase(self):
        if self._width:
            self._on_terminal("")
            print("\r", end="", file=sys.stderr, flush=True)
        if self._handle:
            self._in_notebook("")

    def _nothing(self, text):
        pass

    def _on_terminal(self, text):
        print("\r" + text.ljust(self._width), end="", file=sys.stderr, flush=True)
        self._width = len(text)

    def _in_notebook(self, text):
        from IPython.display import display

        said = {"text/plain": text}
        if self._handle:
            self._handle.update(said, raw=True)
        else:
            self._handle = display(said, raw=True, display_id=True)
