"""What a run leaves: certificate, files, tables, pictures."""

import copy
import json
import pickle

import matplotlib
import numpy as np
import pytest

import equip

matplotlib.use("Agg")


@pytest.fixture(scope="module")
def sol():
    scene = equip.scenes.kepler()
    return equip.solve(
        scene,
        scene.q0,
        scene.p0,
        (0, 10),
        invariants=scene.invariants,
        events=lambda t, q, p: q[1],
        chaos=True,
    )


def test_certificate(sol):
    certificate = sol.certificate
    assert certificate.energy_conserved_on_every_step and certificate.energy_in_round_off_levels <= 8
    assert (
        certificate.energy_round_off.round_off < 1e-14
        and certificate.energy_round_off.scale == pytest.approx(0.5)
    )
    assert certificate.phase_per_step.angle < 8 and certificate.motion_is_resolved
    assert certificate.energy.start == pytest.approx(-0.5, abs=1e-15)
    assert certificate.counts.steps == sum(certificate.outcomes.values()) == len(sol.t) - 1
    assert certificate.start == 0 and certificate.end == 10 and certificate.precision == "f64"
    assert certificate.variable_steps.smallest <= certificate.step <= certificate.variable_steps.largest
    assert certificate.variable_steps.tolerance == 1e-12
    assert len(certificate.alpha_range) in (0, 7) and certificate.lyapunov is not None
    assert certificate.energy.max == np.abs(sol.energy_error).max()
    assert str(certificate).startswith("energy conserved to round-off: yes, on every step\n")
    assert certificate.energy_conserved_to_round_off == "yes, on every step"
    assert next(iter(certificate.to_dict())) == "energy_conserved_to_round_off"
    assert "energy error" in str(certificate)
    with pytest.raises(AttributeError):
        certificate.step = 1


def test_certificate_as_a_dict_and_a_table(sol):
    stored = json.loads(json.dumps(sol.certificate.to_dict()))
    assert (
        stored["energy"]["max"] == sol.certificate.energy.max
        and stored["counts"]["steps"] == sol.certificate.counts.steps
    )
    assert equip.Certificate._from_dict(stored) == sol.certificate
    table = sol.certificate._repr_html_()
    assert table.count("<tr>") == len(str(sol.certificate).splitlines())
    assert table.startswith(
        '<table><tr><th colspan="2">energy conserved to round-off: yes, on every step</th></tr>'
    )
    assert "<td>method</td><td>EQUIP, 8 stages, order 16 in f64</td>" in table


@pytest.mark.parametrize("name", ["run.npz", "run.h5"])
def test_files(sol, tmp_path, name):
    if name.endswith(".h5"):
        pytest.importorskip("h5py")
    path = tmp_path / name
    sol.save(path)
    again = equip.load(path)
    for name in ("t", "y", "q", "p", "energy_error", "outcome", "t_low", "y_low"):
        assert np.array_equal(getattr(again, name), getattr(sol, name))
    assert again.certificate == sol.certificate and again.success and again.message == sol.message
    assert all(
        np.array_equal(a, b) for a, b in zip(again.y_events + again.t_events, sol.y_events + sol.t_events)
    )
    with pytest.raises(ValueError, match="no dense output"):
        again.sol(1.0)
    # A loaded run goes on.
    rest = [
        equip.solve(x.hamiltonian, x.q[-1], x.p[-1], (x.t[-1], 20), events=lambda t, q, p: q[1])
        for x in (sol, again)
    ]
    assert np.array_equal(rest[0].y, rest[1].y) and rest[1].t[-1] == 20


def test_files_are_checked(sol, tmp_path):
    path = tmp_path / "run.npz"
    np.savez(path, t=sol.t)
    with pytest.raises(ValueError, match="is not a solution written by Solution.save"):
        equip.load(path)
    np.savez(path, words=np.array(json.dumps({"format": "equip solution 1"})))
    with pytest.raises(ValueError, match="has the format 'equip solution 1'; this version reads"):
        equip.load(path)
    sol.save(path)
    with np.load(path) as stored:
        arrays = dict(stored)
    assert json.loads(str(arrays["words"]))["equip"] == equip.__version__
    arrays["hamiltonian"][30] ^= 1
    np.savez(path, **arrays)
    with pytest.raises(ValueError, match="these bytes are damaged"):
        equip.load(path)


