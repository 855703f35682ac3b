"""Report sections of a loop: overview, frequency domain, time domain, noise."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.base.number import Array
from flexstage.control.plant_models.electronics import Amplifier, Sensor
from flexstage.control.show.figures.diagram import Block as Box
from flexstage.control.show.figures.diagram import Diagram, loop_diagram
from flexstage.control.show.figures.frequency import (
    measured_figure,
    nyquist_figure,
    open_loop_figure,
    pole_figure,
    sensitivity_figure,
)
from flexstage.control.show.figures.hysteresis import hysteresis_figure
from flexstage.control.show.figures.noise import noise_share_figure, noise_spectrum_figure
from flexstage.control.show.figures.time import error_figure, lesson_figure, path_figure, step_figure
from flexstage.control.show.tables import (
    count_modes,
    error_tables,
    loop_tables,
    margin_tables,
    measured_tables,
    stability_text,
    time_tables,
)
from flexstage.control.study.choices import Compensation, ControllerKind
from flexstage.control.study.runs import Run
from flexstage.control.study.study import LoopStudy
from flexstage.control.tuning.objective import SENSITIVITY
from flexstage.show.display import format_value, number
from flexstage.show.figures.reading import Spot, reading
from flexstage.show.page import Block, Fact, Facts, Headline, Picture, Prose, Section, fold, picture, section
from flexstage.show.table import matrix_table

_NOISELESS = 1e-16


def loop_section(found: LoopStudy) -> Section | None:
    """Build the overview section: facts, block diagram, components."""
    caption = "Block diagram of the loop. The shaded blocks run on the computer, sample by sample."
    drawn = picture(loop_diagram(diagram_of(found)), "loop-diagram", "Block diagram of the loop", caption)
    return section("The loop", [Facts(tuple(_facts(found))), drawn, *loop_tables(found)])


def headline(found: LoopStudy) -> Headline:
    """Return the headline: stability, and the lowest phase margin."""
    if found.margins is None:
        return Headline("Open loop.")
    least = min(found.margins.channels, key=lambda each: each.phase.value)
    smallest = f"the smallest phase margin is {number(np.rad2deg(least.phase.value), 3)} deg, of loop {least.channel}"
    return Headline(f"The loop is {stability_text(found)}; {smallest}.", found.stability.stable)


def _facts(found: LoopStudy) -> Iterator[Fact]:
    yield Fact("stability", stability_text(found), f"slowest decay rate {number(-found.growth_all_modes, 3)} 1/s")
    if found.controller.tuning is not None:
        yield Fact("gain crossover", f"{number(found.controller.tuning.bandwidth, 3)} Hz", "slowest loop")
    if found.peaks is not None:
        yield Fact("peak sensitivity Ms", f"{number(20.0 * np.log10(found.peaks.sensitivity.value), 3)} dB", "6 dB or less is usual")
    slowest = max((test.figures.settling[test.index] for test in found.runs if test.figures is not None), default=None)
    if slowest is not None:
        shown = f"{number(1e3 * slowest, 3)} ms" if np.isfinite(slowest) else "not settled"
        yield Fact("settling time (2 %)", shown, "of the slowest step")
    for test in found.runs:
        if test.figures is None:
            value = format_value(test.tracking.values[test.index][2], test.tracking.unit[test.index][2], 3)
            yield Fact(f"{test.course.name}, {test.course.moved[0]}", value, "rms true error")


def diagram_of(found: LoopStudy) -> Diagram:
    """Return the content of the loop's block diagram, with values of the set-up."""
    setup, plant = found.setup, found.plant
    rate = f"{number(1e-3 * found.settled.rate, 4)} kHz"
    stage = Box("stage", f"{found.model_name.partition(',')[0]}\n{count_modes(len(plant.frequencies))}")
    back = (
        Box("gauges", f"{len(plant.gauges)}"),
        *_filters(found),
        Box("sampler", _sampler(found, rate)),
        Box("R_s^-1", "readings\nto pose", digital=True),
    )
    power = tuple(plant.hardware.amplifiers.values())
    analogue = (
        Box("hold", f"{rate}\nafter {number(1e6 * plant.hardware.delay, 4)} us"),
        Box("amplifier", _bandwidth_text(power) if found.charge is None else f"charge\n{_bandwidth_text(power)}"),
        Box("coils", "linear") if found.settled.kinematics.thrusts else Box("PZT", "linear" if setup.hysteresis is None else "hysteresis"),
    )
    onto = [("floor", "stage")] if found.settled.floor else []
    closed = setup.controller.law is not ControllerKind.NONE
    onto += [("noise", "gauges")] if closed and any(each.noise_density for each in plant.hardware.sensors.values()) else []
    onto += [("load", "gains")] if Compensation.LOAD in setup.compensate else []
    return Diagram(
        forward=(*_digital(found), *analogue, stage),
        back=back,
        onto=tuple(onto),
        fed_forward=Compensation.REFERENCE in setup.compensate and closed,
        closed=closed,
    )


