"""Runs against closed forms and against SciPy; options, events, precision and faults."""

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import equip


def ellipse(e, t):
    """Kepler's problem, μ = 1, semi-major axis 1, started at the pericentre: state at time t by Kepler's equation."""
    anomaly = t + e * np.sin(t)
    for _ in range(50):
        anomaly -= (anomaly - e * np.sin(anomaly) - t) / (1 - e * np.cos(anomaly))
    b, c, s = np.sqrt(1 - e * e), np.cos(anomaly), np.sin(anomaly)
    rate = 1 / (1 - e * c)
    return np.stack([c - e, b * s], axis=-1), np.stack([-s * rate, b * c * rate], axis=-1)


START = ([0.4, 0.0], [0.0, 2.0])
PERIOD = 2 * np.pi


@pytest.mark.parametrize("how", [{"step": 0.05}, {"tolerance": 1e-12}, {}])
def test_kepler_against_its_closed_form(kepler, how):
    times = np.linspace(0, 20, 81)
    sol = equip.solve(kepler, *START, (0, 20), t_eval=times, dense_output=True, **how)
    q, p = ellipse(0.6, times)
    assert sol.success and sol.message == "the end of the interval was reached"
    assert np.array_equal(sol.t, times) and sol.q.shape == sol.p.shape == (81, 2)
    assert np.abs(sol.q - q).max() < 2e-12 and np.abs(sol.p - p).max() < 5e-12
    # 5e-15 between the steps of a tolerance of 1e-12.
    assert np.abs(sol.energy_error).max() < 1e-14
    dense = sol.sol(times[1:-1])
    assert np.abs(dense[0] - q[1:-1]).max() < 2e-12 and dense[1].shape == (79, 2)
    assert sol.sol(3.0)[0].shape == (2,) and sol.sol([[1.0, 2.0]])[0].shape == (1, 2, 2)


def test_agrees_with_dop853_on_henon_heiles():
    def energy(q, p):
        return (p @ p + q @ q) / 2 + q[0] ** 2 * q[1] - Fraction(1, 3) * q[1] ** 3

    def slope(t, y):
        x, v, px, pv = y
        return [px, pv, -x - 2 * x * v, -v - x * x + v * v]

    h = equip.Hamiltonian(energy, 2)
    q0, p0 = [0.1, 0.3], [0.25, 0.2]
    times = np.linspace(0, 50, 26)
    other = solve_ivp(slope, (0, 50), [*q0, *p0], method="DOP853", rtol=1e-13, atol=1e-14, t_eval=times)
    sol = equip.solve(h, q0, p0, (0, 50), t_eval=times)
    assert np.abs(sol.y - other.y.T).max() < 1e-10
    assert np.abs(sol.energy_error).max() < 1e-15


def test_recorded_steps(kepler):
    every = equip.solve(kepler, *START, (0, 1), step=0.1)
    assert every.t == pytest.approx(np.arange(11) / 10) and len(every.outcome) == 11
    assert every.y.shape == (11, 4) and np.array_equal(every.y, np.concatenate([every.q, every.p], axis=1))
    third = equip.solve(kepler, *START, (0, 1), step=0.1, record=3)
    assert np.array_equal(third.t, every.t[[0, 3, 6, 9, 10]]) and np.array_equal(
        third.y, every.y[[0, 3, 6, 9, 10]]
    )
    ends = equip.solve(kepler, *START, (0, 1), step=0.1, record="ends")
    assert np.array_equal(ends.y, every.y[[0, -1]])


def test_outputs_do_not_change_the_run(kepler):
    plain = equip.solve(kepler, *START, (0, 10), step=0.1)
    rich = equip.solve(kepler, *START, (0, 10), step=0.1, dense_output=True, events=lambda t, q, p: q[1])
    assert np.array_equal(plain.y, rich.y)


def test_shapes_of_many_bodies():
    masses = np.array([1.0, 1e-3, 2e-3])

    def energy(q, p):
        i, j = np.triu_indices(3, 1)
        return (p**2 / (2 * masses[:, None])).sum() - (
            masses[i] * masses[j] / np.linalg.norm(q[i] - q[j], axis=1)
        ).sum()

    h = equip.Hamiltonian(energy, (3, 3))
    q0 = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0.1]])
    p0 = masses[:, None] * np.array([[0.0, 0, 0], [0, 1, 0], [-0.7, 0, 0]])
    momentum = {f"P{axis}": (lambda q, p, axis=axis: p[:, axis].sum()) for axis in range(3)}
    spin = {"Lz": lambda q, p: np.cross(q, p)[:, 2].sum()}
    sol = equip.solve(h, q0, p0, (0, 10), invariants=momentum | spin, t_eval=[1, 2, 10])
    assert sol.q.shape == (3, 3, 3) and sol.sol is not None
    assert [i.name for i in sol.certificate.invariants] == ["P0", "P1", "P2", "Lz"]
    assert all(i.max < 1e-16 for i in sol.certificate.invariants)
    with pytest.raises(ValueError, match=r"q0 has shape \(9,\), but this Hamiltonian needs \(3, 3\)"):
        equip.solve(h, q0.ravel(), p0, (0, 1))


