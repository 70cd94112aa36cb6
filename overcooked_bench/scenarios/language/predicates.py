"""The small language of `accept` and `never`: parsed with `ast`, every word checked, never evaluated by Python."""

import ast
from collections.abc import Sequence
from typing import Final

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.scenarios.language.counters import EVENTS, ITEMS, Counter
from overcooked_bench.scenarios.language.terms import (
    At,
    Both,
    Compare,
    Condition,
    Coordinate,
    Count,
    Distance,
    Either,
    Holds,
    Item,
    Lying,
    Not,
    Number,
    PotIs,
    PotSize,
    Term,
)
from overcooked_bench.shelf import guess

LONGEST: Final = 500
"""Most characters of a condition."""

_GREATEST: Final = 10_000
_CHEFS: Final = ("A", "B")
_OPERATORS: Final[dict[type[ast.cmpop], str]] = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
}
_TURNED: Final = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
_ITEMS_OF: Final = {
    "pot": ("onion", "tomato"),
    "plate": (),
    "serve": (),
    "pick": ("onion", "tomato", "dish", "soup"),
    "drop": ("onion", "tomato", "dish", "soup"),
}
_AFTER_CHEF: Final = (*EVENTS, "holds", "at", "x", "y")
_EXAMPLE: Final = "`B.pot >= 1 and A.holds(dish)`"
_WORDS: Final = "A.pot, B.serve, A.holds(dish), A.at(2, 1), A.x, pot(1).n, counter(2, 0), dist(A, B), blocked(B), score"


class PredicateError(WrongUse):
    """A condition is not in the language; the message quotes the part and says what to write instead."""


def parse_condition(text: str, layout: Layout) -> Condition:
    """Reads a condition such as `B.pot >= 1 and A.holds(dish)`.

    Args:
        text: The condition.
        layout: The kitchen: its pots, counters and cells must contain those of the condition.

    Raises:
        PredicateError: It is not in the language, or names what the kitchen does not have.
    """
    if len(text) > LONGEST:
        raise PredicateError(f"{len(text)} characters; a condition has {LONGEST} at most")
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        told = error.msg if isinstance(error, SyntaxError) else str(error) or "too many brackets"
        raise PredicateError(f"`{text.strip()}` is no condition ({told}); write one such as {_EXAMPLE}") from None
    return _Parser(text.strip(), layout).condition(tree)


def parse_any_of(texts: Sequence[str], layout: Layout) -> Condition:
    """Reads a list of conditions, one of which has to hold; see `parse_condition`."""
    parsed = tuple(parse_condition(text, layout) for text in texts)
    return parsed[0] if len(parsed) == 1 else Either(parsed)


