"""tools/measure/stack.py: the deepest path, and what has none."""
import json

import pytest
from conftest import assert_one_line_error, run_tool
from core_fixtures import PRELUDE, make_variant

from tools.common import ToolError
from tools.measure import call_graph, stack

ENTRY = "jp_robot_tick"


@pytest.fixture
def only_entry(monkeypatch, tmp_path):
    monkeypatch.setenv("JP_BUILD", str(tmp_path / "build"))
    monkeypatch.setattr(stack, "ENTRIES", (ENTRY,))
    monkeypatch.setattr(stack, "BAR_ENTRY", ENTRY)


@pytest.fixture
def measure(only_entry, tmp_path):
    """Runs the tool on one source; `listed` are the targets of the indirect calls."""
    def run(source, listed=None, variant="cortex-m4"):
        folder = make_variant(tmp_path, {"src/balancer/robot.o": source}, variant)
        path = tmp_path / "indirect_calls.json"
        path.write_text(json.dumps({call: [t.replace("HERE", str(folder / "src/balancer/robot.c")) for t in targets]
                                    for call, targets in (listed or {}).items()}))
        return run_tool("measure.stack", "--paths", "--indirect", path, folder)
    run.table = lambda: json.loads((tmp_path / "build/numbers/stack.json").read_text())
    run.figures = lambda: json.loads((tmp_path / "build/bench/stack.json").read_text())
    return run


LEAF = "KEEP void {0}(void) {{ volatile char bytes[{1}]; use(bytes); }}\n"
CHAIN = LEAF.format("small", 32) + LEAF.format("large", 200) + "KEEP void jp_robot_tick(void) { small(); large(); }\n"


@pytest.mark.parametrize("variant, core", [("cortex-m0", "Cortex-M0"), ("cortex-m4", "Cortex-M4"), ("rv32", "RV32")])
def test_the_deepest_path_counts(measure, variant, core):
    result = measure(CHAIN, variant=variant)
    assert result.returncode == 0, result.stderr
    depth = measure.table()[ENTRY][core]
    assert 200 < depth < 264
    assert f"{ENTRY}: {depth} B: {ENTRY} -> large" in result.stdout


def test_a_larger_frame_is_seen(measure):
    measure(CHAIN)
    before = measure.table()[ENTRY]["Cortex-M4"]
    measure(CHAIN.replace("200", "264"))
    assert measure.table()[ENTRY]["Cortex-M4"] == before + 64


def test_the_float_library_has_entries_where_it_is(only_entry, monkeypatch, tmp_path):
    monkeypatch.setattr(stack, "FLOAT_ENTRIES", ("jp_float_entry",))
    float_source = PRELUDE + LEAF.format("deep", 300) + "KEEP void jp_float_entry(void) { deep(); }\n"
    float_source = float_source.replace("use(", "use_too(")
    one = make_variant(tmp_path, {"src/balancer/robot.o": CHAIN, "src/local/obstacles.o": float_source})
    other = make_variant(tmp_path, {"src/balancer/robot.o": CHAIN}, "cortex-m0")
    table = stack.measure([one, other], {})
    assert list(table["jp_float_entry"]) == ["Cortex-M4"]
    assert table["jp_float_entry"]["Cortex-M4"] > 300


def test_the_worst_of_several_variants_counts(only_entry, tmp_path):
    one = make_variant(tmp_path / "one", {"src/balancer/robot.o": CHAIN})
    other = make_variant(tmp_path / "other", {"src/balancer/robot.o": CHAIN.replace("200", "400")})
    other = other.rename(other.with_name("cortex-m4-os"))
    table = stack.measure([one, other], {})
    assert table[ENTRY]["Cortex-M4"] > 400
    assert table == stack.measure([other, one], {})


def test_the_bar_is_a_figure(measure):
    measure(CHAIN)
    assert [figure["bound"] for figure in measure.figures()] == [{"op": "<=", "value": 256}]


@pytest.mark.parametrize("source, parts", [
    ("KEEP int jp_robot_tick(int n) { return n ? n + jp_robot_tick(n - 1) : 0; }", ["jp_robot_tick -> jp_robot_tick"]),
    ("KEEP int a(int n);\nKEEP int b(int n) { return n ? 1 + a(n) : 0; }\nKEEP int a(int n) { return 1 + b(n - 1); }\n"
     "void jp_robot_tick(void) { (void)a(3); }", ["a -> b -> a"]),
])
def test_recursion_is_an_error(measure, source, parts):
    assert_one_line_error(measure(source), "recursion", *parts)


@pytest.mark.parametrize("body", ["volatile char bytes[n]; use(bytes);", "use(__builtin_alloca(n));"])
def test_a_frame_of_varying_size_is_an_error(measure, body):
    result = measure(f"void jp_robot_tick(int n) {{ for (; n; n--) {{ {body} }} }}")
    assert_one_line_error(result, "jp_robot_tick", "varies")


POINTERS = """
struct hal { void (*read)(void); int number; };
struct board { struct hal hal; };
KEEP static void deep(void) { volatile char bytes[128]; use(bytes); }
KEEP static void flat(void) { volatile char bytes[8]; use(bytes); }
struct board boards[2] = {{{deep, 1}}, {{flat, 2}}};
KEEP void jp_robot_tick(struct board *board) { board->hal.read(); board->hal.number = 0; }
"""


def test_a_call_by_a_pointer_must_be_listed(measure):
    assert_one_line_error(measure(POINTERS, {"other": ["HERE:deep", "HERE:flat"]}), "robot.c:", "board.hal.read", "list")


def test_the_listed_targets_are_followed(measure):
    result = measure(POINTERS, {"hal.read": ["HERE:flat", "HERE:deep"]})
    assert result.returncode == 0, result.stderr
    assert measure.table()[ENTRY]["Cortex-M4"] > 128


