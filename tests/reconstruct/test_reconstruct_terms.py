"""How strictly space is judged: refused where it cannot be, equal where it judges alike, the same from a site file."""

import subprocess
import sys
from dataclasses import FrozenInstanceError, replace

import pytest

from elbowroom.choices import DETAILS, LAWFUL, RULES
from elbowroom.errors import InputError, MachineError
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct import Terms
from elbowroom.site import Site
from elbowroom.site.schema import SiteEntry


@pytest.mark.parametrize(
    ("given", "kind", "message"),
    [
        ({"rule": "most"}, InputError, "rule: 'most' is unknown, allowed are three, majority, veto, any"),
        ({"detail": "voxel"}, InputError, "detail: 'voxel' is unknown, allowed are footprint, pixel, point"),
        ({"max_age_ns": -1}, InputError, "max_age_ns: is -1, must be at least 0"),
        ({"explain_tolerance_m": -0.1}, MachineError, "explain_tolerance_m is -0.1"),
        ({"explain_tolerance_m": float("nan")}, MachineError, "explain_tolerance_m is nan"),
        ({"body_growth_m": 0.0}, MachineError, "body_growth_m is 0.0"),
        ({"body_growth_m": float("inf")}, MachineError, "body_growth_m is inf"),
    ],
)
def test_what_cannot_be_is_refused(given, kind, message):
    with pytest.raises(kind, match=message):
        Terms(**given)


def test_terms_that_judge_alike_are_equal_and_do_not_change():
    terms = Terms(margin=Margin(bias_m=0.01), max_age_ns=5)
    assert terms == Terms(margin=Margin(bias_m=0.01), max_age_ns=5) and hash(terms) == hash(replace(terms))
    others = {
        "rule": "any",
        "detail": "point",
        "margin": Margin(),
        "max_age_ns": None,
        "explain_tolerance_m": 0.02,
        "body_growth_m": 0.05,
        "look_again": False,
    }
    assert all(replace(terms, **{name: value}) != terms for name, value in others.items())
    with pytest.raises(FrozenInstanceError):
        terms.rule = "any"


def test_three_alone_needs_no_counts_and_what_is_lawful_is_a_rule():
    assert [rule for rule in RULES if not Terms(rule).needs_counts] == ["three"]
    assert set(LAWFUL) < set(RULES)


def test_a_site_says_its_terms_unless_told_others():
    site = Site.simulated_room()
    terms = site.terms()
    assert terms == Terms(
        site.rule, site.detail, site.margin(), site.max_age_ns, site.explain_tolerance_m, None, True
    )
    assert site.terms("majority", "point") == replace(terms, rule="majority", detail="point")


def test_a_site_file_allows_the_same_words():
    fields = SiteEntry.model_json_schema()["properties"]
    assert tuple(fields["rule"]["enum"]) == RULES and tuple(fields["detail"]["enum"]) == DETAILS


def test_the_words_load_nothing():
    code = (
        "import sys, elbowroom.choices; "
        "print(sorted(m for m in sys.modules if m in ('numpy', 'numba') or m.startswith('elbowroom.')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['elbowroom._kernel_cache', 'elbowroom.choices']"
