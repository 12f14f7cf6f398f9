"""What every point of the empty room must have: some views, far enough apart seen from above (thesis 3.3)."""

from dataclasses import dataclass

from elbowroom.errors import InputError
from elbowroom.site import Site

TIE_RAD = 1e-9
"""Views apart by the angle less this count as far enough apart: rounding [rad]."""


@dataclass(frozen=True, slots=True)
class Requirement:
    """So many cameras must see a point, each two of them at least an angle apart in the horizontal plane.

    Thesis 3.3: three views, 100 degrees apart. Then three things must stand in the way at once, each in another
    direction, to hide the point.

    Args:
        views: how many.
        angle_deg: least angle between any two of them, seen from the point, in the horizontal plane [deg].

    Raises:
        InputError: fewer than one view, or an angle at which so many views have no room on a circle.
    """

    views: int = 3
    angle_deg: float = 100.0

    def __post_init__(self) -> None:
        if self.views != int(self.views) or self.views < 1:
            raise InputError(f"placement: views is {self.views}, must be a whole number of at least 1")
        if not 0 <= self.angle_deg <= 180:
            raise InputError(f"placement: angle is {self.angle_deg:g} degrees, must be from 0 to 180")
        if self.views > 1 and self.views * self.angle_deg > 360:
            raise InputError(
                f"placement: {self.views} views each {self.angle_deg:g} degrees apart do not fit on a circle of 360; "
                f"at most {360 / self.views:g} degrees"
            )

    @property
    def words(self) -> str:
        """The requirement as people say it."""
        if self.views == 1:
            return "1 view"
        return f"{self.views} views, each two at least {self.angle_deg:g} degrees apart"


def requirement_of(site: Site, views: int | None = None, angle_deg: float | None = None) -> Requirement:
    """The requirement of a site's key `placement`, or what is said otherwise.

    Args:
        site: the file.
        views, angle_deg: instead of the site's; None: the site's, or 3 and 100 degrees.

    Raises:
        InputError: a requirement that cannot be met on a circle.
    """
    given = site.entry.placement
    default = Requirement()
    if views is None:
        views = default.views if given is None else given.views
    if angle_deg is None:
        angle_deg = default.angle_deg if given is None else given.angle_deg
    return Requirement(views, angle_deg)
