"""Files from elsewhere: damaged, foreign, or with numbers that do not fit; one typed error for all of them."""

import io
import json
import pickle
import zipfile

import numpy as np
import pytest

import equip


@pytest.fixture(scope="module")
def solution():
    h = equip.Hamiltonian(lambda q, p: 0.5 * p @ p - 1 / np.sqrt(q @ q), 2)
    return equip.solve(
        h, [0.4, 0.0], [0.0, 2.0], (0, 7), step=0.25, dense_output=True, events=lambda t, q, p: q @ p
    )


@pytest.fixture(scope="module")
def rows():
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - np.cos(q[0]), 1)
    return equip.ensemble(h, np.linspace(0, 1, 4)[:, None], np.zeros((4, 1)), (0, 2), step=0.25)


def parts_of(path):
    with np.load(path) as stored:
        arrays = {name: stored[name] for name in stored.files}
    return json.loads(str(arrays.pop("words"))), arrays


def write(path, words, arrays):
    np.savez(path, words=np.array(json.dumps(words)), **arrays)


def equal(one, other):
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in ("t", "y", "outcome"))


@pytest.mark.parametrize("name", ["run.npz", "run.h5"])
def test_every_damaged_byte_is_refused_or_changes_nothing(solution, rows, tmp_path, name):
    for whole, load in ((solution, equip.load), (rows, equip.Ensemble.load)):
        path = tmp_path / name
        whole.save(path)
        content = path.read_bytes()
        draw = np.random.default_rng(1)
        places = draw.integers(len(content), size=150)
        damaged = [
            bytes([*content[:i], content[i] ^ (1 << draw.integers(8)), *content[i + 1 :]]) for i in places
        ]
        damaged += [content[:n] for n in (0, 1, 10, len(content) // 2, len(content) - 1)]
        refused = 0
        for content in damaged:
            path.write_bytes(content)
            try:
                load(path)
            except equip.FileFormatError as error:
                refused += 1
                assert str(path) in str(error)
        # HDF5 has no checksums: numbers of another value are numbers.
        assert refused > (100 if name.endswith("npz") else 5)


@pytest.mark.parametrize("load", [equip.load, equip.Ensemble.load])
@pytest.mark.parametrize("name", ["x.npz", "x.h5"])
def test_foreign_files_are_refused(tmp_path, load, name):
    path = tmp_path / name
    archive = io.BytesIO()
    np.savez(archive, a=np.zeros(3))
    objects = io.BytesIO()
    np.savez(objects, words=np.array([{}], dtype=object))
    array = io.BytesIO()
    np.save(array, np.zeros(3))
    texts = io.BytesIO()
    with zipfile.ZipFile(texts, "w") as file:
        file.writestr("words.npy", "no array")
    contents = [b"", b"text", pickle.dumps({}), *(x.getvalue() for x in (archive, objects, array, texts))]
    for content in contents:
        path.write_bytes(content)
        with pytest.raises(equip.FileFormatError, match="is not a.*written by"):
            load(path)
    assert issubclass(equip.FileFormatError, ValueError)
    with pytest.raises(FileNotFoundError):
        load(tmp_path / "nowhere.npz")
    with pytest.raises(IsADirectoryError):
        (tmp_path / "folder.npz").mkdir()
        load(tmp_path / "folder.npz")


def test_arrays_that_do_not_fit_are_refused(solution, tmp_path):
    path = tmp_path / "run.npz"
    solution.save(path)
    words, arrays = parts_of(path)
    write(path, words, arrays)
    assert equal(equip.load(path), solution)
    changes = {
        name: [array[:-1], np.concatenate([array, array]), array[None], array.astype(complex)]
        for name, array in arrays.items()
        if name not in ("t_event_0", "y_event_0") and array.dtype.kind == "f" and len(array)
    }
    changes["outcome"] = [arrays["outcome"][:-1], np.zeros(len(arrays["t"]))]
    changes["y_event_0"] = [arrays["y_event_0"][:-1]]
    changes["y"] += [arrays["y"][:, :-1], arrays["y"].astype(np.float32)]
    for name, others in changes.items():
        for other in others:
            write(path, words, {**arrays, name: other})
            with pytest.raises(equip.FileFormatError, match="is damaged"):
                equip.load(path)
    for name in arrays:
        if name not in ("curve", "energy_error", "outcome"):
            write(path, words, {other: array for other, array in arrays.items() if other != name})
            with pytest.raises(equip.FileFormatError, match="missing"):
                equip.load(path)


def test_words_that_do_not_fit_are_refused(solution, tmp_path):
    path = tmp_path / "run.npz"
    solution.save(path)
    words, arrays = parts_of(path)
    certificate = words["certificate"]
    others = [
        {**words, "shape": shape} for shape in ([], [2, 2], [-2], [2.0], "2", 2, [True, 2], [2**29], [2**70])
    ]
    others += [{**words, "events": events} for events in (0.5, "1", 2, 10**9)]
    others += [{**words, "success": 1}, {**words, "message": None}, {**words, "certificate": []}]
    others += [
        {**words, "certificate": {**certificate, name: {}}} for name in certificate if name != "outcomes"
    ]
    others += [
        {name: word for name, word in words.items() if name != lost} for lost in words if lost != "equip"
    ]
    for other in others:
        write(path, other, arrays)
        with pytest.raises(equip.FileFormatError):
            equip.load(path)
    np.savez(path, words=np.array("[" * 100_000), **arrays)
    with pytest.raises(equip.FileFormatError):
        equip.load(path)


def test_rows_that_do_not_fit_are_refused(rows, tmp_path):
    path = tmp_path / "ends.npz"
    rows.save(path)
    words, arrays = parts_of(path)
    for name, array in arrays.items():
        others = [array[None], array.astype(complex)]
        if name != "lost":
            others += [array[:-1], np.concatenate([array, array])]
        for other in others:
            write(path, words, {**arrays, name: other})
            with pytest.raises(equip.FileFormatError, match="is damaged"):
                equip.Ensemble.load(path)
    for lost in ([4], [-1]):
        write(path, words, {**arrays, "lost": np.array(lost)})
        with pytest.raises(equip.FileFormatError, match="lost runs"):
            equip.Ensemble.load(path)
    for other in ({**words, "errors": {"4": "x"}}, {**words, "errors": {"a": "x"}}, {**words, "of": 1}):
        write(path, other, arrays)
        with pytest.raises(equip.FileFormatError):
            equip.Ensemble.load(path)


def test_a_small_file_that_claims_much_is_refused_before_memory_is_taken(tmp_path):
    path = tmp_path / "run.npz"
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (2**40,)})
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("words.npy", header.getvalue() + bytes(800))
    with pytest.raises(equip.FileFormatError):
        equip.load(path)
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("t", (2**40,), "f8", chunks=(1024,))
        file.attrs["words"] = "{}"
    with pytest.raises(equip.FileFormatError):
        equip.load(path)