def test_events(pendulum):
    def turn(t, q, p):
        return p[0]

    def upward(t, q, p):
        return q[0] + 0 * t

    upward.direction = 1
    sol = equip.solve(pendulum, [0.0], [1.0], (0, 20), events=[turn, upward])
    for q, p, y in zip(sol.q_events, sol.p_events, sol.y_events):
        assert q.shape == p.shape == (len(y), 1) and np.array_equal(np.hstack([q, p]), y)
    # Period 4 K(m) with m = sin²(θ_max/2) = 1/4.
    from scipy.special import ellipk

    period = 4 * ellipk(0.25)
    assert sol.t_events[0] == pytest.approx(
        period * np.array([0.25, 0.75, 1.25, 1.75, 2.25, 2.75]), abs=1e-12
    )
    assert sol.t_events[1] == pytest.approx(period * np.array([1, 2]), abs=1e-12)
    assert sol.y_events[0].shape == (6, 2) and sol.y_events[0][:, 1] == pytest.approx(np.zeros(6), abs=1e-12)
    assert sol.y_events[0][0, 0] == pytest.approx(np.pi / 3, abs=1e-12)


def test_events_of_time(pendulum):
    sol = equip.solve(pendulum, [0.0], [1.0], (0, 5), events=lambda t, q, p: np.sin(np.pi * t - 0.5))
    assert sol.t_events[0] == pytest.approx(0.5 / np.pi + np.arange(5), abs=1e-13)


def test_terminal_events(pendulum):
    def turn(t, q, p):
        return p[0]

    turn.terminal = True
    sol = equip.solve(pendulum, [0.0], [1.0], (0, 20), events=turn, t_eval=[1, 2, 10])
    assert sol.success and sol.message == "a terminal event ended the run"
    assert len(sol.t_events[0]) == 1 and sol.t.tolist() == [1]
    assert sol.certificate.end == sol.t_events[0][0]
    turn.terminal = 3
    with pytest.raises(ValueError, match=r"event 0 \(turn\) has terminal = 3; it must be True"):
        equip.solve(pendulum, [0.0], [1.0], (0, 20), events=turn)


def test_methods_keep_what_they_promise(kepler):
    def drift(method):
        return equip.solve(
            kepler, *START, (0, 20 * PERIOD), step=PERIOD / 60, method=method
        ).certificate.energy.max

    assert drift(equip.Equip(3)) < 1e-14 and drift(equip.Equip(3, alphas="last")) < 1e-8
    assert 1e-7 < drift(equip.Gauss(3)) < 1e-5 and 1e-7 < drift(equip.FixedAlpha(3, "0.001"))
    # Independent figures with 80 steps a period: 5.7e-14 for HBVM(6, 3), which conserves no angular momentum.
    assert drift(equip.Hbvm(8, 3)) < 1e-14 and drift(equip.AveragedVectorField()) < 1e-13
    assert drift(equip.Trapezoidal(8)) < 1e-5
    for order_two in equip.AveragedVectorField(), equip.Trapezoidal(3), equip.Hbvm(4, 1):
        with pytest.raises(ValueError, match="no error estimate"):
            equip.solve(kepler, *START, (0, 1), tolerance=1e-6, method=order_two)
    with pytest.raises(ValueError, match="nodes"):
        equip.solve(kepler, *START, (0, 1), step=0.1, method=equip.Hbvm(2, 3))
    gauss = equip.solve(kepler, *START, (0, 1), step=0.1, method=equip.Gauss(3))
    assert gauss.certificate.energy is not None and gauss.certificate.alpha_range == ()
    unmeasured = equip.solve(kepler, *START, (0, 1), step=0.1, method=equip.Gauss(3), measure_energy=False)
    assert unmeasured.certificate.energy is None and len(unmeasured.energy_error) == 0


