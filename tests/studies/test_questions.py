"""The questions: each answer has the shape that it has to have, not only a run behind it."""

import itertools
from collections.abc import Callable, Sequence
from typing import Any

import pytest

from studies.errors import InputError, StudyError
from studies.program import Program
from studies.questions import loop, numbers, renewals, solvers, thesis_tables
from studies.questions.answer import Row, line, rows_of, where
from studies.questions.page import ANSWERS, answer, index, page
from studies.questions.question_file import FOLDER, NAMES, Question, read_question
from studies.session import Session
from studies.store import Store

Ask = Callable[..., list[Row]]


@pytest.fixture(scope="module")
def ask(program: Program, tmp_path_factory: pytest.TempPathFactory) -> Ask:
    """The rows of a question's points with these values on their axes; the others are not run."""
    session = Session(program, Store(tmp_path_factory.mktemp("questions")), workers=2)

    def of(name: str, **among: Sequence[Any]) -> list[Row]:
        question = read_question(name)
        points = tuple(
            point
            for point in question.points
            if all(point.columns[axis] in some for axis, some in among.items())
        )
        assert points
        asked = Question(
            name, question.title, question.scenario, question.command, question.metrics, points
        )
        records = session.run(points)
        assert all(record.done for record in records), [record.message for record in records]
        return rows_of(asked, records)

    return of


def column(rows: Sequence[Row], name: str) -> list[Any]:
    return [row[name] for row in rows]


def falls(some: Sequence[float]) -> bool:
    return all(after <= before for before, after in itertools.pairwise(some))


def test_each_has_file_text_and_answer() -> None:
    assert tuple(ANSWERS) == NAMES
    for name in NAMES:
        question = read_question(name)
        assert question.scenario.is_file()
        assert len(question.points) == len(set(question.points))
        assert (FOLDER / f"{name}.md").read_text(encoding="utf-8").count("\n---\n") == 1


def test_unknown_question_is_refused_with_the_names() -> None:
    with pytest.raises(InputError, match="expected one of solvers, renewals"):
        read_question("partition")


def test_partitions_saturate_where_the_rest_of_an_iteration_begins(ask: Ask) -> None:
    rows = ask("partitions", rows=[3], columns=[8])
    clocks = column(rows, "cycles.iteration")
    rest = {row["cycles.iteration"] - row["cycles.sparse_product"] for row in rows}
    assert rest == {604}  # two passes over the vectors and two divisions of 68 clocks
    assert falls(clocks[:6])
    # The product halves with the first doubling, and at the end another one gives nothing.
    products = column(rows, "cycles.sparse_product")
    assert products[0] / products[1] == pytest.approx(2, rel=0.02)
    assert clocks[-2] / clocks[-1] == pytest.approx(1, rel=0.002)
    assert [row["fits"] for row in rows] == [row["partitions"] <= 5 for row in rows]


def test_device_gives_nodes_and_not_rate(ask: Ask) -> None:
    rows = ask("devices", device=["EP2S60", "EP2S180", "U280"], partitions=[1, 5])
    five = where(rows, partitions=5)
    nodes = column(five, "largest_mesh.nodes")
    assert nodes == sorted(nodes)
    assert nodes[-1] > 50 * nodes[0]
    assert len(set(column(five, "mesh.frame_rate_hz"))) == 1  # one clock, one engine
    for one, other in zip(where(rows, partitions=1), five, strict=True):
        assert one["largest_mesh.nodes"] > other["largest_mesh.nodes"]


def test_words_have_two_floors(ask: Ask) -> None:
    some = {"matrix bits": [10, 12, 14, 18], "vector bits": [16, 24]}
    rows = ask("word-lengths", **some)
    true = {(row["matrix bits"], row["vector bits"]): row[numbers.TRUE] for row in rows}
    own = {(row["matrix bits"], row["vector bits"]): row[numbers.ROUNDED] for row in rows}
    # Each bit of the matrix halves its rounding, up to the vectors' floor.
    per_bit = (true[12, 24] / true[18, 24]) ** (1 / 6)
    assert 1.8 < per_bit < 2.4
    assert true[18, 16] > 0.8 * true[14, 16]
    # Blocks hold whole words: memory rises in steps, with either word.
    blocks = {(row["matrix bits"], row["vector bits"]): row[numbers.MEMORY] for row in rows}
    assert blocks[10, 16] == blocks[12, 16] < blocks[14, 16] < blocks[18, 16] < blocks[18, 24]
    # The solver's own error is of the vectors alone, a factor of two a bit as well.
    for matrix in (10, 12, 14, 18):
        assert own[matrix, 16] == pytest.approx(own[18, 16], rel=0.1)
        assert 1.7 < (own[matrix, 16] / own[matrix, 24]) ** (1 / 8) < 2.3


