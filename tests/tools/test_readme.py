"""The Markdown files: examples are firmware that compiles and links, links lead somewhere, what is named is there, and
no figure is typed."""
import re
import subprocess

import pytest
import yaml
from conftest import ROOT
from programs import BUILD
from tools.measure.figure_pages import BLOCK_MARK, PAGE, VALUE_MARK, bar_value, documents, measured
from tools.measure.figure_store import STORE, by_name, read_store

LINES_MAX = 200  # of the front page
FRONT = ROOT / "README.md"
PACKAGED = ROOT / "tools/packaging"  # its README's links are those of the package
PAGES = [*documents(ROOT), ROOT / PAGE]
NAMES = [str(path.relative_to(ROOT)) for path in PAGES]
WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"]
FLAGS = ["-std=c11", "-O0", "-fno-math-errno", "-I", str(ROOT / "include"), "-I", str(ROOT)]
COMPILERS = {"host": ["gcc"],
             "cortex-m4": ["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard",
                           "--specs=nosys.specs"]}

BALANCER_BOARD = """
#include "hal/hal.h"
enum jp_status board_read(void *context, struct jp_sensors *sensors);
enum jp_status board_write(void *context, const struct jp_actuation *actuation);
enum jp_status board_read(void *context, struct jp_sensors *sensors)
{
    (void)context;
    (void)sensors;
    return JP_OK;
}
enum jp_status board_write(void *context, const struct jp_actuation *actuation)
{
    (void)context;
    (void)actuation;
    return JP_OK;
}
"""

PLANNER_BOARD = """
#include <joulepath/planner.h>
bool sensed_cell(int32_t *x, int32_t *y, enum jp_cell *cell);
void drive(const struct jp_primitive *primitive);
bool sensed_cell(int32_t *x, int32_t *y, enum jp_cell *cell)
{
    (void)x;
    (void)y;
    (void)cell;
    return false;
}
void drive(const struct jp_primitive *primitive)
{
    (void)primitive;
}
"""

PILOT_BOARD = """
#include <joulepath/pilot.h>
jp_energy energy_left(void);
extern struct jp_robot robot;
struct jp_robot robot;
jp_energy energy_left(void)
{
    return (jp_energy)1000 << 32;
}
"""

ROBOT_AND_PILOT = """
#include <joulepath/pilot.h>
extern struct jp_robot robot;
extern struct jp_pilot pilot;
struct jp_robot robot;
struct jp_pilot pilot;
"""

NAVIGATOR_BOARD = """
#include <joulepath/pilot.h>
#include <joulepath/planner.h>
extern struct jp_planner planner;
extern struct jp_pilot pilot;
bool sensed_cell(int32_t *x, int32_t *y, enum jp_cell *cell);
struct jp_planner planner;
struct jp_pilot pilot;
bool sensed_cell(int32_t *x, int32_t *y, enum jp_cell *cell)
{
    (void)x;
    (void)y;
    (void)cell;
    return false;
}
"""

EXAMPLES = {"README.md": BALANCER_BOARD, "src/search/README.md": PLANNER_BOARD, "src/learn/README.md": PILOT_BOARD,
            "src/trajectory/README.md": ROBOT_AND_PILOT, "src/navigate/README.md": NAVIGATOR_BOARD}


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


def prose(name):
    """Without blocks of code."""
    return re.sub(r"^```.*?^```", "", text_of(name), flags=re.S | re.M)


def shell_lines(name):
    return [line for block in re.findall(r"^```sh\n(.*?)^```", text_of(name), re.S | re.M)
            for line in block.splitlines()]


def test_the_front_page_is_short():
    assert len(text_of("README.md").splitlines()) <= LINES_MAX


# ---- examples ------------------------------------------------------------------------------------------------------

def test_every_example_is_compiled():
    with_example = {name for name in NAMES if "```c\n" in text_of(name)}
    assert with_example == set(EXAMPLES)


def build(*command):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("variant", COMPILERS)
@pytest.mark.parametrize("name", EXAMPLES)
def test_example_builds(name, variant, tmp_path):
    """With the libraries that make has built."""
    compiler = COMPILERS[variant]
    libraries = [BUILD / variant / f"lib{part}.a" for part in ("can", "joulepath_float", "joulepath")]
    (tmp_path / "board.c").write_text(EXAMPLES[name], encoding="utf-8")
    for example in re.findall(r"^```c\n(.*?)^```", text_of(name), re.S | re.M):
        (tmp_path / "main.c").write_text(example, encoding="utf-8")
        build(*compiler, *FLAGS, *WARNINGS, tmp_path / "main.c", tmp_path / "board.c", *libraries, "-lm", "-o",
              tmp_path / "example")


