"""Words and arrays in files: NumPy archives and HDF5. A file may come from anyone, and be damaged."""

from __future__ import annotations

import errno
import json
import math
import os
import threading
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any, Optional, Union

import numpy as np
from numpy.lib import format as npy

from ._native import FileFormatError, __version__

Path = Union[str, PathLike[str]]

#: Bytes that are compressed between two looks at signals: some ten milliseconds.
_SLICE = 1 << 18
#: Deflate makes at most so many bytes of one.
_RATIO = 1032
#: Kinds of numbers and texts in files: no objects, which could be programs.
_KINDS = "biufU"


def _is_hdf5(path: Path) -> bool:
    return fspath(path).endswith((".h5", ".hdf5"))


@contextmanager
def _replacing(path: Path) -> Iterator[str]:
    """A new file next to `path`, which takes its place once it is complete and on the disk: at any time there
    is the one or the other, never a part of one."""
    target = os.path.realpath(fspath(path))
    folder, name = os.path.split(target)
    new = os.path.join(folder, f"new.{os.getpid()}.{threading.get_ident()}.{name}")
    try:
        yield new
        with open(new, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(new, target)
    except BaseException:
        with suppress(OSError):
            os.remove(new)
        raise


def write(
    path: Path, words: dict[str, Any], arrays: dict[str, Any], kind: str, axes: dict[str, tuple[str, ...]]
) -> None:
    """Writes words and arrays of a kind of file, with the version of this package, to HDF5 where the path
    ends so, which has names of the axes as well."""
    text = json.dumps({"format": kind, "equip": __version__, **words})
    with _replacing(path) as new:
        if _is_hdf5(path):
            _write_hdf5(new, text, arrays, axes)
        else:
            _write_archive(new, {"words": np.array(text), **arrays})


def _write_archive(path: str, arrays: dict[str, Any]) -> None:
    """As `numpy.savez_compressed`, which writes 16 MB before it looks at signals."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            array = np.asarray(array, order="C")
            flat = array.reshape(-1).view(np.uint8)
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                npy.write_array_header_2_0(member, npy.header_data_from_array_1_0(array))
                for start in range(0, len(flat), _SLICE):
                    member.write(flat[start : start + _SLICE].tobytes())


def _write_hdf5(path: str, text: str, arrays: dict[str, Any], axes: dict[str, tuple[str, ...]]) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        for name, array in arrays.items():
            data = array.astype(h5py.string_dtype()) if array.dtype.kind == "U" else array
            dataset = file.create_dataset(name, data.shape, data.dtype)
            rows = max(1, _SLICE // max(data[:1].nbytes, 1))
            for start in range(0, len(data), rows):
                dataset[start : start + rows] = data[start : start + rows]
            for axis, label in zip(dataset.dims, axes.get(name, ())):
                axis.label = label
        file.attrs["words"] = text


def _check_claim(size: int, stored: int) -> None:
    """Refuses what claims more bytes than those that are stored can be made of."""
    if size > _RATIO * stored + 1024:
        raise ValueError(f"{stored} bytes cannot be {size} numbers and texts")


def _member(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> Any:
    """An array of an archive, once its header agrees with the bytes that are there."""
    _check_claim(info.file_size, info.compress_size)
    with archive.open(info) as member:
        version = npy.read_magic(member)
        readers = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
        shape, is_fortran, dtype = readers[version](member)
        size = math.prod(shape) * dtype.itemsize
        if dtype.kind not in _KINDS or size != info.file_size - member.tell() or any(n < 0 for n in shape):
            raise ValueError("an array has another length than its header says")
        flat = np.empty(size, dtype=np.uint8)
        for start in range(0, size, _SLICE):
            part = flat[start : start + _SLICE]
            part[:] = np.frombuffer(member.read(len(part)), dtype=np.uint8)
        # Only at its end the checksum of the member is compared.
        if member.read(1):
            raise ValueError("an array is longer than its header says")
    return flat.view(dtype).reshape(shape, order="F" if is_fortran else "C")


def _read_archive(path: Path) -> tuple[str, dict[str, Any]]:
    with zipfile.ZipFile(path) as archive:
        members = archive.infolist()
        _check_claim(sum(info.file_size for info in members), os.path.getsize(path))
        arrays = {info.filename.removesuffix(".npy"): _member(archive, info) for info in members}
    return str(arrays.pop("words")), arrays


def _read_hdf5(path: Path) -> tuple[str, dict[str, Any]]:
    import h5py

    arrays: dict[str, Any] = {}
    with h5py.File(path, "r") as file:
        words = str(file.attrs["words"])
        for name in file:
            dataset = file[name]
            # Texts are stored elsewhere, and their places here.
            _check_claim(dataset.size * dataset.dtype.itemsize, dataset.id.get_storage_size())
            array = dataset[()]
            if array.dtype.kind == "O":
                texts = [text.decode() for text in array.ravel().tolist()]
                array = np.array(texts, dtype=str).reshape(array.shape)
            arrays[name] = array
    return words, arrays


@dataclass(frozen=True)
class Stored:
    """What was read of a file; words and arrays are checked when they are read."""

    path: Path
    words: dict[str, Any]
    arrays: dict[str, Any]

    def damaged(self, what: str) -> FileFormatError:
        return FileFormatError(f"{self.path} is damaged: {what}; write it again")

    def word(self, name: str, kind: type) -> Any:
        """A word of this type."""
        found = self.words.get(name)
        if type(found) is not kind:
            raise self.damaged(f"{name!r} is missing, or no {kind.__name__}")
        return found

    def array(self, name: str, shape: tuple[Optional[int], ...], kinds: str = "f") -> Any:
        """An array of this shape, whose axes may have any length where None stands, of doubles or another
        kind of dtype."""
        found = self.arrays.get(name)
        if not isinstance(found, np.ndarray):
            raise self.damaged(f"the array {name!r} is missing")
        fits = found.ndim == len(shape) and all(n in (None, m) for n, m in zip(shape, found.shape))
        if not fits:
            wanted = ", ".join("any" if n is None else str(n) for n in shape)
            raise self.damaged(f"the array {name!r} has shape {found.shape}, and not ({wanted})")
        kind = found.dtype.kind
        if kind not in kinds or (kind == "f" and found.dtype != np.float64):
            raise self.damaged(f"the array {name!r} has the dtype {found.dtype}")
        return found


def read(path: Path, kind: str) -> Stored:
    """What `write` wrote of this kind, such as "equip solution 3".

    Raises
    ------
    FileFormatError
        If the file is damaged, or another one.
    """
    name = kind.split()[1]
    what = {"solution": "a solution", "ensemble": "an ensemble"}[name]
    no_such = f"{path} is not {what} written by {name.capitalize()}.save, or it is damaged"
    try:
        text, arrays = _read_hdf5(path) if _is_hdf5(path) else _read_archive(path)
        words: dict[str, Any] = dict(json.loads(text))
    except ImportError:
        raise
    except Exception as error:
        # The readers of both formats raise errors of a dozen types on bytes that are not theirs.
        if isinstance(error, OSError) and error.errno not in (None, errno.EINVAL):
            raise
        raise FileFormatError(no_such) from error
    found = str(words.get("format", ""))
    if found == kind:
        return Stored(path, words, arrays)
    if found.startswith(f"equip {name}"):
        raise FileFormatError(f"{path} has the format {found!r}; this version reads {kind!r}: run it again")
    raise FileFormatError(no_such)
