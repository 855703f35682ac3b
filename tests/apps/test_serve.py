"""The virtual controller, spoken to over a socket as the manuals E727T0005 and MS249E say; what it records against the simulation."""

from __future__ import annotations

import asyncio
import random
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import flexstage
from flexstage.analysis.workspace.load import dead_loads
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.serve.controller import StageController
from flexstage.control.serve.errors import Code, CommandError
from flexstage.control.serve.gcs import COMMANDS, LONGEST, Session, spelled
from flexstage.control.serve.server import CLIENTS, HOST, ServedStage
from flexstage.control.serve.waves import segment
from flexstage.control.simulation.noise import noise_series
from flexstage.control.simulation.run import simulate
from flexstage.control.simulation.running import RunningLoop
from flexstage.control.study.choices import Compensation, ControllerKind
from flexstage.control.study.resolve import resolve
from flexstage.control.study.setup import ControllerSetup, LoopSetup
from flexstage.experiment.formats.gcs import read_gcs
from flexstage.experiment.records.options import Options
from flexstage.mechanism.store import dump
from flexstage.models.ideal import ideal
from flexstage.models.linear.static import displacement, static_gain
from flexstage.models.lumped import lumped
from flexstage.spatial.frame import COMPONENTS
from tests.elsewhere.loops import PLATFORM, full_loop, way

SETUP = LoopSetup(controller=ControllerSetup(kind=ControllerKind.PI, integral=300.0))


@pytest.fixture(scope="module")
def stage() -> StageController:
    return StageController(parallelogram(), SETUP)


@pytest.fixture(scope="module")
def port(stage) -> Iterator[int]:
    """A server in a thread of its own, as fast as it goes."""
    loop, served = asyncio.new_event_loop(), ServedStage(stage, 0, paced=False)
    thread = threading.Thread(target=loop.run_forever)
    thread.start()
    asyncio.run_coroutine_threadsafe(served.start(), loop).result()
    yield served.port
    asyncio.run_coroutine_threadsafe(served.stop(), loop).result()
    loop.call_soon_threadsafe(loop.stop)
    thread.join()
    loop.close()


