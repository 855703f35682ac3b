"""Answers: one result as a JSON document, as tables, or both."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexstage.apps.cli.output import STDOUT, announced, write
from flexstage.apps.cli.speech import tell
from flexstage.base.finding import refuse
from flexstage.studies.reading import Reading

if TYPE_CHECKING:
    from flexstage.base.finding import Finding
    from flexstage.mechanism.mechanism import Mechanism
    from flexstage.present.documents.envelope import Document
    from flexstage.present.table import Table
    from flexstage.readings.linear.model import LinearModel


@dataclass(frozen=True)
class Asked:
    """What was asked: the kind of document, of which description (`None`: of none), by which reading, where JSON goes (`None`: nowhere).

    `cautions` are the result's own, told after those about the description.
    """

    kind: str
    mechanism: Mechanism | None
    reading: Reading | None
    json: str | None
    cautions: tuple[Finding, ...] = ()


def answer(asked: Asked, body: Callable[[], Document], tables: Callable[[], Iterable[Table | None]]) -> None:
    """Write the JSON document where one was asked for, and show the tables unless stdout is the document's."""
    if asked.json is not None:
        from flexstage.present.documents.envelope import as_text, enveloped

        write(asked.json, as_text(enveloped(asked.kind, asked.mechanism, asked.reading, body(), asked.cautions)) + "\n", "--json")
        if asked.json == STDOUT:
            return
        announced(f"Wrote {asked.json}")
    from flexstage.apps.cli.show import show

    show((*caveat_lines(asked.kind, asked.mechanism, asked.cautions), *tables()))


def caveat_lines(kind: str, mechanism: Mechanism | None, more: tuple[Finding, ...] = ()) -> Iterator[str]:
    """Cautions about a description (none: a record alone) and `more` about the result, and what this kind of result takes by default."""
    from flexstage.studies.cautions import Caveats, caveats

    found = Caveats() if mechanism is None else caveats(mechanism)
    for title, findings in (("Cautions", (*found.cautions, *more)), ("Taken by default", found.defaults_of(kind))):
        if findings:
            yield "\n".join([title, "", *(f"  {each}" for each in findings)])


def tell_missing(missing: Mapping[str, str]) -> None:
    """Say on stderr which results are not given, and why; a reason that several share once."""
    for reason in dict.fromkeys(missing.values()):
        names = ", ".join(name.replace("_", " ") for name, each in missing.items() if each == reason)
        tell(f"not given: {names}: {reason}")


def elastic_model(mechanism: Mechanism, reading: Reading) -> LinearModel:
    """The linear model of a reading; the ideal one is refused."""
    from flexstage.studies.complete import read

    model = read(mechanism, reading)
    if model is None:
        raise refuse("--reading ideal", "rigid bodies have no stiffness, no lost motion and no modes", "Use --reading lumped or mapped")
    return model


def known_point(model: LinearModel, name: str) -> str:
    """The name, if it is one of a body or point whose twist the model gives; else refused with the nearest ones."""
    from flexstage.base.finding import nearest
    from flexstage.spatial.frame import COMPONENTS

    outputs = {channel.name for channel in model.outputs}
    places = {each.rpartition(".")[0] for each in outputs if each.rpartition(".")[2] in COMPONENTS}
    if name not in places:
        raise refuse("--at", f"there is no body or point {name}", nearest(name, places))
    return name
