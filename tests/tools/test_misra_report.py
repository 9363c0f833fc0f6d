"""tools/measure/misra_report.py: what records cover, what they do not, and records that nothing needs."""
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


@pytest.mark.parametrize("records", ["- rule: '1.1'\n  class: required\n", SHIFTS + "  where: here\n", "- 10.1\n"])
def test_record_with_wrong_keys(report, records):
    assert_one_line_error(report(records), "records.yaml:1", "rule, class and reason")


def test_class_that_cannot_be_deviated_from(report):
    assert_one_line_error(report(SHIFTS.replace("required", "mandatory")), "records.yaml:1", "advisory or required")


def test_records_of_the_project_are_well_formed(tmp_path):
    (tmp_path / "violations").write_text("", encoding="utf-8")
    result = run_tool("measure.misra_report", ROOT / "tests" / "gates" / "misra.yaml", tmp_path / "violations")
    assert not result.returncode and result.stdout.startswith("0 violations")
