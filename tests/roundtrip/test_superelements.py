"""Superelements as files: what is read is bit by bit what was written, or a reason why it cannot be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from flexstage.base.number import Array
from flexstage.base.storage.record_store import from_bytes, to_bytes
from flexstage.solid.fea.solver.superelement import Skin, Superelement

KEY = "0123456789abcdef"
RECORDS = (Superelement, Skin)


def superelement(seed: int, size: int = 8) -> Superelement:
    """Numbers without meaning, in the shapes of a superelement of one body between two links, with names that need care."""
    draw = np.random.default_rng(seed)

    def numbers(*shape: int) -> Array:
        values = draw.standard_normal(shape) * 10.0 ** draw.integers(-300, 300, shape)
        values.ravel()[: min(3, values.size)] = [0.0, -0.0, 5e-324][: min(3, values.size)]
        return values

    groups = ('B1/back "a"', "B1/förder", "B1/front\n")
    return Superelement(
        interfaces=1,
        warps=0,
        stiffness={name: numbers(size, size) for name in groups},
        inertia={name: numbers(size, size) for name in reversed(groups)},
        bodies={groups[1]: numbers(6, size)},
        body_inertia={groups[1]: numbers(6, 6)},
        resultants={},
        strokes={groups[0]: numbers(size)},
        free_strokes={groups[0]: numbers(size)},
        rigid=numbers(size, 6),
        carried=numbers(size, 6),
        skin=Skin(
            vertices=numbers(5, 3),
            triangles=draw.integers(0, 5, (4, 3)),
            motion=draw.standard_normal((5, 3, size)).astype(np.float32),
            stress=draw.standard_normal((5, 6, size)).astype(np.float32),
            owner=draw.integers(0, 3, 4),
        ),
        freedoms=123456,
        elements=789,
    )


def assert_same(one: object, other: object) -> None:
    if isinstance(one, np.ndarray):
        assert isinstance(other, np.ndarray)
        assert (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())
    elif isinstance(one, Mapping):
        assert isinstance(other, Mapping)
        assert list(one) == list(other)
        for name in one:
            assert_same(one[name], other[name])
    elif isinstance(one, (Superelement, Skin)):
        assert type(one) is type(other)
        for field in fields(one):
            assert_same(getattr(one, field.name), getattr(other, field.name))
    else:
        assert one == other


@given(st.integers(0, 2**32), st.integers(6, 20))
def test_what_is_read_is_what_was_written(seed: int, size: int) -> None:
    element = superelement(seed, size)
    assert_same(from_bytes(to_bytes(element, KEY), KEY, RECORDS), element)


DATA = to_bytes(superelement(0), KEY)


@given(st.integers(0, len(DATA) - 1), st.integers(1, 255))
def test_no_changed_byte_goes_unnoticed(place: int, change: int) -> None:
    data = bytearray(DATA)
    data[place] ^= change
    with pytest.raises(ValueError, match="it is damaged"):
        from_bytes(bytes(data), KEY, RECORDS)


@given(st.integers(0, len(DATA) - 1))
def test_nothing_cut_off_goes_unnoticed(kept: int) -> None:
    with pytest.raises(ValueError, match="it is damaged"):
        from_bytes(DATA[:kept], KEY, RECORDS)


@given(st.binary(max_size=200))
@example(b"[]")
@example(b"[1]\n")
@example(b"7")
def test_nonsense_is_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match="it is damaged"):
        from_bytes(data, KEY, RECORDS)


def test_other_versions_are_told_apart() -> None:
    with pytest.raises(ValueError, match=r"it is of another version: flexstage 0\.2"):
        from_bytes(to_bytes(superelement(0), KEY, "flexstage 0.2"), KEY, RECORDS, "flexstage 0.0.9")


def test_another_component_is_told_apart() -> None:
    with pytest.raises(ValueError, match="it has other content"):
        from_bytes(DATA, "another", RECORDS)


def test_nothing_in_a_file_is_run() -> None:
    element = replace(superelement(0), carried=np.array([object()], dtype=object))
    with pytest.raises(ValueError, match="Object arrays cannot be saved"):
        to_bytes(element, KEY)