def test_iterations_cost_alike_and_warm_starts_need_fewer(ask: Ask) -> None:
    rows = ask("iterations", iterations=[10, 30, 80])
    for method, clocks in (("CG", 1070), ("Jacobi-PCG", 1367)):
        warm = where(rows, method=method, start="warm")
        cold = where(rows, method=method, start="zero")
        for some in (warm, cold):
            time = column(some, "deadline.p50_us")
            assert (time[2] - time[0]) / 70 == pytest.approx(clocks / 100, rel=1e-6)
        assert falls(column(cold, numbers.ROUNDED))
        for at_warm, at_cold in zip(warm, cold, strict=True):
            assert at_warm[numbers.ROUNDED] < at_cold[numbers.ROUNDED]
        # Warm, it is flat after 30; from zero it still falls.
        assert warm[1][numbers.ROUNDED] < 1.3 * warm[2][numbers.ROUNDED]
        assert cold[1][numbers.ROUNDED] > 3 * cold[2][numbers.ROUNDED]
        # The matrix' rounding is under all of it.
        assert 0.05 < warm[2][numbers.TRUE] < 0.08
    cg, pcg = (where(rows, method=m, start="zero")[2] for m in ("CG", "Jacobi-PCG"))
    assert pcg[numbers.ROUNDED] < cg[numbers.ROUNDED]


def test_runs_from_zero_are_held_to_the_tables_of_the_thesis(ask: Ask) -> None:
    # Tables 4.1 and 4.2 as the thesis prints them.
    counts = (30, 40, 50, 60, 70, 80)
    for method, printed in (
        ("CG", (2.6e-2, 2.2e-2, 1.9e-2, 1.6e-2, 9.8e-3, 5.1e-3)),
        ("Jacobi-PCG", (1.7e-2, 1.1e-2, 2.4e-3, 1.3e-3, 1.0e-3, 9.0e-4)),
    ):
        assert thesis_tables.thesis(method) == dict(zip(counts, printed, strict=True))
    rows = ask("iterations", iterations=[30, 60, 80])
    facts = numbers.held_to_the_thesis(rows)
    assert float(facts["cg_of_thesis"].split()[0]) > 2  # what the page says: no repetition
    for by in (0.1, 10):
        wrong = [row | {numbers.ROUNDED: row[numbers.ROUNDED] * by} for row in rows]
        warm = [row for row in rows if row["start"] == "warm"]
        with pytest.raises(StudyError, match="expected between"):
            numbers.held_to_the_thesis([*(r for r in wrong if r["start"] == "zero"), *warm])


def test_a_page_without_the_thesis_row_is_no_anchor() -> None:
    with pytest.raises(StudyError, match=r"expected a row thesis, MG below Table 4\.1"):
        thesis_tables._row("Table 4.1", "thesis, MG")


def test_dma_decides_and_not_the_link(ask: Ask) -> None:
    rows = ask("links", link=["PCI 32/33", "PCIe Gen3 x4"])
    for row in rows:
        assert (row[loop.WORST] < 1000) == (row["transfer"] == "dma")
    for link in ("PCI 32/33", "PCIe Gen3 x4"):
        polling, msi, intx = (
            where(rows, link=link, transfer="dma", notification=how)[0][loop.WORST]
            for how in ("polling", "msi", "intx")
        )
        assert polling < msi < intx
        assert msi - polling < 7  # an interrupt's 5 us and the polls' own
    solve = 651.34  # 65 134 clocks at 100 MHz: no link makes it shorter
    fast = where(rows, link="PCIe Gen3 x4", transfer="dma")
    assert all(solve < row[loop.WORST] < solve + 65 for row in fast)


