"""Control-flow graphs of functions of ARMv7-M, from the output of objdump -d, and the longest way through them."""
import re
from dataclasses import dataclass, field

from tools.common import ToolError

LABEL = re.compile(r"^([0-9a-f]+) <(.+)>:$")
LINE = re.compile(r"^\s*([0-9a-f]+):\t([0-9a-f ]+?)\s*\t(\S+)(?:\t([^;@]*))?")
TARGET = re.compile(r"([0-9a-f]+) <([^>+]+)(\+0x[0-9a-f]+)?>")
CONDITION = "(?:eq|ne|cs|cc|hs|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)"
CONDITIONAL = re.compile(rf"b{CONDITION}(\.[nw])?|cbn?z")
LINKED = re.compile(r"blx?(\.[nw])?")
JUMP = re.compile(r"b(\.[nw])?")
IN_BLOCK = re.compile(rf"(b|bx|pop|ldmia|ldr){CONDITION}(\.[nw])?")  # within an IT block
CONSTANT = re.compile(r"movs?(?:\.w)? r2, #(\d+)")
TABLE = re.compile(r"tb[bh]")
DATA = (".word", ".short", ".byte")


@dataclass
class Instruction:
    address: int
    operation: str
    operands: str
    target: int | None
    cases: list = field(default_factory=list)  # of a jump by a table


@dataclass
class Block:
    """A run of instructions, what follows it, and what it calls: addresses, None for a pointer. `size`: the constant in
    r2 at its last call, None if it is none."""

    weight: int = 0
    size: int | None = None
    calls: list = field(default_factory=list)
    follows: set = field(default_factory=set)


@dataclass
class Loop:
    """By the address of its header: blocks, and the cost of one turn is to be found."""

    header: int
    blocks: set


def read_functions(text):
    """({address: name}, {address: [Instruction]}) of the output of objdump -d. Static functions of several sources may
    share a name."""
    names, functions, current, data = {}, {}, None, {}
    for line in text.splitlines():
        label = LABEL.match(line)
        if label:
            start = int(label[1], 16)
            names[start], current = label[2], functions.setdefault(start, [])
            continue
        found = LINE.match(line)
        if found is None or current is None:
            continue
        if found[3] in DATA:
            number = bytes.fromhex(found[2].replace(" ", ""))[::-1]
            data.update({int(found[1], 16) + i: byte for i, byte in enumerate(number)})
        else:
            target = TARGET.search(line)
            current.append(Instruction(int(found[1], 16), found[3], (found[4] or "").strip(),
                                       int(target[1], 16) if target else None))
    functions = {start: body for start, body in functions.items() if body}
    for body in functions.values():
        add_tables(body, data)
    return names, functions


def add_tables(body, data):
    """To jumps by a table where they may lead: the table follows the instruction. Its last byte may be none of it: it
    leads to no instruction then."""
    for instruction in body:
        if TABLE.fullmatch(instruction.operation):
            width = 1 if instruction.operation == "tbb" else 2
            start = at = instruction.address + 4
            while all(at + i in data for i in range(width)):
                instruction.cases.append(start + 2 * int.from_bytes(bytes(data[at + i] for i in range(width)), "little"))
                at += width


def leaves(instruction):
    """Whether it returns."""
    operation, operands = instruction.operation, instruction.operands
    return (re.match(r"bx", operation) is not None and operands.startswith("lr")
            or re.match(r"(pop|ldmia)", operation) is not None and "pc" in operands
            or re.match(r"ldr", operation) is not None and operands.startswith("pc"))