@pytest.mark.parametrize("name", ["run.npz", "run.h5"])
def test_the_earlier_file_is_there_until_the_new_one_is_complete(solution, tmp_path, monkeypatch, name):
    path = tmp_path / name
    solution.save(path)
    before = path.read_bytes()

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("os.fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        solution.save(path)
    assert path.read_bytes() == before and [file.name for file in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("how", [{"step": 0.25}, {"tolerance": 1e-10, "precision": "dd"}])
@pytest.mark.parametrize("span", [(0, 7), (0, -7)])
def test_dense_output_is_in_files_and_pickles(kepler, tmp_path, how, span):
    if span[1] < 0 and "step" in how:
        how = {"step": -0.25}
    sol = equip.solve(kepler, [0.4, 0.0], [0.0, 2.0], span, dense_output=True, **how)
    times = np.linspace(*span, 101)
    kept = [pickle.loads(pickle.dumps(sol))]
    for name in ("run.npz", "run.h5"):
        sol.save(tmp_path / name)
        kept.append(equip.load(tmp_path / name))
    for other in kept:
        for one, two in zip(sol.sol(times), other.sol(times)):
            assert one.tobytes() == two.tobytes()
    pushed = equip.Hamiltonian.with_time(lambda t, q, p: p @ p / 2 - q[0] * np.cos(t), 1)
    sol = equip.solve(pushed, [1.0], [0.0], (0, 3), dense_output=True)
    again = pickle.loads(pickle.dumps(sol))
    assert again.sol(1.5)[0] == sol.sol(1.5)[0]


def test_axes_in_hdf5_have_names(solution, rows, tmp_path):
    h5py = pytest.importorskip("h5py")
    solution.save(tmp_path / "run.h5")
    rows.save(tmp_path / "ends.h5")
    with h5py.File(tmp_path / "run.h5") as file:
        assert [axis.label for axis in file["y"].dims] == ["t", "component"]
    with h5py.File(tmp_path / "ends.h5") as file:
        assert [axis.label for axis in file["q"].dims] == ["run", "axis_0"]
