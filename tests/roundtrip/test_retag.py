"""Tags put into the text of a design file: every value can carry one, and nothing else changes."""

from __future__ import annotations

from dataclasses import replace

import pytest

from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import addresses, set_value, tag_of
from flexstage.mechanism.store import dumps, loads
from flexstage.mechanism.store.retag import set_tags
from tests.conftest import FULL

TAG = "derived update a test, +- 0.3 %"


@pytest.mark.parametrize("name", ["double-triangle", "hexapod", "bridge"])
def test_every_kind_of_value_takes_a_tag(name: str) -> None:
    stage = case(name)
    text = dumps(stage, {"materials": "Steel of the shop."})
    for address in addresses(stage)[:: 9 if FULL else 23]:
        after = set_tags(text, {address: TAG})
        found = loads(after)
        assert tag_of(found, address) == TAG, address
        assert replace(found, tags=stage.tags) == stage
        assert "# Steel of the shop." in after


def test_overrides_are_tagged_by_address() -> None:
    stage = set_value(case("double-triangle"), "B2/front.thickness", 1.5e-3)
    after = set_tags(dumps(stage), {"B2/front.thickness": TAG, "parts.neck.thickness": TAG})
    assert f'"B2/front.thickness" = "{TAG}"' in after.partition("[tags]")[2]
    assert tag_of(loads(after), "parts.neck.thickness") == tag_of(loads(after), "B2/front.thickness") == TAG
