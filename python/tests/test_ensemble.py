"""Many runs over threads."""

import dataclasses
import multiprocessing
import os
import signal
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from fractions import Fraction

import numpy as np
import pytest

import equip
from equip import _native


def starts(n):
    rng = np.random.default_rng(5)
    return [0.4, 0.0] + 0.05 * rng.normal(size=(n, 2)), [0.0, 2.0] + 0.05 * rng.normal(size=(n, 2))


@pytest.mark.parametrize("how", [{"step": 0.1}, {"tolerance": 1e-10}])
def test_bits_are_those_of_single_runs_whatever_the_threads(kepler, how):
    q0, p0 = starts(40)
    ends = [equip.ensemble(kepler, q0, p0, (0, 30), threads=threads, **how) for threads in (1, 2, 3, 7, None)]
    assert ends[0].success and ends[0].q.shape == ends[0].p.shape == (40, 2)
    for other in ends[1:]:
        for name in ("t", "q", "p", "energy_error", "energy_conserved", "steps"):
            assert np.array_equal(getattr(ends[0], name), getattr(other, name))
    for i in (0, 13, 39):
        sol = equip.solve(kepler, q0[i], p0[i], (0, 30), record="ends", **how)
        assert np.array_equal(sol.q[-1], ends[0].q[i]) and np.array_equal(sol.p[-1], ends[0].p[i])
        assert sol.certificate.energy.max == ends[0].energy_error[i] < 1e-13
        assert sol.certificate.counts.steps == ends[0].steps[i] and ends[0].t[i] == 30
        assert sol.certificate.energy_conserved_on_every_step == ends[0].energy_conserved[i]


def test_failing_members_are_rows_of_nan():
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - q[0] ** 4, 1)
    q0, p0 = np.array([[0.1], [1.0], [0.1], [np.nan]]), np.array([[0.0], [1.5], [0.1], [0.0]])
    ends = equip.ensemble(h, q0, p0, (0, 2), step=0.01, threads=2)
    assert sorted(ends.errors) == [1, 3] and not ends.success
    assert "escapes to infinity" in ends.errors[1] and "initial value q0[0] is NaN" in ends.errors[3]
    assert (
        np.isnan(ends.q[[1, 3]]).all()
        and np.isnan(ends.t[[1, 3]]).all()
        and np.isfinite(ends.q[[0, 2]]).all()
    )
    assert ends.energy_conserved.tolist() == [True, False, True, False]


def test_shapes(kepler):
    q0, p0 = starts(3)
    with pytest.raises(ValueError, match=r"q0 has shape \(2,\); it must be \(N, 2\)"):
        equip.ensemble(kepler, q0[0], p0, (0, 1))
    with pytest.raises(ValueError, match="q0 has 3 initial conditions, but p0 has 2"):
        equip.ensemble(kepler, q0, p0[:2], (0, 1))
    with pytest.raises(ValueError, match="threads is 0; it must be a whole number, 1 or more"):
        equip.ensemble(kepler, q0, p0, (0, 1), threads=0)
    with pytest.raises(ValueError, match="steps of -1 from 0.0 lead away from 1.0"):
        equip.ensemble(kepler, q0, p0, (0, 1), step=-1)
    none = equip.ensemble(kepler, np.empty((0, 2)), np.empty((0, 2)), (0, 1))
    assert none.q.shape == (0, 2) and none.success


def test_progress(kepler, capsys):
    q0, p0 = starts(10)
    assert equip.ensemble(kepler, q0, p0, (0, 10), progress=True).success
    assert "10/10" in capsys.readouterr().err


NAMES = ("t", "q", "p", "energy_error", "energy_conserved", "steps")


@pytest.fixture(scope="module")
def pool():
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool


@pytest.mark.parametrize("how", [{"step": 0.1}, {"tolerance": 1e-10, "atol": ([1e-12, 1e-13], 1e-12)}])
def test_processes_make_the_bytes_of_one(kepler, pool, how):
    q0, p0 = starts(23)
    q0[7] = np.nan
    here = equip.ensemble(kepler, q0, p0, (0, 10), **how)
    keep = {"preserve": {"angular momentum": lambda q, p: q[0] * p[1] - q[1] * p[0]}}
    for chunk in (1, 5, 100):
        there = equip.ensemble(kepler, q0, p0, (0, 10), executor=pool, chunk=chunk, **how)
        assert all(getattr(here, name).tobytes() == getattr(there, name).tobytes() for name in NAMES)
        assert here.errors == there.errors and list(there.errors) == [7] and not len(there.lost)
    kept = [equip.ensemble(kepler, q0, p0, (0, 1), executor=e, **how, **keep) for e in (None, pool)]
    assert kept[0].q.tobytes() == kept[1].q.tobytes()