def test_tables(sol):
    frame = sol.to_dataframe()
    assert list(frame.columns) == ["t", "q[0]", "q[1]", "p[0]", "p[1]", "energy_error"]
    assert np.array_equal(frame["p[1]"], sol.p[:, 1])
    dataset = sol.to_xarray()
    assert (
        dataset.q.dims == ("t", "axis_0")
        and np.array_equal(dataset.q, sol.q)
        and np.array_equal(dataset.t, sol.t)
    )


def test_pictures(sol):
    from matplotlib import pyplot

    ax = sol.plot()
    assert len(ax.lines) == 1
    # Curves between the states, of the exact ellipse: a = 1, e = 0.6.
    x, y = ax.lines[0].get_data()
    assert len(x) > 8 * len(sol.t) and np.isin(sol.q[:, 0], x).all()
    assert np.abs((x + 0.6) ** 2 + (y / 0.8) ** 2 - 1).max() < 1e-6
    dense = equip.solve(sol.hamiltonian, sol.q[0], sol.p[0], (0, 7), dense_output=True)
    x, y = dense.plot(pyplot.subplots()[1]).lines[0].get_data()
    assert len(x) > 8 * len(dense.t) and np.abs((x + 0.6) ** 2 + (y / 0.8) ** 2 - 1).max() < 1e-11
    assert sol.plot_energy(pyplot.subplots()[1]).get_yscale() == "log"
    swing = equip.solve(equip.scenes.pendulum(), [0.0], [1.0], (0, 1))
    assert np.isin(swing.p[:, 0], swing.plot(pyplot.subplots()[1]).lines[0].get_ydata()).all()
    chain = equip.scenes.fput_beta(n=8)
    assert len(equip.solve(chain, chain.q0, chain.p0, (0, 1)).plot(pyplot.subplots()[1]).lines) == 8
    pyplot.close("all")


def test_sections():
    h = equip.scenes.henon_heiles(energy="1/12")

    def crossing(t, q, p):
        return q[0]

    crossing.direction = 1
    sol = equip.solve(h, h.q0, h.p0, (0, 300), events=[lambda t, q, p: p[1], crossing])
    ax = sol.section(1, 3, event=1)
    q2, p2 = ax.lines[0].get_data()
    assert len(q2) > 40 and (ax.get_xlabel(), ax.get_ylabel()) == ("q[1]", "p[1]")
    # What is left of 1/12 at q1 = 0 is p1²/2.
    assert (1 / 6 - q2**2 + 2 / 3 * q2**3 - p2**2 > 0).all()
    assert sol.section(0, 1, ax=ax) is ax and len(ax.lines) == 2
    with pytest.raises(ValueError, match="event is 2, but the run has 2 events"):
        sol.section(1, 3, event=2)
    with pytest.raises(ValueError, match="components of .* are 0 to 3"):
        sol.section(1, 4)
    with pytest.raises(TypeError, match="x is 'q0'; .* 0 to 1 for q and 2 to 3 for p, .* 2 events"):
        sol.section("q0", "p0")
    with pytest.raises(TypeError, match="event is None"):
        sol.section(1, 3, event=None)


def test_a_run_without_a_step_has_no_verdict():
    h = equip.scenes.kepler()
    sol = equip.solve(h, h.q0, h.p0, (0, 0))
    assert sol.certificate.counts.steps == 0
    assert sol.certificate.energy_conserved_to_round_off == "no step was made"


def test_matplotlib_is_imported_on_call_only():
    import subprocess
    import sys

    code = "import sys, equip; print([m for m in ('matplotlib', 'pandas', 'xarray', 'scipy', 'tqdm') if m in sys.modules])"
    assert (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        == "[]\n"
    )


