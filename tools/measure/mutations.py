"""The mutants of a C source: small faults, one at a time, as a person might make them.

Operators: arithmetic (+ -, * /, % *, << >>, & |, ^ &, and their assignments), relational (the boundary and the opposite),
logical (&& ||), negation (of a condition without comparison, ! and - and ~ left out, ++ --), constant (a whole number by
one more, one less and none; the value of a macro by none), statement (a call, an assignment, break, continue or return
left out) and return (none instead of the value, or one instead of none; the opposite of what is true or false).

Clang's syntax tree says where. What stands in the arguments of a macro or comes out of one is left as it is. A mutant is
known by its file, its function, the code of the statement or condition, and what becomes of it; not by its line.
"""
import re
from dataclasses import dataclass

from clang import cindex
from clang.cindex import CursorKind, TypeKind

from tools.common import ToolError
from tools.measure.proof_rooms import one_line

OPPOSITES = {
    "+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "<<": ">>", ">>": "<<", "&": "|", "|": "&", "^": "&",
    "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "%=": "*=", "<<=": ">>=", ">>=": "<<=", "&=": "|=", "|=": "&=",
    "^=": "&="}
COMPARISONS = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",)}
LOGICAL = {"&&": "||", "||": "&&"}
SIGNS = ("!", "-", "~")
STEPS = {"++": "--", "--": "++"}
WHOLE = re.compile(r"(0[xX][0-9a-fA-F]+|\d+)([uUlL]*)")
REAL = re.compile(r"(\d+\.\d*|\.\d+)(?:[eE][-+]?\d+)?[fF]?")
DEFINITION = re.compile(r"^#define[ \t]+(\w+)[ \t]+((?:[^\n\\]|\\\n)+)$", re.M)
COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.S)
TRUTH = {"true": "false", "false": "true"}
LEFT_OUT = (CursorKind.BREAK_STMT, CursorKind.CONTINUE_STMT)
BODIES = (CursorKind.COMPOUND_STMT, CursorKind.CASE_STMT, CursorKind.DEFAULT_STMT)
CONDITIONED = (CursorKind.IF_STMT, CursorKind.WHILE_STMT, CursorKind.SWITCH_STMT)
WHOLE_KINDS = {TypeKind.INT, TypeKind.UINT, TypeKind.LONG, TypeKind.ULONG, TypeKind.LONGLONG, TypeKind.ULONGLONG,
               TypeKind.SHORT, TypeKind.USHORT, TypeKind.SCHAR, TypeKind.UCHAR, TypeKind.CHAR_S, TypeKind.ENUM}
REAL_KINDS = {TypeKind.FLOAT, TypeKind.DOUBLE}


@dataclass(frozen=True)
class Mutant:
    """Bytes `start` to `end` of a file become `text`. Its lines are in `scope`, the lines of a function, if in any."""

    file: str
    function: str
    operator: str
    code: str
    becomes: str
    lines: range
    scope: range | None
    start: int
    end: int
    text: bytes

    def name(self):
        return self.file, self.function, self.code, self.becomes

    def applied(self, source):
        return source[:self.start] + self.text + source[self.end:]


@dataclass(frozen=True)
class Place:
    """The function, or what else has a name, and the piece of code that a mutant is known by."""

    function: str
    scope: range | None
    start: int
    end: int

    def between(self, start, end):
        return Place(self.function, self.scope, start, end)

    def narrowed(self, cursor):
        return self.between(cursor.extent.start.offset, cursor.extent.end.offset)


def parse(path, flags):
    unit = cindex.Index.create().parse(str(path), args=[*flags, "-w"])
    errors = [str(problem) for problem in unit.diagnostics if problem.severity >= cindex.Diagnostic.Error]
    if errors:
        raise ToolError(f"{path}: {errors[0]}")
    return unit


def mutants_of(name, path, flags):
    """All mutants of a source, in its order."""
    finder = Finder(name, path.read_bytes())
    for top in parse(path, flags).cursor.get_children():
        if top.location.file and top.location.file.name == str(path):
            finder.visit_top(top)
    finder.visit_macros()
    return numbered(sorted(finder.found.values(), key=lambda mutant: (mutant.start, mutant.end, mutant.becomes)))


def numbered(mutants):
    """Of those that are known by the same, each but the first bears its number."""
    seen = {}
    for mutant in mutants:
        count = seen[mutant.name()] = seen.get(mutant.name(), 0) + 1
        if count > 1:
            mutant = Mutant(**{**mutant.__dict__, "becomes": f"{mutant.becomes} ({count})"})
        yield mutant


