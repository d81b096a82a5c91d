"""Runs one step at a time, the tangent map, suggested steps."""

from itertools import islice, takewhile

import numpy as np
import pytest

import equip

START = ([0.4, 0.0], [0.0, 2.0])


@pytest.mark.parametrize("how", [{"step": 0.1}, {"tolerance": 1e-10}])
def test_steps_are_those_of_the_run(kepler, how):
    run = equip.solve(kepler, *START, (0, 100), **how)
    made = list(islice(equip.steps(kepler, *START, **how), 100))
    assert [step.index for step in made] == list(range(1, 101))
    assert np.array_equal([step.q for step in made], run.q[1:101]) and np.array_equal(
        [step.p for step in made], run.p[1:101]
    )
    assert np.array_equal([step.t for step in made], run.t[1:101])
    assert np.array_equal([step.energy_error for step in made], run.energy_error[1:101])
    assert made[0].alphas.shape == (7,) and made[0].outcome in run.outcome
    assert made[0].t == pytest.approx(made[0].step)


def test_restart_gives_the_bits_of_a_new_run(kepler):
    steps = equip.steps(kepler, *START, tolerance=1e-10)
    first = [step.q for step in islice(steps, 50)]
    assert steps.certificate.counts.steps == 50
    steps.restart(*START, t0=0.0)
    assert steps.last.index == 0 and np.array_equal(steps.last.q, START[0])
    assert np.array_equal([step.q for step in islice(steps, 50)], first)
    with pytest.raises(ValueError, match="initial value q0.0. is NaN"):
        steps.restart([np.nan, 0], [0, 1])
    assert steps.last.index == 50


def test_kicks(kepler):
    steps = equip.steps(kepler, *START, 1.0, step=0.1)
    step = next(steps)
    assert step.t == 1.1
    steps.set_state(step.q, 1.01 * step.p)
    kicked = next(steps)
    assert kicked.t == pytest.approx(1.2) and abs(kicked.energy_error) < 1e-15
    assert kepler(kicked.q, kicked.p) == pytest.approx(kepler(step.q, 1.01 * step.p), abs=1e-15)
    assert kepler(kicked.q, kicked.p) > kepler(*START) + 0.01
    certificate = steps.certificate
    assert certificate.counts.state_changes == 1 and "energy after change" in str(certificate)


def test_tangent_vectors_follow_the_tangent_map(kepler):
    steps = equip.steps(kepler, *START, step=0.05, tangent_vectors=np.eye(4))
    step = next(islice(steps, 99, None))
    map_ = steps.tangent_vectors.T
    # Symplectic, and the derivative of the flow.
    j = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    assert np.abs(map_.T @ j @ map_ - j).max() < 1e-10
    d = 1e-6
    ends = []
    for sign in (1, -1):
        q = np.array(START[0]) + sign * d * np.array([1, 0])
        ends.append(equip.solve(kepler, q, START[1], (0, step.t), step=0.05, record="ends").y[-1])
    assert np.abs(map_[:, 0] - (ends[0] - ends[1]) / (2 * d)).max() < 1e-6
    steps.tangent_vectors = np.zeros((4, 4))
    assert next(islice(steps, 0, None)) is not None and not steps.tangent_vectors.any()
    with pytest.raises(ValueError, match=r"they must keep \(4, 4\)"):
        steps.tangent_vectors = np.zeros(4)
    with pytest.raises(ValueError, match=r"they must have \(k, 4\)"):
        equip.steps(kepler, *START, step=0.1, tangent_vectors=np.eye(3))
    assert equip.steps(kepler, *START, step=0.1, tangent_vectors=[1, 0, 0, 0]).tangent_vectors.shape == (1, 4)


def test_a_step_that_cannot_be_made_raises_and_leaves_the_state():
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - q[0] ** 4, 1)
    steps = equip.steps(h, [1.0], [1.5], step=0.01)
    with pytest.raises(equip.IntegrationError, match="end the run before that time"):
        for step in steps:
            last = step
    assert np.array_equal(steps.last.q, last.q) and steps.last.index == last.index
    assert issubclass(equip.IntegrationError, RuntimeError)


def test_suggested_steps(kepler):
    span = (0, 2 * np.pi)
    step = equip.suggest_step(kepler, *START, span, 1e-9, method=equip.Equip(4))
    run = equip.solve(kepler, *START, span, step=step, method=equip.Equip(4))
    error = np.abs(run.y[-1] - np.concatenate(START)).max()
    assert 1e-12 < error < 2e-9
    assert span[1] / step == pytest.approx(round(span[1] / step))
    assert equip.suggest_step(kepler, *START, span, 0.5, by="phase") < equip.suggest_step(
        kepler, *START, span, 1.0, by="phase"
    )
    assert equip.suggest_step(kepler, *START, span, 1e-6, by="energy") > 0
    with pytest.raises(equip.IntegrationError, match="use a larger target"):
        equip.suggest_step(kepler, *START, span, 1e-17)
    with pytest.raises(ValueError, match="`target error` is -1; it must be positive"):
        equip.suggest_step(kepler, *START, span, -1)
    with pytest.raises(ValueError, match="by is 'error'; it must be 'trajectory', 'energy' or 'phase'"):
        equip.suggest_step(kepler, *START, span, 1e-9, by="error")