def test_further_quantities_are_kept(kepler):
    # Toda's chain of three has an integral of degree three in the momenta.
    def spring(q, i):
        return np.exp(q[i % 3] - q[(i + 1) % 3])

    def cubic(q, p):
        return p[0] * p[1] * p[2] - p[0] * spring(q, 1) - p[1] * spring(q, 2) - p[2] * spring(q, 0)

    toda = equip.Hamiltonian(lambda q, p: p @ p / 2 + sum(spring(q, i) for i in range(3)), 3)

    def defect(**how):
        run = equip.solve(
            toda, [0.5, -0.3, 0.2], [1, -0.4, 0.3], (0, 50), step=0.2, method=equip.Equip(5), **how
        )
        assert run.certificate.invariants[0].name == "cubic" and run.certificate.energy.max < 5e-14
        return run.certificate.invariants[0].max

    # 2.3e-12 and 2.8e-14.
    assert defect(invariants={"cubic": cubic}) > 1e-12 and defect(preserve={"cubic": cubic}) < 1e-13
    with pytest.raises(ValueError, match="2 quantities to conserve, but only 1 free"):
        equip.solve(
            kepler, *START, (0, 10), step=0.1, method=equip.Equip(2), preserve={"p³": lambda q, p: p[0] ** 3}
        )


def test_double_double_against_the_closed_form():
    # q'' = -q from q = 1/10: q(1) = cos(1)/10.
    h = equip.Hamiltonian(lambda q, p: (p @ p + q @ q) / 2, 1)
    tenth = Decimal("0.05403023058681397174009366074429766037323104206179")
    for start in (
        Fraction(1, 10),
        "0.1",
        Decimal("0.1"),
        equip.DoubleDouble(np.array([0.1]), np.array([-5.551115123125783e-18])),
    ):
        start = start if isinstance(start, equip.DoubleDouble) else [start]
        sol = equip.solve(
            h, start, ["0"], (0, 1), step=Fraction(1, 8), precision="dd", method=equip.Equip(12)
        )
        error = Decimal(sol.q_text(35)[-1, 0]) - tenth
        assert abs(error) < Decimal("2e-31")
        assert sol.q[-1, 0] == float(tenth) and abs(sol.q_low[-1, 0]) < 1e-17
    rough = equip.solve(h, [0.1], [0.0], (0, 1), step=0.125, precision="dd", method=equip.Equip(12))
    assert abs(Decimal(rough.q_text(35)[-1, 0]) - tenth) > Decimal("1e-18")


def test_scenes_start_in_double_double():
    scene = equip.scenes.kepler(e="0.6")
    sol = equip.solve(scene, *scene.start("dd"), (0, 5), precision="dd", tolerance=1e-26)
    assert sol.certificate.precision == "dd" and sol.certificate.energy.max < 1e-29


def test_chaos_indicators():
    scene = equip.scenes.henon_heiles(energy="1/6")
    regular = equip.solve(
        equip.scenes.pendulum(), [0.0], [1.0], (0, 500), chaos=True, tolerance=1e-10, record="ends"
    )
    chaotic = equip.solve(scene, scene.q0, scene.p0, (0, 2000), chaos=True, tolerance=1e-10, record="ends")
    assert regular.certificate.megno < 2.5 and regular.certificate.lyapunov < 0.02
    assert chaotic.certificate.megno > 10 and chaotic.certificate.lyapunov > 0.05


def test_a_fault_on_the_way_leaves_what_was_made():
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - q[0] ** 4, 1)
    sol = equip.solve(h, [1.0], [1.5], (0, 10))
    assert not sol.success and "escapes to infinity" in sol.message
    assert 0 < sol.t[-1] < 10 and np.isfinite(sol.y).all() and sol.certificate.end == sol.t[-1]
    fixed = equip.solve(h, [1.0], [1.5], (0, 10), step=0.01)
    assert (
        not fixed.success
        and "escapes to infinity" in fixed.message
        and "end the run before that time" in fixed.message
    )
    few = equip.solve(h, [0.1], [0.0], (0, 1), max_steps=1, max_step=0.1)
    assert not few.success and "raise `max_steps`" in few.message and len(few.t) == 2


def fails(kepler, text, *arguments, **options):
    q0, p0, span = arguments or (*START, (0, 1))
    with pytest.raises(ValueError, match=text):
        equip.solve(kepler, q0, p0, span, **options)


