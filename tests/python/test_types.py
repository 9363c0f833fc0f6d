"""Types and docstrings of the package: mypy in its strict mode finds nothing in it, and a known type wherever a program
uses it; each public name says what it is."""
import inspect
import os
import re
import subprocess
import sys

import joulepath
from conftest import BUILD, ROOT, SITE
from joulepath import door

USE = ROOT / "tests/python/typed_use.py"
WRONG = [("joulepath.Robot(3)", "arg-type"), ("joulepath.Robot('burger').cell_m + 'm'", "operator"),
         ("joulepath.Learner('gao2018', energy='heat')", "arg-type"), ("joulepath.drive('gao2018_short')", "arg-type"),
         ("assert_type(joulepath.patrol('hall').joules, int)", "assert-type")]
MODULES = (joulepath.tables, door)


def checked(*arguments):
    """What mypy says of the package as it is installed, but for the tools that it carries."""
    environment = dict(os.environ, MYPYPATH=str(SITE))
    command = [sys.executable, "-m", "mypy", "--config-file", ROOT / "tests/python/mypy.ini", "--cache-dir",
               BUILD / "python/mypy", *arguments]
    result = subprocess.run([str(part) for part in command], cwd=BUILD, env=environment, capture_output=True, text=True,
                            check=False, timeout=600)
    assert result.stderr == ""
    return result


def test_the_package_and_its_use_are_strictly_typed():
    """An Any is not the type that assert_type() asks for."""
    assert (SITE / "joulepath/py.typed").exists()
    result = checked(USE)
    assert result.returncode == 0, result.stdout


def test_wrong_uses_are_found(tmp_path):
    (tmp_path / "wrong.py").write_text("\n".join(["from typing import assert_type", "import joulepath",
                                                  *(use for use, _ in WRONG)]) + "\n")
    found = re.findall(r"wrong\.py:(\d+): error: .*\[([a-z-]+)\]", checked(tmp_path / "wrong.py").stdout)
    assert found == [(str(line), says) for line, (_, says) in enumerate(WRONG, 3)]


def test_all_that_is_public_is_in_the_use():
    """What a program can write: names of the package, members of its classes."""
    names = [*joulepath.__all__, *(name.rsplit(".", 1)[-1] for name, _ in public_objects() if "door" not in name)]
    names += [name for _, each in public_objects() if inspect.isclass(each) and each.__name__ in
              ("Plan", "Mission", "Patrol", "Navigation", "Balancer", "Identified") for name in each.__annotations__]
    text = USE.read_text()
    assert [name for name in names if not re.search(rf"\b{name}\b", text)] == []


def public_objects():
    """Classes and functions with their names, and what is public in classes."""
    for module in (joulepath, *MODULES):
        names = joulepath.__all__ if module is joulepath else [name for name in vars(module) if name[0] != "_"]
        for name in names:
            each = getattr(module, name)
            if not (inspect.isclass(each) or inspect.isfunction(each)) or (module is not joulepath and each.__module__ != module.__name__):
                continue
            yield f"{module.__name__}.{name}", each
            if inspect.isclass(each):
                yield from ((f"{module.__name__}.{name}.{member}", value) for member, value in vars(each).items()
                            if member[0] != "_" and (callable(value) or isinstance(value, property | classmethod)))


def test_every_public_name_says_what_it_is():
    silent = [name for name, each in public_objects() if not inspect.getdoc(each)]
    assert silent == []


def test_every_number_says_its_unit():
    """Where its name does not."""
    units = re.compile(r"\b(m|J|s|W|rad|kg|%|bytes|B)\b|m/s|degrees|share|how (often|many)|as of|cells|in units|whether|rise over")
    properties = [(name, each) for name, each in public_objects() if isinstance(each, property)]
    assert len(properties) > 20
    untold = [name for name, each in properties
              if inspect.signature(each.fget).return_annotation in ("float", "NDArray[numpy.float64]", "tuple[float, float]")
              and not units.search(inspect.getdoc(each)) and "coordinates" not in name]
    assert untold == []