@pytest.mark.parametrize("how", [{"step": 0.1}, {"tolerance": 1e-10}])
@pytest.mark.parametrize("tangent_vectors", [None, np.eye(4)])
def test_advance_to_and_turn_back(kepler, how, tangent_vectors):
    steps = equip.steps(kepler, *START, **how, tangent_vectors=tangent_vectors)
    there = steps.advance_to(2.345)
    assert there.t == 2.345 and np.array_equal(there.q, steps.last.q)
    end = equip.solve(kepler, *START, (0, 2.345), **how)
    assert np.abs(there.q - end.q[-1]).max() < 1e-9
    back = steps.advance_to(0)
    assert back.t == 0 and np.abs(back.q - START[0]).max() < 1e-9
    if tangent_vectors is not None:
        assert np.abs(steps.tangent_vectors - np.eye(4)).max() < 1e-6
    next(steps)
    before = steps.last.t
    steps.turn_back()
    assert (next(steps).t - before) * before < 0
    with pytest.raises(ValueError, match="t is 'a'; it must be a number"):
        steps.advance_to("a")
    with pytest.raises(ValueError, match="finite"):
        steps.advance_to(np.nan)


def test_tangent_vectors_are_finite(kepler):
    for wrong in ([np.nan] * 4, [np.inf, 0, 0, 0]):
        with pytest.raises(ValueError, match="tangent_vectors have entries that are not finite"):
            equip.steps(kepler, *START, step=0.1, tangent_vectors=wrong)
    steps = equip.steps(kepler, *START, step=0.1, tangent_vectors=np.eye(4))
    with pytest.raises(ValueError, match="tangent_vectors have entries that are not finite"):
        steps.tangent_vectors = np.full((4, 4), np.nan)


def test_spans_of_suggested_steps(kepler):
    with pytest.raises(ValueError, match="span has no length, 1 to 1; give two different times"):
        equip.suggest_step(kepler, *START, (1, 1), 1e-6)
    assert equip.suggest_step(kepler, *START, (1, 0), 1e-6) > 0
    assert equip.suggest_step(kepler, *START, (0, 1), 0.5, by="phase", method=equip.Gauss(1)) > 0


def test_time_and_state_of_a_run(kepler):
    run = equip.steps(kepler, *START, t0=3.0, step=0.1)
    assert run.t == 3.0 and run.q.tolist() == START[0] and run.p.tolist() == START[1]
    step = next(run)
    assert run.t == step.t and np.array_equal(run.q, step.q) and np.array_equal(run.p, step.p)


@pytest.mark.parametrize("how", [{"step": 0.1}, {"tolerance": 1e-10}])
def test_events_of_steps_are_those_of_the_run(kepler, how):
    def apsis(t, q, p):
        return q @ p

    run = equip.solve(kepler, *START, (0, 30), events=[apsis], **how)
    steps = equip.steps(kepler, *START, events=[apsis], **how)
    found = [event for step in takewhile(lambda step: step.t <= 30, steps) for event in step.events]
    assert [event.t for event in found] == list(run.t_events[0]) and len(found) == 9
    assert all(event.event == 0 and abs(event.q @ event.p) < 1e-13 for event in found)
    again = equip.steps(kepler, *START, events=[apsis], **how).advance_to(30.0)
    assert [event.t for event in again.events] == pytest.approx(list(run.t_events[0]), abs=1e-11)


def ball_and_floor():
    def floor(t, q, p):
        return q[0]

    floor.direction = -1
    floor.then = lambda t, q, p: (q, -p)
    return equip.Hamiltonian(lambda q, p: p[0] ** 2 / 2 + q[0], shape=1), floor


def test_a_ball_bounces_step_by_step():
    ball, floor = ball_and_floor()
    steps = equip.steps(ball, [0.5], [0.0], step=0.3, events=floor)
    times = [event.t for step in takewhile(lambda step: step.t < 20, steps) for event in step.events]
    assert times == pytest.approx([2 * k + 1 for k in range(len(times))], abs=1e-13) and len(times) == 10
    assert steps.certificate.energy_conserved_on_every_step
    # The step ends at the event, in the changed state.
    steps.restart([0.5], [0.0])
    bounce = next(step for step in steps if step.events)
    assert bounce.t == bounce.events[0].t and bounce.p[0] == -bounce.events[0].p[0] > 0
    assert steps.advance_to(2.0).q[0] == pytest.approx(0.5, abs=1e-13) and steps.last.events == ()


def test_events_that_steps_refuse_say_what_to_do():
    ball, floor = ball_and_floor()
    with pytest.raises(ValueError, match="omit one of them"):
        equip.steps(ball, [0.5], [0.0], step=0.3, events=floor, tangent_vectors=[1.0, 0.0])
    floor.then = lambda t, q, p: 1 / 0
    with pytest.raises(ZeroDivisionError):
        equip.steps(ball, [0.5], [0.0], step=0.3, events=floor).advance_to(2.0)
    del floor.then
    floor.terminal = True
    with pytest.raises(ValueError, match="break out of the loop"):
        equip.steps(ball, [0.5], [0.0], step=0.3, events=floor)
