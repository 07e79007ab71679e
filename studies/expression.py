"""Comparisons of axes, as constraints have them: read by Python's parser, never run by it."""

import ast
import operator
from collections.abc import Callable, Mapping, Sequence

from studies.nearest import nearest
from studies.point import Value

_LONGEST = 1000
_BINARY: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_COMPARE: dict[type[ast.cmpop], Callable[[object, object], bool]] = {
    ast.Lt: operator.lt,  # type: ignore[dict-item]
    ast.LtE: operator.le,  # type: ignore[dict-item]
    ast.Gt: operator.gt,  # type: ignore[dict-item]
    ast.GtE: operator.ge,  # type: ignore[dict-item]
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}


class Expression:
    """A comparison, such as `rows * columns <= 64`. A dotted key is a name of its own.

    Throws ValueError, saying what was expected, for what is none.
    """

    def __init__(self, text: str, names: Sequence[str]) -> None:
        self._names = names
        if len(text) > _LONGEST:
            raise ValueError(f"expected at most {_LONGEST} characters")
        try:
            self._tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            raise ValueError(f"expected a comparison of axes, found '{text}'") from error
        if not isinstance(self._tree, ast.Compare | ast.BoolOp):
            raise ValueError(f"expected a comparison such as 'a * b <= 64', found '{text}'")
        self._check(self._tree)

    def holds(self, values: Mapping[str, Value]) -> bool:
        """For a point's columns. Throws ValueError where they cannot be compared."""
        try:
            return bool(self._value(self._tree, values))
        except (TypeError, ArithmeticError) as error:
            raise ValueError(f"{ast.unparse(self._tree)}: {error}") from error

    def _check(self, node: ast.AST) -> None:
        if isinstance(node, ast.Name | ast.Attribute):
            name = _dotted(node)
            if name not in self._names:
                raise ValueError(f"no axis '{name}'{nearest(name, self._names)}")
            return
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float | str):
            return
        if isinstance(node, ast.BoolOp):
            parts: list[ast.expr] = node.values
        elif isinstance(node, ast.Compare) and all(type(op) in _COMPARE for op in node.ops):
            parts = [node.left, *node.comparators]
        elif isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
            parts = [node.left, node.right]
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
            parts = [node.operand]
        else:
            raise ValueError(
                f"expected axes, numbers, + - * / and comparisons, found '{_say(node)}'"
            )
        for part in parts:
            self._check(part)

    def _value(self, node: ast.AST, values: Mapping[str, Value]) -> object:  # noqa: PLR0911
        match node:
            case ast.Constant():
                return node.value
            case ast.BoolOp():
                each = (bool(self._value(part, values)) for part in node.values)
                return all(each) if isinstance(node.op, ast.And) else any(each)
            case ast.Compare():
                left = self._value(node.left, values)
                for op, part in zip(node.ops, node.comparators, strict=True):
                    right = self._value(part, values)
                    if not _COMPARE[type(op)](left, right):
                        return False
                    left = right
                return True
            case ast.BinOp():
                return _BINARY[type(node.op)](
                    _number(self._value(node.left, values)),
                    _number(self._value(node.right, values)),
                )
            case ast.UnaryOp():
                inner = self._value(node.operand, values)
                return not inner if isinstance(node.op, ast.Not) else -_number(inner)
            case _:
                return values[_dotted(node)]


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"expected a number, found '{value}'")
    return value


def _dotted(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute):
        return f"{_dotted(node.value)}.{node.attr}"
    if isinstance(node, ast.Name):
        return node.id
    raise ValueError(f"expected an axis, found '{_say(node)}'")


def _say(node: ast.AST) -> str:
    return ast.unparse(node)[:60]
