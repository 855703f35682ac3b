"""The modes of a stage by finite elements, for comparison in commands of other packages."""

from __future__ import annotations

from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.command.progress import progress_bar
from flexstage.show.command.terminal import print_note, print_warning
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.results import modes
from flexstage.solid.results.read import solids
from flexstage.solid.results.resolution import DEFAULT


def fea_modes(mechanism: Mechanism, *, computing: bool) -> FeaModes | None:
    """Return newly computed modes if `computing`, else the modes in the cache; if the cache has no modes, print a note on --fea."""
    if computing:
        with progress_bar() as shown:
            return modes.fea_modes(mechanism, DEFAULT, solids(Ways(Cache(), shown.step, notice=print_warning)))
    found = modes.fea_modes_from_cache(mechanism, Cache())
    if found is None:
        print_note("not computed: modes by FEA (not in the cache; --fea computes them)")
    return found
