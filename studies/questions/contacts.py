"""What each probe costs a frame."""

from collections.abc import Sequence

from studies.plot import Chart, Limit, Panel
from studies.questions.answer import NONE, Answer, Row, line, number, values, where

_WORST = "deadline.worst_us"
_LOAD = "load.worst_us"


def _late(row: Row) -> bool:
    return bool(row["deadline.misses"] or row["load.misses"])


def contacts(rows: Sequence[Row]) -> Answer:
    """A proxy's force waits for no second solve, and the host's work grows with the probes."""
    hosts = values(rows, "host")
    kinds = values(rows, "contact")
    counts = values(rows, "probes")
    table = []
    for probes in counts:
        cells = [probes]
        for kind in kinds:
            for host in hosts:
                row = where(rows, probes=probes, contact=kind, host=host)[0]
                times = f"{number(row[_WORST], '.0f')} / {number(row[_LOAD], '.0f')}"
                cells.append(f"{times}, late" if _late(row) else times)
        table.append(cells)
    for row in rows:
        row["count"] = int(row["probes"])

    def at(probes: str, kind: str, host: str) -> Row:
        return where(rows, probes=probes, contact=kind, host=host)[0]

    fast, slow = hosts[-1], hosts[0]
    first, last = counts[0], counts[-1]
    one, eight = at(first, "proxy", fast)[_WORST], at(last, "proxy", fast)[_WORST]
    held = [int(n) for n in counts if not _late(at(n, "proxy", slow))]
    chart = Chart(
        "Worst frame over the number of probes",
        "probes",
        [
            Panel(
                name,
                [
                    line(
                        f"{kind}, {host}",
                        where(rows, contact=kind, host=host),
                        "count",
                        metric,
                    )
                    for kind in kinds
                    for host in hosts
                ],
                [Limit(2000, "500 Hz")],
                log=True,
            )
            for name, metric in (("force, µs", _WORST), ("load, µs", _LOAD))
        ],
        legend="contact, host",
    )
    facts = {
        "fast": fast,
        "slow": slow,
        "one": number(one, ".0f"),
        "eight": number(eight, ".0f"),
        "slope": number((eight - one) / (int(last) - int(first)), ".1f"),
        "most": str(max(held)) if held else NONE,
        "node_eight": number(at(last, "node", fast)[_WORST], ".0f"),
        "bytes": number(at(first, "proxy", fast)["contact.proxy.compliance_bytes"] / 1e6, ".1f"),
    }
    heading = ["probes", *(f"{kind}, {host}: force / load, µs" for kind in kinds for host in hosts)]
    return Answer(heading, table, chart, facts)
