"""Questions about the loop: links, stiffness, a late host, and the ladder of effects."""

import itertools
import math
from collections.abc import Sequence

import numpy as np

from studies.plot import Chart, Limit, Line, Panel
from studies.questions.answer import Answer, Row, cross, line, number, values, where

WORST = "deadline.worst_us"
_STEP_US = 0.5
_BY_CHANCE = "deadline.late_probability.share"


def links(rows: Sequence[Row]) -> Answer:
    """How the words travel decides; how wide the link is hardly does."""
    for row in rows:
        row["how"] = f"{row['transfer']}, {row['notification']}"
    heading, table = cross(rows, "link", "how", WORST, ".0f")
    names = values(rows, "link")

    def at(link: str, transfer: str, notification: str = "msi") -> float:
        row = where(rows, link=link, transfer=transfer, notification=notification)[0]
        return float(row[WORST])

    chart = Chart(
        "Latency of a frame by link and transfer",
        "link",
        [
            Panel(
                "µs",
                [
                    line(how, where(rows, transfer=how, notification="msi"), "link", WORST)
                    for how in values(rows, "transfer")
                ],
                [Limit(1000, "1 kHz")],
            )
        ],
        legend="transfer, with MSI",
    )
    facts = {
        "pci_pio": number(at(names[0], "programmed-io"), ".0f"),
        "pci_dma": number(at(names[0], "dma"), ".0f"),
        "fast": names[-1],
        "fast_pio": number(at(names[-1], "programmed-io"), ".0f"),
        "fast_dma": number(at(names[-1], "dma"), ".0f"),
        "saved": number(at(names[0], "dma") - at(names[-1], "dma"), ".0f"),
        "polling": number(at(names[0], "dma") - at(names[0], "dma", "polling"), ".1f"),
        "intx": number(at(names[0], "dma", "intx") - at(names[0], "dma"), ".1f"),
    }
    return Answer(heading, table, chart, facts)


def stiffness(rows: Sequence[Row]) -> Answer:
    """Stiffness is damping over age."""
    heading, table = cross(rows, "period", "delay", "stiffness_max", ".0f")
    for row in rows:
        row["age"] = (row["period_us"] / 2 + row["delay_us"]) * 1e-3
        row["form"] = 1e3 / row["age"]  # b = 1 N s/m in scenarios/wall.toml
        row["off"] = row["stiffness_max"] / row["form"] - 1
    ordered = sorted(rows, key=lambda row: row["age"])
    periods = values(rows, "period")
    chart = Chart(
        "Stiffest stable wall over the mean age of a force",
        "T/2 + L, ms",
        [
            Panel(
                "N/m",
                [
                    *(
                        Line(
                            f"runs, T = {period}",
                            [row["age"] for row in where(rows, period=period)],
                            [row["stiffness_max"] for row in where(rows, period=period)],
                            joined=False,
                        )
                        for period in periods
                    ),
                    line("b/(T/2 + L)", ordered, "age", "form"),
                ],
                log=True,
            )
        ],
        log_x=True,
    )

    def at(period: str, delay: str) -> str:
        return number(where(rows, period=period, delay=delay)[0]["stiffness_max"], ".0f")

    facts = {
        "off": number(100 * max(abs(row["off"]) for row in rows), ".1f"),
        "base": at("2 ms", "0 s"),
        "faster": at("1 ms", "0 s"),
        "late": at("2 ms", "1 ms"),
        "both": at("1 ms", "1 ms"),
        "fastest_late": at("0.5 ms", "1 ms"),
    }
    return Answer(heading, table, chart, facts)


def late_share(slack_us: float, spread: float) -> float:
    """Share of frames that are late, each on its own, by the distributions of jittery-host.toml.

    The timer is uniform up to 20 us; the process is woken twice a frame, at its tick and by the
    board, each time by a lognormal of median 20 us, drawn again above 1 ms.
    """
    places = np.arange(0.0, 3000.0, _STEP_US)
    sigma = math.log(spread)
    below = np.array(
        [
            0.5 * (1 + math.erf(math.log(place / 20) / sigma / math.sqrt(2))) if place > 0 else 0.0
            for place in places
        ]
    )
    wake = np.diff(np.where(places <= 1000, below, below[places <= 1000][-1]), prepend=0.0)  # noqa: PLR2004
    wake /= wake.sum()
    total = np.where(places < 20, _STEP_US / 20, 0.0)  # noqa: PLR2004
    for _ in range(2):
        total = np.convolve(total, wake)[: len(places)]
    return float(1 - total[: round(slack_us / _STEP_US)].sum())


