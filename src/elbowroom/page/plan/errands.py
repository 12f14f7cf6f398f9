"""What takes a while: a joint driven until it stops, a walk through the room. In a thread, and given up for another."""

import itertools
import math
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from elbowroom.errors import ElbowroomError
from elbowroom.page.plan.drawn import Drawn
from elbowroom.page.plan.drive import Step, driven
from elbowroom.page.plan.panel import Panel
from elbowroom.page.plan.planner import Planner
from elbowroom.page.plan.stale import Stale, Stop
from elbowroom.page.plan.walk import Place, over_floor, walked
from elbowroom.page.words import Words
from elbowroom.view.screen.words import travel_text

SHOWN_S = 0.05
"""A walker is shown so long at each place at least [s]."""


@dataclass(slots=True, eq=False)
class Errands:
    """Runs one errand at a time.

    Args:
        planner: whose layout is asked.
        drawn: where it is shown.
        panel: where it is said.
        words: of the language.
    """

    planner: Planner
    drawn: Drawn
    panel: Panel
    words: Words
    _number: int = field(default=0, init=False)
    _thread: threading.Thread | None = field(default=None, init=False)

    def stop(self) -> None:
        """Gives up what is done."""
        self._number += 1
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(5.0)

    def forget(self) -> None:
        """What was found of another layout is shown no longer."""
        if self._thread is threading.current_thread():
            return
        self._number += 1
        self.drawn.show_places([])
        self.drawn.show_walker(None)
        self.drawn.show_contact("", None)

    def drive(self) -> None:
        """Drives the chosen joint until it stops."""
        joint, way = self.panel.at["which_joint"].value, self.panel.at["way"].value
        self._run(lambda is_stale: self._drive(joint, way, is_stale))

    def walk(self) -> None:
        """Walks a person along the chosen way."""
        way = [tuple(float(v) for v in self.panel.at[end].value) for end in ("from", "to")]
        self._run(lambda is_stale: self._walk(way, is_stale))

    def floor(self) -> None:
        """Asks all of the floor who would be seen there."""
        self._run(self._floor)

    def _run(self, errand: Callable[[Stop], None]) -> None:
        self._number += 1
        number = self._number

        def run() -> None:
            try:
                errand(lambda: self._number != number)
            except Stale:
                return
            except ElbowroomError as error:
                self.panel.say(self.words("plan.trouble", text=str(error)))

        self._thread = threading.Thread(target=run, name="errand", daemon=True)
        self._thread.start()

    def _drive(self, joint: str, way: str, is_stale: Stop) -> None:
        ground, layout = self.planner.ground, self.planner.layout
        machine = ground.machine
        last: Step | None = None
        for last in driven(ground, layout, joint, 1 if way == "+" else -1, is_stale):
            assert machine is not None
            at = self._position(joint, last.position)
            self.panel.say(self.words("plan.driving", joint=joint, way=way, at=at))
            self.drawn.scene.place_machine(machine.world_from_links({**layout.joints, joint: last.position}))
        if last is None or is_stale():
            return
        self.planner.move_joint(joint, last.position)
        self.drawn.show_contact(f"{joint} {way}", last.verdict.place_in_world if last.stops else None)
        self.panel.say(self._drove(joint, way, last))

    def _drove(self, joint: str, way: str, last: Step) -> str:
        words, verdict, at = self.words, last.verdict, self._position(joint, last.position)
        if not last.stops:
            return words("plan.drove_limit", joint=joint, way=way, at=at)
        place = ""
        if verdict.place_in_world is not None:
            x, y, z = (words.number(value, 2) for value in verdict.place_in_world)
            place = words("plan.at_place", x=x, y=y, z=z)
        cause = words(f"plan.cause.{verdict.cause.name.lower()}")
        free = travel_text(verdict.free_travel, verdict.free_travel_unit)
        return words("plan.drove_stop", joint=joint, way=way, at=at, free=free, cause=cause, place=place)

    def _position(self, joint: str, value: float) -> str:
        machine = self.planner.ground.machine
        assert machine is not None
        if machine.joint(joint).unit == "rad":
            return f"{self.words.number(math.degrees(value), 1)}°"
        return f"{self.words.number(value, 3)} m"

    def _walk(self, way: Sequence[tuple[float, ...]], is_stale: Stop) -> None:
        places: list[Place] = []
        corners = [(corner[0], corner[1]) for corner in way]
        self.panel.say(self.words("plan.walking"))
        for place in walked(self.planner.ground, self.planner.layout, corners, is_stale=is_stale):
            begun_s = time.monotonic()
            places.append(place)
            self.drawn.show_walker(place)
            self.drawn.show_places(places)
            time.sleep(max(0.0, SHOWN_S - (time.monotonic() - begun_s)))
        self.panel.say(walked_words(self.words, places))

    def _floor(self, is_stale: Stop) -> None:
        self.panel.say(self.words("plan.walking"))
        places = list(over_floor(self.planner.ground, self.planner.layout, is_stale=is_stale))
        self.drawn.show_walker(None)
        self.drawn.show_places(places)
        unseen = sum(not place.by for place in places)
        least = min((len(place.by) for place in places), default=0)
        key = "plan.floor_unseen" if unseen or not places else "plan.floor_seen"
        self.panel.say(self.words(key, count=len(places), unseen=unseen, least=least))


def walked_words(words: Words, places: Sequence[Place]) -> str:
    """A walk in a sentence.

    Args:
        words: of the language.
        places: of the walk, in order.
    """
    at = [(place.person.x_m, place.person.y_m) for place in places]
    steps = [math.dist(one, other) for one, other in itertools.pairwise(at)]
    length, unseen = words.number(sum(steps), 1), [not place.by for place in places]
    if not any(unseen):
        return words("plan.walked_seen", length=length, least=min(len(place.by) for place in places))
    lost = sum(step for step, one, other in zip(steps, unseen[:-1], unseen[1:], strict=True) if one or other)
    return words(
        "plan.walked_unseen",
        length=length,
        unseen=words.number(lost, 1),
        places="; ".join(_stretches(words, places)),
    )


def _stretches(words: Words, places: Sequence[Place]) -> list[str]:
    """Where nobody sees the walker, from where to where."""
    found, begun = list[str](), None
    for number, place in enumerate([*places, None]):
        if place is not None and not place.by:
            begun = number if begun is None else begun
        elif begun is not None:
            first, last = places[begun].person, places[number - 1].person
            x0, y0, x1, y1 = (words.number(v, 1) for v in (first.x_m, first.y_m, last.x_m, last.y_m))
            found.append(words("plan.stretch", x0=x0, y0=y0, x1=x1, y1=y1))
            begun = None
    return found
