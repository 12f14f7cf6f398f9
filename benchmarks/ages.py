"""Says of each figure whether the core has changed since it was measured, by the commit beside it."""

import re
import subprocess
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CORE = tuple(f"src/elbowroom/{name}" for name in ("geometry", "sensing", "machine", "reconstruct", "motion"))
"""What figures of free space and verdicts hang on."""
SINCE = " The core has changed since."
STAMP = re.compile(r"^Measured by .*; commit ([0-9a-f]{7,}(?:-dirty)?)[;.].*$", re.MULTILINE)


def with_ages(page: str) -> str:
    """The page with a sentence behind each stamp of a commit that the core has changed since."""
    return STAMP.sub(lambda found: found[0] + (SINCE if is_older(found[1]) else ""), without_ages(page))


def without_ages(page: str) -> str:
    """The page as it was rendered."""
    return page.replace(SINCE, "")


def unsaid(page: str) -> list[str]:
    """Stamps on a page that are older than the core, and do not say so."""
    return [found[1] for found in STAMP.finditer(page) if not found[0].endswith(SINCE) and is_older(found[1])]


@cache
def is_older(commit: str) -> bool:
    """Whether a commit that touches the core came after this one, or this one is unknown."""
    return _git("log", "-1", "--format=%h", f"{commit.partition('-')[0]}..HEAD", "--", *CORE) != ""


def has_history() -> bool:
    """Whether this is a checkout with all its commits."""
    return _git("rev-parse", "--is-shallow-repository") == "false"


def _git(*words: str) -> str | None:
    """What git answers; None: it fails."""
    try:
        done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout.strip()
