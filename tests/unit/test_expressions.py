"""Expressions of a matrix: Python's own arithmetic where it is allowed, and nothing else."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from floatsim.cases.expressions import FUNCTIONS, LONGEST, in_order, parse, plain, strangers
from floatsim.errors import CaseError

NAMES = {"a": 3, "hs": 2.5, "tp": -0.75}
numbers = st.one_of(st.integers(-50, 50), st.floats(-50, 50, allow_nan=False).map(lambda y: round(y, 3))).map(
    lambda y: f"({y!r})"
)
leaves = numbers | st.sampled_from(sorted(NAMES))


def grown(inner):
    pair = st.tuples(inner, inner)
    return st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/", "//", "%"]), inner).map(lambda t: f"({' '.join(t)})"),
        st.tuples(inner, st.sampled_from(["2", "3", "-1", "0"])).map(lambda t: f"({t[0]} ** {t[1]})"),
        inner.map(lambda y: f"(-{y})"),
        inner.map(lambda y: f"sin({y})"),
        pair.map(lambda t: f"max({t[0]}, {t[1]})"),
        st.tuples(inner, inner, inner).map(lambda t: f"({t[0]} if {t[1]} <= {t[2]} else {t[2]})"),
        pair.map(lambda t: f"(({t[0]} < {t[1]} and {t[0]} != 3) or not {t[1]} >= 2)"),
    )


@given(st.recursive(leaves, grown, max_leaves=12))
@settings(max_examples=400, deadline=None)
def test_values_are_those_of_python(text):
    space = {"__builtins__": {}, **FUNCTIONS, **NAMES}
    try:
        expected = eval(text, space)  # of our own making
        if isinstance(expected, int) and abs(expected) > 2**53:
            expected = float(expected)
        ok = math.isfinite(expected)
    except (ArithmeticError, ValueError):
        ok = False
    if not ok:
        with pytest.raises(CaseError, match="has no value|is inf|is nan|is -inf"):
            parse(text)(NAMES)
        return
    assert parse(text)(NAMES) == pytest.approx(expected, rel=1e-12, abs=0.0)


@pytest.mark.parametrize(
    "text, value",
    [
        ("0.4 * a", 1.2000000000000002), ("1.33 + 4.74 * sqrt(hs)", 1.33 + 4.74 * math.sqrt(2.5)), ("a ** 2", 9),
        ("10 ** 15", 10**15), ("0 < a < 5", True), ("'parked' if a > 25 else 'turning'", "turning"),
        ("degrees(pi)", 180), ("not a == 3", False), ("round(hs * 100)", 250), ("atan2(1, 1)", math.pi / 4),
        (" a\n + 1 ", 4), ("-0.0", 0),
    ],
)  # fmt: skip
def test_what_users_write(text, value):
    result = parse(text)(NAMES)
    assert result == value and type(result) is type(value)


def test_whole_numbers_have_one_form():
    assert [repr(plain(y)) for y in (12.0, 12, -0.0, 0.5, True, "12.0", 1e30)] == [
        "12", "12", "0", "0.5", "True", "'12.0'", "1e+30"
    ]  # fmt: skip


@pytest.mark.parametrize(
    "text, said",
    [
        ("hs.real", "a dot after a name"), ("().__class__.__bases__", "a dot after a name"),
        ("__import__('os').system('true')", "only functions by their names|a dot"), ("__import__('os')", "no function"),
        ("open('x')", "no function 'open'"), ("eval('1')", "no function 'eval'"), ("sqr(4)", "did you mean 'sqrt'"),
        ("[y for y in (1, 2)]", "not allowed"), ("lambda: 1", "lambda"), ("hs[0]", "square brackets"),
        ("(a := 3)", "assi"),
        ("f'{hs}'", "f-string"), ("hs ^ 2", r"\*\*"), ("hs & 1", "not allowed"), ("1 << 80", "not allowed"),
        ("b'x'", "not allowed"), ("1j", "not allowed"), ("None", "not allowed"), ("...", "not allowed"),
        ("a in 'abc'", "not allowed"), ("max(*hs)", "not allowed"), ("round(hs, ndigits=1)", "without names"),
        ("sqrt", "needs brackets"), ("2 +", "no expression"), ("", "no expression"), ("a = 3", "no expression"),
        ("import os", "no expression"), ("1; 2", "no expression"), ("+".join(["1"] * LONGEST), "at most"),
        ("(" * 400 + "1" + ")" * 400, "no expression"), ("-" * 900 + "1", "no expression"), ("a\x00", "no expression"),
    ],
)  # fmt: skip
def test_everything_else_is_refused(text, said):
    with pytest.raises(CaseError, match=said):
        parse(text)({**NAMES})


@pytest.mark.parametrize(
    "text",
    ["9**9**9", "9.0**9**9", "2**(10**9)", "(-8)**(1/3)", "1/0", "a % 0", "sqrt(-1)", "log(0)", "exp(1000)",
     "1e300*1e300", "'x' * 1000000000", "'x' + 'y'", "-'x'", "max()", "min('a', 'b')", "1e999", "'a' < 'b'", "0.0**-1"],
)  # fmt: skip
def test_no_value_is_said_at_once(text):
    with pytest.raises(CaseError, match="has no value|is inf"):
        parse(text)(NAMES)


def test_large_whole_numbers_do_not_grow_from_one_variable_to_the_next():
    y = 10
    for _ in range(4):
        y = parse("y * y")({"y": y})
    assert isinstance(y, int) and y == 10**16 or y == 1e16
    with pytest.raises(CaseError, match="has no value|is inf"):
        for _ in range(40):
            y = parse("y * y")({"y": y})


def test_names_that_are_no_variables():
    said = strangers(parse("1.33 + 4.74 * sqrt(h)"), ["hs", "tp"])
    assert said == ["'1.33 + 4.74 * sqrt(h)' refers to 'h', which is no variable (did you mean 'hs'?)"]
    (word,) = strangers(parse("state_space"), ["hs"])
    assert "write {text: state_space}" in word
    assert strangers(parse("hs + pi"), ["hs"]) == []


def test_order_and_circles():
    chain = {"c": parse("b + a"), "b": parse("a * x"), "a": parse("x")}
    assert in_order(chain) == ["a", "b", "c"]
    with pytest.raises(CaseError, match="need each other: (a -> b -> a|b -> a -> b)"):
        in_order({"a": parse("b"), "b": parse("a + 1")})
    with pytest.raises(CaseError, match="a -> a"):
        in_order({"a": parse("a + 1")})
