"""Questions about the board: rows, columns and partitions; devices; meshes; several FPGAs."""

from collections.abc import Sequence

from studies.plot import Chart, Limit, Line, Panel
from studies.questions.answer import (
    NONE,
    TIMES,
    Answer,
    Row,
    cross,
    line,
    number,
    quantity,
    values,
    where,
)


def partitions(rows: Sequence[Row]) -> Answer:
    """The product shrinks with its units, the rest of an iteration does not."""
    for row in rows:
        row["shape"] = f"{row['rows']} {TIMES} {row['columns']}"
        row["rest"] = row["cycles.iteration"] - row["cycles.sparse_product"]
        row["cell"] = number(row["cycles.iteration"], "d") + ("" if row["fits"] else " †")
    heading, table = cross(rows, "shape", "partitions", "cell")
    heading[0] = f"rows {TIMES} columns \\ partitions"
    thesis = where(rows, rows=3, columns=8, partitions=5)[0]
    one = where(rows, rows=3, columns=8, partitions=1)[0]
    most = where(rows, rows=3, columns=8, partitions=32)[0]
    fitting = min((row for row in rows if row["fits"]), key=lambda row: row["cycles.iteration"])
    lines = [
        line(shape, where(rows, shape=shape), "partitions", "cycles.iteration")
        for shape in values(rows, "shape")
    ]
    chart = Chart(
        "Clocks of an iteration over partitions",
        "partitions",
        [Panel("clocks", lines, [Limit(thesis["rest"], "all but the product")], log=True)],
        legend=f"rows {TIMES} columns",
        log_x=True,
    )
    facts = {
        "rest": str(thesis["rest"]),
        "product": str(thesis["cycles.sparse_product"]),
        "thesis": str(thesis["cycles.iteration"]),
        "one": str(one["cycles.iteration"]),
        "speed_up": number(one["cycles.iteration"] / thesis["cycles.iteration"], ".2f"),
        "most": str(most["cycles.iteration"]),
        "more": number(thesis["cycles.iteration"] / most["cycles.iteration"], ".2f"),
        "best": f"{fitting['shape']} in {fitting['partitions']} partitions",
        "best_clocks": str(fitting["cycles.iteration"]),
    }
    return Answer(heading, table, chart, facts)


def devices(rows: Sequence[Row]) -> Answer:
    """Each device at the number of partitions that is fastest on it, and at the fewest."""
    rate, mesh = "mesh.frame_rate_hz", "largest_mesh.nodes"
    table: list[list[str]] = []
    names: list[str] = []
    largest: list[float | None] = []
    fastest: list[float | None] = []
    for name in values(rows, "device"):
        fitting = [row for row in where(rows, device=name) if row["fits"]]
        names.append(name)
        if not fitting:
            table.append([name, "does not fit", NONE, NONE, NONE])
            largest.append(None)
            fastest.append(None)
            continue
        wide = max(fitting, key=lambda row: row[mesh] or 0)
        fast = max(fitting, key=lambda row: row[rate])
        largest.append(wide[mesh])
        fastest.append(fast[rate])
        table.append(
            [
                name,
                number(wide[mesh], "d"),
                number(wide["largest_mesh.frame_rate_hz"], ".0f"),
                number(fast[rate], ".0f"),
                str(fast["partitions"]),
            ]
        )
    chart = Chart(
        "Largest mesh, and highest rate of the mesh of 500",
        "device",
        [
            Panel("nodes", [Line("largest mesh", names, largest, joined=False)], log=True),
            Panel(
                "Hz", [Line("highest rate", names, fastest, joined=False)], [Limit(500, "500 Hz")]
            ),
        ],
    )
    known = [value for value in fastest if value]
    thesis = [row for row in where(rows, device="EP2S60") if row["fits"]]
    facts = {
        "thesis_nodes": str(max(row[mesh] for row in thesis)),
        "thesis_rate": number(max(row[rate] for row in thesis), ".0f"),
        "largest": str(max(value for value in largest if value)),
        "largest_device": names[largest.index(max(value for value in largest if value))],
        "fastest": number(max(known), ".0f"),
        "gain": number(max(known) / max(row[rate] for row in thesis), ".2f"),
        "none": ", ".join(name for name, value in zip(names, largest, strict=True) if not value),
    }
    heading = ["device", "largest mesh, nodes", "its rate, Hz", "500 nodes, Hz", "partitions"]
    return Answer(heading, table, chart, facts)


def mesh_rate(rows: Sequence[Row]) -> Answer:
    """A frame's time is a line in the number of nodes."""
    first, last = rows[0], rows[-1]
    slope = (last["mesh.frame_us"] - first["mesh.frame_us"]) / (
        last["mesh.nodes"] - first["mesh.nodes"]
    )
    fixed = first["mesh.frame_us"] - slope * first["mesh.nodes"]
    table = [
        [
            str(row["nodes"]),
            str(row["mesh.nodes"]),
            number(row["mesh.frame_us"], ".0f"),
            number(fixed + slope * row["mesh.nodes"], ".0f"),
            number(row["mesh.frame_rate_hz"], ".0f"),
            "yes" if row["fits"] else "no",
        ]
        for row in rows
    ]
    chart = Chart(
        "Rate over the mesh",
        "free nodes",
        [
            Panel(
                "Hz",
                [line("rate", rows, "mesh.nodes", "mesh.frame_rate_hz")],
                [Limit(500, "500 Hz"), Limit(1000, "1 kHz")],
                log=True,
            )
        ],
        log_x=True,
    )
    facts = {
        "slope": number(slope, ".2f"),
        "fixed": number(fixed, ".0f"),
        "at_500": number((2000 - fixed) / slope, ".0f"),
        "at_1000": number((1000 - fixed) / slope, ".0f"),
        "fitting": str(max(row["mesh.nodes"] for row in rows if row["fits"])),
    }
    heading = ["mesh, nodes", "free nodes", "frame, µs", "line, µs", "rate, Hz", "fits"]
    return Answer(heading, table, chart, facts)


def several_devices(rows: Sequence[Row]) -> Answer:
    """More devices share the product and wait for each other longer."""
    latencies = values(rows, "latency")
    heading, table = cross(rows, "latency", "devices", "mesh.solve_us", ".0f")
    best = {
        latency: min(where(rows, latency=latency), key=lambda row: row["mesh.solve_us"])
        for latency in latencies
    }
    ideal, latest = latencies[0], latencies[-1]
    two = where(rows, devices=2)
    slope = (two[-1]["cycles.iteration"] - two[0]["cycles.iteration"]) / (
        (quantity(latest) - quantity(ideal)) * 1e8
    )
    chart = Chart(
        "A solve of 1000 nodes over the number of FPGAs in a ring",
        "devices",
        [
            Panel(
                "solve, µs",
                [
                    line(latency, where(rows, latency=latency), "devices", "mesh.solve_us")
                    for latency in latencies
                ],
            )
        ],
        legend="latency of a link",
    )
    facts = {
        "ideal_best": str(best[ideal]["devices"]),
        "ideal_us": number(best[ideal]["mesh.solve_us"], ".0f"),
        "late": latest,
        "late_best": str(best[latest]["devices"]),
        "late_us": number(best[latest]["mesh.solve_us"], ".0f"),
        "late_eight": number(where(rows, latency=latest, devices=8)[0]["mesh.solve_us"], ".0f"),
        "slope": number(slope, ".3g"),
    }
    return Answer(heading, table, chart, facts)
