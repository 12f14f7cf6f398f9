"""Robots that others published."""

from collections.abc import Sequence

from elbowroom.evaluate.robots.robots import DUE
from result_tables.cells import Cell, Row, of, table


def robot_tables(rows: Sequence[Row]) -> list[str]:
    """What the files of all packages come to, then those of each package."""
    summaries = [row for row in rows if row["kind"] == "summary"]
    robots = [row for row in rows if row["kind"] == "robot" and row["format"] == "urdf"]
    packages = sorted({(row["package"], row["version"]) for row in robots})
    return [
        *table(summaries, COLUMNS),
        "",
        *table([_package(*named, robots) for named in packages], PACKAGES),
    ]


def _package(name: str, version: str, robots: Sequence[Row]) -> Row:
    """A package's files by what came of them."""
    of_it = [row for row in robots if (row["package"], row["version"]) == (name, version)]
    whole = [row for row in of_it if not row["lacks"]]
    return {
        "package": f"{name} {version}",
        "files": len(of_it),
        "lacking": len(of_it) - len(whole),
        "whole": len(whole),
        "loads": sum(row["outcome"] == "loads" for row in whole),
    }


COLUMNS: dict[str, Cell] = {
    "files": of("format"),
    "of packages": of("packages"),
    "count": of("files"),
    "load [%]": of("loads_pct", 1),
    "whole": of("whole"),
    "load [%] ": of("loads_of_whole_pct", 1),
    "whole machines": of("machines"),
    "load [%]  ": of("loads_of_machines_pct", 1, due=DUE),
    "refused": of("refused"),
    "other errors": of("crashes", due=DUE),
    "lose a part unsaid": of("lost_unsaid", due=DUE),
}
PACKAGES: dict[str, Cell] = {
    "package": of("package"),
    "URDF files": of("files"),
    "that lack something": of("lacking"),
    "whole": of("whole"),
    "of which load": of("loads"),
}
