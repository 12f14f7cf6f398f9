"""What a site file says of the watch over its cameras."""

from pathlib import Path
from typing import Annotated

from pydantic import Field

from elbowroom.errors import SiteError
from elbowroom.site.entry import Entry, Number, Text
from elbowroom.site.paths import expand


class WatchEntry(Entry):
    """The file of references that `elbowroom calibrate commission` wrote, and what is not yet called moved."""

    reference: Text
    turn_deg: Annotated[Number, Field(ge=0.05, le=5)] = 0.4
    move_mm: Annotated[Number, Field(ge=1, le=100)] = 8.0

    def reference_path(self, beside: Path) -> Path:
        """The file of references.

        Args:
            beside: the site file's folder.

        Raises:
            SiteError: there is no such file.
        """
        path = expand(self.reference, beside)
        if not path.is_file():
            raise SiteError(
                f"watch.reference: no file {path} (written {self.reference}); "
                "`elbowroom calibrate commission` makes one"
            )
        return path
