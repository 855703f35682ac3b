"""The model description of a functional mock-up unit: FMI 2.0 for Co-Simulation."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from flexstage.base.text import printable
from flexstage.base.units.dimension import dimension_of
from flexstage.control.export.code.program import Program
from flexstage.models.linear.model import Channel

_BASE = {"mass": "kg", "length": "m", "time": "s", "current": "A", "temperature": "K", "angle": "rad"}


def guid(program: Program) -> str:
    """Compute an identifier from the program's text: equal programs have equal identifiers.

    >>> from flexstage.control.export.code.product import Code
    >>> one, other = (guid(Program(name, (), 1.0, (), (), (), Code())) for name in ("one", "other"))
    >>> len(one), one == other
    (38, False)
    """
    content = hashlib.sha256((program.header + program.source).encode()).hexdigest()
    return f"{{{uuid.uuid5(uuid.NAMESPACE_OID, content)}}}"


def description(program: Program, sources: Iterable[str]) -> bytes:
    """Generate `modelDescription.xml` of a program: inputs and outputs are discrete real variables with units.

    >>> from flexstage.control.export.code.product import Code
    >>> description(Program("none", (), 1.0, (), (), (), Code()), ["none.c"])[:38]
    b"<?xml version='1.0' encoding='utf-8'?>"
    """
    inputs = [(each, signal.meaning) for signal in program.inputs for each in signal.channels]
    outputs = [(each, signal.meaning) for signal in program.outputs for each in signal.channels]
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=program.name,
        guid=guid(program),
        description=printable(" ".join(program.about)),
        generationTool="flexstage",
        variableNamingConvention="flat",
        numberOfEventIndicators="0",
    )
    _co_simulation(root, program, sources)
    _units(root, [channel.unit for channel, _ in (*inputs, *outputs)])
    SubElement(SubElement(root, "LogCategories"), "Category", name="logStatusError", description="rejected calls")
    SubElement(root, "DefaultExperiment", startTime="0.0", stopTime="1.0", stepSize=repr(program.step))
    variables = SubElement(root, "ModelVariables")
    for number, (channel, meaning) in enumerate((*inputs, *outputs)):
        _variable(variables, number, channel, meaning, is_input=number < len(inputs))
    structure = SubElement(root, "ModelStructure")
    for kind in ("Outputs", "InitialUnknowns") if outputs else ():
        group = SubElement(structure, kind)
        for number in range(len(outputs)):
            SubElement(group, "Unknown", index=str(len(inputs) + number + 1))
    indent(root)
    return tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"


def _co_simulation(root: Element, program: Program, sources: Iterable[str]) -> None:
    element = SubElement(
        root,
        "CoSimulation",
        modelIdentifier=program.name,
        needsExecutionTool="false",
        canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs="false",
        maxOutputDerivativeOrder="0",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="false",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
    )
    files = SubElement(element, "SourceFiles")
    for name in sources:
        SubElement(files, "File", name=name)


def _units(root: Element, units: Iterable[str]) -> None:
    known = sorted({unit for unit in units if unit})
    if not known:
        return
    definitions = SubElement(root, "UnitDefinitions")
    for unit in known:
        powers = {_BASE[name.strip("[]")]: str(int(power)) for name, power in dimension_of(unit).powers}
        SubElement(SubElement(definitions, "Unit", name=unit), "BaseUnit", powers)


def _variable(parent: Element, number: int, channel: Channel, meaning: str, *, is_input: bool) -> None:
    causality = {"causality": "input"} if is_input else {"causality": "output", "initial": "calculated"}
    variable = SubElement(
        parent,
        "ScalarVariable",
        {"name": printable(channel.name), "valueReference": str(number), "description": meaning, "variability": "discrete", **causality},
    )
    unit = {"unit": channel.unit} if channel.unit else {}
    SubElement(variable, "Real", {**unit, **({"start": "0.0"} if is_input else {})})