def test_energies_that_jump(tmp_path):
    """A jump of H exerts no force: p goes on, and the certificate has the jump."""

    def energy(q, p):
        return p[0] ** 2 / 2 + np.where(q[0] > 0.3, 1e-3 + q[0] / 2, q[0] / 2)

    h = equip.Hamiltonian(energy, 1)
    sol = equip.solve(h, [0.0], [1.0], (0, 4), method=equip.Equip(6), step=0.1)
    jumps = sol.certificate.energy_jumps
    assert jumps.count == sol.certificate.counts.discontinuities_crossed == 2
    assert jumps.largest == pytest.approx(1e-3, rel=1e-6)
    assert not sol.certificate.energy_conserved_on_every_step
    # q = t - t²/4.
    assert np.allclose(sol.q[:, 0], sol.t - sol.t**2 / 4, rtol=0, atol=1e-13)
    sol.save(tmp_path / "jumps.npz")
    assert equip.load(tmp_path / "jumps.npz").certificate == sol.certificate


def test_copies_and_pickles(kepler):
    sol = equip.solve(kepler, [0.4, 0.0], [0.0, 2.0], (0, 1), dense_output=True)
    for copied in (copy.copy(sol), copy.deepcopy(sol)):
        assert np.array_equal(copied.sol(0.5), sol.sol(0.5)) and np.array_equal(copied.y, sol.y)
    again = pickle.loads(pickle.dumps(sol))
    assert np.array_equal(again.y, sol.y) and again.hamiltonian == sol.hamiltonian
    assert again.certificate == sol.certificate and sol.sol(0.5)
    assert np.array_equal(again.sol(0.5), sol.sol(0.5))
    assert sol == sol and sol != again and len({sol, again}) == 2


def test_solutions_of_no_states(kepler):
    for shape in (2, 1, (2, 3), 5):
        free = equip.Hamiltonian(lambda q, p: (p * p).sum(), shape)
        sol = equip.solve(free, np.zeros(shape), np.ones(shape), (0, 1), t_eval=[])
        assert sol.plot() and sol.q_text().shape == sol.q.shape == (0, *free.shape)
        assert sol.q_text().dtype.kind == "U"


def test_energies_that_were_not_measured_are_not_drawn(kepler):
    sol = equip.solve(kepler, [0.4, 0.0], [0.0, 2.0], (0, 1), method=equip.Gauss(), measure_energy=False)
    with pytest.raises(ValueError, match="the energy was not measured at these times: solve with"):
        sol.plot_energy()


@pytest.mark.parametrize("name", ["a.npz", "a.npy", "a.h5"])
def test_other_files_are_refused(tmp_path, name):
    path = tmp_path / name
    for content in (b"junk", b""):
        path.write_bytes(content)
        with pytest.raises(
            ValueError, match=r"is not a solution written by Solution.save, or it is damaged$"
        ):
            equip.load(path)
    with pytest.raises(FileNotFoundError):
        equip.load(tmp_path / "none.npz")


def test_results_are_printed_in_five_lines(kepler):
    sol = equip.solve(kepler, [0.4, 0.0], [0.0, 2.0], (0, 50), events=lambda t, q, p: q @ p, step=0.01)
    assert len(sol.t) > 5000
    starts = np.tile([0.4, 0.0], (300, 1)), np.tile([0.0, 2.0], (300, 1))
    ends = equip.ensemble(kepler, *starts, (0, 1), output=lambda sol: sol.q)
    for result in (sol, ends):
        for text in (repr(result), str(result), f"{result}"):
            assert len(text.splitlines()) == 5 and len(text) < 600
        assert result._repr_html_().count("<tr>") == 5
    assert "5001" in repr(sol) and "roots of events: 15" in repr(sol)
    assert "300: 300 conserved" in repr(ends)
    failed = equip.ensemble(kepler, [[np.nan, 0.0]], [[0.0, 2.0]], (0, 1))
    assert "1 failed" in repr(failed) and "run 0: " in repr(failed)


def test_names_of_solve_ivp(kepler):
    def stop(t, q, p):
        return q[0]

    stop.terminal = True
    start = ([0.4, 0.0], [0.0, 2.0])
    sol = equip.solve(kepler, *start, (0, 5))
    assert sol.status == 0 and sol.nfev == sol.certificate.counts.gradients > 0
    assert sol.njev == sol.certificate.counts.hessians
    assert equip.solve(kepler, *start, (0, 5), events=stop).status == 1
    failed = equip.solve(kepler, *start, (0, 5), max_steps=2)
    assert failed.status == -1 and not failed.success