def _digital(found: LoopStudy) -> Iterator[Box]:
    setup = found.setup
    if setup.controller.law is not ControllerKind.NONE:
        bandwidth = f"\n{number(found.controller.tuning.bandwidth, 3)} Hz" if found.controller.tuning is not None else ""
        notched = ", notches" if found.controller.notches else ""
        kind = setup.controller.law.value
        yield Box(
            "controller",
            f"{kind.upper() if len(kind) < 4 else kind}{notched}\n{setup.controller.coordinates.value}{bandwidth}",
            digital=True,
        )
    forced = bool(found.settled.kinematics.thrusts)
    yield Box("W^-1", "pose to\nforces", digital=True) if forced else Box("R_a", "pose to\nstrokes", digital=True)
    if Compensation.LOST_MOTION in setup.compensate or Compensation.LOAD in setup.compensate:
        yield Box("gains", "lost motion", digital=True)
    if Compensation.HYSTERESIS in setup.compensate:
        yield Box("inverse", "of hysteresis", digital=True)


def _filters(found: LoopStudy) -> Iterator[Box]:
    gauges = found.setup.gauges
    if gauges.filter_order and gauges.filter_corner is not None:
        yield Box("filter", f"order {gauges.filter_order}\n{number(gauges.filter_corner, 4)} Hz")


def _sampler(found: LoopStudy, rate: str) -> str:
    plant = found.plant
    step, unit = max((plant.hardware.sensors[each.name].resolution, each.unit) for each in plant.coordinates.readings())
    return f"{rate}\nsteps {format_value(step, unit, 3)}" if step else rate


def _bandwidth_text(items: tuple[Amplifier | Sensor, ...]) -> str:
    slowest = min((each.bandwidth for each in items), default=np.inf)
    return "ideal" if np.isinf(slowest) else f"{number(slowest, 4)} Hz"


def frequency_section(found: LoopStudy) -> Section | None:
    """Build the frequency section: open loops, sensitivities, margins, poles, crosstalk; `None` in open loop."""
    if found.curves is None:
        return None
    seen, plant = found.curves, found.plant
    modes = plant.frequencies[: 2 * len(plant.coordinates.names)]
    spots = tuple(margin_spots(found))
    opened = open_loop_figure(seen, modes, spots)
    peak = found.controller.tuning.spec.sensitivity if found.controller.tuning is not None else SENSITIVITY
    pair = sensitivity_figure(seen, peak)
    return section(
        "Frequency domain",
        [
            *margin_tables(found),
            picture(
                opened,
                "open-loops",
                "Open loops over frequency",
                "Bode plot of each loop, opened at the pose while the other loops are closed. Vertical dotted lines mark mode frequencies "
                "of the stage. Circles mark gain margins (at phase −180°), and phase and delay margins (at gain 1). Every second curve is "
                "dashed.",
                reading=reading(opened, spots),
            ),
            picture(
                nyquist_figure(seen, peak, margin_points(found)),
                "nyquist",
                "Nyquist plot of the open loops",
                "Nyquist plot of each open loop near −1. Dotted circle: gain 1. Dashed circle: limit of |S|. Small circles: margins.",
            ),
            picture(
                pair,
                "sensitivities",
                "Sensitivity and complementary sensitivity over frequency",
                "Sensitivity S (error per disturbance) and complementary sensitivity T = 1 − S. Dashed line: limit of |S|.",
                reading=reading(pair),
            ),
            picture(
                pole_figure(found.closed.system.poles, found.settled.step, found.closed.held.poles),
                "poles",
                "Poles of the closed loop",
                "Poles of the closed loop (with delay and hold) and of the stage in open loop. Dotted: damping ratios 0.1, 0.3 and 0.6.",
            ),
            fold("Static crosstalk", matrix_table("Static motion per reference", found.crosstalk)),
        ],
    )


def measured_section(found: LoopStudy) -> Section | None:
    """Build the section with loop results from measured responses, identified model and design model; `None` without a test."""
    if found.measured is None:
        return None
    seen = found.measured.sensitivities
    figure = measured_figure(seen, found.plant.coordinates.names)
    sure = "shaded: 95 % interval" if seen.low is not None else "the test has no data on the uncertainty of its responses"
    caption = f"Sensitivity of each coordinate to its own disturbance, with hold and delay; {sure}."
    drawn = picture(figure, "measured-loops", "Sensitivities from measured responses", caption, reading=reading(figure))
    return section("Loop with measured responses", [*measured_tables(found), drawn])


