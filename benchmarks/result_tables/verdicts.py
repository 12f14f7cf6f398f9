"""Verdicts and free travel beside the truth."""

from collections.abc import Sequence

from elbowroom.evaluate.cell import rows as cell
from elbowroom.evaluate.escape import escape
from elbowroom.evaluate.hand import hand
from elbowroom.evaluate.own_links import own_links
from elbowroom.evaluate.paths import rows as path_rows
from elbowroom.evaluate.rooms import alone, poses, travel
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


def cell_tables(rows: Sequence[Row]) -> list[str]:
    """Truly clear motions of an arm that stop, by joints, poses and cause."""
    return table(
        _summaries(rows),
        {
            "contact with the table": of("contact"),
            "joints": of("joints"),
            "poses": of("kind_of_pose"),
            **same("motions"),
            "milder than the truth": of("milder_level", due=cell.DUE),
            "of its own links": of("milder_own"),
            "truly clear": of("truly_clear"),
            "of these stop %": of("stop_where_clear_pct", 1, due=cell.DUE),
            **{f"by {cause.name.lower()}": of(f"stopped_by_{cause.name.lower()}") for cause in cell.STOPPING},
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


def escape_tables(rows: Sequence[Row]) -> list[str]:
    """Motions beside an object: refused, or let go too far, by space and machine."""
    return table(
        _summaries(rows),
        {
            **same("space", "machine", "poses", "motions"),
            "least gap [mm]": of("least_gap_mm", 2),
            "lead away": of("leads_away"),
            "of these stop": of("refused"),
            "%": of("refused_pct", 1, due=escape.DUE),
            "escape": of("escapes"),
            "beyond the truth": of("beyond", due=escape.DUE),
            "contact on the way": of("touching", due=escape.DUE),
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


def path_tables(rows: Sequence[Row]) -> list[str]:
    """How far paths may be followed, beside the truth."""
    return table(
        _summaries(rows),
        {
            "voxel": centimetres,
            **same("machine", "brakes", "paths"),
            "free to the end": of("free_to_the_end"),
            "beyond the truth": of("beyond", due=path_rows.DUE),
            "compared": of("compared"),
            "of these unknown": of("unknown"),
            "median shortfall, voxels": of("median_shortfall_voxels", 2, due=path_rows.DUE),
            "greatest known": of("greatest_shortfall_voxels", 2),
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