class Client:
    """A laboratory's program: lines out, answers in. An answer goes on while a line ends with a blank (MS249E p. 116)."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection((HOST, port), timeout=60.0)
        self.file = self.socket.makefile("rb")

    def __enter__(self):
        return self

    def __exit__(self, *_: object) -> None:
        self.file.close()
        self.socket.close()

    def say(self, line: str) -> None:
        self.socket.sendall(line.encode("latin-1") + b"\n")

    def ask(self, line: str) -> str:
        if len(line) == 1:
            self.socket.sendall(line.encode("latin-1"))
        else:
            self.say(line)
        found = [self.file.readline()]
        while found[-1].endswith(b" \n"):
            found.append(self.file.readline())
        return b"".join(found).decode("latin-1")

    def values(self, line: str) -> dict[str, float]:
        pairs = (each.split("=") for each in self.ask(line).split("\n") if each)
        return {name: float(value) for name, value in pairs}

    def error(self) -> int:
        return int(self.ask("ERR?"))

    def wait(self, axis: str) -> None:
        while self.ask(f"ONT? {axis}") != f"{axis}=1\n":
            pass

    def array(self, line: str) -> tuple[dict[str, str], np.ndarray]:
        """A GCS array: header by name, and rows."""
        head, _, rows = self.ask(line).partition("# END_HEADER \n")
        named = (each[2:].split(" = ", 1) for each in head.replace(" \n", "\n").splitlines() if " = " in each)
        return dict(named), np.array([[float(value) for value in row.split()] for row in rows.splitlines()])


@pytest.fixture
def client(port) -> Iterator[Client]:
    with Client(port) as found:
        found.say("SVO x 1")
        found.say("WGO 1 0")
        assert found.error() in {0, int(Code.LOOP_UNSTABLE)}
        yield found


# --- the loop itself ---


def test_load_strokes_are_part_of_the_voltages():
    """The strokes that undo the sag under the permanent load, by statics; of 0.2 um/V, from the bias on, and as much of their range."""
    stage = double_triangle()
    model, poses = lumped(stage), tuple(f"platform.{name}" for name in COMPONENTS)
    sag = displacement(model, sum(dead_loads(stage, model).values())[:, None])
    strokes = np.linalg.solve(static_gain(model, poses, ideal(stage).actuators).values, -model.seen(model.output_index(poses), sag)[:, 0])
    plain, carrying = (
        StageController(stage, LoopSetup(controller=ControllerSetup(integral=5.0), compensate=each)) for each in ((), (Compensation.LOAD,))
    )
    assert np.all(strokes[3:] > 1e-6)
    assert (carrying.volts - plain.volts)[3:] == pytest.approx(strokes[3:] / 0.2e-6, rel=1e-4)
    ranges = [each.running.machine.amplifiers.high[3:] for each in (plain, carrying)]
    assert ranges[0] - ranges[1] == pytest.approx(strokes[3:], rel=1e-4)


def test_a_loop_that_goes_on_is_the_simulation():
    given = full_loop(inverse=True, motions=PLATFORM)
    reference, noise = way(given, 300)
    expected, running = simulate(given, reference, noise), RunningLoop(given, noise)
    held = np.ones(6, dtype=bool)
    found = [running.advance(reference[start:stop], held) for start, stop in ((0, 1), (1, 150), (150, 300))]
    for field, known in (("pose", expected.pose), ("given", expected.given), ("readings", expected.readings)):
        ours = np.vstack([getattr(each, field) for each in found])
        assert np.max(np.abs(ours - known)) < 1e-11 * np.max(np.abs(known)), field


def test_noise_runs_back_at_its_end():
    given = full_loop(motions=PLATFORM)
    series = {f"noise.{given.gauges[0]}": np.arange(5.0)}
    running = RunningLoop(given, series)
    found = running.advance(np.zeros((13, len(given.names)))).readings[:, 0]  # metres, beyond the range: the loop does not answer them
    assert np.rint(found).tolist() == [0, 1, 2, 3, 4, 3, 2, 1, 0, 1, 2, 3, 4]


def test_a_servo_goes_on_without_a_bump():
    one = StageController(parallelogram(), SETUP)
    session = Session(one)
    session.hear(b"SVO x 1")
    session.hear(b"MOV x 5")
    one.advance(3000)
    before = one.volts.copy()
    session.hear(b"SVO x 0")
    one.advance(500)
    session.hear(b"SVO x 1")
    one.advance(1)
    assert np.allclose(one.volts, before, atol=1e-3 * abs(before).max())
    assert one.position[0] == pytest.approx(5.0, abs=0.05)


# --- what it says ---


def test_it_says_what_it_is(client, stage):
    assert client.ask("*IDN?").startswith(f"flexstage,virtual controller,parallelogram,{flexstage.__version__}")
    assert client.ask("*idn?") == client.ask("*IDN?")
    assert client.ask("CSV?") == "2.0\n"
    assert client.ask("SAI?") == "x\n"
    assert client.ask("SAI? ALL") == "x\n"
    assert client.ask("PUN? x") == "x=um\n"
    assert float(client.ask("SPA? 1 0x0E000200").removeprefix("1 0x0E000200=")) == stage.step
    assert client.ask("\x07") == "\xb1\n"
    assert client.error() == 0


def test_every_query_answers_and_every_command_is_told(client):
    told = client.ask("HLP?")
    for name in COMMANDS:
        assert f"{spelled(name)} " in told
    plain = [name for name in COMMANDS if name.endswith("?") and name not in {"SPA?", "GWD?", "VOL?", "DRR?"}]
    assert all(client.ask(name) for name in plain)


def test_it_moves_to_its_target_and_says_so(client):
    client.say("MOV x 3.5")
    assert client.ask("MOV? x") == "x=3.500000\n"
    client.wait("x")
    assert client.values("POS? x")["x"] == pytest.approx(3.5, abs=0.05)
    client.say("MVR x -1.5")
    client.wait("x")
    assert client.values("POS?")["x"] == pytest.approx(2.0, abs=0.05)
    assert client.ask("\x05") == "0\n"
    assert client.error() == 0


def test_velocity_limits_the_way(client, stage):
    client.say("MOV x 0")
    client.wait("x")
    before = client.values("VEL? x")["x"]
    client.say("DRC 1 x 1 2 x 2")
    client.say("DRT 0 1 0")
    client.say("VEL x 40")
    client.say("MOV x 4")
    client.wait("x")
    client.say(f"VEL x {before}")
    count = int(client.values("DRL? 1")["1"])
    head, rows = client.array(f"DRR? 1 {count} 1 2")
    step = float(head["SAMPLE_TIME"])
    speed = np.diff(rows[:, 0]) / step
    assert np.max(speed) == pytest.approx(40.0, rel=1e-3)
    assert (head["DIM"], head["NDATA"], head["NAME0"]) == ("2", str(count), "target position of axis x")
    moving = np.count_nonzero(speed > 1.0)
    assert moving * step == pytest.approx(0.1, rel=0.02)
    assert client.error() == 0


def test_a_wave_is_what_the_loop_simulates(tmp_path):
    """Points in, the recorder's positions out: those of `simulate` for the same reference, from rest, to the digits that are told."""
    one = StageController(parallelogram(), SETUP)
    session, begun = Session(one), one.running.count
    wanted = np.round(2.0 * np.sin(np.linspace(0.0, 4.0 * np.pi, 400)) ** 2, 6)
    points = " ".join(f"{each:.6f}" for each in wanted)
    for line in ("SVO x 1", f"WAV 1 X PNT 1 400 {points}", "WSL 1 1", "WGC 1 1", "DRC 1 x 2 2 x 1 3 x 3", "WGO 1 1"):
        session.hear(line.encode())
    for count in (1, 150, 249, 7):
        one.advance(count)
    told = session.hear(b"DRR? 1 400 1 2 3")
    (tmp_path / "record.dat").write_bytes(told)
    (record,) = read_gcs(tmp_path / "record.dat", Options())
    rows = np.array([row.split() for row in told.decode().partition("END_HEADER \n")[2].splitlines()], dtype=float)
    assert np.array_equal(record.values, rows)
    assert record.rate == pytest.approx(1.0 / one.step)
    given = resolve(parallelogram(), SETUP)
    noise = {name: values[begun : begun + 400] for name, values in noise_series(given.plant, given.floor, 65_536).items()}
    expected = simulate(one.running.machine, wanted[:, None] * 1e-6, noise).pose[:, 0] * 1e6
    assert np.max(np.abs(rows[:, 0] - expected)) < 1e-6
    assert np.max(expected) > 1.0
    assert np.array_equal(rows[:, 1], wanted)
    assert np.allclose(rows[:, 2], rows[:, 1] - rows[:, 0], atol=2e-6)


