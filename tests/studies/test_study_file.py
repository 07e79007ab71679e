"""A study file: read whole, refused in one line that says where."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studies.errors import InputError
from studies.study_file import Study, load, parse

TOP = Path(__file__).resolve().parents[2]
FILE = Path("dir/study.toml")
GOOD = """title = "t"
scenario = "s.toml"

[[axis]]
key = "solver.iterations"
values = [15, 30]

[[axis]]
key = "budget.period"
from = "1 ms"
to = "4 ms"
steps = 4

[design]
kind = "product"
"""


def test_reads_every_table() -> None:
    study = parse(GOOD, FILE)
    assert study.title == "t"
    assert [axis.label for axis in study.axis] == ["solver.iterations", "budget.period"]
    assert study.axis[0].values == [15, 30]
    assert (study.axis[1].start, study.axis[1].to, study.axis[1].steps) == ("1 ms", "4 ms", 4)


@pytest.mark.parametrize(
    ("change", "line", "words"),
    [
        (('scenario = "s.toml"', ""), 1, "scenario: is missing"),
        (("steps = 4", "step = 4"), 12, "axis.step: unknown key; did you mean 'steps'?"),
        (("values = [15, 30]", "values = 15"), 6, "axis.values: "),
        (("values = [15, 30]", "values = []"), 4, "axis: expected one value or more in `values`"),
        (("values = [15, 30]", "values = [15, 30, 15]"), 6, "axis.values: 15 stands there twice"),
        (("values = [15, 30]", ""), 4, "expected either `values` or a range"),
        (('to = "4 ms"', ""), 8, "expected both `from` and `to`"),
        (('kind = "product"', 'kind = "grid"'), 15, "design.kind: "),
        (('key = "budget.period"', 'key = "solver.iterations"'), 8, "one axis called"),
        (("[design]", "[desing]"), 14, "desing: unknown key; did you mean 'design'?"),
        (('title = "t"', "title = 3"), 1, "title: "),
        (("[[axis]]", "[axis"), 4, ""),
    ],
)
def test_refuses_in_one_line(change: tuple[str, str], line: int, words: str) -> None:
    text = GOOD.replace(*change)
    assert text != GOOD
    with pytest.raises(InputError) as refused:
        parse(text, FILE)
    message = str(refused.value)
    assert "\n" not in message
    assert words in message
    assert f"{FILE}:{line}: " in message or f"at line {line}," in message


@pytest.mark.parametrize(
    ("expression", "words"),
    [
        ("budget.perod > 1", "no axis 'budget.perod'; did you mean 'budget.period'?"),
        ("solver.iterations", "expected a comparison"),
        ("__import__('os').system('x') < 1", "expected axes, numbers"),
        ("(lambda: 1)() < 2", "expected axes, numbers"),
        ("solver.iterations ** 9999999 < 1", "expected axes, numbers"),
        ("1 <", "expected a comparison"),
    ],
)
def test_refuses_constraints_that_are_none(expression: str, words: str) -> None:
    with pytest.raises(InputError) as refused:
        parse(f'{GOOD}\n[[constraint]]\nthat = "{expression}"\n', FILE)
    assert f"{FILE}:18: constraint.that: " in str(refused.value)
    assert words in str(refused.value)


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=200))
def test_any_text_is_a_study_or_refused(text: str) -> None:
    for candidate in (text, GOOD + text, GOOD.replace("product", text)):
        try:
            assert isinstance(parse(candidate, FILE), Study)
        except InputError as refused:
            assert "\n" not in str(refused)


@settings(max_examples=200, deadline=None)
@given(st.integers(0, len(GOOD)), st.integers(0, 40), st.text(max_size=8))
def test_any_damage_is_refused_or_read(place: int, length: int, put: str) -> None:
    try:
        parse(GOOD[:place] + put + GOOD[place + length :], FILE)
    except InputError as refused:
        assert "\n" not in str(refused)


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(InputError, match="expected a study file"):
            load(path)


def test_every_example_can_be_read() -> None:
    files = list((TOP / "studies" / "examples").glob("*.toml"))
    assert files
    for file in files:
        assert load(file).axis