def test_bad_input_is_refused_with_a_remedy(kepler):
    fails(kepler, "give a step or a tolerance, not both", step=0.1, tolerance=1e-8)
    fails(kepler, "max_step belongs to variable steps: leave out step, or them", step=0.1, max_step=1.0)
    fails(kepler, "steps of -0.1 from 0 lead away from 1; give a step without a sign", step=-0.1)
    fails(kepler, "the step is 0; it must", step=0.0)
    fails(kepler, r"atol has 3 parts; it must be a number, or a pair", atol=(1e-9, 1e-9, 1e-9))
    fails(kepler, r"atol must be numbers, or arrays of the shape \(2,\)", atol=([1e-9] * 3, 1e-9))
    fails(kepler, r"`atol \(q\)` is -1", atol=-1.0)
    fails(kepler, r"rtol must be numbers, or arrays of the shape \(2,\)", rtol=([1e-9] * 3, 1e-9))
    fails(kepler, r"`rtol \(p\)` is 0", rtol=(1e-9, [1e-9, 0.0]))
    fails(kepler, "`tolerance` is 1; it must be between", tolerance=1.0)
    fails(kepler, "must be finite", *START, (0, np.inf))
    fails(kepler, r"initial value p0\[1\] is inf; it must be finite", [1, 0], [0, np.inf], (0, 1))
    fails(kepler, "not finite .H = -inf.; change the initial state", [0, 0], [0, 1], (0, 1))
    fails(kepler, r"q0 has shape \(3,\), but this Hamiltonian needs \(2,\)", [1, 2, 3], [0, 1], (0, 1))
    fails(kepler, "q0 is complex; it must be real", [1j, 0], [0, 1], (0, 1))
    fails(kepler, "q0: .*is not a number", [None, 0], [0, 1], (0, 1))
    fails(kepler, "`one` is not a decimal|one", ["one", "0"], [0, 1], (0, 1))
    fails(kepler, r"output time 2 \(number 1\) must lie between 0 and 1", t_eval=[0.5, 2])
    fails(kepler, "sorted in the direction of the run", t_eval=[0.5, 0.25])
    fails(kepler, r"t_eval has shape \(1, 2\); it must have one axis", t_eval=[[0.25, 0.5]])
    fails(kepler, "stages is 40; it must be a whole number, 2 to 32", method=equip.Equip(40))
    fails(kepler, "alpha_policy is 'far'; it must be", method=equip.Equip(4, alpha_policy="far"))
    fails(kepler, "preconditioner is 'none'; it must be", method=equip.Gauss(4, preconditioner="none"))
    fails(kepler, "alphas is 'first'; it must be 'several' or 'last'", method=equip.Equip(4, alphas="first"))
    fails(kepler, "precision is 'f32'; it must be 'f64' or 'dd'", precision="f32")
    fails(kepler, "record is 0; it must be a positive integer or 'ends'", record=0)
    fails(kepler, "record is 'all'; it must be a positive integer or 'ends'", record="all")
    fails(kepler, "span has two numbers, start and end; .* has 3", *START, (0, 1, 2))
    with pytest.raises(TypeError, match=r"equip.Hamiltonian\(function, shape\)"):
        equip.solve(lambda q, p: q[0], *START, (0, 1))
    with pytest.raises(TypeError, match="cannot be compared"):
        equip.solve(kepler, *START, (0, 1), events=lambda t, q, p: 1 if q[0] > 0 else -1)
    other = equip.Hamiltonian(lambda q, p: q[0], 1)
    fails(
        kepler,
        r"invariants\['L'\] is made for shape \(1,\), but this Hamiltonian has \(2,\)",
        invariants={"L": other},
    )


def test_options_are_named(kepler):
    for options, text in [
        ({"method": equip.Equip(8.5)}, "stages is 8.5; it must be a whole number, 2 to 32"),
        ({"method": equip.Gauss(-1)}, "stages is -1; it must be a whole number, 1 to 32"),
        ({"method": equip.Gauss(1)}, "give a step, or stages=2 or more"),
        ({"max_steps": -1}, "max_steps is -1; it must be a whole number, 1 or more"),
        ({"record": 10**30}, "record is 10*; it must be"),
        ({"record": None}, "record is None; it must be"),
        ({"record": np.nan}, "record is nan; it must be"),
        ({"dense_output": "a"}, "dense_output is 'a'; it must be True or False"),
        ({"chaos": "a"}, "chaos is 'a'; it must be True or False"),
        ({"tolerance": "a"}, "tolerance is 'a'; it must be a number"),
        ({"first_step": "a"}, "first_step is 'a'; it must be a number"),
    ]:
        fails(kepler, text, **options)
    fails(kepler, r"span is 10; it must be two numbers: \(start, end\)", *START, 10)
    fails(kepler, "q0 is ragged; all of its rows must be equally long", [[1], [1, 2]], [0, 1], (0, 1))
    fails(kepler, "q0 has masked entries", np.ma.array([1.0, 2.0], mask=[1, 0]), [0, 1], (0, 1))
    with pytest.raises(ValueError, match="q has masked entries"):
        kepler(np.ma.array([1.0, 2.0], mask=[1, 0]), [0, 1])
    assert equip.solve(kepler, *START, (0, 1), method=equip.Gauss(1), step=0.1).success