class _Parser:
    """Converts a tree of Python's grammar, and refuses what is not in the language."""

    def __init__(self, text: str, layout: Layout) -> None:
        self._text, self._layout = text, layout

    def condition(self, node: ast.expr) -> Condition:
        if isinstance(node, ast.BoolOp):
            parts = tuple(self.condition(value) for value in node.values)
            return Both(parts) if isinstance(node.op, ast.And) else Either(parts)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return Not(self.condition(node.operand))
        if isinstance(node, ast.Compare):
            sides = [self.term(side) for side in (node.left, *node.comparators)]
            compared = tuple(
                self._compare(node, left, operator, right)
                for left, operator, right in zip(sides[:-1], node.ops, sides[1:], strict=True)
            )
            return compared[0] if len(compared) == 1 else Both(compared)
        term = self.term(node)
        if not isinstance(term, Condition):
            raise self._wrong(node, f"is no condition; compare it: `{term} {self._example(term)}`")
        return term

    def term(self, node: ast.expr) -> Term:
        if isinstance(node, ast.Constant) and type(node.value) is int:
            if node.value > _GREATEST:
                raise self._wrong(node, f"is too great a number; {_GREATEST} is the greatest")
            return Number(node.value)
        if isinstance(node, ast.Name):
            if node.id in ITEMS:
                return Item(node.id)
            if node.id == "score":
                return Count(Counter("score"))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            return self._called(node, node.func.id)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            return self._of_chef(node, self._chef(node.func.value), node.func.attr, node.args, node.keywords)
        if isinstance(node, ast.Attribute):
            if isinstance(node.value, ast.Call):
                return self._of_pot(node, node.value)
            return self._of_chef(node, self._chef(node.value), node.attr, None, [])
        raise self._wrong(node, f"is not in the language; its words are {_WORDS}, and numbers")

    def _called(self, node: ast.Call, name: str) -> Term:
        if name == "dist":
            if node.keywords or sorted(self._chef(argument) for argument in node.args) != list(_CHEFS):
                raise self._wrong(node, "measures between both chefs; write `dist(A, B)`")
            return Distance()
        if name == "blocked":
            if node.keywords or len(node.args) != 1:
                raise self._wrong(node, "asks about one chef; write `blocked(B) >= 3`")
            return Count(Counter("blocked", self._chef(node.args[0])))
        if name == "counter":
            x, y = self._cell(node, node.args, node.keywords, "counter(2, 0)")
            if self._layout.tile((x, y)) != "X":
                raise self._wrong(node, f"is no counter; the layout has {self._layout.tile((x, y))!r} there")
            return Lying(x, y)
        if name == "pot":
            raise self._wrong(node, "needs a word more: `pot(1).n`, `pot(1).cooking` or `pot(1).ready`")
        raise self._wrong(node, f"is not in the language; its words are {_WORDS}")

    def _of_pot(self, node: ast.Attribute, call: ast.Call) -> Term:
        if not isinstance(call.func, ast.Name) or call.func.id != "pot" or call.keywords or len(call.args) != 1:
            raise self._wrong(node, "is not in the language; pots are written `pot(1).n`")
        number = self._pot(call.args[0])
        if node.attr == "n":
            return PotSize(number)
        if node.attr in ("ready", "cooking"):
            return PotIs(number, node.attr)
        raise self._wrong(node, "is not in the language; a pot has `n`, `cooking` and `ready`")

    def _of_chef(
        self, node: ast.expr, chef: str, word: str, arguments: list[ast.expr] | None, keywords: list[ast.keyword]
    ) -> Term:
        if word in EVENTS:
            return self._event(node, chef, word, arguments, keywords)
        if word in ("x", "y") and arguments is None:
            return Coordinate(chef, word)
        if word == "holds" and arguments is not None and len(arguments) == 1 and not keywords:
            return Holds(chef, self._item(arguments[0], tuple(ITEMS)))
        if word == "at" and arguments is not None:
            x, y = self._cell(node, arguments, keywords, f"{chef}.at(2, 1)")
            if self._layout.tile((x, y)) != " ":
                raise self._wrong(node, f"is no floor; the layout has {self._layout.tile((x, y))!r} there")
            return At(chef, x, y)
        if word in _AFTER_CHEF:
            forms = {"holds": "holds(dish)", "at": "at(2, 1)"}
            raise self._wrong(node, f"is written `{chef}.{forms.get(word, word)}`")
        near = guess(word, _AFTER_CHEF)
        raise self._wrong(node, f"is not in the language; {near}After a chef come {', '.join(_AFTER_CHEF)}")

    def _event(
        self, node: ast.expr, chef: str, event: str, arguments: list[ast.expr] | None, keywords: list[ast.keyword]
    ) -> Count:
        allowed, at_pots = _ITEMS_OF[event], event in ("pot", "plate")
        forms = [f"{chef}.{event}", *(f"{chef}.{event}({item})" for item in allowed)]
        forms += [f"{chef}.{event}(at=1)"] * at_pots
        given = arguments if arguments is not None else []
        names = [keyword.arg for keyword in keywords]
        fits = len(given) <= bool(allowed) and (not names or (at_pots and names == ["at"]))
        if not fits or (arguments is not None and not given and not names):
            raise self._wrong(node, f"is written {' or '.join(f'`{form}`' for form in forms)}")
        item = self._item(given[0], allowed) if given else None
        return Count(Counter(event, chef, item, self._pot(keywords[0].value) if names else None))

    def _compare(self, node: ast.Compare, left: Term, operator: ast.cmpop, right: Term) -> Compare:
        if type(operator) not in _OPERATORS:
            raise self._wrong(node, f"compares in a way that is not in the language; use {' '.join(_TURNED)}")
        sign = _OPERATORS[type(operator)]
        for one in (left, right):
            if isinstance(one, Condition):
                raise self._wrong(node, f"compares `{one}`, which is true or false already; write it by itself")
        if isinstance(left, Number | Item):
            if isinstance(right, Number | Item):
                raise self._wrong(node, "compares two fixed values, which is always true or never")
            left, sign, right = right, _TURNED[sign], left
        if isinstance(left, Lying) or isinstance(right, Item):
            if not isinstance(left, Lying) or not isinstance(right, Item) or sign not in ("==", "!="):
                raise self._wrong(node, "mixes things and numbers; things are compared as in `counter(2, 0) == onion`")
            return Compare(left, sign, right)
        if isinstance(right, Count) or (isinstance(left, Count) and not isinstance(right, Number)):
            raise self._wrong(node, "compares a count with what changes; compare it with a number: `A.pot >= 1`")
        columns = [isinstance(side, Coordinate) and side.axis == "x" for side in (left, right)]
        if any(columns) and not all(columns) and not isinstance(right, Number):
            raise self._wrong(node, "means nothing in the mirrored kitchen; compare `A.x` with a number or `B.x`")
        return Compare(left, sign, right)

    def _chef(self, node: ast.expr) -> str:
        if isinstance(node, ast.Name) and node.id in _CHEFS:
            return node.id
        raise self._wrong(node, "is no chef; `A` is the tested agent, `B` its partner")

    def _item(self, node: ast.expr, allowed: tuple[str, ...]) -> str:
        if isinstance(node, ast.Name) and node.id in allowed:
            return node.id
        raise self._wrong(node, f"is no thing that fits here; write {' or '.join(allowed)}")

    def _pot(self, node: ast.expr) -> int:
        pots = len(self._layout.positions("P"))
        if isinstance(node, ast.Constant) and type(node.value) is int and 1 <= node.value <= pots:
            return node.value
        raise self._wrong(node, f"is no pot; they are numbered in reading order, 1 to {pots} here")

    def _cell(
        self, node: ast.expr, arguments: list[ast.expr], keywords: list[ast.keyword], example: str
    ) -> tuple[int, int]:
        found = [a.value for a in arguments if isinstance(a, ast.Constant) and type(a.value) is int]
        if len(found) != 2 or len(arguments) != 2 or keywords:
            raise self._wrong(node, f"needs a column and a row, counted from 0 at the top left: `{example}`")
        x, y = found
        if x >= self._layout.width or y >= self._layout.height:
            raise self._wrong(
                node, f"is outside; columns go to {self._layout.width - 1} and rows to {self._layout.height - 1}"
            )
        return x, y

    def _example(self, term: Term) -> str:
        return "== onion" if isinstance(term, Lying | Item) else ">= 1"

    def _wrong(self, node: ast.AST, what: str) -> PredicateError:
        return PredicateError(f"`{ast.get_source_segment(self._text, node)}` {what}")