def test_cycles_offset_and_rate_of_the_wave_generator(client):
    client.say("MOV x 0")
    client.wait("x")
    for line in ("WAV 2 X LIN 4 3 0 4 0 0", "WSL 1 2", "WGC 1 2", "WTR 1 2 1", "WOS 1 0.5", "DRC 1 x 1 2 x 0"):
        client.say(line)
    assert client.ask("WAV? 2 1") == "2 1=4\n"
    assert client.array("GWD? 1 4 2")[1][:, 0].tolist() == [0.0, 1.0, 2.0, 3.0]
    client.say("WGO 1 1")
    while client.values("DRL? 1")["1"] < 20:
        pass
    _, rows = client.array("DRR? 1 20 1")
    cycle = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 1.5]
    assert rows[:, 0].tolist() == [each + 0.5 for each in [*cycle, *cycle, 1.5, 1.5, 1.5, 1.5]]
    for line in ("WTR 0 1 0", "WOS 1 0"):
        client.say(line)
    assert client.error() == 0


def test_a_step_is_recorded(client):
    client.say("MOV x 0")
    client.wait("x")
    client.say("DRC 1 x 2 2 x 1")
    client.say("STE x 1")
    while client.values("DRL? 1")["1"] < 500:
        pass
    _, rows = client.array("DRR? 1 500 1 2")
    assert np.all(rows[:, 1] == 1.0)
    assert rows[0, 0] < 0.1
    assert 0.9 < rows[-1, 0] < 1.1