def test_a_function_whose_pointer_alone_is_used_must_be_listed(measure):
    assert_one_line_error(measure(POINTERS, {"hal.read": ["HERE:flat"]}), "robot.c:deep", "pointer")


def test_a_listed_target_must_exist(measure):
    result = measure(POINTERS, {"hal.read": ["HERE:gone"], "other": ["HERE:flat", "HERE:deep"]})
    assert_one_line_error(result, "board.hal.read", "exists")


def test_recursion_through_a_pointer_is_an_error(measure):
    source = POINTERS.replace("use(bytes); }\nKEEP static void flat", "jp_robot_tick(boards); }\nKEEP static void flat")
    source = source.replace("KEEP static void deep", "extern struct board boards[2];\n"
                            "void jp_robot_tick(struct board *board);\nKEEP static void deep")
    assert_one_line_error(measure(source, {"read": ["HERE:flat", "HERE:deep"]}), "recursion", "deep -> jp_robot_tick")


def test_a_board_function_counts_nothing(measure):
    source = "struct hal { void (*read)(void); };\nKEEP void jp_robot_tick(struct hal *hal) { hal->read(); hal->read(); }"
    assert measure(source, {"hal.read": ["board"]}).returncode == 0
    assert measure.table()[ENTRY]["Cortex-M4"] <= 16


DIVISION = "volatile unsigned long long number;\nvoid jp_robot_tick(unsigned long long by) { number = number / by; }"


@pytest.mark.parametrize("variant, core, least", [("cortex-m0", "Cortex-M0", 84), ("cortex-m4", "Cortex-M4", 48)])
def test_helpers_of_the_compiler_count(measure, variant, core, least):
    result = measure(DIVISION, variant=variant)
    assert result.returncode == 0, result.stderr
    assert measure.table()[ENTRY][core] >= least
    assert "__udivmoddi4" in result.stdout


def test_an_object_of_another_build_is_refused(only_entry, tmp_path):
    folder = make_variant(tmp_path, {"src/balancer/robot.o": CHAIN})
    path = folder / "src/balancer/robot.ci"
    path.write_text(path.read_text().replace(" bytes (static)", "0 bytes (static)"))
    with pytest.raises(ToolError, match="build again"):
        stack.measure([folder], {})


def test_a_missing_entry_is_an_error(measure):
    assert_one_line_error(measure("void other(void) {}"), "jp_robot_tick", "does not know")


@pytest.mark.parametrize("content, part", [("[]", "list of functions"), ('{"read": []}', "list"), ("{", "no JSON")])
def test_a_garbled_list_is_refused(only_entry, tmp_path, content, part):
    (tmp_path / "list.json").write_text(content)
    assert_one_line_error(run_tool("measure.stack", "--indirect", tmp_path / "list.json", tmp_path), "list.json", part)


def test_a_folder_without_a_build_is_refused(only_entry, tmp_path):
    assert_one_line_error(run_tool("measure.stack", tmp_path / "cortex-m4"), "cortex-m4", "no call graphs")


@pytest.mark.parametrize("operation, operands, growth", [
    ("push", "{r4, r5, r6, lr}", 16), ("push", "{r4-r7, lr}", 20), ("stmdb", "sp!, {r4, r5}", 8), ("stmdb", "r0!, {r4}", 0),
    ("vpush", "{d8-d9}", 16), ("sub", "sp, #24", 24), ("sub.w", "sp, sp, #1024", 1024), ("strd", "ip, lr, [sp, #-16]!", 16),
    ("add", "sp, #24", 0), ("pop", "{r4, pc}", 0), ("ldmia.w", "sp!, {r4, pc}", 0), ("str", "r0, [sp, #4]", 0),
    ("mov", "r0, sp", 0), ("mov", "sp, r7", None), ("sub", "sp, r3", None), ("add", "sp, r3", None)])
def test_growth_on_arm(operation, operands, growth):
    assert call_graph.arm_growth(operation, operands) == growth


@pytest.mark.parametrize("operation, operands, growth", [
    ("addi", "sp,sp,-32", 32), ("add", "sp,sp,-32", 32), ("addi", "sp,sp,32", 0), ("sw", "ra,28(sp)", 0),
    ("mv", "a0,sp", 0), ("sub", "sp,sp,a0", None), ("mv", "sp,s0", None)])
def test_growth_on_riscv(operation, operands, growth):
    assert call_graph.riscv_growth(operation, operands) == growth


@pytest.mark.parametrize("line, column, expression", [
    ("    x = hal->read(hal->context);", 9, "hal.read"), ("    table[i - 1U].fill(ecu);", 5, "table.fill"),
    ("    fill[left - 1U](&plan);", 5, "fill"), ("    (*send)(frame);", 5, "send")])
def test_the_called_expression_is_read(tmp_path, line, column, expression):
    (tmp_path / "x.c").write_text(f"\n{line}\n")
    assert call_graph.called_expression(f"{tmp_path}/x.c:2:{column}") == expression


@pytest.mark.parametrize("place", ["x.c:9:1", "x.c:1:1"])
def test_a_place_without_a_call_is_an_error(tmp_path, place):
    (tmp_path / "x.c").write_text("+ 1;\n")
    with pytest.raises(ToolError, match="build again"):
        call_graph.called_expression(f"{tmp_path}/{place}")


def test_the_longest_end_of_an_expression_is_taken():
    listed = {"send": ["a"], "bus.send": ["b"]}
    assert call_graph.targets_of("node.bus.send", listed) == ["b"]
    assert call_graph.targets_of("port.send", listed) == ["a"]
    assert call_graph.targets_of("port.state", listed) is None