def test_frame_is_a_line_in_the_nodes(ask: Ask) -> None:
    rows = ask("mesh-rate", nodes=[100, 300, 500, 600])
    nodes, time = column(rows, "mesh.nodes"), column(rows, "mesh.frame_us")
    slope = (time[-1] - time[0]) / (nodes[-1] - nodes[0])
    for free, frame in zip(nodes, time, strict=True):
        assert frame == pytest.approx(time[0] + slope * (free - nodes[0]), rel=0.02)
    assert [row["fits"] for row in rows] == [True, True, True, False]


def test_late_links_have_a_best_number_of_devices(ask: Ask) -> None:
    rows = ask("several-devices", latency=["0 s", "2 us"])
    free = column(where(rows, latency="0 s"), "mesh.solve_us")
    late = where(rows, latency="2 us")
    assert falls(free)
    assert min(late, key=lambda row: row["mesh.solve_us"])["devices"] == 3
    # Two devices wait three times an iteration: for d and for two sums, 200 clocks each.
    two = where(rows, devices=2)
    assert two[1]["cycles.iteration"] - two[0]["cycles.iteration"] == 3 * 200


def test_wall_is_damping_over_age(ask: Ask) -> None:
    rows = ask("stiffness", period=["1 ms", "4 ms"], delay=["0 s", "0.5 ms", "2 ms"])
    for row in rows:
        form = 1e6 / (row["period_us"] / 2 + row["delay_us"])
        assert row["stiffness_passive"] == pytest.approx(form, rel=1e-9)
        assert row["stiffness_max"] == pytest.approx(form, rel=0.01)
        assert row["stiffness_max"] == pytest.approx(row["stiffness_linear"], rel=0.006)


def test_misses_are_the_tails_where_frames_do_not_touch(ask: Ask) -> None:
    rows = ask("jitter", iterations=[30, 60])
    for spread in (3, 4, 6, 8):
        row = where(rows, spread=spread, iterations=30)[0]
        frames = row["deadline.frames"]
        expected = frames * loop.late_share(1000 - 446.12, spread)
        assert abs(row["deadline.misses"] - expected) < 4 * expected**0.5
        # What the run says of all frames, by a convolution of its own; some make the next one late.
        by_chance = row["deadline.late_probability.share"]
        assert by_chance == pytest.approx(loop.late_share(1000 - 446.12, spread), rel=0.12)
    calm = where(rows, spread=1.5, iterations=60)[0]
    assert calm["deadline.misses"] == 0
    assert 1e-8 < calm["deadline.late_probability.share"] < 4e-8
    tight = where(rows, iterations=60)
    misses = column(tight, "deadline.misses")
    assert misses == sorted(misses)
    # Where many are late, they make others late: more than each on its own.
    assert misses[-1] > 4000 * loop.late_share(1000 - 767.12, 8) * 1.2
    assert tight[-1]["deadline.p50_us"] / tight[0]["deadline.p50_us"] < 1.1


def test_ladder_rises_and_the_wall_falls(ask: Ask) -> None:
    rows = ask("effects-ladder")
    latency = column(rows, "deadline.p50_us")
    assert latency[0] == pytest.approx(651.34)
    assert latency == sorted(latency)
    assert latency[3] - latency[2] == pytest.approx(11)  # the converters' 1 and 10 us
    wall = column(rows, "stiffness.stable_N_m")
    assert falls(wall[:6])
    # Late wake-ups are the worst frame's, hardly the wall's.
    assert rows[-1][loop.WORST] > 1.5 * rows[-2][loop.WORST]
    assert wall[-1] > 0.9 * wall[0]


def test_a_proxy_more_costs_the_host_alone(ask: Ask) -> None:
    rows = ask("contacts", probes=["1", "8"], host=["1 Gflop/s", "4 Gflop/s"])

    def force_us(probes: str, contact: str, host: str) -> float:
        row = where(rows, probes=probes, contact=contact, host=host)[0]
        assert row["deadline.misses"] == 0
        assert row["load.misses"] == 0
        return float(row[loop.WORST])

    for host in ("1 Gflop/s", "4 Gflop/s"):
        assert force_us("8", "proxy", host) > force_us("1", "proxy", host)
        assert force_us("8", "proxy", host) < force_us("1", "node", host)
    # What grows but for some words on the bus is arithmetic: a host that is four times as fast.
    slow = force_us("8", "proxy", "1 Gflop/s") - force_us("1", "proxy", "1 Gflop/s")
    fast = force_us("8", "proxy", "4 Gflop/s") - force_us("1", "proxy", "4 Gflop/s")
    assert 3 < slow / fast <= 4
    proxies = where(rows, contact="proxy")
    assert len(set(column(proxies, "contact.proxy.compliance_bytes"))) == 1


