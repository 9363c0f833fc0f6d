"""The gates that know the rooms find what they are for."""
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/gates"))
import includes  # pylint: disable=wrong-import-position
import private  # pylint: disable=wrong-import-position

LAYERS = {"src/base": [], "src/energy": ["src/base"], "hal": ["include/joulepath"], "hal/can": ["include/joulepath", "hal"]}
GOOD = {
    "include/joulepath/fixed.h": "#include <stdint.h>\n",
    "include/joulepath/energy.h": "#include <joulepath/fixed.h>\n",
    "src/base/fixed.c": "#include <joulepath/fixed.h>\n",
    "src/energy/energy.c": '#include <joulepath/energy.h>\n\n#include "src/energy/terms.h"\n',
    "src/energy/terms.h": "#include <joulepath/energy.h>\n",
    "hal/hal.h": "#include <joulepath/energy.h>\n",
    "hal/can/can.c": '#include "hal/hal.h"\n#include <linux/can.h>\n',
}


def complaints(**changed):
    files = {**GOOD, **{name.replace("__", "/").replace("_h", ".h").replace("_c", ".c"): text
                        for name, text in changed.items()}}
    return [reason for problems in includes.check(files, LAYERS, {}).values() for _, reason in problems]


def test_arrows_that_run_down_pass():
    assert complaints() == []


@pytest.mark.parametrize("name, text, words", [
    ("src__base__fixed_c", '#include "src/energy/terms.h"\n', "src/base may not include src/energy/terms.h"),
    ("src__base__fixed_c", "#include <joulepath/energy.h>\n", "src/base may not include src/energy"),
    ("include__joulepath__fixed_h", "#include <joulepath/energy.h>\n", "src/base may not include src/energy"),
    ("src__energy__energy_c", '#include "terms.h"\n', "not a path from the root"),
    ("src__energy__energy_c", '#include "../energy/terms.h"\n', "not a path from the root"),
    ("src__energy__energy_c", "#include <stdio.h>\n", "not allowed in the core"),
    ("hal__hal_h", '#include "hal/can/can.c"\n', "hal may not include hal/can/can.c"),
])
def test_each_kind_of_wrong_include_is_found(name, text, words):
    assert any(words in reason for reason in complaints(**{name: text}))


def test_a_circle_of_modules_is_found():
    found = complaints(**{"src__energy__terms_c": '#include "src/energy/terms.h"\n#include "src/energy/sums.h"\n',
                          "src__energy__sums_h": "", "src__energy__sums_c": '#include "src/energy/terms.h"\n'})
    assert any("circle" in reason and "sums" in reason for reason in found)


def test_the_settings_name_every_room():
    rooms = includes.yaml.safe_load((ROOT / "tests/gates/layers.yaml").read_text("utf-8"))["rooms"]
    folders = {path.parent.relative_to(ROOT).as_posix() for top in ("src", "hal", "sim") for path in (ROOT / top).rglob("*.[ch]")}
    assert folders == set(rooms)


FLAGS = ["-std=c11", f"-I{ROOT}/include", f"-I{ROOT}", "-w"]
READER = ("#include <joulepath/planner.h>\n"
          "unsigned reader(const struct jp_planner *p) { return p->internal.phase; }\n")


@pytest.mark.parametrize("place, count", [("src/search/reader.c", 0), ("hal/app/reader.c", 1), ("src/navigate/reader.c", 1)])
def test_a_private_member_is_read_by_its_own_room_only(place, count):
    headers = subprocess.run(["gcc", "-print-file-name=include"], capture_output=True, text=True, check=True).stdout.strip()
    homes = includes.homes_of(path.relative_to(ROOT).as_posix() for path in (ROOT / "src").rglob("*.c"))
    unit = private.parse(ROOT / place, [*FLAGS, "-isystem", headers], READER)
    assert len(list(private.problems_of(unit, ROOT / place, homes))) == count
