"""tools/measure/misra_report.py: what records cover, what they do not, and records that nothing needs; the gate with an
addon that breaks down."""
import os
import shutil
import subprocess
import sys
import tempfile

import pytest
from conftest import ROOT, assert_one_line_error, run_tool

SOURCE = "int a = b << 1;\nint c = d >> 2;\nif (a) {\n"
SHIFTS = '- rule: "10.1"\n  class: required\n  reason: >\n    numbers in\n    fixed point\n'


@pytest.fixture(name="report")
def fixture_report(tmp_path, monkeypatch):
    def report(records, *violations):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "shifts.c").write_text(SOURCE, encoding="utf-8")
        (tmp_path / "records.yaml").write_text(records, encoding="utf-8")
        lines = [f"shifts.c:{line}:{column}: misra-c2012-{rule}\n" for line, column, rule in violations]
        (tmp_path / "violations").write_text("".join(lines) + "shifts.c:1:1: unusedVariable\n", encoding="utf-8")
        return run_tool("measure.misra_report", "records.yaml", "violations")

    return report


def test_record_covers_its_rule_everywhere(report):
    result = report(SHIFTS, (1, 11, "10.1"), (2, 11, "10.1"), (2, 11, "10.1"))
    assert result.stderr == ""
    assert result.stdout.splitlines()[0] == "2 violations of 1 rules"
    assert result.stdout.splitlines()[-1].split(None, 3) == ["10.1", "required", "2",
                                                             "everywhere  numbers in fixed point"]


def test_violation_without_a_record(report):
    result = report(SHIFTS, (1, 11, "10.1"), (3, 4, "14.4"))
    assert result.stderr == "shifts.c:3: error: MISRA C:2012 rule 14.4, and no reason is recorded: if (a) {\n"


def test_record_covers_only_its_file_and_code(report):
    right = SHIFTS + '  in: shifts\\.c\n  code: "<<"\n'
    assert report(right, (1, 11, "10.1")).stderr == ""
    assert "shifts.c:2: error: " in report(right, (1, 11, "10.1"), (2, 11, "10.1")).stderr
    assert "shifts.c:1: error: " in report(SHIFTS + "  in: other\\.c\n", (1, 11, "10.1")).stderr


def test_record_that_nothing_needs(report):
    records = SHIFTS + '\n- rule: "15.5"\n  class: advisory\n  reason: returns\n'
    result = report(records, (1, 11, "10.1"))
    assert result.stderr == "records.yaml:7: error: the code keeps rule 15.5 now: remove the record\n"


GAVE_UP = "Bailing out from checking {}since there was an internal error: Failed to execute the addon. {}\n"


@pytest.mark.parametrize("output, problem", [
    (GAVE_UP.format("shifts.c ", "Killed"), "shifts.c:1: error: {}: Failed to execute the addon. Killed"),
    (GAVE_UP.format("shifts.c ", "Traceback\n  File misra.py\n\nKeyError: 3"), "shifts.c:1: error: {}: KeyError: 3"),
    (GAVE_UP.format("", "Killed"), "project:1: error: {}: Failed to execute the addon. Killed"),
    ("shifts.c:0:0: internalError\n", "shifts.c:1: error: {}: shifts.c:0:0: internalError"),
    ("Traceback\nMemoryError\n", "project:1: error: {}: MemoryError"),
], ids=["killed", "traceback", "all files together", "as newer ones say it", "anything else"])
def test_what_broke_down_is_told(tmp_path, output, problem):
    (tmp_path / "records.yaml").write_text("[]", encoding="utf-8")
    (tmp_path / "violations").write_text("other.c:1:1: unusedVariable\n" + output, encoding="utf-8")
    result = run_tool("measure.misra_report", tmp_path / "records.yaml", tmp_path / "violations")
    assert result.stderr == problem.format("not checked for MISRA C:2012, the addon failed") + "\n"


@pytest.mark.parametrize("records", ["- rule: '1.1'\n  class: required\n", SHIFTS + "  where: here\n", "- 10.1\n"])
def test_record_with_wrong_keys(report, records):
    assert_one_line_error(report(records), "records.yaml:1", "rule, class and reason")