def test_attributes_of_events(kepler):
    def side(t, q, p):
        return q[1]

    def run(**attributes):
        side.__dict__.clear()
        side.__dict__.update(attributes)
        return equip.solve(kepler, *START, (0.1, 20), events=side)

    both = run(terminal=None, direction=None).t_events[0]
    assert len(both) == 6 and np.array_equal(both, run(terminal=False, direction=0).t_events[0])
    assert len(run(terminal=1).t_events[0]) == 1 and len(run(direction=np.float64(-1)).t_events[0]) == 3
    with pytest.raises(ValueError, match=r"event 0 \(side\) has terminal = 2; it must be True"):
        run(terminal=2)
    with pytest.raises(ValueError, match=r"event 0 \(side\) has direction = 'up'; it must be 1, -1 or 0"):
        run(direction="up")


def test_the_message_names_what_was_not_kept(kepler):
    momentum = {"L": lambda q, p: q[0] * p[1] - q[1] * p[0]}
    for h, start in [(kepler, START), (kepler, ([0.4, 0.0], [0.0, 0.0001])), (equip.scenes.kepler(), START)]:
        kept = equip.solve(h, *start, (0, 0.1), preserve=momentum)
        assert kept.message == "the end of the interval was reached"
    sol = equip.solve(kepler, *START, (0, 10), preserve={**momentum, "x": lambda q, p: q[0]}, record="ends")
    assert sol.success
    off = sol.certificate.invariants[1].max
    assert sol.message.endswith(f"reached, but x was not conserved: its error is up to {off:.2g}")


def test_dense_output_is_asked_for(kepler):
    with pytest.raises(ValueError, match="solve with dense_output=True"):
        equip.solve(kepler, *START, (0, 1)).sol(0.5)
    with pytest.raises(ValueError, match="t = 2 is outside the run, 0 to 1"):
        equip.solve(kepler, *START, (0, 1), dense_output=True).sol([0.5, 2])


def test_progress(kepler, capsys):
    sol = equip.solve(kepler, *START, (0, 100), progress=True)
    assert sol.success and "t = 100" in capsys.readouterr().err


@pytest.mark.parametrize("how", [{"step": 0.05}, {"tolerance": 1e-12}])
def test_runs_go_back_in_time(kepler, how):
    there = equip.solve(kepler, *START, (0, 10), **how)
    back = equip.solve(kepler, there.q[-1], there.p[-1], (10, 0), t_eval=[7.5, 2.5], dense_output=True, **how)
    assert back.t.tolist() == [7.5, 2.5]
    forward = equip.solve(kepler, *START, (0, 10), t_eval=[2.5, 7.5], **how)
    assert np.abs(back.q - forward.q[::-1]).max() < 1e-10
    q, p = back.sol(0.0)
    assert np.abs(np.concatenate([q - START[0], p - START[1]])).max() < 1e-12


def test_errors_below_atol_are_allowed():
    """A fast motion of 1e-7 beside a slow one of 1."""
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - np.cos(q[0]) + 450 * q[1] ** 2, 2)

    def steps(**how):
        return len(
            equip.solve(h, [1.0, 1e-7], [0.0, 0.0], (0, 20), tolerance=1e-8, method=equip.Gauss(6), **how).t
        )

    fine = steps()
    assert 4 * steps(atol=1e-5) < fine and 4 * steps(atol=([0, 1e-6], [0, 1e-4])) < fine


def test_every_component_has_the_relative_error_it_is_given():
    """Two pendulums, one thirty times as quick: the quick one asks for the steps."""
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 - np.cos(q[0]) - 900 * np.cos(q[1]), 2)

    def steps(**how):
        return len(equip.solve(h, [1.0, 1.0], [0.0, 0.0], (0, 5), method=equip.Gauss(3), **how).t)

    tight, loose = steps(tolerance=1e-12), steps(tolerance=1e-9)
    assert 2 * loose < tight and steps(tolerance=1e-9, rtol=1e-12) == tight
    mixed = steps(tolerance=1e-12, rtol=([1e-12, 1e-9], [1e-12, 1e-9]))
    assert abs(mixed - loose) <= loose / 20
