"""The studio's messages: the same in both languages, and the same after a way over the wire."""

import json
from typing import get_type_hints

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.apps.studio import protocol
from flexstage.apps.studio.protocol import Drag, Edit, Floats, Frequencies, Matrix, Motion, Refusal, Respond
from flexstage.apps.studio.wire import decode, encode, floats
from flexstage.base.finding import DesignError
from tests.apps.studio_page import array, leaves
from tools.protocol import TARGET, written


def test_protocol_of_the_page_is_written_from_the_classes():
    assert TARGET.read_text(encoding="utf-8") == written(), "Run python -m tools.protocol"


def test_every_message_has_a_kind_of_its_own():
    kinds = [each.__name__.lower() for base in (protocol.Request, protocol.Said) for each in leaves(base)]
    assert len(set(kinds)) == len(kinds)


@pytest.mark.parametrize(
    "message", [Edit(3, "µ\n", 4), Drag(1, "parts.neck.thickness", 1e-3), Respond(2, ("B1",), ("S1", "S2"), None, 4.0)]
)
def test_requests_come_back(message):
    assert decode(encode(message)) == message


def test_what_the_server_says_comes_back():
    matrix = Matrix(("x",), ("B1", "B2"), (("1", "m/rad"),), ((1.0, None),))
    message = Motion(matrix, None, None, None, None, {"a": 1.0}, {"a": None}, {}, to=1, revision=2)
    assert decode(encode(message), protocol.Said) == message


ANY = st.recursive(
    st.none() | st.booleans() | st.integers() | st.just(10**400) | st.floats() | st.text(st.characters(exclude_categories=()), max_size=3),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.sampled_from("ab"), inner, max_size=2),
    max_leaves=3,
)


def test_numbers_that_are_not_finite_are_null():
    assert json.loads(encode(Frequencies("a", 1.0, (np.float64("nan"), 2.0), ())))["frequencies"] == [None, 2.0]


def test_arrays_keep_every_bit():
    values = np.random.default_rng(1).standard_normal((3, 4))
    assert np.array_equal(array(floats(values)), values)
    assert isinstance(floats(values), Floats)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"kind": "nothing"}',
        '{"kind": ["edit"]}',
        '{"kind": "edit"}',
        '{"kind": "undo", "id": "1"}',
        '{"kind": "undo", "id": true}',
        '{"kind": "undo", "id": 1, "more": 2}',
        '{"kind": "drag", "id": 1, "address": "a", "value": "1"}',
        '{"kind": "drag", "id": 1, "address": "a", "value": NaN}',
        '{"kind": "drag", "id": 1, "address": "a", "value": 1e999}',
        '{"kind": "drag", "id": 1, "address": "a", "value": 1' + 400 * "0" + "}",
        '{"kind": "cancel", "id": 1, "job": 1' + 400 * "0" + "}",
        '{"kind": "cancel", "id": -9007199254740993, "job": 1}',
        '{"kind": "edit", "id": 1, "text": "\\ud800", "revision": 1}',
        '{"kind": "run", "id": 1, "command": "loop", "study": null, "record": 0, "options": []}',
        '{"kind": "run", "id": 1, "command": ["loop"], "study": null, "record": null, "options": []}',
        '{"kind": "run", "id": 1, "command": "rm", "study": null, "record": null, "options": []}',
        "[" * 100_000,
    ],
)
def test_what_is_no_request_is_refused(text):
    with pytest.raises(DesignError, match="Reload the page"):
        decode(text)


@given(st.sampled_from(leaves(protocol.Request)), st.data())
def test_any_message_is_a_request_or_refused(kind, data):
    """Every field with what JSON can hold; what is read is sent again as it came."""
    text = json.dumps({name: data.draw(ANY) for name in get_type_hints(kind)} | {"kind": kind.__name__.lower()})
    try:
        found = decode(text)
    except DesignError:
        return
    assert decode(encode(found)) == found


def test_what_the_server_says_is_no_request():
    with pytest.raises(DesignError):
        decode(encode(Refusal(())))
