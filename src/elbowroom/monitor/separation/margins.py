"""The margins of a pass: how far the machine is from blocked space beyond what has to lie between."""

from dataclasses import dataclass
from typing import Any

from elbowroom.monitor.separation.figures import Figures
from elbowroom.monitor.separation.reaction import Reaction
from elbowroom.motion.distances import Distances, LinkDistances, Nearest


@dataclass(frozen=True, slots=True)
class Margins:
    """What a pass came to.

    Args:
        distances: of each link.
        figures: of the site.
        reaction: of this pass; None: not known.
        measured_ms: the sum of the worst terms so far [ms]; None: nothing was measured yet.
    """

    distances: Distances
    figures: Figures
    reaction: Reaction | None
    measured_ms: float | None

    @property
    def reaction_s(self) -> float | None:
        """T_r that the margins are by [s]; None: it is not known, and neither are they."""
        return self.figures.reaction_s(self.measured_ms)

    def standing_m(self, to: Nearest) -> float | None:
        """What is left before something that stands still: distance - (S_r + S_s + Z_d + Z_r) [m].

        Args:
            to: how far a link is from it.
        """
        known = self.reaction_s
        return (
            None if known is None else to.distance_m - self.figures.separation.from_standing_m(to.link, known)
        )

    def person_m(self, to: Nearest) -> float | None:
        """What is left before a person who comes out of there: distance - S_p [m].

        Args:
            to: how far a link is from it.
        """
        known = self.reaction_s
        return (
            None if known is None else to.distance_m - self.figures.separation.from_person_m(to.link, known)
        )

    @property
    def least_standing_m(self) -> float | None:
        """The least margin of any link against what stands, seen or not [m]."""
        return self._least([self.standing_m(link.blocked) for link in self.distances.links])

    @property
    def least_person_m(self) -> float | None:
        """The least margin of any link against a person who steps out of space that nobody sees [m]."""
        return self._least([self.person_m(link.unseen) for link in self.distances.links])

    @staticmethod
    def _least(margins: list[float | None]) -> float | None:
        return min((margin for margin in margins if margin is not None), default=None)

    def row(self) -> dict[str, Any]:
        """As a file has it; margins are None while no reaction time is known."""
        seen, unseen = self.distances.seen, self.distances.unseen
        known = self.reaction_s
        return {
            "nearest_seen": None if seen is None else seen.row(),
            "nearest_unseen": None if unseen is None else unseen.row(),
            "looked_m": self.distances.up_to_m,
            "slack_m": self.distances.slack_m,
            "standing_margin_m": self.least_standing_m,
            "person_margin_m": self.least_person_m,
            "reaction_ms": None if self.reaction is None else self.reaction.row(),
            "worst_reaction_ms": self.measured_ms,
            "reaction_time_ms": None if known is None else 1e3 * known,
            "links": [self._link_row(link) for link in self.distances.links],
        }

    def _link_row(self, link: LinkDistances) -> dict[str, Any]:
        return {
            "link": link.link,
            "seen_m": link.seen.distance_m,
            "unseen_m": link.unseen.distance_m,
            "standing_margin_m": self.standing_m(link.blocked),
            "person_margin_m": self.person_m(link.unseen),
            "seen_person_margin_m": self.person_m(link.seen),
        }