def test_chaos(pool):
    scene = equip.scenes.henon_heiles(energy="1/8")
    q0, p0 = np.repeat(scene.q0[None], 3, axis=0), np.repeat(scene.p0[None], 3, axis=0)
    q0[:, 0] += [0, 0.01, 0.02]
    here, there = (
        equip.ensemble(scene, q0, p0, (0, 200), chaos=True, executor=e, chunk=2) for e in (None, pool)
    )
    for i in range(3):
        certificate = equip.solve(scene, q0[i], p0[i], (0, 200), chaos=True).certificate
        assert here.lyapunov[i] == there.lyapunov[i] == certificate.lyapunov
        assert here.megno[i] == there.megno[i] == certificate.megno
    assert np.isnan(equip.ensemble(scene, q0, p0, (0, 1)).megno).all()


def test_other_executors_and_no_starts(kepler, pool):
    q0, p0 = starts(9)
    here = equip.ensemble(kepler, q0, p0, (0, 5))
    with ThreadPoolExecutor(3) as threads:
        there = equip.ensemble(kepler, q0, p0, (0, 5), executor=threads, chunk=2, progress=True)
    assert here.q.tobytes() == there.q.tobytes()
    none = equip.ensemble(kepler, q0[:0], p0[:0], (0, 5), executor=pool)
    assert none.q.shape == (0, 2) and none.success
    with pytest.raises(ValueError, match="chunk is 0"):
        equip.ensemble(kepler, q0, p0, (0, 5), executor=pool, chunk=0)
    with pytest.raises(ValueError, match="stages"):
        equip.ensemble(kepler, q0, p0, (0, 5), executor=pool, method=equip.Equip(stages=99))


class Killer:
    """Hands chunks to a pool, and kills its workers when the third is asked for."""

    def __init__(self, pool):
        self.pool, self.made = pool, 0

    def submit(self, function, *arguments):
        future = self.pool.submit(function, *arguments)
        future.result() if self.made < 2 else self.kill()
        self.made += 1
        return future

    def kill(self):
        for process in list((self.pool._processes or {}).values()):
            os.kill(process.pid, signal.SIGKILL)


def test_a_killed_worker_loses_nothing_that_was_finished(kepler):
    q0, p0 = starts(20)
    span = (0, 2000)
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        part = equip.ensemble(kepler, q0, p0, span, step=0.1, executor=Killer(pool), chunk=4)
    assert part.lost.tolist() == list(range(8, 20)) == sorted(part.errors) and not part.success
    assert "the worker of this run died" in part.errors[8]
    assert np.isfinite(part.q[:8]).all() and np.isnan(part.q[8:]).all()
    whole = equip.ensemble(kepler, q0, p0, span, step=0.1, resume=part)
    here = equip.ensemble(kepler, q0, p0, span, step=0.1)
    assert whole.success and not len(whole.lost)
    assert all(getattr(here, name).tobytes() == getattr(whole, name).tobytes() for name in NAMES)
    with pytest.raises(ValueError, match="resume has 20 initial conditions, but q0 has 3"):
        equip.ensemble(kepler, q0[:3], p0[:3], span, resume=part)


def test_starts_are_drawn_by_seed_and_number(kepler):
    q, p = equip.draw_starts([0.4, 0.0], [0.0, 2.0], 500, seed=7, spread=0.02)
    assert q.shape == p.shape == (500, 2) and not q[:, 1].any() and not p[:, 0].any()
    u = np.concatenate([q[:, 0] / 0.4 - 1, p[:, 1] / 2 - 1]) / 0.02
    # Uniform in [-1, 1): mean 0 ± 0.018, mean square 1/3 ± 0.01; three of these.
    assert abs(u).max() <= 1 + 1e-12 and abs(u.mean()) < 0.055 and abs((u**2).mean() - 1 / 3) < 0.03
    assert abs(np.corrcoef(q[:, 0], p[:, 1])[0, 1]) < 0.15
    few = equip.draw_starts([0.4, 0.0], [0.0, 2.0], 9, seed=7, spread=0.02)
    assert np.array_equal(few[0], q[:9]) and np.array_equal(few[1], p[:9])
    assert not np.array_equal(equip.draw_starts([0.4, 0.0], [0.0, 2.0], 9, seed=8, spread=0.02)[0], q[:9])
    ends = equip.ensemble(kepler, [0.4, 0.0], [0.0, 2.0], (0, 10), n=9, seed=7, spread=0.02)
    same = equip.ensemble(kepler, q[:9], p[:9], (0, 10))
    assert np.array_equal(ends.q, same.q)
    with pytest.raises(ValueError, match="give their number n as well"):
        equip.ensemble(kepler, [0.4, 0.0], [0.0, 2.0], (0, 10), seed=7)
    for wrong, words in [
        ({"n": 0}, "n is 0"),
        ({"n": 3, "seed": -1}, "seed is -1"),
        ({"n": 3, "spread": -1.0}, "spread is -1.0"),
        ({"n": 3, "spread": np.nan}, "spread is nan"),
    ]:
        with pytest.raises(ValueError, match=words):
            equip.ensemble(kepler, [0.4, 0.0], [0.0, 2.0], (0, 10), **wrong)


