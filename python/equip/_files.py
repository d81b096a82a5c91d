"""Words and arrays in files: NumPy archives and HDF5."""

from __future__ import annotations

import json
import zipfile
from os import PathLike, fspath
from typing import Any, Union

import numpy as np

from ._native import __version__

Path = Union[str, PathLike[str]]


def _is_hdf5(path: Path) -> bool:
    return fspath(path).endswith((".h5", ".hdf5"))


def write(path: Path, words: dict[str, Any], arrays: dict[str, Any], kind: str) -> None:
    """Writes words and arrays of a kind of file, with the version of this package, to HDF5 where the path
    ends so."""
    text = json.dumps({"format": kind, "equip": __version__, **words})
    if _is_hdf5(path):
        import h5py

        with h5py.File(path, "w") as file:
            for name, array in arrays.items():
                file[name] = array.astype(h5py.string_dtype()) if array.dtype.kind == "U" else array
            file.attrs["words"] = text
    else:
        with open(path, "wb") as archive:
            np.savez_compressed(archive, words=np.array(text), **arrays)


def _read(path: Path) -> tuple[str, dict[str, Any]]:
    """The words, and the arrays by name."""
    if not _is_hdf5(path):
        with np.load(path) as stored:
            if not isinstance(stored, np.lib.npyio.NpzFile):
                raise ValueError("no archive")
            arrays = {name: stored[name] for name in stored.files}
        return str(arrays.pop("words", "{}")), arrays
    import h5py

    with h5py.File(path, "r") as file:
        arrays = {name: file[name][()] for name in file}
        words = str(file.attrs.get("words", "{}"))
    if "outcome" in arrays:
        arrays["outcome"] = np.array([text.decode() for text in arrays["outcome"]], dtype=str)
    return words, arrays


def read(path: Path, kind: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """The words, and the arrays by name, that `write` wrote of this kind, such as "equip solution 3"."""
    name = kind.split()[1]
    what = {"solution": "a solution", "ensemble": "an ensemble"}[name]
    no_such = f"{path} is not {what} written by {name.capitalize()}.save"
    try:
        text, arrays = _read(path)
        words: dict[str, Any] = json.loads(text)
    except (ValueError, EOFError, OSError, zipfile.BadZipFile) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        raise ValueError(no_such) from error
    found = str(words.get("format", ""))
    if found == kind:
        return words, arrays
    if found.startswith(f"equip {name}"):
        raise ValueError(f"{path} has the format {found!r}; this version reads {kind!r}: run it again")
    raise ValueError(no_such)