# ---- what is named is there ----------------------------------------------------------------------------------------

def anchors(path):
    """As GitHub makes them of the headings."""
    lines = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", path.read_text("utf-8"), flags=re.S | re.M), re.M)
    return {re.sub(r"[^\w -]", "", line.lower()).replace(" ", "-") for line in lines}


@pytest.mark.parametrize("name", NAMES)
def test_links_lead_somewhere(name):
    for target in re.findall(r"\]\(([^)]+)\)", prose(name)):
        if target.startswith(("http://", "https://")):
            continue
        file, _, anchor = target.partition("#")
        place = (ROOT / name).parent
        if place == PACKAGED:
            place = ROOT
        path = place / file if file else ROOT / name
        assert path.exists(), target
        assert not anchor or anchor in anchors(path), target


@pytest.mark.parametrize("name", NAMES)
def test_commands_are_targets(name):
    makefiles = [ROOT / "Makefile", *ROOT.glob("tools/make/*.mk")]
    targets = {target for path in makefiles
               for words in re.findall(r"^([a-z-]+(?: [a-z-]+)*):", path.read_text("utf-8"), re.M)
               for target in words.split()}
    named = set(re.findall(r"(?:`|^)(?:JP_SETUP=skip )?make ([a-z][a-z-]*)(?![\w/-])", text_of(name), re.M))
    assert named <= targets


def is_placeholder(path):
    return re.search(r"mine|name|<", path) is not None


@pytest.mark.parametrize("name", NAMES)
def test_paths_exist(name):
    for path in re.findall(r"`((?:include|src|hal|sim|tools|tests)/[\w./*-]+)`", text_of(name)):
        assert is_placeholder(path) or list(ROOT.glob(path)), path


@pytest.mark.parametrize("name", NAMES)
def test_programs_and_modules_exist(name):
    text = text_of(name)
    for program in re.findall(r"(?:`|^|build/bin/)(jp-[a-z-]+)\b", text, re.M):
        assert (ROOT / f"sim/programs/{program}.c").exists(), program
    for module in re.findall(r"\b-m (tools(?:\.\w+)+)", text):
        assert (ROOT / (module.replace(".", "/") + ".py")).exists(), module


@pytest.mark.parametrize("name", NAMES)
def test_options_exist(name):
    for line in shell_lines(name):
        program = re.match(r"(?:build/bin/)?(jp-[a-z-]+) ", line)
        source = program and "\n".join(path.read_text("utf-8") for path in ROOT.glob("sim/**/*.c"))
        for option in re.findall(r" --([a-z-]+)", line) if program else []:
            assert f'"{option}"' in source, line


def test_the_rooms_are_those_of_the_gate():
    rooms = yaml.safe_load(text_of("tests/gates/layers.yaml"))["rooms"]
    layers = {room: below for room, below in rooms.items() if room.startswith("src/")}
    rows = re.findall(r"^\| `(\w+/)` \|.*\| ([\w, ]*)\|$", text_of("src/README.md"), re.M)
    assert [f"src/{room[:-1]}" for room, _ in rows] == list(layers)
    for room, included in rows:
        if re.fullmatch(r"(\w+, )*\w+ |", included):
            assert [f"src/{name}" for name in included.strip().split(", ") if name] == layers[f"src/{room[:-1]}"], room


# ---- figures -------------------------------------------------------------------------------------------------------

def without_marks(name):
    """Text in which figures could only have been typed."""
    return BLOCK_MARK.sub("", VALUE_MARK.sub("", text_of(name)))


def without_spaces(text):
    """Between digits."""
    return re.sub(r"(?<=\d)[ \u202f](?=\d)", "", text)


def test_no_figure_is_typed_on_the_front_page():
    text = re.sub(r"^```.*?^```", "", without_marks("README.md"), flags=re.S | re.M)
    assert re.findall(r"\d[\d.,\u202f ]*(?:%|J|B|KiB|KB|×|instructions)(?![\w])", text) == []


@pytest.mark.parametrize("name", [name for name in NAMES if name != PAGE])
def test_no_figure_is_typed(name):
    """Nor a bar. Short ones could be anything; of some digits and with a unit it is one of the store's."""
    figures = [figure for figure in by_name(STORE, read_store(ROOT / STORE)).values() if figure["unit"]]
    shown = {measured(figure): 3 for figure in figures}
    shown |= {bar_value(figure): 4 for figure in figures if figure["bound"]}
    text = without_spaces(without_marks(name))
    assert [number for number, digits in shown.items() if len(re.sub(r"\D", "", number)) >= digits
            and re.search(rf"(?<![\w.]){re.escape(without_spaces(number))}(?!\w)", text)] == []