def test_outcomes():
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - q[0] ** 4, 1)
    q0, p0 = np.array([[0.1], [1.0], [0.1]]), np.array([[0.0], [1.5], [0.1]])
    ends = equip.ensemble(h, q0, p0, (0, 2), step=0.01)
    assert ends.outcome.tolist() == ["conserved", "failed", "conserved"]
    gauss = equip.ensemble(h, q0[:1], p0[:1], (0, 2), step=0.5, method=equip.Gauss(stages=2))
    assert gauss.outcome.tolist() == ["finished"] and not gauss.errors


def by_zero(sol):
    return 1 / 0


def highest(sol):
    return sol.t[sol.q[:, 0].argmax()], len(sol.t)


def test_outputs(kepler, pool):
    q0, p0 = starts(11)
    q0[4] = np.nan
    here = equip.ensemble(kepler, q0, p0, (0, 10), output=highest, threads=3, progress=True)
    there = equip.ensemble(kepler, q0, p0, (0, 10), output=highest, executor=pool, chunk=3)
    plain = equip.ensemble(kepler, q0, p0, (0, 10))
    assert plain.outputs == ()
    for ends in (here, there):
        assert all(getattr(plain, name).tobytes() == getattr(ends, name).tobytes() for name in NAMES)
        assert ends.errors == plain.errors and ends.outputs[4] is None
        for i in (0, 10):
            assert ends.outputs[i] == highest(equip.solve(kepler, q0[i], p0[i], (0, 10)))
    with pytest.raises(ZeroDivisionError):
        equip.ensemble(kepler, q0, p0, (0, 10), output=lambda sol: 1 / 0)
    with pytest.raises(ZeroDivisionError) as raised:
        equip.ensemble(kepler, q0, p0, (0, 10), output=by_zero, executor=pool, chunk=3)
    assert "in by_zero" in str(raised.value.__cause__)


class Pool:
    """As multiprocessing.Pool: without submit."""


def outside(sol):
    return lambda: sol


@pytest.mark.parametrize("wrong", [3, "processes", Pool(), ProcessPoolExecutor])
def test_executors_have_submit(kepler, wrong):
    with pytest.raises(TypeError, match="it must have the method submit: give concurrent.futures"):
        equip.ensemble(kepler, *starts(3), (0, 1), executor=wrong)


def apsis(t, q, p):
    return q @ p


def seen(sol):
    return sol.t, sol.q, sol.t_events[0], sol.sol(3.0), sol.t_low


@pytest.mark.parametrize("precision", ["f64", "dd"])
def test_outputs_of_runs_with_times_events_and_dense_output(kepler, pool, precision):
    q0, p0 = starts(3)
    more = {"t_eval": [0.5, 2.0, 9.0], "dense_output": True, "events": apsis, "precision": precision}
    more["tolerance"] = 1e-9
    here = equip.ensemble(kepler, q0, p0, (0, 10), output=seen, threads=2, **more)
    there = equip.ensemble(kepler, q0, p0, (0, 10), output=seen, executor=pool, chunk=2, **more)
    for i in range(3):
        alone = equip.solve(kepler, q0[i], p0[i], (0, 10), **more)
        for ends in (here, there):
            assert ends.t[i] == 10 and np.array_equal(ends.q[i], there.q[i])
            for got, wanted in zip(ends.outputs[i], seen(alone)):
                assert np.array_equal(got, wanted)
        assert len(alone.t_events[0]) >= 1
    with pytest.raises(ValueError, match="give output"):
        equip.ensemble(kepler, q0, p0, (0, 10), t_eval=[1.0])


def test_billiards_in_an_ensemble():
    def wall(t, q, p):
        return 1 - q[0] ** 2

    wall.direction = -1
    wall.then = lambda t, q, p: (q, -p)
    free = equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2, shape=1)
    momenta = np.array([[0.7], [1.9]])
    ends = equip.ensemble(
        free,
        np.zeros((2, 1)),
        momenta,
        (0, 20),
        events=wall,
        output=lambda sol: len(sol.t_events[0]),
        step=0.1,
    )
    assert ends.outputs == (7, 19)
    # Unfolded, the path is a straight line.
    unfolded = (momenta * 20 + 1) % 4
    assert np.allclose(ends.q, np.where(unfolded < 2, unfolded, 4 - unfolded) - 1, atol=1e-12)


