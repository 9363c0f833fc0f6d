"""Our unity.h declares no more than the real one, so that a test that compiles with it compiles with that too."""
import re
import subprocess

import pytest
from conftest import ROOT

HEADER = ROOT / "tests/unity/unity.h"
# Of what the real one includes: the rest comes with floating point, or with its own way of printing.
SYSTEM = "#include <setjmp.h>\n#include <stddef.h>\n#include <stdint.h>\n"
OWN_NAME = re.compile(r"_*(unity|test_|run_test)", re.IGNORECASE)


def compile_(source, *options):
    return subprocess.run(["gcc", "-std=c11", "-Werror", "-D_GNU_SOURCE", *options, "-x", "c", "-o", "-", "-"],
                          input=source, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("text", ["memcpy(a, b, 1)", "memset(a, 0, 1)", "memcmp(a, b, 1)", "strlen(b)", "bool found = 0",
                                  "abs(*b)", "assert(a)"])
def test_what_a_test_needs_it_must_include(text):
    source = f'#include "tests/unity/unity.h"\nvoid test(char *a, const char *b);\nvoid test(char *a, const char *b)\n' \
             f'{{\n    (void)a, (void)b;\n    {text};\n}}\n'
    everything = "#include <assert.h>\n#include <stdbool.h>\n#include <stdlib.h>\n#include <string.h>\n"
    assert compile_(source, "-fsyntax-only").returncode != 0
    result = compile_(everything + source, "-fsyntax-only")
    assert result.returncode == 0, result.stderr


def test_its_macros_bear_its_own_names():
    ours = set(compile_(f'{SYSTEM}#include "{HEADER}"\n', "-E", "-dM", "-DUNITY_OUTPUT_CHAR").stdout.splitlines())
    ours -= set(compile_(SYSTEM, "-E", "-dM", "-DUNITY_OUTPUT_CHAR").stdout.splitlines())
    names = [line.split()[1] for line in ours]
    assert len(names) > 300
    assert [name for name in names if not OWN_NAME.match(name)] == []