class Finder:
    """Walks over a syntax tree."""

    def __init__(self, name, source):
        self.name = name
        self.source = source
        self.found = {}

    def text(self, start, end):
        return self.source[start:end].decode()

    def of(self, cursor):
        return self.text(cursor.extent.start.offset, cursor.extent.end.offset)

    def add(self, place, operator, start, end, text):
        before, after = self.text(place.start, start), self.text(end, place.end)
        code, becomes = one_line(self.text(place.start, place.end)), one_line(before + text + after)
        if code == becomes or (start, end, text) in self.found:
            return
        self.found[start, end, text] = Mutant(self.name, place.function, operator, code, becomes,
                                              self.lines(place.start, place.end), place.scope, start, end, text.encode())

    def lines(self, start, end):
        return range(self.source.count(b"\n", 0, start) + 1, self.source.count(b"\n", 0, end) + 2)

    # ---- Where -------------------------------------------------------------------------------------------------------

    def visit_top(self, cursor):
        if cursor.kind == CursorKind.FUNCTION_DECL and cursor.is_definition():
            for child in cursor.get_children():
                if child.kind == CursorKind.COMPOUND_STMT:
                    start, end = child.extent.start.offset, child.extent.end.offset
                    self.visit(child, Place(cursor.spelling, self.lines(start, end), start, end))
        elif cursor.kind == CursorKind.VAR_DECL:
            self.visit(cursor, Place(cursor.spelling, None, cursor.extent.start.offset, cursor.extent.end.offset))

    def visit(self, cursor, place):
        """What is to be found in a cursor, and then in what it holds."""
        kind = cursor.kind
        children = list(cursor.get_children())
        if kind in (CursorKind.BINARY_OPERATOR, CursorKind.COMPOUND_ASSIGNMENT_OPERATOR):
            self.binary(children, place)
        elif kind == CursorKind.UNARY_OPERATOR:
            self.unary(cursor, place)
        elif kind == CursorKind.INTEGER_LITERAL:
            self.constant(cursor, place)
        elif kind == CursorKind.FLOATING_LITERAL:
            self.real_constant(cursor, place)
        elif kind == CursorKind.RETURN_STMT:
            self.returned(cursor, children, place)
        elif kind == CursorKind.CONDITIONAL_OPERATOR:
            self.negated(children[0], place)
        if kind in BODIES:
            for child in children if kind == CursorKind.COMPOUND_STMT else children[-1:]:
                self.left_out(child, place)
        self.visit_inside(cursor, children, place)

    def visit_inside(self, cursor, children, place):
        kind = cursor.kind
        if kind in CONDITIONED and children:
            if kind != CursorKind.SWITCH_STMT:
                self.negated(children[0], place.narrowed(children[0]))
            self.visit(children[0], place.narrowed(children[0]))
            children = children[1:]
        elif kind == CursorKind.FOR_STMT:
            head = place.between(cursor.extent.start.offset, children[-1].extent.start.offset)
            for child in children[:-1]:
                self.visit(child, head)
            children = children[-1:]
        elif kind == CursorKind.CASE_STMT:
            children = children[1:]
        elif kind == CursorKind.VAR_DECL:
            value = cursor.extent.start.offset + self.of(cursor).find("=")
            children = [child for child in children if child.extent.start.offset > value > cursor.extent.start.offset]
        for child in children:
            narrow = kind in BODIES or child.kind == CursorKind.INIT_LIST_EXPR
            self.visit(child, place.narrowed(child) if narrow else place)

    # ---- What --------------------------------------------------------------------------------------------------------

    def binary(self, children, place):
        found = self.operator_between(children) if len(children) == 2 else None
        if not found:
            return
        operator, start = found
        end = start + len(operator)
        if operator in OPPOSITES:
            self.add(place, "arithmetic", start, end, OPPOSITES[operator])
        for other in COMPARISONS.get(operator, ()):
            self.add(place, "relational", start, end, other)
        if operator in LOGICAL:
            self.add(place, "logical", start, end, LOGICAL[operator])
            for child in children:
                self.negated(child, place)

    def operator_between(self, children):
        """(operator, where), if it is written there and does not come out of a macro."""
        start, end = children[0].extent.end.offset, children[1].extent.start.offset
        between = COMMENT.sub(lambda match: " " * len(match[0]), self.text(start, end))
        operator = between.strip(" \t\n()")
        if start >= end or operator not in {*OPPOSITES, *COMPARISONS, *LOGICAL}:
            return None
        return operator, start + between.index(operator)

    def unary(self, cursor, place):
        start, end, text = cursor.extent.start.offset, cursor.extent.end.offset, self.of(cursor)
        for step, other in STEPS.items():
            if text.startswith(step):
                self.add(place, "negation", start, start + 2, other)
            elif text.endswith(step):
                self.add(place, "negation", end - 2, end, other)
        if text.startswith(SIGNS) and not text.startswith("--"):
            self.add(place, "negation", start, start + 1, "")

    def comparison(self, cursor):
        """Whether other mutants already turn this condition round."""
        while cursor.kind in (CursorKind.PAREN_EXPR, CursorKind.UNEXPOSED_EXPR):
            inner = list(cursor.get_children())
            if len(inner) != 1:
                return False
            cursor = inner[0]
        if cursor.kind == CursorKind.UNARY_OPERATOR:
            return self.of(cursor).startswith("!")
        if cursor.kind != CursorKind.BINARY_OPERATOR:
            return False
        found = self.operator_between(list(cursor.get_children()))
        return bool(found) and (found[0] in COMPARISONS or found[0] in LOGICAL)

    def negated(self, cursor, place):
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        if start < end and not self.comparison(cursor):
            self.add(place, "negation", start, end, f"!({self.text(start, end)})")

    def constant(self, cursor, place):
        text = self.of(cursor)
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        if text in TRUTH:
            self.add(place, "constant", start, end, TRUTH[text])
        for other in other_numbers(text):
            self.add(place, "constant", start, end, other)

    def real_constant(self, cursor, place):
        text = self.of(cursor)
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        if REAL.fullmatch(text):
            suffix = "f" if text[-1] in "fF" else ""
            for other in ("0.0", f"({text} + 1.0{suffix})"):
                self.add(place, "constant", start, end, other if other.startswith("(") else other + suffix)

    def left_out(self, cursor, place):
        """A statement, if it is one that can be."""
        is_return = cursor.kind == CursorKind.RETURN_STMT and not list(cursor.get_children())
        if not (cursor.kind.is_expression() or cursor.kind in LEFT_OUT or is_return):
            return
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        if start < end and self.source[end:].lstrip()[:1] == b";":
            self.add(place.between(start, end), "statement", start, end, "(void)0")

    def returned(self, cursor, children, place):
        if not children:
            return
        value = children[0]
        start, end = value.extent.start.offset, value.extent.end.offset
        function_type = self.result_type(cursor, value)
        if start < end:
            other = other_value(function_type, self.text(start, end))
            if other is not None and not (other.startswith("!") and self.comparison(value)):
                self.add(place, "return", start, end, other)

    @staticmethod
    def result_type(cursor, value):
        parent = cursor.semantic_parent
        return (parent.result_type if parent and parent.kind == CursorKind.FUNCTION_DECL else value.type).get_canonical()

    def visit_macros(self):
        """Constants that the source gives a name; those that use them are judged by."""
        for match in DEFINITION.finditer(self.source.decode()):
            start = len(self.source.decode()[:match.start(2)].encode())
            body = COMMENT.sub("", match[2]).rstrip()
            if '"' in body or body.startswith("{") or not body:
                continue
            end = start + len(body.encode())
            place = Place(match[1], None, start, end)
            for other in other_numbers(body) or ["0"]:
                self.add(place, "constant", start, end, other)


def other_numbers(text):
    """One more, one less and none, of a whole number as it is written."""
    match = WHOLE.fullmatch(text)
    if not match:
        return []
    value = int(match[1], 8 if re.fullmatch(r"0\d+", match[1]) else 0)
    return [f"{other}{match[2]}" for other in sorted({value + 1, value - 1, 0} - {value, -1})]


def other_value(kind, text):
    """What a function gives back instead, or None."""
    if kind.kind == TypeKind.BOOL:
        return f"!({text})"
    if kind.kind == TypeKind.POINTER:
        return "((void *)0)" if text != "NULL" else None
    if kind.kind in WHOLE_KINDS | REAL_KINDS:
        return "1" if text in ("0", "0U", "JP_OK", "0.0f", "0.0") else "0"
    if kind.kind == TypeKind.RECORD and kind.spelling.startswith("struct "):
        return f"({kind.spelling}){{0}}"
    return None
