"""tools/measure/prove.py: what it makes of the analyser's reports, and how it compares them with the reviewed list."""
import json

import pytest
from conftest import assert_one_line_error, run_tool

from tools.common import ToolError
from tools.measure import prove

HEADING = "directory\tfile\tline\tfunction\tproperty kind\tstatus\tproperty\n"
ROWS = ("src/x\tx.c\t12\tstep_3\tsigned_overflow\tUnknown\ta + b\n"
        "src/x\tx.c\t12\tstep_3\tsigned_overflow\tInvalid or unreachable\tb + a\n"
        "src/x\tx.c\t13\tstep_3\tshift\tValid\t0 ≤ n\n"
        "src/x\tx.c\t14\tstep_3\tassigns clause\tUnknown\tassigns x\n"
        "src/x\tx.c\t15\tstep_3\tprecondition of zeros_of_7\tUnknown\tword\n"
        "src/x\tx.c\t20\tnever_called\tshift\tUnknown\t0 ≤ m\n"
        "FRAMAC_SHARE/libc\tstring.h\t9\tstep_3\tprecondition\tUnknown\tvalid\n"
        "tests/proof/c11/src/base\tcompiler.h\t9\tstep_3\tprecondition\tUnknown\tword\n")
LOG = """[eva] computing for function step_3 <- main.
[eva] a.c:3: Frama_C_show_each_end:
[eva:summary] ====== ANALYSIS SUMMARY ======
  2 functions analyzed (out of 3): 66% coverage.
  In these functions, 9 statements reached (out of 10): 90% coverage.
"""


@pytest.fixture
def report(tmp_path):
    path = tmp_path / "report.csv"
    path.write_text(HEADING + ROWS)
    return path


def test_alarms_are_what_is_not_proved_in_what_was_analysed(report):
    assert prove.read_alarms(report, {"main", "step_3"}) == [
        ["src/x/x.c", 12, "step", "signed_overflow", "a + b"], ["src/x/x.c", 12, "step", "signed_overflow", "b + a"],
        ["src/x/x.c", 15, "step", "precondition of zeros_of", "word"]]


def test_a_driver_that_did_not_arrive_or_lacks_a_source_is_in_trouble():
    assert prove.trouble_of(LOG) == ""
    assert prove.trouble_of(LOG.replace("show_each_end", "show_each_x")) == "its end is not reached"
    assert prove.trouble_of("Neither code nor specification for function jp_gone, generating\n" + LOG) == "no source of jp_gone"


def result(driver, *alarms, trouble=""):
    return prove.Result(driver, 2, 9, 10, [list(alarm) for alarm in alarms], 1.0, trouble)


ALARM = ("src/x/x.c", 12, "step", "shift", "0 ≤ n")
OTHER = ("src/x/x.c", 13, "step", "shift", "0 ≤ n")


@pytest.fixture
def judged(monkeypatch, tmp_path):
    """The tool on results, with a list and a room."""
    def call(results, listed, room=""):
        (tmp_path / "alarms.yaml").write_text(json.dumps(listed))
        paths = {r.driver: tmp_path / r.driver.replace("/", "/prove_") for r in results}
        monkeypatch.setattr(prove, "chosen", lambda room: (list(paths), room == ""))
        monkeypatch.setattr(prove, "analyse", lambda driver, *rest: next(r for r in results if r.driver == driver))
        return run_tool("measure.prove", "library.a", "--folder", tmp_path, "--room", room, "--list",
                        tmp_path / "alarms.yaml")
    return call


def entry(count, **why):
    return {"file": "src/x/x.c", "function": "step", "kind": "shift", "count": count} | (why or {"reason": "n is 3"})


def test_listed_alarms_pass_and_are_counted(judged):
    found = judged([result("x/a", ALARM, OTHER), result("x/b", ALARM)], [entry(2)])
    assert found.returncode == 0, found.stdout + found.stderr
    assert found.stdout.splitlines()[-1] == "2 drivers, 2 alarms: 2 explained, 0 open"
    assert judged([result("x/a", ALARM)], [entry(1, open="not traced")]).stdout.splitlines()[-1] == \
        "1 drivers, 1 alarms: 0 explained, 1 open"


def test_another_alarm_fails_and_is_shown(judged):
    found = judged([result("x/a", ALARM, OTHER)], [entry(1)])
    assert found.returncode == 1
    assert "src/x/x.c step shift: 2 alarms, 1 listed" in found.stderr
    assert "src/x/x.c:13: step: shift: 0 ≤ n" in found.stdout
    assert judged([result("x/a", ALARM)], []).returncode == 1


def test_an_alarm_that_is_gone_leaves_the_list(judged):
    assert "lower the count" in judged([result("x/a")], [entry(1)]).stderr
    assert judged([result("x/a")], [entry(1)], room="x").returncode == 0


def test_a_driver_in_trouble_fails(judged):
    assert "x/a: took more than 9 s" in judged([result("x/a", trouble="took more than 9 s")], []).stderr


def test_a_list_without_reasons_is_refused(judged):
    for wrong in (entry(1) | {"open": "both"}, {"file": "x"}, "text"):
        assert_one_line_error(judged([result("x/a")], [wrong]), "either reason or open")
    assert_one_line_error(judged([result("x/a")], [entry(1), entry(2)]), "listed twice")


def test_a_room_without_drivers_is_refused():
    with pytest.raises(ToolError, match="no drivers; rooms are app, balancer, base"):
        prove.chosen("no-such-room")


def test_what_the_project_lists_is_explained_and_does_not_grow():
    """`make prove` is no part of `make test`; who adds an alarm raises this number, and says why."""
    listed = prove.read_listed(prove.ALARMS).values()
    assert all(entry.explained for entry in listed)
    assert sum(entry.count for entry in listed) <= 522
