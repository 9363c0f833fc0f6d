"""tools/measure/prove.py: what it makes of the analyser's reports, and how it compares them with the reviewed list."""
import json

import pytest
from conftest import ROOT, assert_one_line_error, run_tool

from tools.common import ToolError
from tools.measure import proof_functions, prove

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


def test_a_renamed_parameter_or_constant_makes_no_other_alarm(tmp_path):
    path = tmp_path / "report.csv"
    path.write_text(HEADING + "src/x\tx.c\t12\tstep\tshift\tUnknown\tstate_0->n + state_12->m < BITS_0\n")
    assert prove.read_alarms(path, {"step"}) == [["src/x/x.c", 12, "step", "shift", "state->n + state->m < BITS"]]


def test_a_driver_that_did_not_arrive_or_lacks_a_source_is_in_trouble():
    assert prove.trouble_of(LOG) == ""
    assert prove.trouble_of(LOG.replace("show_each_end", "show_each_x")) == "its end is not reached"
    assert prove.trouble_of("Neither code nor specification for function jp_gone, generating\n" + LOG) == "no source of jp_gone"


def result(driver, *alarms, trouble="", names=("main", "jp_step")):
    return prove.Result(driver, 2, 9, 10, [list(alarm) for alarm in alarms], 1.0, trouble, list(names))


ALARM = ("src/x/x.c", 12, "step", "shift", "0 ≤ n")
OTHER = ("src/x/x.c", 13, "step", "shift", "0 ≤ n")


# Of two headers; the driver reaches the first.
PUBLIC = {"jp_step": "include/joulepath/x.h", "jp_walk": "include/joulepath/x.h", "jp_run": "hal/app/y.h"}


@pytest.fixture
def judged(monkeypatch, tmp_path):
    """The tool on results, with a list and a room."""
    def call(results, listed, *options, room=""):
        (tmp_path / "alarms.yaml").write_text(json.dumps(listed))
        paths = {r.driver: tmp_path / r.driver.replace("/", "/prove_") for r in results}
        monkeypatch.setattr(prove, "chosen", lambda room: (list(paths), room == ""))
        monkeypatch.setattr(prove, "public_functions", lambda libraries: PUBLIC)
        monkeypatch.setattr(prove, "FUNCTIONS", tmp_path / "functions.yaml")
        if not (tmp_path / "functions.yaml").exists():
            proof_functions.write_functions(PUBLIC, {"jp_step"}, tmp_path / "functions.yaml")
        monkeypatch.setattr(prove, "analyse", lambda driver, *rest: next(r for r in results if r.driver == driver))
        return run_tool("measure.prove", "library.a", "--folder", tmp_path, "--room", room, "--list",
                        tmp_path / "alarms.yaml", *options)
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


def test_the_functions_that_drivers_reach_are_counted_and_listed(judged, tmp_path):
    assert "1 of 3 public functions reached" in judged([result("x/a")], []).stdout
    further = judged([result("x/a", names=("main", "jp_step", "jp_run"))], [])
    assert further.returncode == 1 and "functions.yaml: jp_run: a driver reaches it now" in further.stderr
    lost = judged([result("x/a", names=("main",))], [])
    assert lost.returncode == 1 and "functions.yaml: jp_step: no driver reaches it any more" in lost.stderr
    assert judged([result("x/a", names=("main",))], [], room="x").returncode == 0
    assert judged([result("x/a", names=("jp_step", "jp_run__fc_inline"))], [], "--record").returncode == 0
    assert proof_functions.read_functions(tmp_path / "functions.yaml") == ({"jp_step", "jp_run"}, {"jp_walk"})


def test_a_list_of_functions_is_of_those_that_headers_declare(tmp_path):
    path = tmp_path / "functions.yaml"
    proof_functions.write_functions({"jp_gone": "x.h", "jp_step": "x.h"}, {"jp_step"}, path)
    assert list(proof_functions.problems(PUBLIC, {"jp_step"}, path)) == [
        "hal/app/y.h: jp_run: is not in functions.yaml", "include/joulepath/x.h: jp_walk: is not in functions.yaml",
        "functions.yaml: jp_gone: no header declares it any more"]


def test_public_functions_are_those_that_a_header_declares_and_a_library_defines(tmp_path, monkeypatch):
    folder = tmp_path / "include/joulepath"
    folder.mkdir(parents=True)
    (folder / "x.h").write_text("/** As\n * jp_run(). */\nstruct jp_x *jp_step(int32_t a,\n    int b);\nvoid jp_other(void);\n"
                                "static inline int jp_inline(int a)\n{\n    return jp_run(a);\n}\n")
    monkeypatch.setattr(proof_functions, "defined_in", lambda library: ["jp_step", "jp_run"])
    assert proof_functions.public_functions(["library.a"], tmp_path) == {"jp_step": "include/joulepath/x.h"}


def test_a_list_without_reasons_is_refused(judged):
    for wrong in (entry(1) | {"open": "both"}, {"file": "x"}, "text"):
        assert_one_line_error(judged([result("x/a")], [wrong]), "either reason or open")
    assert_one_line_error(judged([result("x/a")], [entry(1), entry(2)]), "listed twice")


def test_a_room_without_drivers_is_refused():
    with pytest.raises(ToolError, match="no drivers; rooms are app, balancer, base"):
        prove.chosen("no-such-room")


LIBRARIES = [ROOT / "build/host/libcan.a", ROOT / "build/host/libjoulepath.a"]


def test_each_public_function_is_listed_and_no_more_are_without_a_driver():
    """`make prove` is no part of `make test`; who adds a public function writes a driver that reaches it."""
    reached, missing = proof_functions.read_functions()
    public = proof_functions.public_functions(LIBRARIES)
    assert public.keys() == reached | missing and not reached & missing
    assert len(missing) <= 9


def test_what_the_project_lists_is_explained_and_does_not_grow():
    """`make prove` is no part of `make test`; who adds an alarm raises this number, and says why."""
    listed = prove.read_listed(prove.ALARMS).values()
    assert all(entry.explained for entry in listed)
    assert sum(entry.count for entry in listed) <= 1296
