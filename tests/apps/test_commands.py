"""The command line as people use it: help, examples, exit codes, failures, streams."""

from __future__ import annotations

import inspect
import os
import shlex
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer
from netgen import occ
from threadpoolctl import threadpool_info, threadpool_limits

import flexstage as fs
from flexstage.apps import doctor
from flexstage.apps.cli import commands, run
from flexstage.apps.cli.commands import COMMANDS
from flexstage.apps.commands import analyses
from flexstage.apps.doctor import Row, Verdict
from flexstage.apps.installation import self_test
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import case
from flexstage.control.hysteresis.example import example_record
from flexstage.experiment.formats.write import write
from flexstage.mechanism.store import dump
from flexstage.show.command import answer
from flexstage.show.render import to_rich
from flexstage.show.table import Table
from tests.apps.command import Command, design_in
from tests.models.stage_records import stage_record
from tests.show.widths import broken

PROCESS = [sys.executable, "-c", "from flexstage.apps.cli import main; main()"]
NAMES = [each.name for each in COMMANDS]
LONG = ("verify", "solid", "calibrate", "identify", "compare", "loop", "buckle", "stroke", "superelement", "cad")
"""Commands whose examples take long on the shipped stage, and that have tests of their own on smaller ones: run in full only."""

EXAMPLES = [
    pytest.param(each.example, marks=pytest.mark.full if each.name in LONG else ())
    for each in COMMANDS
    if each.name not in ("doctor", "studio", "serve")
]

STUDY = """
format = "flexstage study 1"
case = "parallelogram"
responses.f = "frequency.1"
sweep = { sampling = "latin hypercube", designs = 16, seed = 3 }
optimise = { maximise = "f", starts = 1 }
tolerance = { copies = 16 }
scatter = { young = { address = "materials.young", normal = "1 %" } }
[variables]
young = { address = "materials.aluminium.young", from = "-10 %", to = "10 %" }
"""

SPECIFICATION = """
format = "flexstage specification 1"
name = "focus"
motion.x = "20 um"
payload = { mass = "0.2 kg", size = ["40 mm", "30 mm", "20 mm"] }
box = { size = ["160 mm", "100 mm", "40 mm"] }
actuators.like = "PiezoDrive SA050536"
starts = 1
requirements.frequency = "at least 300 Hz"
"""


@pytest.mark.parametrize("name", NAMES)
def test_help_of_each_command_has_an_example(flexstage: Command, name: str) -> None:
    ended = flexstage(name, "--help")
    assert ended.code == 0
    assert f"Example: flexstage {name}" in " ".join(ended.out.split())


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_run_and_their_tables_fit_a_terminal(
    flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, example: str
) -> None:
    words = shlex.split(example.partition(" > ")[0])
    if words[1] == "new":
        (tmp_path / "stage.toml").unlink()
    if words[1] == "import":
        occ.Box(occ.Pnt(0, 0, 0), occ.Pnt(10, 20, 30)).WriteStep(str(tmp_path / "part.step"))
    if "record.uff" in words and words[1] != "rig":
        write(tmp_path / "record.uff", stage_record(double_triangle()))
    if words[1] in {"sweep", "optimise", "tolerance"}:
        (tmp_path / "study.toml").write_text(STUDY)
    if words[1] == "design":
        (tmp_path / "spec.toml").write_text(SPECIFICATION)
    if words[1] == "hysteresis":
        write(tmp_path / "stack.csv", example_record())
    shown: list[Table] = []
    monkeypatch.setattr(answer, "to_rich", lambda table, width: [shown.append(table), *to_rich(table, width)][1:])
    ended = flexstage(*words[1:], *{"analyse": ["--full"], "design": ["--architecture", "guide"]}.get(words[1], []))
    assert ended.code == 0, ended.err
    assert [(width, table.title, *found[:5]) for width in (60, 80, 100, 120) for table in shown if (found := broken(table, width))] == []
    assert ended.out or "Wrote" in ended.err


def test_help_names_every_command_under_its_purpose(flexstage: Command) -> None:
    out = flexstage("--help").out
    assert all(f"\n  {each.name} " in out for each in COMMANDS)
    assert "..." not in out.replace("[ARGS]...", "")
    groups = [each.group for each in COMMANDS]
    assert all(out.count(f"\n{group}:\n") == 1 for group in groups)
    assert [out.index(f"\n{group}:\n") for group in groups] == sorted(out.index(f"\n{group}:\n") for group in groups)


@pytest.mark.parametrize("command", COMMANDS, ids=NAMES)
def test_the_line_of_each_command_is_that_of_its_docstring(command: commands.Command) -> None:
    docstring = inspect.getdoc(command.load())
    assert docstring is not None
    assert docstring.splitlines()[0] == command.help


def test_only_the_module_of_a_command_that_runs_is_imported() -> None:
    code = "import sys; from flexstage.apps.cli import run; run(sys.argv[1:]); print(*sys.modules)"
    homes = {each.home.partition(":")[0] for each in COMMANDS}
    for words, expected in ((["--help"], set()), (["version"], {"apps.commands.about"}), (["sweep", "--help"], {"studies.commands.sweep"})):
        done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=True)
        assert homes & set(done.stdout.splitlines()[-1].split()) == {f"flexstage.{name}" for name in expected}


