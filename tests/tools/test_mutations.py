"""tools/measure/mutations.py: which mutants a source has, and what they are known by."""
import subprocess

import pytest
from conftest import ROOT  # noqa: F401 - puts the tools on the path

from tools.common import ToolError
from tools.measure import mutations

FLAGS = ["-std=c11", "-isystem", subprocess.run(["gcc", "-print-file-name=include"], capture_output=True, text=True,
                                                check=True).stdout.strip()]


@pytest.fixture(name="mutants")
def fixture_mutants(tmp_path):
    def mutants(source):
        path = tmp_path / "a.c"
        path.write_text(source, encoding="utf-8")
        return list(mutations.mutants_of("a.c", path, FLAGS))
    return mutants


def becomes(found, operator):
    return [mutant.becomes for mutant in found if mutant.operator == operator]


def of_statement(mutants, statement, before="int f(int a, int b)"):
    return mutants(f"{before}\n{{\n    {statement}\n}}\n")


@pytest.mark.parametrize("statement, operator, expected", [
    ("return a + b;", "arithmetic", ["return a - b"]),
    ("return a % b << 1;", "arithmetic", ["return a * b << 1", "return a % b >> 1"]),
    ("a += b; return a;", "arithmetic", ["a -= b"]),
    ("return a < b;", "relational", ["return a <= b", "return a >= b"]),
    ("return a >= b;", "relational", ["return a < b", "return a > b"]),
    ("return a == b;", "relational", ["return a != b"]),
    ("return a > 0 && b > 0;", "logical", ["return a > 0 || b > 0"]),
    ("return a && -b;", "negation", ["return !(a) && -b", "return a && b", "return a && !(-b)"]),
    ("if (a) { return 2; } return b;", "negation", ["!(a)"]),
    ("if (!a) { return 2; } return b;", "negation", ["a"]),
    ("return a < b ? 5 : b;", "negation", []),
    ("for (; a < b; a++) { } return a;", "negation", ["for (; a < b; a--)"]),
    ("return b + 0x10U;", "constant", ["return b + 0U", "return b + 15U", "return b + 17U"]),
    ("return b + 1;", "constant", ["return b + 0", "return b + 2"]),
    ("int c[3]; c[0] = a; return c[0];", "constant", ["c[1] = a", "return c[1]"]),
    ("switch (a) { case 3: return b; default: return a; }", "constant", []),
    ("a = b; f(a, b); return a;", "statement", ["(void)0", "(void)0"]),
    ("for (;;) { break; } return a;", "statement", ["(void)0"]),
    ("return a;", "return", ["return 0"]),
    ("return 0;", "return", ["return 1"]),
    ("return a /* + */ -b;", "arithmetic", ["return a +b"])])
def test_operators(mutants, statement, operator, expected):
    assert becomes(of_statement(mutants, statement), operator) == expected


@pytest.mark.parametrize("before, statement, expected", [
    ("#include <stdbool.h>\nbool f(bool a)", "return a;", ["return !(a)"]),
    ("#include <stdbool.h>\nbool f(int a)", "return a > 3;", []),
    ("#include <stddef.h>\nint *f(int *a)", "return a;", ["return ((void *)0)"]),
    ("struct s { int a; };\nstruct s f(struct s a)", "return a;", ["return (struct s){0}"]),
    ("float f(float a)", "return a;", ["return 0"]),
    ("void f(int *a)", "if (*a) { return; } *a = 1;", [])])
def test_what_a_function_gives_back(mutants, before, statement, expected):
    assert becomes(of_statement(mutants, statement, before), "return") == expected


def test_what_comes_out_of_a_macro_is_left_as_it_is(mutants):
    found = mutants("#define SUM(a, b) ((a) + (b))\nint f(int a)\n{\n    return SUM(a, 3) - 1;\n}\n")
    assert becomes(found, "arithmetic") == ["return SUM(a, 3) + 1"]
    assert becomes(found, "constant") == ["return SUM(a, 3) - 0", "return SUM(a, 3) - 2"]


def test_named_constants_and_tables_have_no_function(mutants):
    found = mutants("#define SIZE 2U\n#define SCALE (SIZE * 3)\nstatic const int table[2] = {5, 7};\n"
                    "int f(unsigned a)\n{\n    return table[a % SIZE];\n}\n")
    outside = [(mutant.function, mutant.becomes) for mutant in found if mutant.scope is None]
    assert outside == [("SIZE", "0U"), ("SIZE", "1U"), ("SIZE", "3U"), ("SCALE", "0"), ("table", "{0, 7}"),
                       ("table", "{4, 7}"), ("table", "{6, 7}"), ("table", "{5, 0}"), ("table", "{5, 6}"),
                       ("table", "{5, 8}")]


def test_a_mutant_is_known_by_what_it_is_and_not_by_where(mutants):
    source = "int f(int a)\n{\n    a = a +\n        1;\n    a = a + 1;\n    return a;\n}\n"
    names = [mutant.name() for mutant in mutants(source)]
    assert len(set(names)) == len(names)
    assert ("a.c", "f", "a = a + 1", "a = a - 1") in names and ("a.c", "f", "a = a + 1", "a = a - 1 (2)") in names
    assert [mutant.name() for mutant in mutants("/* a line */\n\n" + source)] == names


def test_a_mutant_is_the_source_with_one_piece_replaced(mutants):
    source = "int f(int a)\n{\n    return a + 2;\n}\n"
    mutant = next(mutant for mutant in mutants(source) if mutant.operator == "arithmetic")
    assert mutant.applied(source.encode()).decode() == source.replace("+", "-")
    assert list(mutant.lines) == [3] and list(mutant.scope) == [2, 3, 4]


def test_a_source_that_does_not_compile_is_an_error(mutants):
    with pytest.raises(ToolError, match="a.c"):
        mutants("int f(\n")