def margin_spots(found: LoopStudy) -> Iterator[Spot]:
    """Return the positions of the margins of all loops in the open-loop figure."""
    for each in () if found.margins is None else found.margins.channels:
        for edge in (each.gain_low, each.gain_high):
            if 0.0 < edge.value < np.inf and edge.frequency > 0.0:  # zero frequency is not drawn
                decibel = number(20.0 * np.log10(edge.value), 3)
                yield Spot(edge.frequency, f"{each.channel}: gain margin {decibel} dB at {number(edge.frequency)} Hz", 1.0 / edge.value)
        if np.isfinite(each.phase.value):
            turn = number(np.rad2deg(each.phase.value), 3)
            yield Spot(each.phase.frequency, f"{each.channel}: phase margin {turn}° at {number(each.phase.frequency)} Hz", 1.0)
        if np.isfinite(each.delay.value) and np.isfinite(each.delay.frequency):
            later = number(1e3 * each.delay.value, 3)
            yield Spot(each.delay.frequency, f"{each.channel}: delay margin {later} ms at {number(each.delay.frequency)} Hz", 1.0)


def margin_points(found: LoopStudy) -> Array:
    """Evaluate each open loop at its gain, phase and delay margins; return all m complex values (m,)."""
    if found.margins is None or found.curves is None:
        return np.zeros(0, complex)
    edges = [
        (edge.frequency, index)
        for index, each in enumerate(found.margins.channels)
        for edge in (each.gain_low, each.gain_high, each.phase, each.delay)
        if 0.0 < edge.frequency < np.inf
    ]
    places, loops = (np.array(each) for each in zip(*edges, strict=True)) if edges else (np.zeros(0), np.zeros(0, int))
    return 1.0 / found.curves.response.sweep(places)[np.arange(len(places)), loops, loops] - 1.0


def time_section(found: LoopStudy) -> Section | None:
    """Build the time section: steps and trajectories."""
    stepped = [(test.course.name, test.simulated) for test in found.runs if test.figures is not None]
    pictures = []
    if stepped:
        figure = step_figure(stepped)
        caption = "Dashed: the reference; blue: the true motion; grey: the other coordinates of the same unit."
        pictures.append(picture(figure, "steps", "Steps of every motion", caption, reading=reading(figure)))
    for number_, test in enumerate(test for test in found.runs if test.figures is None):
        pictures += _trajectory_pictures(test, f"trajectory{number_}")
    small = None if found.second_order is None else Prose(found.second_order.text)
    return section("Time domain", [small, *time_tables(found.runs), *pictures])


def _trajectory_pictures(test: Run, name: str) -> Iterator[Picture]:
    course = test.course
    if course.plane is not None:
        view = f"Plan view of the {course.name}"
        caption = f"{view}, to scale. The legend gives the magnification of the error."
        yield picture(path_figure(test.simulated, course.plane), f"{name}-path", view, caption)
    error = f"Error along the {course.name}"
    yield picture(error_figure(test.simulated), f"{name}-error", f"{error} over time", "Reference minus true pose over time.")
    if (taught := test.learned) is not None:
        figure = lesson_figure(taught.rms, taught.coordinates, taught.units, "number of learned passes", taught.noise)
        caption = f"Error up to {number(taught.band, 4)} Hz in each pass. Dotted: component that does not repeat from pass to pass."
        yield picture(figure, f"{name}-lessons", f"{error} by pass", caption)
    if (seen := test.repeated) is not None:
        figure = lesson_figure(seen.rms, seen.coordinates, seen.units, "number of previous periods")
        yield picture(figure, f"{name}-lessons", f"{error} by period", f"Error up to {number(seen.band, 4)} Hz in each period.")


def error_section(found: LoopStudy) -> Section | None:
    """Build the error section: static errors in open loop, noise in closed loop, hysteresis of the stacks."""
    blocks: list[Block | None] = [*error_tables(found), *_noise_pictures(found)]
    if (swept := found.hysteresis) is not None:
        worst = int(np.argmax(swept.rms_error))
        reached = {"without inverse": swept.bare[:, worst], "with inverse": swept.inverse[:, worst]}
        figure = hysteresis_figure(swept.wanted[:, worst], reached)
        caption = f"Isolated stack of {swept.actuators[worst]}, driven up and down in open loop."
        blocks.append(picture(figure, "hysteresis", "Hysteresis of a stack with and without the inverse model", caption))
    return section("Errors and noise", blocks)


def _noise_pictures(found: LoopStudy) -> Iterator[Picture]:
    budget = found.noise
    if not np.any(budget.rms > _NOISELESS):
        return
    caption = "Contribution of each source to the mean square of each coordinate in regulation, and the rms of the coordinate."
    yield picture(noise_share_figure(budget), "noise-shares", "Contributions to the noise by source", caption)
    caption = "Amplitude density of the true motion, and its cumulative rms from the lowest frequency."
    yield picture(noise_spectrum_figure(budget), "noise-spectrum", "Noise over frequency", caption)
