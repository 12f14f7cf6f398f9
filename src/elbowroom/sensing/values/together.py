"""Findings of several cameras that say the same as one."""

from collections.abc import Iterable

from elbowroom.finding import Finding

NAMED = 6
"""So many cameras are named; of more, only how many there are beside."""


def together(findings: Iterable[Finding], cameras: int) -> tuple[Finding, ...]:
    """One finding for all cameras of which the same was found; its numbers are those of the first.

    Args:
        findings: each of one camera, with a text that does not name it.
        cameras: how many there are.
    """
    groups: dict[tuple[str, bool], list[Finding]] = {}
    for finding in findings:
        groups.setdefault((finding.kind, finding.stops), []).append(finding)
    merged = []
    for (kind, stops), found in groups.items():
        names = tuple(dict.fromkeys(name for finding in found for name in finding.about))
        merged.append(Finding(kind, names, f"{_named(names, cameras)}: {found[0].text}", stops))
    return tuple(merged)


def _named(names: tuple[str, ...], cameras: int) -> str:
    if len(names) == 1:
        return f"camera {names[0]}"
    if len(names) == cameras and cameras > NAMED:
        return f"all {cameras} cameras"
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return f"cameras {', '.join(names[:NAMED])}{more}"
