"""A robot file with other numbers; comments and everything else stay."""
import re

from tools.common import ToolError

DIGITS = 5
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


def number(value):
    """With a point, as libconfig tells numbers from whole ones."""
    text = f"{value:.{DIGITS}g}"
    return text if any(mark in text for mark in ".e") else text + ".0"


def rewritten(source, text, values):
    """The text with the values by "group.key". ToolError: a key is not in it as a number of its own line."""
    lines, group, left = text.splitlines(keepends=True), None, dict(values)
    for index, line in enumerate(lines):
        code = line.split("#")[0].split("//")[0]
        begun = re.match(r"\s*(\w+)\s*[:=]\s*\{", code)
        if begun:
            group = begun[1]
        for key in [key for key in left if key.split(".")[0] == group]:
            found = re.search(rf"(\b{key.split('.')[1]}\s*[=:]\s*)({NUMBER})", code)
            if found:
                lines[index] = line[:found.start(2)] + number(left.pop(key)) + line[found.end(2):]
                code = lines[index].split("#")[0]
                line = lines[index]
        if "}" in code:
            group = None
    if left:
        raise ToolError(f"{source}: {next(iter(left))}: not found as a number, so it cannot be corrected there")
    return "".join(lines)
