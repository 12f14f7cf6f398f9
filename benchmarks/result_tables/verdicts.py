"""Verdicts and free travel beside the truth."""

from collections.abc import Sequence

from elbowroom.evaluate.hand import hand
from elbowroom.evaluate.own_links import own_links
from elbowroom.evaluate.rooms import alone, poses, travel
from elbowroom.evaluate.table import table as on_table
from result_tables.cells import Row, centimetres, of, same, table


def _summaries(rows: Sequence[Row]) -> list[Row]:
    return [row for row in rows if row.get("kind") == "summary"]


def alone_tables(rows: Sequence[Row]) -> list[str]:
    """Levels of all verdicts, by voxel size."""
    return table(
        _summaries(rows),
        {
            "voxel": centimetres,
            **same("detail", "poses", "verdicts", "stop", "decelerate", "inform", "clear"),
            "clear %": of("clear_pct", 2, due=alone.DUE),
        },
    )


def hand_tables(rows: Sequence[Row]) -> list[str]:
    """Levels of motions that meet a hand, and of the machine alone, by what explains."""
    return table(
        _summaries(rows),
        {
            "explained by": of("explain_with"),
            **same("noise", "arms", "motions"),
            "hand in the excess": of("in_excess"),
            **same("stop", "decelerate", "inform"),
            "clear": of("clear", due=hand.DUE),
            "machine alone, stop %": of("alone_stop_pct", 1, due=hand.DUE),
        },
    )


def own_links_tables(rows: Sequence[Row]) -> list[str]:
    """Stops at own links beside the truth, of all robots together."""
    return table(
        _summaries(rows),
        {
            **same("robots", "poses", "motions"),
            "meets": of("meet"),
            "called clear": of("called_clear", due=own_links.DUE),
            **same("beyond", "stops"),
            "stops where clear %": of("false_stops_pct", 2, due=own_links.DUE),
        },
    )


def table_tables(rows: Sequence[Row]) -> list[str]:
    """Motions of an arm on a table, without declared contact and with it."""
    return table(
        _summaries(rows),
        {
            "declared contact": of("contact"),
            **same("poses", "motions"),
            "truly clear": of("clear"),
            "of these stop %": of("stop_where_clear_pct", 1, due=on_table.DUE),
            "meets within S": of("within"),
            "milder": of("milder", due=on_table.DUE),
            "beyond": of("beyond"),
        },
    )


def poses_tables(rows: Sequence[Row]) -> list[str]:
    """Verdicts beside the truth."""
    return table(
        _summaries(rows),
        {
            "voxel": centimetres,
            **same("detail", "poses", "verdicts"),
            "milder than the truth": of("milder", due=poses.DUE),
            "truly clear": of("truly_clear"),
            "of these stop %": of("stop_where_clear_pct", 2, due=poses.DUE),
            "the very level of the truth %": of("same_level_pct", 2),
        },
    )


def travel_tables(rows: Sequence[Row]) -> list[str]:
    """Free travel beside the truth."""
    return table(
        _summaries(rows),
        {
            "voxel": centimetres,
            **same("poses"),
            "more than the truth": of("more_than_truth", due=travel.DUE),
            "something is touched": of("touching"),
            "median shortfall, voxels": of("median_shortfall_voxels", 2, due=travel.DUE),
            "greatest shortfall, voxels": of("greatest_shortfall_voxels", 2),
        },
    )