def jitter(rows: Sequence[Row]) -> Answer:
    """The tail decides, and how much slack there is for it."""
    table = []
    for row in rows:
        # 10.7 us a solve's iteration; 767.1 us a frame of 60 without jitter (docs/accelerator.md).
        row["slack"] = 1000 - (767.12 - 10.7 * (60 - row["iterations"]))
        row["expected"] = late_share(row["slack"], row["spread"])
        row["rate"] = row["deadline.misses"] / row["deadline.frames"]
        row["name"] = f"{row['slack']:.0f} µs"
        table.append(
            [
                str(row["spread"]),
                row["name"],
                number(row["deadline.p50_us"], ".0f"),
                number(row["deadline.p99_us"], ".0f"),
                number(100 * row["rate"], ".2f"),
                # Less is not told from none.
                number(100 * row[_BY_CHANCE], ".2g") if row[_BY_CHANCE] else "< 1e-11",
                number(100 * row["expected"], ".2g"),
            ]
        )
    chart = Chart(
        "Frames that are late, over the spread of the wake-ups",
        "spread of the lognormal",
        [
            Panel(
                "late, %",
                [
                    Line(
                        name,
                        [row["spread"] for row in where(rows, name=name)],
                        [100 * row["rate"] for row in where(rows, name=name)],
                    )
                    for name in values(rows, "name")
                ],
            )
        ],
        legend="slack of a frame",
    )

    def at(spread: float, iterations: int) -> Row:
        return where(rows, spread=spread, iterations=iterations)[0]

    facts = {
        "median_calm": number(at(2, 60)["deadline.p50_us"], ".0f"),
        "median_wild": number(at(6, 60)["deadline.p50_us"], ".0f"),
        "calm": number(100 * at(2, 60)["rate"], ".2f"),
        "wild": number(100 * at(6, 60)["rate"], ".1f"),
        "slack": number(at(6, 60)["slack"], ".0f"),
        "more_slack": number(at(6, 30)["slack"], ".0f"),
        "with_slack": number(100 * at(6, 30)["rate"], ".1f"),
        "independent": number(100 * at(6, 60)["expected"], ".1f"),
        "independent_slack": number(100 * at(6, 30)["expected"], ".1f"),
        "rare": number(1e-6 / at(1.5, 60)[_BY_CHANCE], ".0f"),
    }
    heading = ["spread", "slack", "median, µs", "99 %, µs", "late, %"]
    heading += ["by chance, %", "each on its own, %"]
    return Answer(heading, table, chart, facts)


def effects_ladder(rows: Sequence[Row]) -> Answer:
    """What each effect adds to those before it."""
    table = []
    stable = "stiffness.stable_N_m"
    for row in rows:
        table.append(
            [
                row["up to"],
                number(row["deadline.p50_us"], ".1f"),
                number(row[WORST], ".1f"),
                number(row[stable], ".0f"),
            ]
        )
    names = [str(number_) for number_ in range(1, len(rows) + 1)]
    chart = Chart(
        "Latency and stable wall, effect after effect",
        "rung of the ladder",
        [
            Panel(
                "latency, µs",
                [
                    Line("median", names, [row["deadline.p50_us"] for row in rows]),
                    Line("worst", names, [row[WORST] for row in rows]),
                ],
            ),
            Panel("wall, N/m", [Line("", names, [row[stable] for row in rows])]),
        ],
    )
    first, last = rows[0], rows[-1]
    steps = [
        (after["deadline.p50_us"] - before["deadline.p50_us"], after["up to"])
        for before, after in itertools.pairwise(rows)
    ]
    facts = {
        "first": number(first["deadline.p50_us"], ".0f"),
        "last": number(last["deadline.p50_us"], ".0f"),
        "worst": number(last[WORST], ".0f"),
        "largest": max(steps)[1],
        "largest_us": number(max(steps)[0], ".0f"),
        "least": min(steps)[1],
        "least_us": number(min(steps)[0], ".2f"),
        "before_worst": number(rows[-2][WORST], ".0f"),
        "wall_first": number(first[stable], ".0f"),
        "wall_last": number(last[stable], ".0f"),
    }
    heading = ["up to", "median, µs", "worst, µs", "stable wall, N/m"]
    return Answer(heading, table, chart, facts)
