"""Prefilters: their response, and that they change what a loop follows, nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.prefilter import Prefilter, with_prefilters
from flexstage.control.example import integral_loop
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.systems.closed import loop
from flexstage.control.systems.system import select, static
from flexstage.models.linear.model import Channel

FREQUENCIES = np.geomspace(0.1, 4000.0, 40)


@pytest.mark.parametrize("lead", [None, 200.0])
def test_a_prefilter_has_its_response(lead):
    s = 2j * np.pi * FREQUENCIES
    own = Prefilter(90.0, 0.8, lead)
    expected = (1.0 + (s / (2.0 * np.pi * lead) if lead else 0.0)) / (1.0 + 1.6 * s / (180.0 * np.pi) + (s / (180.0 * np.pi)) ** 2)
    assert own.system().transfer(FREQUENCIES).ravel() == pytest.approx(expected, rel=1e-11)
    sampled = own.system(1e-4)
    assert sampled.transfer(np.array([0.0, 90.0])).ravel() == pytest.approx(own.system().transfer(np.array([0.0, 90.0])).ravel(), rel=0.01)
    assert sampled.growth < 0.0


@pytest.mark.parametrize("ahead", [None, np.array([[1.0]])])
def test_the_loop_follows_what_is_left_of_the_command_and_rejects_as_before(ahead):
    """Also where the reference is fed forward: F stands before everything."""
    plant = integral_loop().plant
    own, loops = Prefilter(90.0, 0.8, 200.0), platform_loops(plant.coordinates)
    bare, shaped = (
        loop(plant, Decentralised(loops, (PI(0.1, 200.0),), (), ahead, filters).system(1e-4)).system for filters in ((), (own,))
    )
    follows = [select(each, ["reference.x"], ["platform.x"]).transfer(FREQUENCIES).ravel() for each in (bare, shaped)]
    assert follows[1] == pytest.approx(follows[0] * own.system(1e-4).transfer(FREQUENCIES).ravel(), rel=1e-9)
    rejects = [select(each, ["noise.S", "ground.x"], ["platform.x"]).transfer(FREQUENCIES).ravel() for each in (bare, shaped)]
    assert rejects[1] == pytest.approx(rejects[0], rel=1e-9)


def test_prefilters_of_turned_loops_stand_in_their_coordinates():
    """S^+ F S: a filter of the sum of two axes leaves their difference."""
    entry, exit_ = (tuple(Channel(f"{kind}.{name}", "m") for name in ("x", "y")) for kind in ("error", "command"))
    sense = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0)
    plane = Coordinates(("x", "y"), ("m", "m"), ("x", "y"), ("a", "b"), np.eye(2), np.eye(2), np.eye(2), 0.1)
    found = with_prefilters(static(np.eye(2), entry, exit_), (Prefilter(90.0), None), sense, plane)
    response = select(found, ["reference.x", "reference.y"], ["command.x", "command.y"]).transfer(np.array([90.0]))[0]
    assert response @ [1.0, -1.0] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert response @ [1.0, 1.0] == pytest.approx(np.array([1.0, 1.0]) * (1.0 / 2.0j - 1.0), rel=1e-12)


def test_what_no_prefilter_is_is_named():
    with pytest.raises(DesignError, match=r"damping must be positive \(got 0\)") as caught:
        Prefilter(-3.0, 0.0)
    assert len(caught.value.findings) == 2
