"""What looks at values and at cameras find, and whom they accuse."""

from collections.abc import Sequence

from elbowroom.evaluate.contradictions.rows import DUE as CONTRADICTIONS
from elbowroom.evaluate.looks.looks import DUE as LOOKS
from elbowroom.evaluate.looks.looks import RIGHT, SCALED_KIND, WRONG_KIND
from result_tables.cells import Row, of, same, table


def looks_tables(rows: Sequence[Row]) -> list[str]:
    """False alarms, what was said of rooms that are right, and silence on each kind that is wrong."""
    summaries = [row for row in rows if "scenes" in row]
    right = [row for row in summaries if row["what"] == RIGHT]
    wrong = [row for row in summaries if row["what"] == WRONG_KIND]
    scaled = [row for row in summaries if row["what"] == SCALED_KIND]
    alarms = [row for row in rows if row["what"] == RIGHT and row.get("warns")]
    return [
        *table(
            right,
            {
                "right": of("kind"),
                "moments": of("scenes"),
                "refused": of("refused", due=LOOKS),
                "warned of": of("warned"),
                "warned of [%]": of("warned_pct", 2, due=LOOKS),
            },
        ),
        "",
        *(f"- Warned of, {row['scene']}: *{' '.join(row['said'])}*" for row in alarms),
        "",
        *table(
            wrong,
            {
                "wrong": of("kind"),
                "sites": of("scenes"),
                "stopped": of("stopped"),
                "named": of("named"),
                "nothing said": of("unsaid", due=LOOKS),
            },
        ),
        *(("", *_scaled_table(scaled)) if scaled else ()),
    ]


def _scaled_table(rows: Sequence[Row]) -> list[str]:
    """From which size on a focal length that is off is told."""
    return table(
        rows,
        {
            "off by a factor": of("kind"),
            "sites": of("scenes"),
            "stopped": of("stopped"),
            "named": of("named"),
            "nothing said [%]": of("unsaid_pct", due=LOOKS),
        },
    )


def contradiction_tables(rows: Sequence[Row]) -> list[str]:
    """Wrong cameras that are named, by the way in which they are wrong, and right ones that are accused."""
    wrong = [row for row in rows if row["kind"] == "wrong"]
    every = [row | {"what": "all of these"} for row in rows if row["kind"] == "all wrong"]
    right = [row for row in rows if row["kind"] == "right"]
    named = of("named_pct", 1, due=CONTRADICTIONS["all wrong"])
    return [
        *table(
            [*wrong, *every],
            {
                "described wrongly": of("what"),
                **same("sites"),
                "named, and no others": of("named"),
                "[%]": lambda row: named(row) if row["kind"] == "all wrong" else "",
                "stopped": of("stopped"),
                "milder than stop above the limit": of("milder", due=CONTRADICTIONS["wrong"]),
            },
        ),
        "",
        *table(
            right,
            {
                "right sites": of("sites"),
                "refused": of("stopped", due=CONTRADICTIONS["right"]),
                "warned of": of("warned"),
                "warned of [%]": of("warned_pct", 2, due=CONTRADICTIONS["right"]),
            },
        ),
    ]
