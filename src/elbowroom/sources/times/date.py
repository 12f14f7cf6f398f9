"""A date and time in the name of a file."""

import re
from datetime import UTC, datetime

_DATE = re.compile(r"((?:19|20)\d\d)\D?(\d\d)\D?(\d\d)\D?(\d\d)\D?(\d\d)\D?(\d\d)(?:\D?(\d{1,9}))?(?!\d)")


def date_in(name: str) -> int | None:
    """A date and time in a name, as if of UTC [us since 1970]; None: there is none."""
    found = _DATE.search(name)
    if found is None:
        return None
    *date, fraction = found.groups()
    try:
        whole = datetime(*map(int, date), tzinfo=UTC)  # type: ignore[arg-type,misc]
    except ValueError:
        return None
    return round(whole.timestamp()) * 1_000_000 + int((fraction or "0")[:6].ljust(6, "0"))