class Graph:
    """Of a function: blocks by address."""

    def __init__(self, name, instructions, names):
        self.name = name
        self._names = names
        self._first = {instruction.address: i for i, instruction in enumerate(instructions)}
        self._instructions = instructions
        self.entry = instructions[0].address
        self.blocks = {}
        self._build()

    def _inside(self, address):
        return address in self._first

    def _build(self):
        leaders = {self.entry}
        for i, instruction in enumerate(self._instructions):
            if self._ends(instruction) or LINKED.fullmatch(instruction.operation):
                leaders |= set(self._follows(i)) if self._ends(instruction) else set()
                if i + 1 < len(self._instructions):
                    leaders.add(self._instructions[i + 1].address)
        block = None
        for i, instruction in enumerate(self._instructions):
            if instruction.address in leaders:
                if block is not None and not self._ends(self._instructions[i - 1]):
                    block.follows.add(instruction.address)
                block = self.blocks.setdefault(instruction.address, Block())
            block.weight += 1
            if re.search(r"\br2\b", instruction.operands):
                constant = CONSTANT.fullmatch(f"{instruction.operation} {instruction.operands}")
                block.size = int(constant[1]) if constant else None
            self._add_call(block, instruction)
            if self._ends(instruction):
                block.follows |= set(self._follows(i))

    def _ends(self, instruction):
        operation = instruction.operation
        return bool(CONDITIONAL.fullmatch(operation) or JUMP.fullmatch(operation) or TABLE.fullmatch(operation)
                    or leaves(instruction) or operation.startswith("bx"))

    def _follows(self, i):
        """Addresses within the function."""
        instruction = self._instructions[i]
        operation = instruction.operation
        falls = [self._instructions[i + 1].address] if i + 1 < len(self._instructions) else []
        if TABLE.fullmatch(operation):
            if not instruction.cases:
                raise ToolError(f"{self.name}: no table follows the jump at {instruction.address:x}")
            return [case for case in instruction.cases if self._inside(case)]
        if leaves(instruction) or operation.startswith("bx"):
            return falls if re.search(rf"{CONDITION}(\.[nw])?$", operation) and IN_BLOCK.fullmatch(operation) else []
        inside = [instruction.target] if instruction.target is not None and self._inside(instruction.target) else []
        return inside + falls if CONDITIONAL.fullmatch(operation) else inside

    def _add_call(self, block, instruction):
        operation = instruction.operation
        if LINKED.fullmatch(operation):
            block.calls.append(instruction.target)
            if instruction.target is not None and instruction.target not in self._names:
                raise ToolError(f"{self.name}: calls into the middle of a function at {instruction.address:x}")
        elif operation.startswith("bx") and not instruction.operands.startswith("lr"):
            block.calls.append(None)
        elif (JUMP.fullmatch(operation) or CONDITIONAL.fullmatch(operation)) and not self._inside(instruction.target):
            if instruction.target not in self._names:
                raise ToolError(f"{self.name}: jumps into the middle of a function at {instruction.address:x}")
            block.calls.append(instruction.target)

    def loops(self):
        """Addresses of the headers of all loops, in order."""
        return sorted(loop.header for loop in find_loops(self.blocks, self.entry, set(self.blocks)))

    def calls(self):
        return {called for block in self.blocks.values() for called in block.calls}

    def worst(self, cost_of, bounds, without=frozenset()):
        """Instructions of the longest way that calls nothing of `without`, 0 if there is none. cost_of(block): of it
        with its calls; bounds: {header: turns}."""
        kept = self._leading_out({address for address, block in self.blocks.items() if not without & set(block.calls)})
        if self.entry not in kept:
            return 0
        costs = {address: cost_of(self.blocks[address]) for address in kept}
        return longest(self.blocks, costs, self.entry, kept, bounds)

    def _leading_out(self, kept):
        """Those of the blocks from which a way leads out of the function through them alone."""
        before = {address: {other for other in kept if address in self.blocks[other].follows} for address in kept}
        out = [address for address in kept if not self.blocks[address].follows]
        found = set(out)
        while out:
            new = before[out.pop()] - found
            found |= new
            out += new
        return found


# ---- Loops ----------------------------------------------------------------------------------------------------------


def components(blocks, within):
    """Strongly connected ones by Tarjan, without recursion; each after those it leads to."""
    index, low, on_stack, stack, result = {}, {}, set(), [], []
    for root in sorted(within):
        if root in index:
            continue
        work = [(root, iter(sorted(blocks[root].follows & within)))]
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        while work:
            node, following = work[-1]
            for after in following:
                if after not in index:
                    index[after] = low[after] = len(index)
                    stack.append(after)
                    on_stack.add(after)
                    work.append((after, iter(sorted(blocks[after].follows & within))))
                    break
                if after in on_stack:
                    low[node] = min(low[node], index[after])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    component = set()
                    while node not in component:
                        last = stack.pop()
                        on_stack.discard(last)
                        component.add(last)
                    result.append(component)
    return result


def is_loop(blocks, component):
    return len(component) > 1 or any(node in blocks[node].follows for node in component)


def header_of(blocks, component, entry, within):
    """The one block by which the component is entered."""
    entries = {node for node in component if node == entry
               or any(node in blocks[other].follows for other in within - component)}
    if len(entries) != 1:
        raise ToolError(f"a loop at {min(component):x} is entered at {len(entries)} places")
    return entries.pop()


def without_back_edges(blocks, component, header):
    return {node: Block(follows=(blocks[node].follows & component) - {header}) for node in component}


def find_loops(blocks, entry, within):
    for component in components(blocks, within):
        if is_loop(blocks, component):
            header = header_of(blocks, component, entry, within)
            yield Loop(header, component)
            yield from find_loops(without_back_edges(blocks, component, header), header, component)


def longest(blocks, costs, entry, within, bounds):
    """Cost of the longest way from the entry within these blocks; each loop counts its bound times its longest turn."""
    worst = {}
    for component in components(blocks, within):
        if is_loop(blocks, component):
            header = header_of(blocks, component, entry, within)
            turn = longest(without_back_edges(blocks, component, header), costs, header, component, bounds)
            own = bounds[header] * turn
        else:
            (node,) = component
            own = costs[node]
        after = {other for node in component for other in blocks[node].follows & within} - component
        most = own + max((worst[other] for other in after), default=0)
        worst.update(dict.fromkeys(component, most))
    return worst[entry]