def test_version_is_an_option_too(flexstage: Command) -> None:
    assert flexstage("--version").out == flexstage("version").out
    assert flexstage("--version").code == 0


def test_a_section_of_the_catalogue_without_entries_says_so(flexstage: Command) -> None:
    assert flexstage("catalogue", "coils").out.startswith("No shipped coils. A design file uses a catalogue of your own")


def test_unknown_commands_suggest(flexstage: Command) -> None:
    ended = flexstage("analse")
    assert ended.code == 2
    assert ended.err == "error: analse: unknown command. Use analyse.\n"


def test_groups_of_commands_are_lazy_too(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    app = typer.Typer(rich_markup_mode=None)
    app.command("slow")(lambda: typer.echo("slow it is"))
    app.command("fast")(lambda: typer.echo("fast it is"))
    group = commands.application((commands.Command("tune", "Control it", "Tune loops.", "tuning:app", ""),))
    with pytest.raises(ModuleNotFoundError, match="tuning"):
        group(["tune", "slow"], standalone_mode=False)
    monkeypatch.setitem(sys.modules, "tuning", SimpleNamespace(app=app))
    group(["tune", "slow"], standalone_mode=False)
    assert capsys.readouterr().out == "slow it is\n"
    with pytest.raises(Exception, match=r"No such command 'slo'. Did you mean 'slow'\?"):
        group(["tune", "slo"], standalone_mode=False)


def test_a_new_design_is_sound_and_commented(flexstage: Command, tmp_path: Path) -> None:
    assert flexstage("new", "other.toml", "--case", "hexapod").code == 0
    assert (tmp_path / "other.toml").read_text().startswith("#:schema ./flexstage.schema.json\n# hexapod: six axes")
    assert flexstage("check", "other.toml").code == 0
    assert flexstage("new", "other.toml", "--force").code == 0
    assert (tmp_path / "other.toml").read_text().startswith("#:schema ./flexstage.schema.json\n# double-triangle:")


def test_missed_requirements_change_the_exit_code_only_if_strict(flexstage: Command, tmp_path: Path) -> None:
    design = tmp_path / "stage.toml"
    design.write_text(design.read_text().replace('"at least 100 Hz"', '"at least 1000 Hz"'))
    ended = flexstage("analyse", "stage.toml")
    assert ended.code == 0
    assert ended.out.splitlines()[2].startswith("Requirements")
    assert "Verdict: 7 of 8 requirements are met. Not met: frequency.platform.1 (" in ended.out
    strict = flexstage("analyse", "stage.toml", "--strict", "--json", "-")
    assert strict.code == 1
    assert [line["key"] for line in strict.document["requirements"] if not line["passed"]] == ["frequency.platform.1"]
    assert "1 of 8 requirements" in strict.err


@pytest.mark.parametrize(
    "name",
    [
        "double-triangle",
        "xy-stage-floating",
        "mirror-mount",
        *(pytest.param(each, marks=pytest.mark.full) for each in ("double-triangle-a", "hexapod")),
    ],
)
def test_the_short_form_fits_a_screen_and_ends_with_the_verdict(flexstage: Command, tmp_path: Path, name: str) -> None:
    design_in(tmp_path, name)
    short, whole = (flexstage("analyse", "stage.toml", *full).out for full in ([], ["--full"]))
    assert len(short.splitlines()) <= 62
    verdict, look, more = short.splitlines()[-3:]
    assert verdict.startswith("Verdict: ")
    assert look.startswith("  Look at ")
    assert ("--full" in more, "--report" in more) == (True, True)
    assert whole.splitlines()[-2:] == [verdict, look]
    assert len(whole.splitlines()) > 2 * len(short.splitlines())


def test_a_stage_of_which_nothing_is_required_is_not_judged(flexstage: Command, tmp_path: Path) -> None:
    dump(replace(case("parallelogram"), requirements={}), tmp_path / "stage.toml")
    told = "Verdict: no requirements. Add a table [requirements] to the design file."
    assert told in flexstage("analyse", "stage.toml").out


def test_met_requirements_are_no_failure_if_strict(flexstage: Command) -> None:
    assert flexstage("analyse", "stage.toml", "--strict", "--json", "out.json").code == 0


def test_changes_are_shown_old_new_and_change(flexstage: Command) -> None:
    out = flexstage("analyse", "stage.toml", "--set", "horizontal/front.thickness=1.4mm").out
    heads = next(line for line in out.splitlines() if "old" in line)
    assert heads.index("old") < heads.index("new") < heads.index("change")
    (line,) = (line for line in out.splitlines() if line.strip().startswith("horizontal/front.thickness"))
    assert "1.54" in line
    assert "1.4" in line


def test_faults_of_the_program_are_told_without_traceback(flexstage: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise RuntimeError("a gear fell out")

    monkeypatch.setattr(analyses, "platform_modes", broken)
    monkeypatch.delenv("FLEXSTAGE_DEBUG", raising=False)
    ended = flexstage("modes", "stage.toml")
    assert ended.code == 70
    assert "a gear fell out" in ended.err
    assert "report" in ended.err
    assert "Traceback" not in ended.err
    monkeypatch.setenv("FLEXSTAGE_DEBUG", "1")
    with pytest.raises(RuntimeError, match="a gear fell out"):
        run(["modes", "stage.toml"])


def test_warnings_of_libraries_are_one_line_each(flexstage: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    found = analyses.platform_modes

    def loud(*arguments: object) -> object:
        warnings.warn("overflow somewhere", RuntimeWarning, stacklevel=1)
        return found(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(analyses, "platform_modes", loud)
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        ended = flexstage("modes", "stage.toml")
    assert "warning: overflow somewhere\n" in ended.err


def test_interruption_is_told(flexstage: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(analyses, "platform_modes", interrupted)
    ended = flexstage("modes", "stage.toml")
    assert ended.code == 130
    assert ended.err.startswith("Interrupted. Nothing was written.")


def test_leaving_runs_what_is_registered_for_the_end_and_keeps_the_code() -> None:
    work = "atexit.register(print, 'last', flush=False) and print('first', end=' ') or 3"
    words = f"import atexit; from flexstage.apps import cli; cli.run = lambda _: {work}; cli.main()"
    ended = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (3, "first last\n")


def test_the_entry_point_exits_with_the_code(tmp_path: Path) -> None:
    done = subprocess.run([*PROCESS, "modes", "nowhere.toml"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: nowhere.toml: file not found. Check the path")


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_reader_that_leaves_is_no_failure(tmp_path: Path, unbuffered: str) -> None:
    """Python's buffer decides whether the pipe breaks while the command runs or after it."""
    design_in(tmp_path)
    environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
    with subprocess.Popen([*PROCESS, "schema"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.read(1)
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 0


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_bad_input_is_bad_input_also_where_nobody_reads_it(tmp_path: Path, unbuffered: str) -> None:
    """`flexstage ... 2>&1 | head -1`: stderr breaks too, and the exit code still tells."""
    environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
    words, pipe = [*PROCESS, "check", "none.toml"], subprocess.PIPE
    with subprocess.Popen(words, cwd=tmp_path, stdout=pipe, stderr=pipe, env=environment) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        process.stderr.close()
        assert process.wait() == 2


def test_tables_fit_the_encoding_of_the_terminal(tmp_path: Path) -> None:
    design_in(tmp_path)
    environment = os.environ | {"PYTHONIOENCODING": "ascii"}
    done = subprocess.run([*PROCESS, "modes", "stage.toml"], cwd=tmp_path, capture_output=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    assert b"106.01" in done.stdout


def test_numpy_gets_one_thread_unless_told_otherwise(tmp_path: Path) -> None:
    code = "import os; from flexstage.apps.cli import run; run(['version']); print(os.environ['OPENBLAS_NUM_THREADS'])"
    free = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    for environment, expected in ((free, "1"), (free | {"OPENBLAS_NUM_THREADS": "2"}, "2")):
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True, env=environment)
        assert done.stdout.splitlines()[-1] == expected


def test_in_python_one_thread_serves_small_matrices_and_the_callers_are_restored(monkeypatch: pytest.MonkeyPatch) -> None:
    def counts() -> set[int]:
        return {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"}

    seen: list[set[int]] = []
    monkeypatch.setattr("flexstage.analysis.complete.judge", lambda *_: seen.append(counts()) or divmod(1, 0))
    with threadpool_limits(2):
        with pytest.raises(ZeroDivisionError):
            fs.analyse(double_triangle())
        assert (seen, counts()) == ([{1}], {2})


def test_the_doctor_runs_without_typer(tmp_path: Path) -> None:
    code = (
        "import sys; sys.modules['typer'] = None\n"
        "import flexstage.apps.installation as installation\n"
        "installation.consult = lambda: print('consulted') or 0\n"
        "from flexstage.apps.cli import run; print(run(['doctor'])); print(run(['modes']))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["consulted", "0", "70"]
    assert "flexstage doctor" in done.stderr


def test_the_doctor_prints_rows_and_tells_by_exit_code(flexstage: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [Row("numpy", "2.0", ">=2", Verdict.GOOD), Row("folder", "missing", "writable", Verdict.BAD, "make it")]
    monkeypatch.setattr(doctor, "examine", lambda *_: rows)
    sick = flexstage("doctor")
    assert sick.code == 2
    assert "1 problem found" in sick.out
    assert "make it" in sick.out
    rows.pop()
    sound = flexstage("doctor")
    assert sound.code == 0, sound.out
    assert "sound" in sound.out


def test_the_doctors_self_test_is_good_and_notices_wrong_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    assert self_test().verdict is Verdict.GOOD
    monkeypatch.setattr("flexstage.apps.installation.FREQUENCIES", (110.9, 110.9, 135.1, 145.5, 176.7, 176.7))
    assert self_test().verdict is Verdict.BAD
