"""Expressions of a matrix's variables, `1.33 + 4.74 * sqrt(hs)`: read once, checked, evaluated for every case.

Arithmetic (+ - * / // % **), comparisons, and, or, not, `a if condition else b`, numbers, text in quotes, True, False,
pi, the functions of FUNCTIONS and names of other variables; nothing else. They are read by Python's own parser, walked
by simpleeval and never given to `eval`. Whole numbers stay whole; a power beyond 2^53 is a floating-point number, so
none takes long.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from graphlib import CycleError, TopologicalSorter
from typing import Any

from floatsim.cases.case import Value
from floatsim.errors import CaseError, nearest

LONGEST, DEEPEST = 1000, 100  # characters of an expression, and brackets in brackets
_EXACT = 2.0**53  # whole numbers up to here are exact in floating point

FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sqrt": math.sqrt, "exp": math.exp, "log": math.log, "log10": math.log10, "sin": math.sin, "cos": math.cos,
    "tan": math.tan, "asin": math.asin, "acos": math.acos, "atan": math.atan, "atan2": math.atan2,
    "hypot": math.hypot, "radians": math.radians, "degrees": math.degrees, "min": min, "max": max, "abs": abs,
    "round": round, "floor": math.floor, "ceil": math.ceil,
}  # fmt: skip
CONSTANTS = {"True": True, "False": False, "pi": math.pi}


def _power(a: Any, b: Any) -> Any:
    y = float(a) ** float(b)
    if isinstance(y, complex):
        raise ValueError("a root of a negative number")
    return a**b if isinstance(a, int) and isinstance(b, int) and b >= 0 and abs(y) < _EXACT else y


def _of_numbers(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function for numbers alone: no text is repeated or joined."""

    def checked(*values: Any) -> Any:
        wrong = [y for y in values if not isinstance(y, int | float)]
        if wrong:
            raise TypeError(f"{wrong[0]!r} is no number")
        return function(*values)

    return checked


_ARITHMETIC: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.Pow: _power, ast.USub: operator.neg,
    ast.UAdd: operator.pos, ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge,
}  # fmt: skip
_OPERATORS: dict[Any, Callable[..., Any]] = {
    **{kind: _of_numbers(function) for kind, function in _ARITHMETIC.items()},
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Not: operator.not_,
}  # fmt: skip
_CHECKED = {name: _of_numbers(function) for name, function in FUNCTIONS.items()}
_SHAPES = (ast.Expression, ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp, ast.Call, ast.Name,
           ast.Constant, ast.Load, ast.And, ast.Or, *_OPERATORS)  # fmt: skip
_CALLED = {
    ast.Attribute: "a dot after a name", ast.Subscript: "square brackets after a name", ast.Lambda: "lambda",
    ast.List: "a list", ast.Tuple: "commas", ast.Dict: "a dictionary", ast.JoinedStr: "an f-string",
    ast.BitXor: "^ (a power is **)", ast.NamedExpr: "an assignment",
}  # fmt: skip


class Expression:
    """One expression. text; names: the variables that it needs. Made by `parse`."""

    def __init__(self, text: str, tree: ast.Expression, names: frozenset[str]) -> None:
        from simpleeval import SimpleEval

        self.text, self.names, self._tree = text, names, tree
        self._walker = SimpleEval(operators=_OPERATORS, functions=dict(_CHECKED), names={})

    def __call__(self, values: Mapping[str, Value]) -> Value:
        """Its value. Raises CaseError if there is none: a root of a negative number, a division by zero."""
        own = {name: values[name] for name in self.names}
        self._walker.names = {**CONSTANTS, **own}
        try:
            result = self._walker.eval(self.text, previously_parsed=self._tree.body)
            if isinstance(result, int) and abs(result) > _EXACT:
                result = float(result)
        except (ArithmeticError, ValueError, TypeError) as error:
            raise CaseError(f"'{self.text}' has no value{_with(own)}: {error}") from None
        if isinstance(result, float) and not math.isfinite(result):
            raise CaseError(f"'{self.text}' is {result}{_with(own)}")
        return plain(result)


