"""`save` and `load`: solutions in files."""

from __future__ import annotations

import json
from os import PathLike, fspath
from typing import Any, Union

import numpy as np

from ._certificate import Certificate
from ._hamiltonian import Hamiltonian
from ._solution import Solution

Path = Union[str, PathLike[str]]

#: Of files written by `Solution.save`.
FORMAT = "equip solution 2"

_ARRAYS = ("t", "y", "energy_defect", "outcome", "t_low", "y_low")


def _is_hdf5(path: Path) -> bool:
    return fspath(path).endswith((".h5", ".hdf5"))


def save(sol: Solution, path: Path) -> None:
    """Writes a solution."""
    arrays: dict[str, Any] = {name: getattr(sol, name) for name in _ARRAYS}
    arrays |= {f"t_event_{i}": t for i, t in enumerate(sol.t_events)}
    arrays |= {f"y_event_{i}": y for i, y in enumerate(sol.y_events)}
    arrays["hamiltonian"] = np.frombuffer(sol.hamiltonian.to_bytes(), dtype=np.uint8)
    words = {
        "format": FORMAT,
        "success": sol.success,
        "message": sol.message,
        "shape": sol.shape,
        "certificate": sol.certificate.to_dict(),
        "events": len(sol.t_events),
    }
    if _is_hdf5(path):
        import h5py

        with h5py.File(path, "w") as file:
            for name, array in arrays.items():
                text = array.dtype.kind == "U"
                file[name] = array.astype(h5py.string_dtype()) if text else array
            file.attrs["words"] = json.dumps(words)
    else:
        with open(path, "wb") as archive:
            np.savez_compressed(archive, words=np.array(json.dumps(words)), **arrays)


def _read(path: Path) -> tuple[str, dict[str, Any]]:
    """The words, and the arrays by name."""
    if not _is_hdf5(path):
        with np.load(path) as stored:
            arrays = {name: stored[name] for name in stored.files}
        return str(arrays.pop("words", "{}")), arrays
    import h5py

    with h5py.File(path, "r") as file:
        arrays = {name: file[name][()] for name in file}
        words = str(file.attrs.get("words", "{}"))
    if "outcome" in arrays:
        arrays["outcome"] = np.array([text.decode() for text in arrays["outcome"]], dtype=str)
    return words, arrays


def load(path: Path) -> Solution:
    """The solution that `Solution.save` wrote to `path`; it has no dense output.

    Raises
    ------
    ValueError
        If the file was not written by `Solution.save`, or its recording of H is damaged.
    """
    text, arrays = _read(path)
    words = json.loads(text)
    found = words.get("format", "")
    if found != FORMAT:
        if str(found).startswith("equip solution"):
            raise ValueError(f"{path} has the format {found!r}; this version reads {FORMAT!r}: run it again")
        raise ValueError(f"{path} is not a solution written by Solution.save")
    shape = tuple(words["shape"])
    return Solution(
        **{name: arrays[name] for name in _ARRAYS},
        shape=shape,
        t_events=tuple(arrays[f"t_event_{i}"] for i in range(words["events"])),
        y_events=tuple(arrays[f"y_event_{i}"] for i in range(words["events"])),
        success=words["success"],
        message=words["message"],
        certificate=Certificate._from_dict(words["certificate"]),
        hamiltonian=Hamiltonian.from_bytes(arrays["hamiltonian"].tobytes(), shape),
    )
