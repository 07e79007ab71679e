"""Mutants of SystemVerilog: places in a module where something else could stand.

All are written into one text, each as a choice by a number (mutant schemata, Untch, Offutt and
Harrold 1993), so that one translation has them all and a run chooses. What is mutated is what works
at run time: operators, conditions, literals and assignments of processes, continuous assignments,
functions and ports; not what fixes widths and sizes, which would change every type around it.
"""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pyslang import syntax

# Each operator with those that may stand in its place: same operands, and a result as wide.
OPERATORS = {
    "+": ["-"],
    "-": ["+"],
    "*": ["+"],
    "&&": ["||"],
    "||": ["&&"],
    "&": ["|", "^"],
    "|": ["&", "^"],
    "^": ["|", "&"],
    "==": ["!="],
    "!=": ["=="],
    "<": ["<=", ">="],
    "<=": ["<", ">"],
    ">": [">=", "<="],
    ">=": [">", "<"],
    "<<": [">>"],
    ">>": ["<<"],
    "<<<": [">>"],
    ">>>": ["<<"],
}
UNARY_OPERATORS = {"!": "", "~": "", "-": "", "|": "&", "&": "|"}
LITERALS = {
    "IntegerVectorExpression",
    "IntegerLiteralExpression",
    "UnbasedUnsizedLiteralExpression",
}
# A literal without a width has that of what it stands beside, also in a choice.
OTHER_LITERAL = {"1'b0": "1'b1", "1'b1": "1'b0", "'0": "'1", "'1": "'0"}
# Whose text stays as it is, with all that is in it: types, sizes, constants and names.
CONSTANT = {
    "ParameterDeclaration",
    "ParameterDeclarationStatement",
    "ParameterPortList",
    "ParameterValueAssignment",
    "AnsiPortList",
    "ImplicitType",
    "LogicType",
    "NamedType",
    "VariableDimension",
    "GenvarDeclaration",
    "TypedefDeclaration",
    "PackageDeclaration",
    "ElabSystemTask",
    "FunctionPrototype",
    "EventControlWithExpression",
}
GENERATED = {"GenerateBlock", "ElseClause"}
ASSIGNMENTS = {"NonblockingAssignmentExpression", "AssignmentExpression"}


@dataclass(frozen=True)
class Mutant:
    file: str
    line: int
    what: str  # the operator that made it
    before: str
    after: str
    source_line: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.what}: `{self.before}` becomes `{self.after}`"


def explanation(mutant: Mutant, reasons: list[dict[str, str]]) -> dict[str, str] | None:
    """The entry that speaks of it; by its text and its line's, as numbers of lines change."""
    for reason in reasons:
        if (
            reason["file"] == mutant.file
            and reason["before"] == mutant.before
            and reason["after"] == mutant.after
            and reason["line"] == mutant.source_line
        ):
            return reason
    return None


def entry(mutant: Mutant) -> str:
    """What its entry in a file of reasons begins with."""
    keys = {"file": mutant.file, "line": mutant.source_line}
    keys |= {"before": mutant.before, "after": mutant.after}
    # A string of JSON is one of TOML, too.
    return "\n".join(["[[survivor]]", *(f"{key} = {json.dumps(keys[key])}" for key in keys)])


def _kind(node: syntax.SyntaxNode) -> str:
    return str(node.kind).removeprefix("SyntaxKind.")


def _children(node: syntax.SyntaxNode) -> Iterator[syntax.SyntaxNode]:
    for child in node:
        if isinstance(child, syntax.SyntaxNode):
            yield child


def _span(node: syntax.SyntaxNode) -> tuple[int, int]:
    return node.sourceRange.start.offset, node.sourceRange.end.offset


