"""Things that move past cameras of unlike age, and what aged claims cost."""

from collections.abc import Callable, Sequence

from elbowroom.evaluate.skew import moving, price
from result_tables.cells import Cell, Row, of, same, table


def skew_tables(rows: Sequence[Row]) -> list[str]:
    """Touched voxels declared free by spread of ages, the worst of noise and detail; then what is lost."""
    found = [row for row in rows if row.get("kind") == "moving"]
    spreads = sorted({row["spread_ms"] for row in found})
    groups: dict[tuple[object, ...], list[Row]] = {}
    for row in found:
        groups.setdefault(tuple(row[key] for key in ("what", "speed_m_s", "law_m_s", "rule")), []).append(row)
    columns: dict[str, Cell] = {
        "what": of("what"),
        "goes, m/s": of("speed_m_s", 1),
        "fastest point, m/s": of("fastest_m_s", 1),
        "aged for, m/s": lambda row: f"{row['law_m_s']:g}" if row["law_m_s"] else "not aged",
        "rule": of("rule"),
        **{f"{spread:g} ms, free %": _worst(spread) for spread in spreads},
    }
    lines = table(({**own[0], "rows": own} for own in groups.values()), columns)
    rays = {
        "what": of("what"),
        "goes, m/s": of("speed_m_s", 1),
        "margin to the side, px": of("lateral_px"),
        "touched voxels": of("touched"),
        "of these free": of("false_free_voxels", due=moving.DUE[1:]),
    }
    still = [row for row in rows if row.get("kind") == "still"]
    lines += ["", *table(still, rays)] if still else []
    lost = {
        **same("room", "detail"),
        "aged for, m/s": of("law_m_s"),
        "ages up to, ms": of("spread_ms"),
        "found without ages %": of("found_without_pct", 2),
        "found %": of("found_pct", 2),
        "lost, points": of("price_points", 2, due=price.DUE),
        "worst deal": of("price_worst_points", 2),
    }
    return [*lines, "", *table([row for row in rows if row.get("kind") == "price"], lost)]


def _worst(spread_ms: float) -> Callable[[Row], str]:
    """The greatest share over noise and detail, marked where nothing was to be free."""

    def cell(row: Row) -> str:
        own = [each for each in row["rows"] if each["spread_ms"] == spread_ms]
        worst = max(own, key=lambda each: each["false_pct"])
        text = f"{worst['false_pct']:.2f}" if worst["false_free_voxels"] else "0"
        missed = any(due.of(each) and not due.met(each) for due in moving.DUE[:1] for each in own)
        return f"**{text}** (due 0: missed)" if missed else text

    return cell