def test_stopping_leaves_it_where_it_is(client):
    client.say("VEL x 1")
    client.say("MOV x 5")
    assert client.ask("\x05") == "1\n"
    client.socket.sendall(b"\x18")
    assert client.error() == Code.STOPPED
    assert client.values("MOV? x")["x"] < 5.0
    assert client.ask("\x05") == "0\n"
    client.say("VEL x 500")


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("FOO", Code.UNKNOWN_COMMAND),
        ("MOV", Code.NUMBER_OF_PARAMETERS),
        ("MOV x", Code.NUMBER_OF_PARAMETERS),
        ("MOV q 1", Code.INVALID_AXIS),
        ("MOV x one", Code.INVALID_NUMBER),
        ("MOV x nan", Code.INVALID_NUMBER),
        ("MOV x 1e999", Code.INVALID_NUMBER),
        ("MOV x 1 x 2", Code.DOUBLE_AXIS),
        ("MOV x 1e6", Code.POSITION_OUT_OF_LIMITS),
        ("SVO x 2", Code.PARAMETER_OUT_OF_RANGE),
        ("VEL x 0", Code.VELOCITY_OUT_OF_LIMITS),
        ("SPA? 1 0x1", Code.UNKNOWN_PARAMETER),
        ("SPA? 1 x", Code.INVALID_NUMBER),
        ("STE x", Code.NUMBER_OF_PARAMETERS),
        ("WGO 1 1", Code.NO_WAVE_SELECTED),
        ("WAV 9 X SIN_P 1e12 1 0 1 0 0", Code.PARAMETER_OUT_OF_RANGE),
        ("WAV 9 X SIN_P 100 1 0 200 0 50", Code.PARAMETER_OUT_OF_RANGE),
        ("WAV 9 X TAN 1 2 3", Code.WAVE_TYPE),
        ("WAV 9 Y LIN 1 2 3", Code.PARAMETER_SYNTAX),
        ("WAV 9 X LIN 1 2 3", Code.NUMBER_OF_PARAMETERS),
        ("WAV 9 X PNT 1 3 1 2", Code.NUMBER_OF_PARAMETERS),
        ("WSL 7 1", Code.PARAMETER_OUT_OF_RANGE),
        ("DRC 9 x 1", Code.INVALID_RECORDER_TABLE),
        ("DRC 1 q 1", Code.INVALID_RECORDER_SOURCE),
        ("DRC 1 x 77", Code.INVALID_RECORDER_OPTION),
        ("DRR? 1 1000000 1", Code.NOT_ENOUGH_RECORDED),
        ("DRR? 1", Code.NUMBER_OF_PARAMETERS),
        ("GWD? 1 5 31", Code.NO_WAVE_SELECTED),
        ("*IDN? now", Code.NUMBER_OF_PARAMETERS),
    ],
)
def test_what_is_wrong_has_its_code(stage, line, code):
    session = Session(stage)
    session.hear(b"SVO x 1")
    session.hear(b"WSL 1 0")
    state = (stage.target.copy(), [vars(each).copy() for each in stage.generators], dict(stage.tables))
    assert session.hear(line.encode()) == b""
    assert session.hear(b"ERR?") == f"{code}\n".encode()
    assert session.hear(b"ERR?") == b"0\n"
    assert np.array_equal(state[0], stage.target)
    assert state[1:] == ([vars(each) for each in stage.generators], dict(stage.tables))


def test_a_servo_that_is_off_takes_no_target(stage):
    session = Session(stage)
    session.hear(b"SVO x 0")
    session.hear(b"MOV x 1")
    assert session.error is Code.SERVO_OFF


def test_a_lost_loop_is_told_and_goes_on_from_rest():
    one = StageController(parallelogram(), SETUP)
    session = Session(one)
    session.hear(b"SVO x 1")
    one.running._row[:] = np.inf
    one.advance(5)
    assert session.hear(b"POS? x") == b"x=0.000000\n"
    assert session.hear(b"ERR?") == f"{Code.LOOP_UNSTABLE}\n".encode()
    assert session.hear(b"SVO? x") == b"x=0\n"


# --- what nobody should send ---


def test_nonsense_is_answered_by_codes_and_the_server_stays(port):
    noise = random.Random(3)  # noqa: S311 nothing to be kept secret
    with Client(port) as bad:
        for _ in range(50):
            bad.socket.sendall(bytes(noise.randrange(256) for _ in range(500)))
        bad.socket.sendall(b"\n")
        bad.say("ERR?")
        while (answer := bad.file.readline()).strip() not in {str(int(each)).encode() for each in Code}:
            assert answer
    with Client(port) as good:
        assert good.ask("CSV?") == "2.0\n"


def test_a_line_that_never_ends_is_dropped(port):
    with Client(port) as bad:
        for _ in range(40):
            bad.socket.sendall(b"M" * LONGEST)
        bad.socket.sendall(b"OV x 1\n")
        assert bad.error() == Code.COMMAND_TOO_LONG
        assert bad.ask("CSV?") == "2.0\n"


def test_clients_that_vanish_leave_the_others_alone(port):
    with Client(port) as good:
        good.say("SVO x 1")
        for _ in range(2 * CLIENTS):
            bad = Client(port)
            with suppress(OSError):
                bad.socket.sendall(b"HLP?\nMOV x")
                bad.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\0\0\0\0\0\0\0")
            bad.file.close()
            bad.socket.close()
        assert good.ask("SVO? x") == "x=1\n"
        assert good.error() == 0


