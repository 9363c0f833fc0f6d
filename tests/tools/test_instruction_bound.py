"""tools/measure/instruction_bound.py: the longest way through a function's control flow, and what it is compared with."""
import json

import pytest
from conftest import assert_one_line_error, run_tool

from tools.common import ToolError
from tools.measure import control_flow, instruction_bound

LEAF = """
00000100 <leaf>:
 100:\t3001      \tadds\tr0, #1
 102:\t4770      \tbx\tlr
"""
# 2 + the longer of 2 (with the call: 2 + 2) and 1, + 1.
BRANCH = LEAF + """
00000200 <branch>:
 200:\t2800      \tcmp\tr0, #0
 202:\td002      \tbeq.n\t20a <branch+0xa>
 204:\tf7ff ff7c \tbl\t100 <leaf>
 208:\te000      \tb.n\t20c <branch+0xc>
 20a:\t3002      \tadds\tr0, #2
 20c:\t4770      \tbx\tlr
"""
# 1 + 10 turns of 3, + 1.
LOOP = """
00000300 <loop>:
 300:\t2000      \tmovs\tr0, #0
 302:\t3001      \tadds\tr0, #1
 304:\t280a      \tcmp\tr0, #10
 306:\td1fc      \tbne.n\t302 <loop+0x2>
 308:\t4770      \tbx\tlr
"""
# 1 + 4 turns of (1 + 5 turns of 2 + 2), + 1.
NESTED = """
00000300 <nested>:
 300:\t2000      \tmovs\tr0, #0
 302:\t2100      \tmovs\tr1, #0
 304:\t3101      \tadds\tr1, #1
 306:\td1fd      \tbne.n\t304 <nested+0x4>
 308:\t3001      \tadds\tr0, #1
 30a:\td1fa      \tbne.n\t302 <nested+0x2>
 30c:\t4770      \tbx\tlr
"""
# The bytes of the table, 2 and 3, lead to 408 and 40a; the default to 40c.
TABLE = """
00000400 <table>:
 400:\te8df f000 \ttbb\t[pc, r0]
 404:\t0302      \t.short\t0x0302
 406:\tbf00      \tnop
 408:\t3001      \tadds\tr0, #1
 40a:\t3002      \tadds\tr0, #2
 40c:\t4770      \tbx\tlr
"""
# One of both calls, as the caller knows.
EITHER = LEAF + """
00000110 <other>:
 110:\t3001      \tadds\tr0, #1
 112:\t3001      \tadds\tr0, #1
 114:\t4770      \tbx\tlr
00000500 <either>:
 500:\t2800      \tcmp\tr0, #0
 502:\td001      \tbeq.n\t508 <either+0x8>
 504:\tf7ff fdfc \tbl\t100 <leaf>
 508:\t2900      \tcmp\tr1, #0
 50a:\td001      \tbeq.n\t510 <either+0x10>
 50c:\tf7ff fe00 \tbl\t110 <other>
 510:\t4770      \tbx\tlr
"""
SIZED = """
00000600 <memset>:
 600:\t3a10      \tsubs\tr2, #16
 602:\td1fd      \tbne.n\t600 <memset>
 604:\t4770      \tbx\tlr
00000700 <known>:
 700:\t2240      \tmovs\tr2, #64
 702:\tf7ff ff7d \tbl\t600 <memset>
 706:\t4770      \tbx\tlr
00000710 <unknown>:
 710:\t2240      \tmovs\tr2, #64
 712:\t1852      \tadds\tr2, r2, r1
 714:\tf7ff ff74 \tbl\t600 <memset>
 718:\t4770      \tbx\tlr
"""
NO_FACTS = {"sized": {}, "loops": {}, "exclusions": [], "entries": []}


@pytest.fixture
def bound(monkeypatch, tmp_path):
    def find(text, name, **facts):
        monkeypatch.setattr(instruction_bound, "disassemble", lambda path: text)
        return instruction_bound.Image(tmp_path, NO_FACTS | facts).bound(name)
    return find


def turns(**loops):
    return {name: {"turns": values, "reason": "as said"} for name, values in loops.items()}