class Module:
    """A file of SystemVerilog, and its mutants."""

    def __init__(self, path: Path) -> None:
        self.name = path.name
        self.text = path.read_text()
        self._bytes = self.text.encode()
        # Kept: the nodes live in it.
        self._tree = syntax.SyntaxTree.fromFile(str(path))
        self._found: list[tuple[Mutant, syntax.SyntaxNode, str]] = []
        self._walk(self._tree.root, runs=False)

    @property
    def mutants(self) -> list[Mutant]:
        return [mutant for mutant, _, _ in self._found]

    def _source(self, node: syntax.SyntaxNode) -> str:
        begin, end = _span(node)
        return self._bytes[begin:end].decode()

    def _add(self, node: syntax.SyntaxNode, what: str, after: str) -> None:
        begin, _ = _span(node)
        line = self._bytes[:begin].count(b"\n") + 1
        one_line = re.sub(r"\s+", " ", self._source(node))
        shown = re.sub(r"\s+", " ", after)
        source_line = self.text.splitlines()[line - 1].strip()
        mutant = Mutant(self.name, line, what, one_line, shown, source_line)
        self._found.append((mutant, node, after))

    def _walk(self, node: syntax.SyntaxNode, runs: bool) -> None:
        kind = _kind(node)
        if kind in CONSTANT:
            return
        runs = runs or kind in {
            "AlwaysFFBlock",
            "AlwaysCombBlock",
            "ContinuousAssign",
            "NetDeclaration",
            "FunctionDeclaration",
            "TaskDeclaration",
            "NamedPortConnection",
        }
        if runs:
            self._mutate(node, kind)
        for child in self._working_children(node, kind):
            self._walk(child, runs)

    def _working_children(self, node: syntax.SyntaxNode, kind: str) -> Iterator[syntax.SyntaxNode]:
        if isinstance(node, syntax.ForLoopStatementSyntax):
            yield node.statement  # its header counts at translation
        elif isinstance(node, syntax.CastExpressionSyntax):
            yield node.right
        elif isinstance(node, syntax.MultipleConcatenationExpressionSyntax):
            yield node.concatenation
        elif isinstance(node, syntax.ScopedNameSyntax) and self._source(node).startswith("g_"):
            yield node.right  # which of the generated blocks is fixed at translation
        elif isinstance(node, syntax.RangeSelectSyntax):
            if kind != "SimpleRangeSelect":
                yield node.left  # the other one is a width
        elif kind in ASSIGNMENTS:
            assert isinstance(node, syntax.BinaryExpressionSyntax)
            yield node.right
        elif isinstance(node, syntax.StandardCaseItemSyntax):
            yield node.clause
        elif kind in {"LoopGenerate", "IfGenerate"}:
            # Only what is generated.
            yield from (child for child in _children(node) if _kind(child) in GENERATED)
        else:
            yield from _children(node)

    def _mutate(self, node: syntax.SyntaxNode, kind: str) -> None:
        if isinstance(node, syntax.ExpressionStatementSyntax):
            if _kind(node.expr) in ASSIGNMENTS:
                self._add(node, "no assignment", ";")
        elif kind in ASSIGNMENTS:
            return  # the statement's
        elif isinstance(node, syntax.BinaryExpressionSyntax | syntax.PrefixUnaryExpressionSyntax):
            self._operator(node)
        elif isinstance(node, syntax.ConditionalPredicateSyntax):
            condition = self._source(node)
            if not re.search(r"[!=]=|^!", condition):  # of these the operator does the same
                self._add(node, "condition", f"!({condition})")
            self._add(node, "condition", "1'b1")
            self._add(node, "condition", "1'b0")
        elif kind in LITERALS:
            self._literal(node)

    def _operator(self, node: syntax.SyntaxNode) -> None:
        operator = node.operatorToken.rawText
        if isinstance(node, syntax.BinaryExpressionSyntax):
            left, right = self._source(node.left), self._source(node.right)
            for other in OPERATORS.get(operator, []):
                self._add(node, "operator", f"{left} {other} {right}")
        elif operator in UNARY_OPERATORS:
            self._add(node, "operator", UNARY_OPERATORS[operator] + self._source(node.operand))

    def _literal(self, node: syntax.SyntaxNode) -> None:
        text = self._source(node)
        sized = re.fullmatch(r"(\d+)'d(\d+)", text)
        if re.fullmatch(r"\d+", text):
            self._add(node, "literal", str(int(text) + 1))
        elif sized:
            width, value = int(sized[1]), int(sized[2])
            self._add(node, "literal", f"{width}'d{(value + 1) % 2**width}")
        elif text in OTHER_LITERAL:
            self._add(node, "literal", OTHER_LITERAL[text])

    def with_mutants(self, numbers: dict[int, int], selected: str) -> str:
        """The text with some of its mutants: by place in `mutants`, the number that chooses it.

        `selected` is an expression of that number.
        """
        by_node: dict[tuple[int, int], list[tuple[int, str, bool]]] = {}
        for place, (mutant, node, after) in enumerate(self._found):
            if place in numbers:
                statement = mutant.what == "no assignment"
                by_node.setdefault(_span(node), []).append((numbers[place], after, statement))
        # What is inside of another one is written first; a mutant itself has nothing mutated in it.
        changes: dict[tuple[int, int], str] = {}

        def text(begin: int, end: int) -> str:
            inner = [s for s in changes if begin <= s[0] and s[1] <= end and s != (begin, end)]
            outermost = [
                s for s in inner if not any(o != s and o[0] <= s[0] and s[1] <= o[1] for o in inner)
            ]
            parts, at = [], begin
            for span in sorted(outermost):
                parts += [self._bytes[at : span[0]].decode(), changes[span]]
                at = span[1]
            return "".join([*parts, self._bytes[at:end].decode()])

        for span in sorted(by_node, key=lambda s: s[1] - s[0]):
            written = text(*span)
            for number, after, statement in by_node[span]:
                if statement:
                    # In a block of its own, so that an `else` behind it stays where it is.
                    written = f"begin if ({selected} != {number}) {written} end"
                else:
                    written = f"({selected} == {number} ? {after} : {written})"
            changes[span] = written
        return text(0, len(self._bytes))
