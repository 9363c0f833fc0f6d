"""Call graphs with the stack of each function: from gcc's -fcallgraph-info=su and from the disassembly of an image."""
import bisect
import re
from dataclasses import dataclass, field

from tools.common import ROOT, ToolError, read_text

INDIRECT = "__indirect_call"

NODE = re.compile(r'node: { title: "(?P<title>[^"]*)" label: "(?P<label>[^"]*)"')
EDGE = re.compile(r'edge: { sourcename: "(?P<source>[^"]*)" targetname: "(?P<target>[^"]*)"(?: label: "(?P<place>[^"]*)")?')
USAGE = re.compile(r"\\n(?P<bytes>\d+) bytes \((?P<kind>[a-z,]+)\)")
CALLED = re.compile(r"(?:\(\*+)?(?P<name>[A-Za-z_]\w*(?:(?:->|\.|\[[^]]*\])+[A-Za-z_]?\w*)*)\)?\s*\(")


@dataclass
class Function:
    """Bytes of its frame, None if there is no bound, and what it calls."""

    frame: int | None
    calls: set[str] = field(default_factory=set)
    indirect: list[str] = field(default_factory=list)  # places: file:line:column


def read_gcc(paths):
    """{name: Function} of gcc's .ci files; names of static functions begin with their file."""
    functions = {}
    for path in paths:
        text = read_text(path)
        for node in NODE.finditer(text):
            usage = USAGE.search(node["label"])
            if usage is None:
                continue  # another object defines it
            if usage["kind"] != "static":
                raise ToolError(f"{path}: {node['title']}: the size of its frame varies ({usage['kind']}): "
                                "no variable-length array, no alloca()")
            if node["title"] in functions:
                raise ToolError(f"{path}: {node['title']}: defined twice")
            functions[node["title"]] = Function(int(usage["bytes"]))
        for edge in EDGE.finditer(text):
            source = functions[edge["source"]]
            if edge["target"] != INDIRECT:
                source.calls.add(edge["target"])
            elif edge["place"] is None:
                raise ToolError(f"{path}: {edge['source']}: an indirect call without a place in the source")
            else:
                source.indirect.append(edge["place"])
    return functions


def called_expression(place, root=ROOT):
    """What is called at file:line:column, such as ecu.port.send."""
    name, line, column = place.rsplit(":", 2)
    lines = read_text(root / name).splitlines()
    if int(line) > len(lines):
        raise ToolError(f"{place}: no such line; build again")
    called = CALLED.match(lines[int(line) - 1], int(column) - 1)
    if called is None:
        raise ToolError(f"{place}: no call can be read there; build again, or call by a plain member or name")
    return re.sub(r"\[[^]]*\]", "", called["name"]).replace("->", ".")


def targets_of(expression, listed):
    """The listed targets of the longest end of the expression that is listed; None if there is none."""
    parts = expression.split(".")
    for i in range(len(parts)):
        if ".".join(parts[i:]) in listed:
            return listed[".".join(parts[i:])]
    return None


# ---- Disassembly ----------------------------------------------------------------------------------------------------

INSTRUCTION = re.compile(r"^\s*(?P<address>[0-9a-f]+):\t[0-9a-f ]+\t(?P<operation>\S+)"
                         r"(?:\t(?P<operands>[^@<;#\n]*(?:#-?\d+[^@<;\n]*)?))?")
TARGET = re.compile(r"\b(?P<address>[0-9a-f]+) <[^>]+>")
BRANCH = re.compile(r"b(?!ic|f[ci]|kpt)\w*(\.[nw])?|cbn?z|j|jal")
INDIRECT_BRANCH = re.compile(r"blx|jalr")

PUSH = re.compile(r"push(\.w)?|(stmdb|stmfd)(\.w)?(?= sp!)")
FLOAT_PUSH = re.compile(r"vpush|vstmdb(?= sp!)")


def registers(operands):
    """How many registers a list such as {r4, r5-r7, lr} holds."""
    count = 0
    for item in re.search(r"{([^}]*)}", operands)[1].split(","):
        ends = [int(number) for number in re.findall(r"\d+", item)]
        count += ends[1] - ends[0] + 1 if "-" in item else 1
    return count


def arm_growth(operation, operands):
    """Bytes by which an instruction grows the stack; None if that cannot be told."""
    text = f"{operation} {operands}"
    if PUSH.match(text):
        return 4 * registers(operands)
    if FLOAT_PUSH.match(text):
        return 8 * registers(operands)
    moved = re.search(r"\[sp, #-(\d+)\]!", operands)
    if moved:
        return int(moved[1])
    if not operands.startswith("sp,") or operation.startswith("cmp"):
        return 0
    constant = re.fullmatch(r"sp, (?:sp, )?#(\d+)\s*", operands)
    if constant is None:
        return None
    return {"sub": int(constant[1]), "add": 0}.get(operation[:3])


def riscv_growth(operation, operands):
    if not operands.startswith("sp,"):
        return 0
    constant = re.fullmatch(r"sp,sp,(-?\d+)\s*", operands)
    if operation in ("addi", "c.addi", "add") and constant:
        return max(0, -int(constant[1]))
    return None


GROWTH = {"arm": arm_growth, "riscv": riscv_growth}


def read_disassembly(text, machine, starts):
    """{name: Function} of the output of objdump -d; starts: {address: name}. A frame is the sum of all that its
    instructions push: an upper bound where no loop pushes. It is None where there is no bound."""
    functions = {name: Function(0) for name in starts.values()}
    addresses = sorted(starts)

    def name_at(address):
        index = bisect.bisect(addresses, int(address, 16)) - 1
        return starts[addresses[index]] if index >= 0 else None

    for line in text.splitlines():
        instruction = INSTRUCTION.match(line)
        name = name_at(instruction["address"]) if instruction else None
        if name:
            target = TARGET.search(line)
            add_instruction(functions[name], instruction, machine, name_at(target["address"]) if target else None)
    for name, function in functions.items():
        function.calls.discard(name)  # its own branches
    return functions


def add_instruction(function, instruction, machine, target):
    operation, operands = instruction["operation"], instruction["operands"] or ""
    growth = GROWTH[machine](operation, operands)
    if BRANCH.fullmatch(operation) and target:
        function.calls.add(target)
    elif INDIRECT_BRANCH.match(operation):
        growth = None
    if growth is None or function.frame is None:
        function.frame = None
    else:
        function.frame += growth
