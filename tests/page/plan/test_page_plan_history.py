from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.page.plan.history import KEPT, History
from elbowroom.page.plan.layout import Layout


def plain(value: float) -> Layout:
    return Layout(joints={"j": value})


@settings(max_examples=60)
@given(st.lists(st.sampled_from(["do", "undo", "redo", "drag", "let go"]), max_size=40))
def test_undo_and_redo_are_as_two_stacks_of_values(deeds: list[str]) -> None:
    history, past, future, now, held = History(plain(0)), [], [], 0.0, False
    for number, deed in enumerate(deeds, 1):
        if deed == "undo":
            history.undo()
            if past:
                future.append(now)
                now = past.pop()
            held = False
        elif deed == "redo":
            history.redo()
            if future:
                past.append(now)
                now = future.pop()
            held = False
        elif deed == "let go":
            history.let_go()
            held = False
        else:
            history.become(plain(number), "drag" if deed == "drag" else None)
            if deed == "do" or not held:
                past.append(now)
            now, future, held = float(number), [], deed == "drag"
        assert history.now.joints["j"] == now
        assert (history.can_undo, history.can_redo) == (bool(past), bool(future))


def test_a_drag_is_one_step_and_another_drag_another() -> None:
    history = History(plain(0))
    for value in (1, 2, 3):
        history.become(plain(value), "camera a")
    history.become(plain(4), "camera b")
    assert history.undo().joints["j"] == 3
    assert history.undo().joints["j"] == 0


def test_it_does_not_grow_without_end() -> None:
    history = History(plain(0))
    for value in range(KEPT + 50):
        history.become(plain(value))
    steps = 0
    while history.can_undo:
        history.undo()
        steps += 1
    assert steps == KEPT


def test_undo_gives_back_the_very_same_layout() -> None:
    first = plain(0)
    history = History(first)
    history.become(replace(first, joints={"j": 1.0}))
    assert history.undo() is first
