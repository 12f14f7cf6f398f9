"""The figures of the house as a report.

python tests/house_report.py                  the figures, beside what they were and what is due
python tests/house_report.py --list           and every offender, sorted by folder
python tests/house_report.py --list reconstruct/ motion/check.py      those of these places only
python tests/house_report.py other/src/elbowroom                      of another checkout
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from reference import house
from reference.house import House, Place


@dataclass(frozen=True)
class Figure:
    """A line of the report: what it was before the house was moved, what is due, what is now, and who offends."""

    name: str
    before: str
    due: str
    now: str
    offenders: list[Place]


def figures(counted: House, kernels: list[Place]) -> list[Figure]:
    """All figures of the report."""
    outside, everything, lines = counted.parameters(), counted.parameters(commands=True), counted.code_lines()
    calls, many, long = counted.positional_calls(), counted.many_parameters(), counted.long_functions()
    asked, silent = len(counted.explained()), counted.unexplained()
    files, folders = len(counted.file_circles()), len(counted.folder_circles())

    commands = f"with commands {house.nine_tenths(everything)} / {max(everything)}"
    most = f"{house.nine_tenths(outside)} / {max(outside)} ({commands})"
    longest = f"{house.nine_tenths(lines)} / {max(lines)} ({house.above_nine_tenths(lines, house.DUE_LINES)})"
    told = f"{asked - len(silent)} of {asked}, {(asked - len(silent)) / max(asked, 1):.0%}"
    circles = f"{files + folders} ({files} of files, {folders} of folders)"
    return [
        Figure(
            "parameters, 90 % / max",
            "6 / 25",
            f"{house.DUE_PARAMETERS} / {house.MOST_PARAMETERS}",
            most,
            many,
        ),
        Figure(
            "code lines, 90 % / max", "27 / 107", f"{house.DUE_LINES} / {house.MOST_LINES}", longest, long
        ),
        Figure("calls with nine positions or more", "58", f"{house.DUE_CALLS}", f"{len(calls)}", calls),
        Figure("circles", "3", f"{house.DUE_CIRCLES}", circles, counted.circle_places()),
        Figure("Args told at three arguments or more", "53 %", f"{house.DUE_ARGS:.0%}", told, silent),
        Figure("lines that name kernels", "81", f"{house.DUE_KERNEL_LINES}", f"{len(kernels)}", kernels),
    ]


def by_folder(figures: list[Figure], places: list[str]) -> Iterator[str]:
    """Lines of the list: folder, figure, offenders. Places are beginnings of paths; none: all."""
    found = [
        (str(PurePosixPath(place.file).parent), figure.name, place)
        for figure in figures
        for place in figure.offenders
        if not places or any(place.file.startswith(start) for start in places)
    ]
    order = [figure.name for figure in figures]
    last = ("", "")
    for folder, name, place in sorted(found, key=lambda row: (row[0], order.index(row[1]), row[2])):
        if folder != last[0]:
            here = sum(row[0] == folder for row in found)
            yield f"\n{folder}/  ({here})"
        if (folder, name) != last:
            yield f"  {name}"
        yield f"    {place}"
        last = (folder, name)


def main() -> None:
    """Prints the report."""
    parser = argparse.ArgumentParser(description="The figures of the house.")
    parser.add_argument("source", nargs="?", type=Path, default=house.SOURCE, help="folder of the package")
    parser.add_argument("--list", nargs="*", metavar="PLACE", help="offenders, of all or of these places")
    asked = parser.parse_args()
    source = asked.source.resolve()
    found = figures(House(source), house.kernel_lines(source.parents[1] / "pyproject.toml"))
    print(f"{'':38}{'before':>9}{'due':>9}   now")
    for figure in found:
        print(
            f"{figure.name:38}{figure.before:>9}{figure.due:>9}   {figure.now}; {len(figure.offenders)} listed"
        )
    if asked.list is not None:
        print(*by_folder(found, asked.list), sep="\n")


if __name__ == "__main__":
    main()