def test_class_that_cannot_be_deviated_from(report):
    assert_one_line_error(report(SHIFTS.replace("required", "mandatory")), "records.yaml:1", "advisory or required")


def test_records_of_the_project_are_well_formed(tmp_path):
    (tmp_path / "violations").write_text("", encoding="utf-8")
    result = run_tool("measure.misra_report", ROOT / "tests" / "gates" / "misra.yaml", tmp_path / "violations")
    assert not result.returncode and result.stdout.startswith("0 violations")


# The Python of the addon, which breaks down as the variable says.
ADDON_PYTHON = f"""#!/bin/sh
case "$*" in *misra.py*$JP_BREAKS_ON*) printf 'Traceback\\nKeyError: 3\\n' >&2; exit 1;; esac
exec {sys.executable} "$@"
"""


@pytest.fixture(name="gate", scope="module")
def fixture_gate(tmp_path_factory):
    """The gate on two sources, one of each of its two runs of cppcheck."""
    folder = tmp_path_factory.mktemp("gate")
    shutil.copytree(ROOT / "tests/gates", folder / "tests/gates")
    (folder / "tools").symlink_to(ROOT / "tools")
    (folder / "tests/gates/misra.yaml").write_text(SHIFTS, encoding="utf-8")
    (folder / "src").mkdir()
    (folder / "include").mkdir()
    for name, head in (("plain", ""), ("differing", "/* JP_DSP */\n")):
        (folder / f"src/{name}.c").write_text(
            f"{head}static int {name}(int a);\nstatic int {name}(int a) {{\n    return a << 1;\n}}\n", encoding="utf-8")
    python = folder / "python3"
    python.write_text(ADDON_PYTHON, encoding="utf-8")
    python.chmod(0o755)

    def gate(breaks_on, build=None):
        environment = dict(os.environ, PYTHON=str(python), JP_BREAKS_ON=breaks_on,
                           JP_BUILD=build or tempfile.mkdtemp(dir=folder))
        return subprocess.run([folder / "tests/gates/misra.sh"], env=environment, capture_output=True, text=True,
                              check=False)

    gate.folder = folder
    return gate


def test_gate_passes_where_the_addon_does_its_work(gate):
    result = gate("nothing")
    assert not result.returncode and "2 violations of 1 rules" in result.stdout, result.stdout + result.stderr


@pytest.mark.parametrize("breaks_on, name", [
    ("plain", "src/plain.c"), ("differing", "src/differing.c"), ("--file-list", "project"),
])
def test_gate_fails_by_the_name_of_what_the_addon_broke_down_on(gate, breaks_on, name):
    result = gate(breaks_on)
    assert result.returncode == 1
    failures = [line for line in result.stdout.splitlines() if ":misra:FAIL" in line]
    assert failures == [f"{name}:1:misra:FAIL: not checked for MISRA C:2012, the addon failed: KeyError: 3"]


def test_gate_asks_anew_only_of_what_has_changed(gate, tmp_path):
    first = gate("nothing", tmp_path)
    again = gate("plain", tmp_path)  # the addon, which would break down, is not asked
    assert (again.returncode, again.stdout) == (0, first.stdout)
    assert not list(tmp_path.rglob("*.dump"))
    plain = gate.folder / "src/plain.c"
    text = plain.read_text(encoding="utf-8")
    plain.write_text(text.replace("return a << 1;", "goto end;\nend:\n    return a << 1;"), encoding="utf-8")
    changed = gate("nothing", tmp_path)
    plain.write_text(text, encoding="utf-8")
    assert changed.returncode == 1 and "src/plain.c:3:misra:FAIL: MISRA C:2012 rule 15.1" in changed.stdout, changed.stdout
    assert gate("nothing", tmp_path).stdout == first.stdout
    assert gate("differing", tmp_path).returncode == 0


def test_an_addon_that_broke_down_is_asked_again(gate, tmp_path):
    assert gate("plain", tmp_path).returncode == 1
    assert gate("nothing", tmp_path).returncode == 0
