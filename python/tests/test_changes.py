"""Events that change the state: bounces and kicks, against closed forms and against runs that are started again."""

import math
import pickle

import numpy as np
import pytest

import equip


def floor(t, q, p):
    return q[0]


floor.direction = -1
floor.then = lambda t, q, p: (q, -p)


@pytest.fixture(scope="module")
def ball():
    return equip.Hamiltonian(lambda q, p: p @ p / 2 + 9.8 * q[0], 1)


@pytest.mark.parametrize("how", [{"tolerance": 1e-12}, {"step": 0.37}])
def test_a_ball_that_bounces(ball, how):
    """From a height of 50 bounce n is at √(100/9.8) (2n - 1)."""
    sol = equip.solve(ball, [50.0], [0.0], (0, 640), events=floor, dense_output=True, **how)
    assert sol.success and sol.status == 0
    n = np.arange(1, len(sol.t_events[0]) + 1)
    exact = math.sqrt(100 / 9.8) * (2 * n - 1)
    # Measured: 1.8e-12 after a hundred flights by a tolerance of 1e-12, below 1e-13 with steps of other kinds.
    bound = 1e-11 if "tolerance" in how else 1e-13
    assert len(n) == 100 and np.abs(sol.t_events[0] / exact - 1).max() < bound
    # The states of events are those before, the states of the run those after.
    assert (sol.p_events[0] < 0).all() and np.abs(sol.q_events[0]).max() < 1e-9
    after = sol.p[np.isin(sol.t, sol.t_events[0])]
    assert len(after) == 100 and (after > 0).all()
    # Dense output is that of each flight.
    t = np.linspace(0, 640, 2001)
    since = (t + exact[0]) % (2 * exact[0]) - exact[0]
    # The error of the time, by the speed.
    assert np.abs(sol.sol(t)[0][:, 0] - (50 - 4.9 * since**2)).max() < 640 * 31.4 * bound
    again = pickle.loads(pickle.dumps(sol))
    assert np.array_equal(again.sol(t)[0], sol.sol(t)[0])


def test_the_run_is_that_of_runs_that_are_started_again(ball):
    def stop(t, q, p):
        return q[0]

    stop.direction, stop.terminal = -1, True
    whole = equip.solve(ball, [50.0], [1.0], (0, 20), events=floor, tolerance=1e-12)
    t, q, p, roots = 0.0, [50.0], [1.0], []
    while True:
        part = equip.solve(ball, q, p, (t, 20), events=stop, tolerance=1e-12)
        if part.status == 0:
            break
        t, q, p = part.t[-1], part.q[-1], -part.p[-1]
        roots.append(t)
    assert whole.t_events[0].tolist() == pytest.approx(roots, rel=1e-14)
    assert whole.q[-1] == pytest.approx(part.q[-1], abs=1e-11)


@pytest.mark.parametrize("how", [{"tolerance": 1e-10}, {"step": 0.4}])
def test_outputs_beyond_a_bounce_are_those_after_it(ball, how):
    t = np.linspace(0, 40, 173)
    sol = equip.solve(ball, [50.0], [0.0], (0, 40), events=floor, t_eval=t, **how)
    first = math.sqrt(100 / 9.8)
    since = (t + first) % (2 * first) - first
    assert np.array_equal(sol.t, t) and np.abs(sol.q[:, 0] - (50 - 4.9 * since**2)).max() < 1e-10


def test_a_billiard():
    """A free particle within a circle: all chords are equal, and the angles of the bounces are evenly spaced."""
    free = equip.Hamiltonian(lambda q, p: p @ p / 2, 2)

    def wall(t, q, p):
        return 1 - q @ q

    def reflect(t, q, p):
        normal = q / np.linalg.norm(q)
        return q, p - 2 * (p @ normal) * normal

    wall.direction, wall.then = -1, reflect
    angle = 0.4
    p0 = [-math.cos(angle), math.sin(angle)]
    sol = equip.solve(free, [1.0 - 1e-12, 0.0], p0, (0, 100), events=wall, step=0.3)
    chord = 2 * math.cos(angle)
    assert len(sol.t_events[0]) == int(100 / chord)
    assert np.abs(np.diff(sol.t_events[0]) - chord).max() < 1e-11
    x, y = sol.q_events[0].T
    turns = np.diff(np.unwrap(np.arctan2(y, x)))
    assert np.abs(turns - (math.pi - 2 * angle)).max() < 1e-11


def test_kicks_at_times(kepler):
    """A kick every unit of time, in the direction of motion, raises the energy."""

    def clock(t, q, p):
        return np.sin(np.pi * t)

    calls = []

    def kick(t, q, p):
        calls.append(t)
        return q, 1.01 * p

    clock.then = kick
    sol = equip.solve(kepler, [1.0, 0.0], [0.0, 1.0], (0, 5.5), events=clock, tolerance=1e-11)
    assert calls == pytest.approx([1, 2, 3, 4, 5]) == sol.t_events[0].tolist()
    q, p = sol.q_events[0], sol.p_events[0]
    gained = ((1.01**2 - 1) * (p * p).sum(axis=1) / 2).sum()
    assert kepler(sol.q[-1], sol.p[-1]) - kepler([1.0, 0.0], [0.0, 1.0]) == pytest.approx(gained, rel=1e-9)
    assert len(q) == 5


def test_events_that_accumulate_end_the_run(ball):
    """A ball that loses a half of its speed in each bounce comes to rest after a finite time."""

    def soft(t, q, p):
        return q[0]

    soft.direction, soft.then = -1, lambda t, q, p: (q, -0.5 * p)
    sol = equip.solve(ball, [1.0], [0.0], (0, 10), events=soft, tolerance=1e-10)
    rest = math.sqrt(2 / 9.8) * 3
    assert not sol.success and sol.status == -1 and sol.t[-1] == pytest.approx(rest, abs=1e-6)


def test_faults_of_changes(ball):
    def event(then, **attributes):
        def g(t, q, p):
            return q[0]

        g.then = then
        for name, value in attributes.items():
            setattr(g, name, value)
        return g

    def run(*events, **options):
        return equip.solve(ball, [1.0], [0.0], (0, 2), events=list(events), **options)

    with pytest.raises(ZeroDivisionError):
        run(event(lambda t, q, p: 1 / 0))
    with pytest.raises(TypeError, match="must return"):
        run(event(lambda t, q, p: q))
    with pytest.raises(ValueError, match=r"returned p of shape \(2,\); it must have \(1,\)"):
        run(event(lambda t, q, p: (q, [1.0, 2.0])))
    with pytest.raises(ValueError, match="returned complex p; it must be real"):
        run(event(lambda t, q, p: (q, p * 1j)))
    with pytest.raises(TypeError, match="must be a function of t, q and p"):
        run(event(3))
    with pytest.raises(ValueError, match="ends the run, or changes its state, not both"):
        run(event(lambda t, q, p: (q, -p), terminal=True))
    for options in ({"precision": "dd"}, {"chaos": True}, {"checkpoint": "x"}):
        with pytest.raises(ValueError, match="are not available with"):
            run(event(lambda t, q, p: (q, -p)), **options)
    nan = run(event(lambda t, q, p: (q, p * np.nan)))
    assert not nan.success and "finite" in nan.message