def test_clients_have_an_error_each_and_share_the_stage(port):
    with Client(port) as one, Client(port) as other:
        one.say("SVO x 1")
        one.say("NON SENSE")
        one.say("VEL x 123")
        assert one.ask("VEL? x") == "x=123.000000\n"
        assert other.ask("VEL? x") == "x=123.000000\n"
        assert other.error() == 0
        assert one.error() == Code.UNKNOWN_COMMAND
        one.say("VEL x 500")
        assert one.ask("VEL? x") == "x=500.000000\n"


@pytest.mark.parametrize(
    "request_line", ["POST / HTTP/1.1", "GET / HTTP/1.0", "PRI * HTTP/2.0", "get / http/1.0 ", f"PUT /{9000 * 'a'} HTTP/1.0"]
)
def test_a_page_of_a_browser_is_shown_the_door(port, request_line):
    with Client(port) as page:
        page.socket.sendall(f"{request_line}\r\nHost: x\r\n\r\nMOV x 1\n".encode())
        with suppress(ConnectionResetError):
            assert page.file.read() == b""


@pytest.mark.parametrize("count", [2_000, pytest.param(1_000_000, marks=pytest.mark.full)])
def test_many_commands(port, count):
    with Client(port) as client:
        client.socket.settimeout(None)
        client.say("SVO x 1")
        sender = threading.Thread(target=lambda: client.socket.sendall(b"MOV x 1\nPOS? x\n" * (count // 2)))
        sender.start()
        for _ in range(count // 2):
            assert client.file.readline().startswith(b"x=")
        sender.join()
        assert client.error() == 0


# --- curves ---


def test_the_manuals_waves():
    """E727T0005 p. 108: a sine of 2000 points from 10 to 30 and back, a line from 50 down to 10 with edges of 650 points."""
    sine = segment("SIN_P", [2000, 20, 10, 2000, 0, 1000])
    assert (sine[0], sine[1000], sine[500]) == (10.0, 30.0, pytest.approx(20.0))
    assert np.allclose(sine[1:], sine[:0:-1])
    line = segment("LIN", [3000, -40, 50, 3000, 0, 650])
    assert (len(line), line[0], line[-1]) == (3000, 50.0, pytest.approx(10.0))
    speed = np.diff(line)
    assert np.allclose(speed[700:2300], -40.0 / (2999 - 650))
    assert np.all(np.diff(speed[:640]) < 0.0)


def test_ramps_and_starts():
    ramp = segment("RAMP", [120, 10, 1, 100, 10, 5, 50])
    assert np.all(ramp[:11] == 1.0)
    assert ramp[60] == 11.0
    assert np.all(ramp[110:] == 1.0)
    assert np.allclose(ramp[60:110], ramp[60:10:-1])
    assert segment("PNT", [1, 2, 0.5, 0.25]).tolist() == [0.5, 0.25]
    with pytest.raises(CommandError):
        segment("PNT", [1, 1])


# --- the command ---


def test_the_command_serves_until_it_is_interrupted(tmp_path):
    dump(parallelogram(), tmp_path / "stage.toml")
    (tmp_path / "loop.toml").write_text('format = "flexstage loop 1"\ncontroller = { kind = "pi", integral = "300 1/s" }\n')
    program = [sys.executable, "-m", "flexstage", "serve", "stage.toml", "--setup", "loop.toml", "--port", "0"]
    with subprocess.Popen(program, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as running:
        try:
            first = running.stderr.readline()
            assert "axes x" in first
            with Client(int(first.split(f"{HOST}:")[1].split(":")[0])) as client:
                assert client.ask("*IDN?").startswith("flexstage")
                client.say("SVO x 1")
                client.say("MOV x 1")
                client.wait("x")
                assert client.error() == 0
                running.send_signal(signal.SIGINT)
                last = running.stderr.read()
        finally:
            running.kill()
    assert running.returncode == 0
    assert "ms behind real time" in last
    assert "Traceback" not in last


def test_a_port_that_is_taken_is_a_finding(port, stage):
    with pytest.raises(DesignError, match=f"--port {port}"):
        asyncio.run(ServedStage(stage, port).start())


def test_the_documentation_lists_every_command():
    page = (Path(__file__).parents[2] / "docs" / "serve.md").read_text(encoding="utf-8")
    listed = {cells[1].strip(" `"): cells[3].strip() for line in page.splitlines() if len(cells := line.split("|")) == 5}
    assert {*map(spelled, COMMANDS)} <= {*listed}
