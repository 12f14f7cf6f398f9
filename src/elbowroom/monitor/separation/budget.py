"""The budget of distances of a site: every term, its value, where it comes from, and the sums."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from elbowroom.monitor.separation.figures import Figures
from elbowroom.monitor.separation.margins import Margins
from elbowroom.monitor.separation.reaction import Reaction

ASSUMED = (
    "all joints run at full speed at once, and brake together; speeds and braking times are the site's",
    "a joint that moves a link from farther up does so with the chain between them stretched out",
    "a person comes straight on at that speed for as long as the machine takes to stand",
    "the reaction time is the sum of the worst terms that this run met: a busier computer takes longer",
    "formulas are as the literature gives ISO 10218-2:2025 and ISO 13855:2024; check them in the standards",
)
"""What every budget takes for granted."""
GROUPS = {
    "reaction": "reaction time T_r",
    "standing": "from what stands still: S_r + S_s + Z_d + Z_r",
    "person": "from a person, ISO 10218-2:2025: S_p = S_h + S_r + S_s + C + Z_d + Z_r",
    "reaching": "from where hands are noticed, ISO 13855:2024: S = K T + D_DS + Z, K = {reaching_m_s:g} m/s",
    "walking": "from where bodies are noticed, ISO 13855:2024: S = K T + D_DS + Z, K = {walking_m_s:g} m/s",
}
"""What the terms add up to, in the order in which they are said."""


@dataclass(frozen=True, slots=True)
class Term:
    """A line of the budget.

    Args:
        group: which sum it is a part of.
        symbol: as the standards write it; empty: they have none.
        words: what it is.
        value: [unit].
        unit: "ms" or "m".
        source: a key of the site file, "measured", or why it is taken to be so.
        is_sum: whether it is the sum of its group.
    """

    group: str
    symbol: str
    words: str
    value: float
    unit: str
    source: str
    is_sum: bool = False

    def row(self) -> dict[str, Any]:
        """As a file has it; what has no bound is None."""
        return {
            "kind": "sum" if self.is_sum else "term",
            "group": self.group,
            "symbol": self.symbol,
            "words": self.words,
            "value": self.value if math.isfinite(self.value) else None,
            "unit": self.unit,
            "source": self.source,
        }


@dataclass(frozen=True, slots=True)
class Budget:
    """What was measured of a run, beside what its site says.

    Args:
        figures: of the site.
        worst: the worst of each term of the reaction time; None: nothing could be measured.
        passes: so many were made.
        margins: of the passes, the least of each kind [m], by its name; none were known.
    """

    figures: Figures
    worst: Reaction | None
    passes: int
    margins: Mapping[str, float]

    @property
    def reaction_s(self) -> float | None:
        """T_r [s]; None: it is neither measured nor vouched for."""
        return self.figures.reaction_s(None if self.worst is None else self.worst.total_ms)

    @property
    def worst_link(self) -> str:
        """The link from which people have to stay farthest; empty: no link is checked."""
        separation, reaction_s = self.figures.separation, self.reaction_s or 0.0
        return max(
            separation.stopping_m, key=lambda link: separation.from_standing_m(link, reaction_s), default=""
        )

    def terms(self) -> list[Term]:
        """Every term and every sum; without a reaction time that alone, as far as it goes."""
        terms = [*self._reaction()]
        known = self.reaction_s
        if known is None or not self.worst_link:
            return terms
        terms.append(_sum("reaction", "T_r", "reaction time", 1e3 * known, "ms"))
        separation, link = self.figures.separation, self.worst_link
        still, moving = [*self._still(known)], [*self._moving(known)]
        terms += [replace(term, group="standing") for term in still]
        terms.append(_sum("standing", "", f"from {link}", separation.from_standing_m(link, known)))
        terms += [replace(term, group="person") for term in (moving[0], *still[:2], moving[1], *still[2:])]
        terms.append(_sum("person", "S_p", f"from {link}", separation.from_person_m(link, known)))
        for group, key in (("reaching", "reaching_m_s"), ("walking", "walking_m_s")):
            terms += self._fixed(group, key, known)
        return terms

    def _reaction(self) -> Iterator[Term]:
        entry = self.figures.entry
        if self.worst is not None:
            for words, value, what in (
                ("from one image of a camera to the next", self.worst.period_ms, "between stamps"),
                ("age of the images when a pass begins", self.worst.age_ms, "from their stamps"),
                ("the pass, frames to verdicts", self.worst.pass_ms, "by this computer's clock"),
                ("from verdicts to the decision", self.worst.output_ms, "by this computer's clock"),
            ):
                source = f"measured {what}, worst of {self.passes} passes"
                yield Term("reaction", "", words, value, "ms", source)
        if entry.reaction_ms is not None:
            missing = entry.reaction_ms - (0.0 if self.worst is None else self.worst.total_ms)
            if missing > 0:
                yield Term(
                    "reaction", "", "vouched for beyond that", missing, "ms", "site: separation.reaction_ms"
                )
        said = "site: separation.command_ms" if entry.command_ms is not None else (
            "0: not known here; the receiver and the drives take time, write separation.command_ms"
        )  # fmt: skip
        yield Term("reaction", "", "from the decision to the brakes", self.figures.command_ms, "ms", said)

    def _still(self, reaction_s: float) -> Iterator[Term]:
        """S_r, S_s, Z_d, Z_r."""
        entry, separation, link = self.figures.entry, self.figures.separation, self.worst_link
        way = separation.reaction_way_m(link, reaction_s)
        speed = separation.speeds_m_s[link]
        yield Term(
            "", "S_r", f"{link} at {speed:.2f} m/s for T_r", way, "m", "site: joints, speeds; T_r as above"
        )
        stopping = separation.stopping_m[link]
        yield Term(
            "", "S_s", f"{link} until it stands", stopping, "m", "site: joints, speeds and braking times"
        )
        person = "0: distances are to space that holds whatever is there, margins and all"
        yield Term(
            "",
            "Z_d",
            "where the person is",
            separation.person_m,
            "m",
            person if entry.person_uncertainty_mm is None else "site: separation.person_uncertainty_mm",
        )
        machine = "explain_tolerance_m: what is farther from the model is seen, and blocked"
        yield Term(
            "",
            "Z_r",
            "where the machine is",
            separation.machine_m,
            "m",
            machine if entry.machine_uncertainty_mm is None else "site: separation.machine_uncertainty_mm",
        )

    def _moving(self, reaction_s: float) -> Iterator[Term]:
        """S_h and C."""
        separation = self.figures.separation
        words = f"a person at {separation.walking_m_s:g} m/s for T_r + T_s ({separation.stopping_time_s:g} s)"
        source = f"{self._said('walking_m_s')}; T_s: site: joints, braking_time_s"
        yield Term("", "S_h", words, separation.person_way_m(reaction_s), "m", source)
        yield self._intrusion("C")

    def _intrusion(self, symbol: str) -> Term:
        if self.figures.entry.intrusion_mm is not None:
            source = "site: separation.intrusion_mm"
        else:
            source = (
                f"detection capability {1e3 * self.figures.capability_m:.0f} mm at the far end: "
                "8 (d - 14 mm) up to 40 mm, else an arm, 850 mm"
            )
        words = "how far somebody reaches before being noticed"
        return Term("", symbol, words, self.figures.separation.intrusion_m, "m", source)

    def _fixed(self, group: str, key: str, reaction_s: float) -> list[Term]:
        separation = self.figures.separation
        speed = getattr(separation, key)
        way = speed * (reaction_s + separation.stopping_time_s)
        both = separation.person_m + separation.machine_m
        source = f"{self._said(key)}; T = T_r + T_s"
        return [
            Term(group, "K T", f"a person at {speed:g} m/s until the machine stands", way, "m", source),
            replace(self._intrusion("D_DS"), group=group),
            Term(group, "Z", "where person and machine are, Z_d + Z_r", both, "m", "as above"),
            _sum(group, "S", "from the machine's space", separation.fixed_m(reaction_s, speed)),
        ]

    def _said(self, key: str) -> str:
        is_said = key in self.figures.entry.model_fields_set
        return f"site: separation.{key}" if is_said else "default, as the standards take it"

    def rows(self) -> list[dict[str, Any]]:
        """Terms, sums and the least margins, as a file has them."""
        known, separation = self.reaction_s, self.figures.separation
        summary = {
            "kind": "budget",
            "passes": self.passes,
            "reaction_time_ms": None if known is None else 1e3 * known,
            "stopping_time_s": separation.stopping_time_s,
            "required_iso_13855_m": None if known is None else separation.required_fixed_m(known),
            "looked_m": self.figures.look_m,
            "least_margins_m": dict(self.margins),
            "assumed": list(ASSUMED),
        }
        return [*(term.row() for term in self.terms()), summary]


def least_margins(found: Sequence[Margins]) -> dict[str, float]:
    """The least margins of some passes [m]: against what stands, and against a person out of unseen space.

    Args:
        found: of the passes.
    """
    each = {
        "standing": [margins.least_standing_m for margins in found],
        "person": [margins.least_person_m for margins in found],
    }
    known = {name: [m for m in values if m is not None] for name, values in each.items()}
    return {name: min(values) for name, values in known.items() if values}


def _sum(group: str, symbol: str, words: str, value: float, unit: str = "m") -> Term:
    return Term(group, symbol, words, value, unit, "", is_sum=True)
