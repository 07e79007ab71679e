"""Which points a study has."""

from pathlib import Path

import pytest

from studies.design import points_of
from studies.errors import InputError
from studies.study_file import parse

FILE = Path("dir/study.toml")
HEAD = 'scenario = "../s.toml"\nset = ["frames=9"]\n'
AXIS = '[[axis]]\nkey = "{}"\nvalues = {}\n'
RANGE = '[[axis]]\nkey = "{}"\nfrom = {}\nto = {}\n'


def _columns(text: str) -> list[tuple[object, ...]]:
    return [tuple(point.columns.values()) for point in points_of(parse(HEAD + text, FILE), FILE)]


def test_product_has_every_combination_the_last_axis_fastest() -> None:
    text = AXIS.format("a", "[1, 2]") + AXIS.format("b", '["x", "y"]')
    assert _columns(text) == [(1, "x"), (1, "y"), (2, "x"), (2, "y")]


def test_a_point_is_set_as_the_command_line_takes_it() -> None:
    text = AXIS.format("a", '["2 ms"]') + AXIS.format("b", "[true]")
    (point,) = points_of(parse(HEAD + text, FILE), FILE)
    assert point.overrides == ("frames=9", 'a="2 ms"', "b=true")
    assert point.scenario == Path("s.toml")


def test_fixed_keys_are_words_or_tables() -> None:
    text = '[[set]]\nkey = "x"\nvalue = false\n[[set]]\nkey = "y"\nvalue = "2 ms"\n'
    study = parse('scenario = "s.toml"\n' + text + AXIS.format("a", "[1]"), FILE)
    (point,) = points_of(study, FILE)
    assert point.overrides == ("x=false", 'y="2 ms"', "a=1")
    with pytest.raises(InputError, match=r"study.toml:2: set: |study.toml:4: set.value: "):
        parse('scenario = "s.toml"\n[[set]]\nkey = "x"\n' + AXIS.format("a", "[1]"), FILE)


def test_zip_takes_the_axes_side_by_side_and_wants_equal_lengths() -> None:
    design = '[design]\nkind = "zip"\n'
    text = AXIS.format("a", "[1, 2]") + AXIS.format("b", "[3, 4]")
    assert _columns(text + design) == [(1, 3), (2, 4)]
    with pytest.raises(InputError, match=r"found \[2, 1\]"):
        _columns(AXIS.format("a", "[1, 2]") + AXIS.format("b", "[3]") + design)


def test_keys_that_change_together() -> None:
    text = '[[axis]]\nname = "w"\nkeys = ["a", "b"]\nvalues = [[12, 16], [18, 24]]\n'
    points = points_of(parse(HEAD + text, FILE), FILE)
    assert [point.overrides[1:] for point in points] == [("a=12", "b=16"), ("a=18", "b=24")]
    assert [point.columns for point in points] == [{"w": "12 16"}, {"w": "18 24"}]


def test_ranges_are_linear_or_logarithmic_and_keep_their_unit() -> None:
    linear = RANGE.format("a", '"1 ms"', '"4 ms"') + "steps = 4\n"
    assert _columns(linear) == [("1.0 ms",), ("2.0 ms",), ("3.0 ms",), ("4.0 ms",)]
    log = RANGE.format("a", 1, 100) + 'steps = 3\nscale = "log"\n'
    assert _columns(log) == [(1.0,), (10.0,), (100.0,)]
    whole = RANGE.format("a", 1, 3) + "steps = 5\ninteger = true\n"
    assert _columns(whole) == [(1,), (2,), (3,)]


@pytest.mark.parametrize(
    "text",
    [
        RANGE.format("a", '"1 ms"', '"4 us"') + "steps = 3\n",
        RANGE.format("a", '"x"', '"4 us"') + "steps = 3\n",
        RANGE.format("a", 0, 4) + 'steps = 3\nscale = "log"\n',
        RANGE.format("a", 0, 4),
        AXIS.format("a", "[1]") + '[design]\nkind = "sobol"\n',
        AXIS.format("a", "[1]") + '[[constraint]]\nthat = "a > 1"\n',
        RANGE.format("a", 0, 1e6) + "steps = 2000\n" + RANGE.format("b", 0, 1) + "steps = 2000\n",
    ],
)
def test_what_cannot_be_points_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        _columns(text)


def test_constraints_leave_points_out() -> None:
    text = AXIS.format("a.b", "[1, 2, 4, 8]") + AXIS.format("c", "[1, 2, 4, 8]")
    kept = _columns(text + '[[constraint]]\nthat = "a.b * c <= 8 and a.b >= c"\n')
    assert kept == [(1, 1), (2, 1), (2, 2), (4, 1), (4, 2), (8, 1)]


@pytest.mark.parametrize("kind", ["latin-hypercube", "sobol"])
def test_samplers_fill_the_space_and_follow_the_seed(kind: str) -> None:
    axes = RANGE.format("a", 0, 16) + AXIS.format("b", '["x", "y", "z", "w"]')
    design = f'[design]\nkind = "{kind}"\nsamples = 16\nseed = %d\n'
    sample = _columns(axes + design % 1)
    assert len(sample) == 16
    # One sample in each sixteenth of the first axis, four of each name: what both designs promise.
    assert sorted(int(float(str(a))) for a, _ in sample) == list(range(16))
    assert sorted(str(b) for _, b in sample) == sorted("xyzw" * 4)
    assert sample == _columns(axes + design % 1)
    assert sample != _columns(axes + design % 2)