@pytest.mark.parametrize("output", [lambda sol: sol.t, outside])
def test_outputs_that_cannot_be_sent(kepler, pool, output):
    with pytest.raises(
        TypeError, match=r"output, or what it returns, cannot be sent .*a function of a module"
    ):
        equip.ensemble(kepler, *starts(3), (0, 1), executor=pool, output=output)


def test_resume_is_of_the_same_runs(kepler, tmp_path):
    q0, p0 = starts(4)
    whole = equip.ensemble(kepler, q0, p0, (0, 5), step=0.1)
    part = dataclasses.replace(whole, lost=np.array([2]))
    part.save(tmp_path / "part.npz")
    loaded = equip.Ensemble.load(tmp_path / "part.npz")
    for before in (part, loaded):
        again = equip.ensemble(kepler, q0, p0, (0, 5), step=0.1, threads=2, resume=before)
        assert again.q.tobytes() == whole.q.tobytes() and again.digest == whole.digest
        for span, how in [((0, 6), {"step": 0.1}), ((0, 5), {"step": 0.2}), ((0, 5), {"tolerance": 1e-9}),
                          ((0, 5), {"step": 0.1, "method": equip.Gauss()})]:  # fmt: skip
            with pytest.raises(
                ValueError, match="resume has runs with another H, other initial conditions, another span"
            ):
                equip.ensemble(kepler, q0, p0, span, **how, resume=before)
        with pytest.raises(ValueError, match="resume has runs with another H"):
            equip.ensemble(kepler, q0 + 1e-9, p0, (0, 5), step=0.1, resume=before)
    unknown = dataclasses.replace(part, digest="")
    assert equip.ensemble(kepler, q0, p0, (0, 5), step=0.1, resume=unknown).success
    with pytest.raises(ValueError, match="another span"):
        equip.ensemble(kepler, q0, p0, (0, 6), step=0.1, resume=unknown)
    with pytest.raises(TypeError, match="resume is int; it must be an Ensemble"):
        equip.ensemble(kepler, q0, p0, (0, 5), resume=3)


def test_no_more_threads_than_runs(kepler, monkeypatch):
    asked = []
    made = _native.ensemble
    monkeypatch.setattr(_native, "ensemble", lambda *given: asked.append(given[5]) or made(*given))
    assert equip.ensemble(kepler, *starts(6), (0, 1), threads=5000).success
    assert max(asked) == 6


def test_options_of_ensembles_are_named(kepler):
    for options, text in [
        ({"chunk": 2.5}, "chunk is 2.5; it must be a whole number, 1 or more"),
        ({"threads": "x"}, "threads is 'x'; it must be a whole number, 1 or more"),
        ({"span": (0, np.inf)}, "the interval 0 to inf must be finite"),
    ]:
        with pytest.raises(ValueError, match=text):
            equip.ensemble(kepler, *starts(3), options.pop("span", (0, 1)), **options)
    with pytest.raises(ValueError, match="n is '5'; it must be a whole number, 1 or more"):
        equip.ensemble(kepler, [0.4, 0.0], [0.0, 2.0], (0, 1), n="5")


def test_tasks_of_a_small_ensemble(kepler):
    """Each worker has four of them, whatever the number of runs."""

    class Counting(ThreadPoolExecutor):
        tasks = 0

        def submit(self, *args, **kwargs):
            self.tasks += 1
            return super().submit(*args, **kwargs)

    q0, p0 = np.tile([0.4, 0.0], (40, 1)), np.tile([0.0, 2.0], (40, 1))
    for chunk, tasks in ((None, 8), (10, 4), (256, 1)):
        with Counting(2) as pool:
            equip.ensemble(kepler, q0, p0, (0, 0.2), step=0.1, executor=pool, chunk=chunk)
            assert pool.tasks == tasks


def test_double_double_starts_and_spans_have_all_digits():
    oscillator = equip.Hamiltonian(lambda q, p: p @ p / 2 + q @ q / 2, 1)
    starts, span = (["0.1", "0.2"], [Fraction(1, 3), "0.3"]), (0, Fraction(1, 3))
    q0, p0 = ([[x] for x in values] for values in starts)
    ends = equip.ensemble(oscillator, q0, p0, span, precision="dd", output=lambda sol: sol.q_text()[:, 0])
    for q, p, texts in zip(q0, p0, ends.outputs):
        assert texts.tolist() == equip.solve(oscillator, q, p, span, precision="dd").q_text()[:, 0].tolist()
