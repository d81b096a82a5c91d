"""Arrays of any shape and dtype: the numbers that NumPy makes of them, or a refusal in words."""

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import equip

KINDS = [
    *("?", "i1", "u1", "i2", "u4", "i8", "u8", "f2", "f4", "f8", ">f8", "<i4", ">u2", "g"),
    *("c8", "c16", "U3", "S2", "M8[s]", "m8[ms]", "O"),
]
#: What a refusal may be; anything else, and a process that ends, is a fault.
REFUSALS = (TypeError, ValueError, equip.IntegrationError)
FUZZ = settings(max_examples=300, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


@st.composite
def any_array(draw, shapes):
    kind = draw(st.sampled_from(KINDS))
    shape = draw(shapes)
    if kind == "O":
        elements = st.one_of(
            st.none(), st.integers(-9, 9), st.floats(), st.text(max_size=2), st.complex_numbers()
        )
        made = np.empty(shape, dtype=object)
        for index in np.ndindex(*shape):
            made[index] = draw(elements)
        return made
    made = draw(arrays.arrays(np.dtype(kind), shape))
    how = draw(st.sampled_from(["as it is", "Fortran", "backwards", "read only"]))
    if how == "Fortran":
        return np.asfortranarray(made)
    if how == "backwards" and made.ndim:
        return made[::-1]
    if how == "read only":
        made.flags.writeable = False
    return made


any_shape = st.one_of(
    st.just((2,)), st.just((3, 2)), arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=3)
)


def floats_of(x):
    """As real doubles, or None."""
    if np.asarray(x).dtype.kind not in "biuf":
        return None
    with np.errstate(all="ignore"):
        return np.asarray(x).astype(float)


@FUZZ
@given(any_array(any_shape), any_array(any_shape))
def test_starts(q0, p0):
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + q @ q / 2, 2)
    q, p = floats_of(q0), floats_of(p0)
    fits = q is not None and p is not None and q.shape == p.shape == (2,)
    try:
        sol = equip.solve(h, q0, p0, (0, 1), step=0.5, max_steps=None)
    except REFUSALS as refusal:
        # Numbers of a moderate size and the right shape are no reason.
        assert not (fits and np.abs([q, p]).max() < 1e6), refusal
        return
    assert sol.q.shape == sol.p.shape == (len(sol.t), 2)
    if fits:
        assert np.array_equal(sol.q[0], q) and np.array_equal(sol.p[0], p)


@FUZZ
@given(any_array(any_shape), any_array(any_shape))
def test_ensembles(q0, p0):
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + q @ q / 2, 2)
    q, p = floats_of(q0), floats_of(p0)
    fits = q is not None and p is not None and q.shape == p.shape and q.shape[1:] == (2,)
    try:
        ends = equip.ensemble(h, q0, p0, (0, 1), step=0.5, threads=1)
    except REFUSALS as refusal:
        assert not fits, refusal
        return
    assert ends.q.shape == ends.p.shape == (len(ends.t), 2)
    if fits:
        moderate = np.abs(np.stack([q, p])).max(axis=(0, 2), initial=0) < 1e6
        assert set(ends.errors) <= set(np.flatnonzero(~moderate).tolist())


@FUZZ
@given(any_array(any_shape))
def test_captured_arrays(captured):
    def energy(q, p):
        return p @ p / 2 + (q * captured).sum()

    numbers = floats_of(captured)
    try:
        h = equip.Hamiltonian(energy, 2)
    except REFUSALS as refusal:
        fits = numbers is not None and numbers.size and np.isfinite(numbers).all()
        assert not (fits and numbers.shape == (2,)), refusal
        return
    if numbers is None:
        return
    q, p = np.array([0.3, -0.7]), np.array([0.1, 0.2])
    expected = p @ p / 2 + (q * numbers).sum()
    # Sums of long doubles and of half floats are made in doubles.
    size = 1 + np.abs(q * numbers).sum()
    assert abs(h(q, p) - expected) <= 1e-12 * size or not np.isfinite(size)


@FUZZ
@given(any_array(any_shape), any_array(any_shape))
def test_many_states(q, p):
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + q @ q / 2, 2)
    x, v = floats_of(q), floats_of(p)
    try:
        values, slopes, curvature = h(q, p), h.gradient(q, p), h.hessian(q, p)
    except REFUSALS as refusal:
        fits = x is not None and v is not None and x.shape[-1:] == v.shape[-1:] == (2,)
        assert not (fits and x.shape == v.shape), refusal
        return
    if x is None or v is None:
        return
    with np.errstate(all="ignore"):
        expected = (x * x / 2).sum(axis=-1) + (v * v / 2).sum(axis=-1)
    shape = np.shape(expected)
    assert np.shape(values) == shape and curvature.shape == (*shape, 4, 4)
    assert slopes[0].shape == slopes[1].shape == (*shape, 2)
    assert np.allclose(values, expected, rtol=1e-14, atol=0, equal_nan=True)


@FUZZ
@given(any_array(st.one_of(st.just(()), st.just((4,)), any_shape)))
def test_output_times(times):
    h = equip.Hamiltonian(lambda q, p: p @ p / 2 + q @ q / 2, 2)
    try:
        sol = equip.solve(h, [1, 0], [0, 1], (0, 10), step=0.5, t_eval=times)
    except REFUSALS:
        return
    numbers = floats_of(times)
    if numbers is not None:
        assert (
            numbers.ndim < 2 and np.array_equal(sol.t, numbers.ravel()) and sol.q.shape == (numbers.size, 2)
        )
        assert np.allclose(sol.q[:, 0], np.cos(numbers), atol=1e-9)