def test_the_longer_branch_counts_with_what_it_calls(bound):
    assert bound(BRANCH, "branch") == 2 + (2 + 2) + 1


def test_a_loop_counts_its_longest_turn_as_often_as_listed(bound):
    assert bound(LOOP, "loop", loops=turns(loop=[10])) == 1 + 10 * 3 + 1
    assert bound(NESTED, "nested", loops=turns(nested=[4, 5])) == 1 + 4 * (1 + 5 * 2 + 2) + 1


def test_a_jump_by_a_table_leads_to_each_of_its_entries(bound):
    assert bound(TABLE, "table") == 1 + 3
    names, functions = control_flow.read_functions(TABLE)
    assert control_flow.Graph("table", functions[0x400], names).blocks[0x400].follows == {0x408, 0x40a}


def test_calls_that_exclude_each_other_do_not_both_count(bound):
    exclusion = {"function": "either", "if": ["leaf"], "never": ["other"], "reason": "as said"}
    assert bound(EITHER, "either") == 7 + 2 + 3
    assert bound(EITHER, "either", exclusions=[exclusion]) == 6 + 3


def test_the_size_that_is_set_is_that_of_the_call(bound):
    sized = {"memset": {"turns": ["size/16"], "most": 160, "reason": "as said"}}
    assert bound(SIZED, "known", sized=sized) == 3 + 4 * 2 + 1
    assert bound(SIZED, "unknown", sized=sized) == 4 + 10 * 2 + 1


def test_what_has_no_bound_is_refused(bound):
    for text, name, why in ((LOOP, "loop", "loops at 302: list their turns"),
                            (LEAF.replace("bx\tlr", "bx\tr3"), "leaf", "calls by a pointer"),
                            (LEAF, "twig", "0 functions of that name"),
                            (BRANCH.replace("100 <leaf>", "200 <branch>"), "branch", "recursion: branch"),
                            (LEAF.replace("bx\tlr", "b.n\t100 <leaf>"), "leaf", "loops at 100")):
        with pytest.raises(ToolError, match=why):
            bound(text, name)
    with pytest.raises(ToolError, match="no way leads out"):
        bound(LEAF.replace("bx\tlr", "b.n\t100 <leaf>"), "leaf", loops=turns(leaf=[3]))


@pytest.fixture
def tool(monkeypatch, tmp_path):
    monkeypatch.setenv("JP_BUILD", str(tmp_path / "build"))
    monkeypatch.setattr(instruction_bound, "disassemble", lambda path: LEAF)

    def call(measured, **facts):
        entries = [{"image": "whole", "functions": ["leaf", "leaf"], "figure": "ticks"}]
        (tmp_path / "facts.json").write_text(json.dumps(NO_FACTS | {"entries": entries} | facts))
        figures = [{"name": "ticks", "value": measured}]
        (tmp_path / "figures.json").write_text(json.dumps({"benches": {"x": figures}}))
        return run_tool("measure.instruction_bound", tmp_path, "--facts", tmp_path / "facts.json", "--figures",
                        tmp_path / "figures.json")
    return call


def test_bounds_stand_beside_what_was_measured(tool, tmp_path):
    result = tool(4)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout.splitlines()[1].split()[-4:] == ["4", "4", "1.00", "ticks"]
    (row,) = json.loads((tmp_path / "build/numbers/instruction_bounds.json").read_text())
    assert row == {"name": "leaf + leaf", "figure": "ticks", "bound": 4, "measured": 4, "ratio": 1.0}


def test_a_bound_below_the_measured_or_far_above_it_fails(tool):
    assert "ticks: bound 4 is below the measured 5" in tool(5).stdout
    result = tool(2)
    assert result.returncode == 1
    assert "ticks: bound 4 is 2.00 times the measured 2, bar 1.5" in result.stdout


def test_facts_that_nothing_needs_are_refused(tool):
    assert_one_line_error(tool(4, loops=turns(gone=[3])), "gone", "no image needs")
    exclusion = {"function": "leaf", "if": ["a"], "never": ["b"], "reason": "as said"}
    assert_one_line_error(tool(4, exclusions=[exclusion]), "leaf", "calls nothing of a")
