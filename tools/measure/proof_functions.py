"""Which public functions the proof reaches: those that the analyser interprets in some driver.

Public is what an object of the libraries defines and a header declares that other rooms may include; what cantools makes
is left out. tests/proof/functions.yaml holds both lists, header by header: a new function is in neither.
"""
import re
import subprocess

import yaml

from tools.common import ROOT, ToolError, read_text

FUNCTIONS = ROOT / "tests/proof/functions.yaml"
HEADERS = ("include/joulepath/*.h", "hal/*.h", "hal/app/*.h", "hal/can/*.h", "hal/storage/*.h")
GENERATED = ("hal/can/jp_can.h",)
HEADING = """# Public functions of the rooms in integers: those that a driver of the proof reaches, and those that none does; each of
# these is a task. Written by `make prove RECORD=1`; `make prove` fails where it is not true.
"""
DECLARED = re.compile(r"^[a-z][\w *]*?\b(jp_\w+)\(", re.M)


def public_functions(libraries, root=ROOT):
    """{function: header}."""
    defined = {name for library in libraries for name in defined_in(library)}
    public = {}
    for header in headers(root):
        for name in DECLARED.findall(without_comments(read_text(root / header))):
            if name in defined:
                public.setdefault(name, header)
    return public


def headers(root):
    found = sorted(path.relative_to(root).as_posix() for pattern in HEADERS for path in root.glob(pattern))
    return [header for header in found if header not in GENERATED]


def without_comments(text):
    return re.sub(r"/\*.*?\*/", " ", text, flags=re.S)


def defined_in(library):
    listed = subprocess.run(["nm", "--defined-only", "--format=posix", library], capture_output=True, text=True,
                            check=False)
    if listed.returncode != 0:
        raise ToolError(f"{library}: {listed.stderr.strip()}")
    return [line.split()[0] for line in listed.stdout.splitlines() if " T " in line]


def read_functions(path=FUNCTIONS):
    """(reached, not reached): sets of functions."""
    lists = yaml.safe_load(read_text(path))
    return tuple({name for names in (lists[key] or {}).values() for name in names} for key in ("reached", "not_reached"))


def write_functions(public, reached, path=FUNCTIONS):
    lines = [HEADING]
    for key, chosen in (("reached", public.keys() & reached), ("not_reached", public.keys() - reached)):
        lines.append(f"{key}:\n" if chosen else f"{key}: {{}}\n")
        for header in sorted({public[name] for name in chosen}):
            names = sorted(name for name in chosen if public[name] == header)
            lines.append(f"  {header}:\n" + "".join(f"  - {name}\n" for name in names))
    path.write_text("".join(lines), encoding="utf-8")


def problems(public, reached, path=FUNCTIONS):
    """Sentences: what the list says and is not so."""
    listed, missing = read_functions(path)
    for name in sorted(public.keys() - listed - missing):
        yield f"{public[name]}: {name}: is not in {path.name}"
    for name in sorted((listed | missing) - public.keys()):
        yield f"{path.name}: {name}: no header declares it any more"
    for name in sorted((listed & public.keys()) - reached):
        yield f"{path.name}: {name}: no driver reaches it any more"
    for name in sorted(missing & reached):
        yield f"{path.name}: {name}: a driver reaches it now"
