from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.geometry import looking_at
from elbowroom.motion import Level
from elbowroom.page.plan.drive import driven
from elbowroom.page.plan.errands import walked_words
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout, PlacedCamera, PlacedPerson
from elbowroom.page.plan.package_room import package_room
from elbowroom.page.plan.planner import Planner
from elbowroom.page.plan.stale import Stale
from elbowroom.page.plan.walk import Watch, over_floor, walked
from elbowroom.page.words import words_of
from elbowroom.placement import known_sensors
from elbowroom.simulate import wall_cameras


@pytest.fixture(scope="module")
def arm() -> Ground:
    return Ground.of(package_room("simulated"), 0.1)


@pytest.fixture(scope="module")
def watched(arm) -> Layout:
    """Eight small cameras at two heights."""
    cameras = wall_cameras(8, size="thesis", height_m=(2.4, 0.4))
    return replace(arm.first_layout(), cameras=tuple(PlacedCamera(one, "thesis") for one in cameras))


@pytest.fixture(scope="module")
def stopped(arm, watched) -> list:
    """Driven with somebody in the way."""
    return list(driven(arm, replace(watched, people=(PlacedPerson("p", -0.6, 0.75),)), "larm", -1))


def test_a_joint_is_driven_until_it_stops_and_never_farther_than_it_was_told(stopped) -> None:
    *on, last = stopped
    assert last.is_last and last.stops and not any(step.is_last for step in on)
    assert len(on) > 2 and all(step.verdict.level is not Level.STOP for step in on)
    positions = np.array([step.position for step in stopped])
    assert (np.diff(positions) < 0).all()
    free = np.array([max(step.verdict.free_travel, 1e-3) for step in on])
    assert (-np.diff(positions) <= free + 1e-12).all()


def test_with_nobody_in_the_way_it_comes_farther(arm, watched, stopped) -> None:
    begun = replace(watched, joints={**watched.joints, "larm": -1.1})
    *_, last = driven(arm, begun, "larm", -1)
    assert not last.stops and last.position == pytest.approx(arm.machine.joint("larm").lower, abs=1e-3)
    assert stopped[-1].position > -0.5


def test_driving_is_given_up_when_nobody_wants_to_know(arm, watched) -> None:
    steps = driven(arm, watched, "larm", 1, lambda: True)
    with pytest.raises(Stale):
        next(steps)


def test_what_cannot_be_driven_is_said(arm, ground) -> None:
    with pytest.raises(InputError, match="no machine"):
        next(driven(ground, Planner(ground).layout, "larm", 1))
    with pytest.raises(InputError, match="no camera"):
        next(driven(arm, replace(arm.first_layout(), cameras=()), "larm", 1))


def looking(position, at) -> Layout:
    """One VGA camera."""
    camera = known_sensors()["vga"].at("eye", looking_at(position, at))
    return Layout((PlacedCamera(camera, "vga"),))


def test_a_person_before_a_camera_is_seen_and_behind_it_or_a_cabinet_is_not(ground) -> None:
    layout = looking((-1.1, -1.1, 1.2), (0.6, 0.6, 1.0))
    watch = Watch(ground, layout)
    assert watch.at(PlacedPerson("p", -0.2, -0.2)).by == ("eye",)
    assert watch.at(PlacedPerson("p", -0.2, -0.2)).seen_pct > 25
    # the shelf is 1.6 m high, and somebody of 1.4 m hides behind it
    hidden = watch.at(PlacedPerson("p", 1.09, 1.09, 0.0, 1.4))
    assert hidden.by == () and hidden.seen_pct < 5
    away = Watch(ground, looking((-1.1, -1.1, 1.2), (-1.15, -1.15, 1.2)))
    assert away.at(PlacedPerson("p", 0.0, 0.0)).seen_pct == 0


def test_no_camera_sees_more_than_a_bodys_near_side(ground) -> None:
    place = Watch(ground, looking((-1.1, 0.0, 1.2), (0.0, 0.0, 1.0))).at(PlacedPerson("p", 0.2, 0.0))
    assert 20 < place.seen_pct < 60


def test_more_cameras_see_no_less(ground) -> None:
    every = Planner(ground).layout
    fewer = replace(every, cameras=every.cameras[:2])
    for few, many in zip(over_floor(ground, fewer), over_floor(ground, every), strict=True):
        assert set(few.by) <= set(many.by) and few.seen_pct <= many.seen_pct


def test_a_walk_has_the_length_that_was_asked_and_is_told_in_a_sentence(ground) -> None:
    layout = looking((-1.1, -1.1, 1.9), (-0.6, -0.6, 0.9))
    places = list(walked(ground, layout, [(-0.8, -0.8), (0.9, -0.8)]))
    assert len(places) == 18
    assert places[0].person.x_m == -0.8 and places[-1].person.x_m == pytest.approx(0.9)
    for language, word in (("en", "nobody sees"), ("de", "niemand")):
        words = words_of(language)
        blind = [replace(place, by=() if place.person.x_m > 0.5 else ("eye",)) for place in places]
        said = walked_words(words, blind)
        assert word in said and words("decimal").join(("1", "7")) in said
        assert "0" not in walked_words(words, [replace(p, by=("a", "b")) for p in places])[-20:]


def test_places_where_furniture_stands_are_not_asked(ground) -> None:
    places = list(over_floor(ground, Planner(ground).layout))
    assert len(places) == 64 - 4  # rows of 25 cm, and a shelf of 40 cm
    assert not any(p.person.x_m > 0.55 and p.person.y_m > 0.55 for p in places)
