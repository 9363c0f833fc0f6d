"""Who may include whom: prints one result a file in the format of Unity.

The rooms and their layers are in layers.yaml. An arrow that runs up, a circle of files, an include that is not written
from the root, and in the core a header that is not its own nor of a free-standing C library fail.
"""
import re
import sys
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]+([<"])([^>"]+)[>"]', re.M)
PUBLIC = "include/joulepath"
# A free-standing C library's, float.h for single precision, and the compiler's for the DSP instructions.
CORE_SYSTEM = {"arm_acle.h", "float.h", "stdbool.h", "stddef.h", "stdint.h", "string.h"}
# Made by cantools, which writes the name alone.
GENERATED = {"hal/can/jp_can.c"}


def room_of(path, homes):
    """The room of a file; that of a public header holds the module of its name."""
    if path.startswith(PUBLIC + "/"):
        return homes.get(Path(path).stem, "src/base")
    return path.rpartition("/")[0]


def includes_of(path, text):
    """(line, system header or None, path from the root or None) of each include."""
    for match in INCLUDE.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        kind, name = match.groups()
        if kind == "<" and name.startswith("joulepath/"):
            yield line, None, f"include/{name}"
        elif kind == "<":
            yield line, name, None
        elif path in GENERATED:
            yield line, None, f"{path.rpartition('/')[0]}/{name}"
        else:
            yield line, None, name


def problems_of(path, text, layers, homes, known):
    """What is wrong with the includes of one file: (line, reason)."""
    room = room_of(path, homes)
    is_core = path.startswith(("src/", "include/"))
    allowed = {room, *layers[room]}
    for line, system, target in includes_of(path, text):
        if system is not None:
            if is_core and system not in CORE_SYSTEM:
                yield line, f"<{system}> is not allowed in the core"
        elif target not in known:
            yield line, f'"{target}" is not a path from the root'
        elif target.startswith(PUBLIC + "/"):
            above = room_of(target, homes)
            if is_core and above not in allowed:
                yield line, f"{room} may not include {above}: {target}"
        elif target.rpartition("/")[0] not in allowed:
            yield line, f"{room} may not include {target}"


def circles(graph):
    """{file: the circle of includes that it begins}."""
    found, done = {}, set()

    def visit(path, trail):
        if path in trail:
            circle = trail[trail.index(path):]
            found.setdefault(min(circle), [*circle, path])
        elif path not in done:
            for target in graph.get(path, ()):
                visit(target, [*trail, path])
            done.add(path)

    for path in graph:
        visit(path, [])
    return found


def module_circles(graph):
    """The same for modules: a module is a source with its header."""
    modules = {}
    for path, targets in graph.items():
        modules.setdefault(path.rpartition(".")[0], set()).update(target.rpartition(".")[0] for target in targets)
    for module, targets in modules.items():
        targets.discard(module)
    return circles(modules)


def homes_of(paths):
    """{module: room} of the core, by its sources and by the headers that declare parts of them."""
    return {Path(path).stem: path.rpartition("/")[0] for path in paths if path.startswith("src/")}


def check(files, layers, public_homes):
    """{path: problems} of {path: text}."""
    homes = {**homes_of(files), **public_homes}
    results = {path: list(problems_of(path, text, layers, homes, files)) for path, text in files.items()}
    graph = {path: [target for _, _, target in includes_of(path, text) if target in files] for path, text in files.items()}
    for name, circle in {**circles(graph), **module_circles(graph)}.items():
        path = name if name in files else next(file for file in files if file.rpartition(".")[0] == name)
        results[path].append((1, f"circle: {' -> '.join(circle)}"))
    return results


def main():
    settings = yaml.safe_load((Path(__file__).parent / "layers.yaml").read_text(encoding="utf-8"))
    paths = sorted(path.relative_to(ROOT).as_posix() for top in ("include", "src", "hal", "sim")
                   for path in (ROOT / top).rglob("*.[ch]"))
    files = {path: (ROOT / path).read_text(encoding="utf-8") for path in paths}
    results = check(files, settings["rooms"], settings["public_headers"])
    failed = 0
    for path, problems in results.items():
        if not problems:
            print(f"{path}:1:includes:PASS")
        for line, reason in problems:
            print(f"{path}:{line}:includes:FAIL: {reason}")
            failed += 1
    passed = sum(not problems for problems in results.values())
    print(f"\n-----------------------\n{passed + failed} Tests {failed} Failures 0 Ignored \n{'FAIL' if failed else 'OK'}")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