def _with(values: Mapping[str, Value]) -> str:
    return f" with {', '.join(f'{name} = {value!r}' for name, value in sorted(values.items()))}" if values else ""


def plain(value: Any) -> Any:
    """Numbers in one form, whole ones as int, so that 12 and 12.0 are the same case; anything else unchanged."""
    whole = isinstance(value, float) and value.is_integer() and abs(value) < _EXACT
    return int(value) if whole else value


@lru_cache(maxsize=4096)
def parse(text: str) -> Expression:
    """Read an expression. Raises CaseError for what is none, and for everything that is not allowed in one."""
    if len(text) > LONGEST:
        raise CaseError(f"an expression of {len(text)} characters; at most {LONGEST} are allowed")
    try:
        tree = ast.parse(" ".join(text.splitlines()).strip(), mode="eval")
        nodes = list(ast.walk(tree))
    except SyntaxError as error:
        raise CaseError(f"'{text}' is no expression: {error.msg}") from None
    except (ValueError, MemoryError, RecursionError):
        raise CaseError(f"'{text:.60}' is no expression that can be read") from None
    if _depth(tree) > DEEPEST:
        raise CaseError(f"'{text:.60}' is no expression that can be read: it is nested too deeply")
    problems = []
    functions = {id(node.func) for node in nodes if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    names = set()
    for node in nodes:
        if not isinstance(node, _SHAPES):
            what = _CALLED.get(type(node), type(node).__name__.lower())
            problems.append(f"'{text}': {what} is not allowed in an expression")
        elif isinstance(node, ast.Call):
            if not isinstance(node.func, ast.Name):
                problems.append(f"'{text}': only functions by their names can be called")
            elif node.func.id not in FUNCTIONS:
                problems.append(f"'{text}': there is no function '{node.func.id}'{nearest(node.func.id, FUNCTIONS)}")
            if node.keywords:
                problems.append(f"'{text}': arguments of functions are given without names")
        elif isinstance(node, ast.Constant):
            if not isinstance(node.value, bool | int | float | str):
                problems.append(f"'{text}': {node.value!r} is not allowed in an expression")
        elif isinstance(node, ast.Name) and id(node) not in functions:
            if node.id in FUNCTIONS:
                problems.append(f"'{text}': the function {node.id} needs brackets, {node.id}(...)")
            elif node.id not in CONSTANTS:
                names.add(node.id)
    if problems:
        raise CaseError(dict.fromkeys(problems))
    return Expression(text, tree, frozenset(names))


def _depth(tree: ast.AST) -> int:
    """How deeply an expression is nested, counted level by level."""
    level, depth = [tree], 0
    while level and depth <= DEEPEST:
        level, depth = [child for node in level for child in ast.iter_child_nodes(node)], depth + 1
    return depth


def strangers(expression: Expression, known: Iterable[str]) -> list[str]:
    """One sentence for every name in the expression that is no variable."""
    names = list(known)
    return [
        f"'{expression.text}' refers to '{name}', which is no variable{nearest(name, names)}; "
        f"if it is text, write {{text: {name}}}"
        if expression.text.strip() == name
        else f"'{expression.text}' refers to '{name}', which is no variable{nearest(name, names)}"
        for name in sorted(expression.names - set(names))
    ]


def in_order(expressions: Mapping[str, Expression]) -> list[str]:
    """Names in an order in which each can be evaluated after those it needs. Raises CaseError for a circle."""
    needs = {name: sorted(item.names & expressions.keys()) for name, item in expressions.items()}
    try:
        return list(TopologicalSorter(needs).static_order())
    except CycleError as error:
        circle = " -> ".join(reversed(error.args[1]))
        raise CaseError(f"these variables need each other: {circle}") from None
