"""The run of `elbowroom evaluate robots`: a row for each file, then what they come to."""

from collections.abc import Sequence
from pathlib import Path

from elbowroom.cli.evaluate.measured import measured
from elbowroom.cli.evaluate.shown import as_table
from elbowroom.evaluate.due import Row, sentence
from elbowroom.evaluate.robots.robots import DUE, robot_rows, summary_rows

COLUMNS = {
    "format": "{format}",
    "packages": "{packages}",
    "files": "{files}",
    "loads": "{loads_pct:.1f} %",
    "whole": "{whole}",
    "whole ones load": "{loads_of_whole_pct:.1f} %",
    "machines": "{machines}",
    "machines load": "{loads_of_machines_pct:.1f} %",
    "refused": "{refused}",
    "crashes": "{crashes}",
    "lose a part unsaid": "{lost_unsaid}",
}


def run_robots(folders: Sequence[Path], leave_out: Sequence[str], json: Path | None) -> None:
    """Loads them, shows what came of it, writes a file.

    Args:
        folders: in which packages were unpacked.
        leave_out: files with one of these words in their path are left out.
        json: the file to write; None: none.

    Raises:
        InputError: a folder that is not there or holds no robot.
    """

    def summed(rows: Sequence[Row]) -> Sequence[Row]:
        return summary_rows(rows)

    measured("robots", robot_rows(folders, leave_out), None, json, as_table(COLUMNS, sentence(DUE)), summed)
