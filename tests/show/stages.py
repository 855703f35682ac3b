"""Stages the presentation is tried on, each analysed and reported once a session."""

from __future__ import annotations

import functools
from dataclasses import replace

import pytest

from flexstage.analysis.complete import Analysis, Model, analyse
from flexstage.cases.registry import CASES, case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.report import report

NAMES = tuple(CASES)
"""All shipped cases."""

SEVERAL = tuple(CASES)[:14]
"""Those that costly tests try always; the others, which differ in what they say and not in how, in full only."""
HOSTILE = '<script>alert("1 & 2")</script>'


def analysed(name: str, model: Model = Model.LUMPED) -> Analysis:
    return _analysed(name, model)  # kept under both arguments, whether the second is given or not


def reported(name: str, model: Model = Model.LUMPED) -> str:
    return _reported(name, model)


@functools.cache
def _analysed(name: str, model: Model) -> Analysis:
    return analyse(case(name), model)


@functools.cache
def _reported(name: str, model: Model) -> str:
    return report(_analysed(name, model))


def hostile() -> Mechanism:
    """The parallelogram with markup in every text a user may write, and mathematics in the names of its copies."""
    stage = case("parallelogram")
    materials = {name: replace(material, source=HOSTILE) for name, material in stage.materials.items()}
    renamed = {
        "name": HOSTILE,
        "materials": materials,
        "tags": {"parts": f"stated {HOSTILE}"},
        "sources": {HOSTILE: HOSTILE, "$x^{": "$\\alpha$"},
    }
    bodies = {f"<b>{name}" if name != "platform" else name: body for name, body in stage.bodies.items()}
    links = {f"<i>$_{{{name}}}": replace(link, joins=tuple(_renamed(join) for join in link.joins)) for name, link in stage.links.items()}
    return replace(stage, bodies=bodies, links=links, overrides={}, requirements={}, **renamed)


def _renamed(body: str) -> str:
    return body if body in ("platform", "ground") else f"<b>{body}"


def seldom(name: str) -> object:
    """The name of a case as a parameter of a costly test."""
    return name if name in SEVERAL else pytest.param(name, marks=pytest.mark.full)
