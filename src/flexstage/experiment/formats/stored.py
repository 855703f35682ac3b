"""Frequency responses among the named arrays of a file, as analysers and scripts store them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.experiment.formats.variables import (
    FREQUENCIES,
    Contents,
    Held,
    Variable,
    complex_of,
    frequency_axis,
    plain_name,
    vector_length,
)
from flexstage.experiment.options import Options, assigned, numbered, wanted
from flexstage.experiment.record import Channel, Responses, Role, not_rising
from flexstage.experiment.unit import plain_unit

RESPONSES = re.compile(
    r"(.*_)?(h|h[0-9v]|h_?[0-9]+(_[0-9]+)?|hf|frfs?|tfs?|transfer|responses?|receptance|compliance|mobility|inertance)(_.*)?"
)
"""Names of arrays that hold frequency responses."""
OTHERS = re.compile(r".*(spec|psd|csd|cross|auto|corr|coh|gamma|g[xy][xy]).*")
"""Names of complex arrays that do not."""
COHERENCES = re.compile(r".*(coh|gamma).*")
AVERAGES = re.compile(r"averages|n_?avg|num_averages|n_averages")
_HALVES = re.compile(r"(?P<stem>.*?)_?(?P<half>re|im|real|imag|imaginary)$")


def responses_of(contents: Contents, options: Options) -> Responses | None:
    """The frequency responses of a file's arrays; None if it has none. Raises `DesignError` with what keeps them from being read.

    The axis as long as the vector of frequencies is that of frequency; of the others the first is that of outputs, the second that of
    inputs. Several arrays of one axis are outputs to one input.

    >>> lines, values = np.array([0.0, 0.5, 1.0]), np.array([[1.0, 1j, -1.0]])
    >>> found = responses_of(Contents("a.mat", (Held("f", lines), Held("H", values))), Options())
    >>> found.at("H", "input").tolist()
    [(1+0j), 1j, (-1+0j)]
    """
    lines = frequency_axis(contents)
    if lines is None:
        require(_unordered(contents))
        return None
    size = vector_length(lines)
    found = _functions([each for each in (*contents.variables, *_joined(contents.variables)) if each.is_complex and size in each.shape])
    if not found:
        return None
    cubes = [_cube(each, size) for each in found]
    if len({cube.shape[2] for cube in cubes}) > 1:
        shapes = ", ".join(f"{each.name} {each.shape}" for each in found)
        raise refuse(contents.where, f"its responses are to different numbers of inputs: {shapes}", "Name those that are meant (only)")
    values = np.concatenate(cubes, axis=1)
    outputs, inputs = _outputs(contents, found, cubes, options), _inputs(contents, values.shape[2], options)
    require(_not_finite(contents.where, values, outputs))
    return _chosen(
        Responses(
            lines.whole().ravel().astype(float),
            outputs,
            inputs,
            values,
            _coherence(contents, found, values),
            window=" ".join(contents.text("window")),
            averages=_averages(contents),
            name=" ".join(contents.text("name", "title")),
            source=contents.where,
        ),
        options,
    )


def _unordered(contents: Contents) -> Iterable[Finding]:
    """Frequencies that do not rise, beside complex arrays as long."""
    lengths = {size for each in (*contents.variables, *_joined(contents.variables)) if each.is_complex for size in each.shape}
    for each in contents.variables:
        if FREQUENCIES.fullmatch(plain_name(each.name)) and not each.is_complex and vector_length(each) in lengths - {0, 1}:
            problem = not_rising(each.whole().ravel())
            if problem is not None:
                yield Finding(f"{contents.where}: {each.name}", problem, "Export each frequency once, from the lowest to the highest")


def _functions(arrays: list[Variable]) -> list[Variable]:
    """Those that are called responses; else the only one that is not called something else."""
    plain = [each for each in arrays if not OTHERS.fullmatch(plain_name(each.name))]
    called = [each for each in plain if RESPONSES.fullmatch(plain_name(each.name))]
    return called or (plain if len(plain) == 1 else [])


def _joined(variables: Iterable[Variable]) -> list[Held]:
    """Complex arrays of real and imaginary parts that are stored apart: `H_re`, `H_im`."""
    halves: dict[str, dict[str, Variable]] = {}
    for each in variables:
        found = _HALVES.fullmatch(each.name.lower())
        if found and not each.is_complex:
            halves.setdefault(found["stem"], {})[found["half"][:2]] = each
    pairs = [(both["re"], both["im"]) for both in halves.values() if both.keys() == {"re", "im"} and both["re"].shape == both["im"].shape]
    stems = (re.sub(r"_?(re|real)$", "", real.name, flags=re.IGNORECASE) for real, _ in pairs)
    return [
        Held(name, complex_of(real.whole(), imaginary.whole()), real.attributes)
        for name, (real, imaginary) in zip(stems, pairs, strict=True)
    ]


def _cube(variable: Variable, size: int) -> Array:
    """The array as (frequencies, outputs, inputs)."""
    values = np.moveaxis(variable.whole(), variable.shape.index(size), 0)
    rest = values.shape[1:] if values.ndim <= 3 else tuple(length for length in values.shape[1:] if length > 1)
    if len(rest) > 2:
        raise refuse(variable.name, f"it has shape {variable.shape}", "Store frequencies, outputs and inputs")
    return values.reshape(size, *rest, *[1] * (2 - len(rest)))


def _outputs(contents: Contents, found: list[Variable], cubes: list[Array], options: Options) -> tuple[Channel, ...]:
    widths = [cube.shape[1] for cube in cubes]
    total = sum(widths)
    names = _listed(contents, ("output_names", "outputs", "responses_names", "y_names"), total)
    names = names or _given(options.outputs, total)
    plain = [plain_name(each.name) and re.split(r"[/.]", each.name)[-1] for each in found]
    pairs = zip(plain, widths, strict=True)
    names = names or [name if width == 1 else f"y{number + 1}" for name, width in pairs for number in range(width)]
    units = _listed(contents, ("output_units", "y_units"), total) or ("",) * total
    return tuple(Channel(name, plain_unit(unit), Role.OUTPUT) for name, unit in zip(numbered(names), units, strict=True))


def _inputs(contents: Contents, total: int, options: Options) -> tuple[Channel, ...]:
    names = _listed(contents, ("input_names", "inputs", "references", "u_names"), total)
    names = names or _given(options.inputs, total)
    names = names or (["input"] if total == 1 else [f"u{number + 1}" for number in range(total)])
    units = _listed(contents, ("input_units", "u_units"), total) or ("",) * total
    return tuple(Channel(name, plain_unit(unit), Role.INPUT) for name, unit in zip(numbered(names), units, strict=True))


def _given(patterns: tuple[str, ...], total: int) -> tuple[str, ...]:
    """Names the user gives to channels without any; patterns name none."""
    return patterns if len(patterns) == total and not any(sign in pattern for pattern in patterns for sign in "*?[") else ()


def _listed(contents: Contents, names: tuple[str, ...], total: int) -> tuple[str, ...]:
    found = contents.text(*names)
    return found if len(found) == total else ()


def _coherence(contents: Contents, found: list[Variable], values: Array) -> Array | None:
    """The coherence that is stored with the responses, if it is as large as they are."""
    size = values.shape[0]
    stored = [
        each for each in contents.variables if COHERENCES.fullmatch(plain_name(each.name)) and not each.is_complex and size in each.shape
    ]
    if len(stored) != len(found):
        return None
    whole = np.concatenate([_cube(each, size) for each in stored], axis=1).astype(float)
    return whole if whole.shape == values.shape else None


def _averages(contents: Contents) -> int | None:
    number = contents.number(AVERAGES)
    return None if number is None or not number >= 1.0 else int(number)


def _not_finite(where: str, values: Array, outputs: tuple[Channel, ...]) -> Iterable[Finding]:
    for column, output in enumerate(outputs):
        broken = int(np.count_nonzero(~np.isfinite(values[:, column])))
        if broken:
            yield Finding(
                f"{where}: {output.name}", f"{broken} of {values[:, column].size} responses are not numbers", "Store the responses anew"
            )


def _chosen(responses: Responses, options: Options) -> Responses:
    """The responses with units as the user says; only the channels that count."""
    plain = replace(options, inputs=(), outputs=(), only=(), units=options.units)
    whole = assigned((*responses.outputs, *responses.inputs), plain, responses.source)
    outputs, inputs = whole[: len(responses.outputs)], whole[len(responses.outputs) :]
    rows = [row for row, channel in enumerate(outputs) if wanted([channel.name], _only(options, options.outputs))]
    columns = [column for column, channel in enumerate(inputs) if wanted([channel.name], _only(options, options.inputs))]
    missing = {"outputs": (rows, outputs, options.outputs), "inputs": (columns, inputs, options.inputs)}
    require(
        Finding(
            f"{responses.source}: {kind}",
            f"none of {', '.join(channel.name for channel in there)} is called {', '.join(asked)}",
            "Check the names",
        )
        for kind, (left, there, asked) in missing.items()
        if not left
    )
    coherence = None if responses.coherence is None else responses.coherence[:, rows][:, :, columns]
    values = responses.values[:, rows][:, :, columns]
    picked = tuple(outputs[row] for row in rows), tuple(inputs[column] for column in columns)
    return replace(responses, outputs=picked[0], inputs=picked[1], values=values, coherence=coherence)


def _only(options: Options, patterns: tuple[str, ...]) -> Options:
    return replace(options, only=patterns)