def test_page_has_its_numbers_from_the_runs(session: Session) -> None:
    question = read_question("effects-ladder")
    made = answer(question, session.run(question.points))
    text = page(question, made)
    assert "The solve alone is 651 µs" in text
    assert "{" not in text
    assert text.count("\n| ") == 2 + len(question.points)
    assert "(effects-ladder.md): The solve alone" in index({question.name: (question, made)})


def test_line_takes_two_columns() -> None:
    made = line("a", [{"x": 1, "y": 2.0}, {"x": 2, "y": None}], "x", "y")
    assert (made.x, made.y) == ([1, 2], [2.0, None])


def test_the_page_says_who_beats_whom() -> None:
    def row(solver: str, load: float, force: float, displacement: float) -> Row:
        return {
            "solver": solver,
            "host": "desktop-2026",
            "load.worst_us": load,
            "accuracy.force_of_frame.p95": force,
            "accuracy.displacement_of_frame.p95": displacement,
        }

    rows = [
        row("board", 800.0, 0.3, 0.2),
        row("cg", 50.0, 1e-4, 1e-4),
        row("cholesky", 200.0, 0.0, 0.0),
    ]
    said = solvers.verdict(rows)
    assert said.startswith("A core beats the board: a period's work takes a core of today 0.2 ms")
    assert "(cholesky)" in said and "0.8 ms with a force that is 30 % off" in said
    assert solvers.verdict([rows[0], row("cholesky", 900.0, 0.0, 0.0)]).startswith(
        "The board beats"
    )


def test_a_map_counts_who_holds_and_with_how_much_to_spare() -> None:
    """A board is needed where nobody else holds; a wake-up takes from what is left."""

    def row(who: str, every: int, load: float) -> dict[str, Any]:
        status = "held" if load <= 2000 else "not held"
        return {
            "who": who,
            "nodes": 500,
            renewals.EVERY: every,
            renewals.LOAD: load,
            "status": status,
        }

    rows = [
        row("board", 0, 700.0),
        row("core, cg", 0, 1900.0),
        row("board", 50, 1500.0),
        row("core, cg", 50, 2900.0),
    ]
    said = renewals.verdict(rows)
    assert said.startswith("A board alone holds 500 Hz in 1 of 2 places of the map: without one")
    assert "they are held in 1 of 2 places, in 0 by nobody" in said
    assert renewals.least_work(rows) == "a board in 2, a core in 0, a GPU in 0"
    by_gpu = [row("board", 0, 2100.0), row("core, cg", 0, 2100.0), row("GPU, cg", 0, 300.0)]
    assert renewals.least_work(by_gpu) == "a board in 0, a core in 0, a GPU in 1"
    assert (renewals.without_gpu(by_gpu), renewals.without_gpu(rows)) == ("1", "0")
    assert said.endswith('"board" holds 2, "board" 2.')
    assert renewals.verdict(rows[:2]).startswith("Nowhere on the map does a board alone")
    answer = renewals.renewals(rows)
    assert answer.table[1] == ["500", "50", "1.5", "2.9 late"]
    assert answer.facts["tangents"] == "1"
    assert answer.facts["tails"].splitlines()[2:] == [
        "| 0 | 2 | 1 |",
        "| 100 | 2 | 1 |",
        "| 300 | 2 | 0 |",
        "| 1000 | 1 | 0 |",
    ]


def test_the_page_of_solvers_begins_with_its_own_table() -> None:
    """What the page says first is the least of its rows."""
    text = (FOLDER.parents[1] / "docs/questions/solvers.md").read_text(encoding="utf-8")
    cells = [
        [c.strip() for c in line.split("|")[1:-1]] for line in text.splitlines() if "|" in line
    ]
    table = [row for row in cells if row[1] == "desktop-2026" and row[3][0].isdigit()]
    exact = [r for r in table if not r[0].startswith("board") and float(r[6] or 0) < 1e-9]
    least = min(exact, key=lambda row: float(row[3]))
    board = next(row for row in table if row[0] == "board")
    first = next(line for line in text.splitlines() if "beats" in line)
    assert first.startswith("A core beats") == (float(least[3]) < float(board[3]))
    for figure in (least[3], board[3], least[0]):
        assert figure in first
