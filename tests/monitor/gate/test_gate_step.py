"""The gate's laws: falls at once and rises slowly, latched until reset, a reset starts nothing, silence is stop."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from elbowroom.errors import InputError
from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason
from elbowroom.monitor.gate import step as code
from elbowroom.monitor.gate.claim import Claim
from elbowroom.monitor.gate.state import (
    Decision,
    Ended,
    Event,
    GateState,
    Held,
    Judged,
    Phase,
    ResetAsked,
    Rules,
    Ticked,
)
from elbowroom.monitor.gate.step import step
from elbowroom.motion import Level

MS = 1_000_000
PAGE = (Path(__file__).resolve().parents[3] / "docs" / "safety.md").read_text(encoding="utf-8")
RULES = Rules(("slide +", "slide -", "turn +"))
WATCH = Fault(Reason.WATCH, "cam1", "camera cam1 has moved")
FAULTS = [Fault(reason, subject) for reason in Reason if reason.is_fault for subject in ("", "cam1")]
BARRIERS = [Reason.SURFACE, Reason.MACHINE, Reason.BLIND, Reason.OUTSIDE_GRID, Reason.UNSEEN, Reason.KEPT_OUT]


def clear(motion: str) -> Claim:
    return Claim(motion, Level.CLEAR, 1.0, Reason.NONE)


def blocked(motion: str, reason: Reason = Reason.SURFACE, escapes: bool = False) -> Claim:
    return Claim(motion, Level.STOP, 0.0, reason, reason is Reason.UNSEEN, escapes)


def whole(*claims: Claim) -> Judged:
    """A pass without fault: what is given for the first motions, clear for the others."""
    return Judged((*claims, *(clear(motion) for motion in RULES.motions[len(claims) :])))


def run(*events: Event, every_ms: int = 100, state: GateState | None = None) -> tuple[GateState, Decision]:
    """What events come to that follow each other so fast."""
    state = state or GateState.start(RULES)
    now_ns = (state.seen_ns or 0) + every_ms * MS
    for event in events:
        state, decision = step(state, event, now_ns, RULES)
        now_ns += every_ms * MS
    return state, decision


@st.composite
def claims(draw: st.DrawFn, motion: str) -> Claim:
    level = draw(st.sampled_from(Level))
    speed = 0.0 if level is Level.STOP else draw(st.floats(0, 1))
    reason = draw(st.sampled_from(BARRIERS))
    return Claim(motion, level, speed, reason, reason is Reason.UNSEEN, draw(st.booleans()))


PASSES = st.builds(
    Judged,
    st.tuples(*(claims(motion) for motion in RULES.motions)),
    st.lists(st.sampled_from(FAULTS), max_size=2).map(tuple),
)
WHOLE = PASSES.map(lambda judged: Judged(judged.claims))
EVENTS = st.one_of(
    PASSES, WHOLE, st.just(Ticked()), st.just(Held()), st.just(ResetAsked()), st.just(Judged(()))
)


class GateMachine(RuleBasedStateMachine):
    """Passes, faults, time, held signals and resets in any order; the laws hold after each of them."""

    def __init__(self) -> None:
        super().__init__()
        self.state = GateState.start(RULES)
        self.now_ns = 1_000_000_000
        self.event: Event = Ticked()
        self.before, self.before_ns = self.state, self.now_ns
        self.said: Decision | None = None
        self.unreset: set[tuple[Reason, str]] = set()
        self.passes: list[int] = []
        self.held_ns: int | None = None

    def tell(self, event: Event, later_ms: float) -> None:
        self.before, self.before_ns, self.event = self.state, self.now_ns, event
        self.now_ns += round(later_ms * MS)
        self.state, self.said = step(self.state, event, self.now_ns, RULES)
        if isinstance(event, Judged):
            self.unreset |= {(fault.reason, fault.subject) for fault in event.faults}
            self.passes.append(self.now_ns)
        if isinstance(event, Held):
            self.held_ns = self.now_ns
        if self.said.is_reset:
            self.unreset.clear()
            self.passes.clear()

    @rule(judged=PASSES, later_ms=st.floats(0, 800))
    def a_pass(self, judged: Judged, later_ms: float) -> None:
        self.tell(judged, later_ms)

    @rule(judged=WHOLE, later_ms=st.floats(0, 300))
    def a_whole_pass(self, judged: Judged, later_ms: float) -> None:
        self.tell(judged, later_ms)

    @rule(later_ms=st.floats(0, 100))
    def all_clear(self, later_ms: float) -> None:
        self.tell(whole(), later_ms)

    @rule(judged=WHOLE, motion=st.sampled_from(RULES.motions))
    def a_pass_without_a_verdict(self, judged: Judged, motion: str) -> None:
        self.tell(Judged(tuple(claim for claim in judged.claims if claim.motion != motion)), 50)
        self.unreset.add((Reason.FAULT, ""))

    @rule(later_ms=st.floats(0, 1200))
    def time_goes_by(self, later_ms: float) -> None:
        self.tell(Ticked(), later_ms)

    @rule(later_ms=st.floats(0, 100))
    def a_person_holds_on(self, later_ms: float) -> None:
        self.tell(Held(), later_ms)

    @rule(later_ms=st.floats(0, 100))
    def a_person_resets(self, later_ms: float) -> None:
        self.tell(ResetAsked(), later_ms)

    @precondition(lambda self: self.state.phase is Phase.LATCHED)
    @rule()
    def a_person_resets_while_a_cause_is_there(self) -> None:
        self.tell(ResetAsked(), 1)
        assert self.said is not None and not self.said.is_reset
        assert self.said.answer is not None and self.said.answer.startswith("refused")

    @invariant()
    def speeds_rise_by_the_rate_and_with_passes_alone(self) -> None:
        gap_s = min(self.now_ns - self.before_ns, RULES.deadline_ns) / 1e9
        if len(self.passes) > 1:
            gap_s = min(self.passes[-1] - self.passes[-2], RULES.deadline_ns) / 1e9
        rise = RULES.rise_per_s * gap_s if isinstance(self.event, Judged) and len(self.passes) > 1 else 0.0
        for before, after in zip(self.before.speeds, self.state.speeds, strict=True):
            assert after <= before + rise + 1e-12

    @invariant()
    def no_more_than_the_last_pass_claims(self) -> None:
        if self.said is None or not isinstance(self.event, Judged) or len(self.event.claims) != 3:
            return
        for claim, allowed in zip(self.event.claims, self.said.motions, strict=True):
            creeps = claim.escapes or (claim.overridable and allowed.held)
            assert allowed.speed <= max(claim.speed, RULES.low_speed if creeps else 0.0)

    @invariant()
    def latched_until_reset(self) -> None:
        latched = {(fault.reason, fault.subject) for fault in self.state.latched}
        assert self.unreset <= latched
        if self.said is None or not latched:
            return
        assert self.said.level is Level.STOP and self.said.speed == 0
        for allowed in self.said.motions:
            assert allowed.speed == 0 or (allowed.held and allowed.escapes)
            assert allowed.speed <= RULES.low_speed

    @invariant()
    def a_reset_starts_nothing(self) -> None:
        if self.said is not None and self.said.is_reset:
            assert set(self.state.speeds) == {0.0}
            assert self.said.level is Level.STOP
            assert not self.before.active

    @invariant()
    def silence_is_stop(self) -> None:
        last_ns = self.passes[-1] if self.passes else None
        if last_ns is None or self.now_ns - last_ns > RULES.silence_ns:
            assert set(self.state.speeds) == {0.0}
        if last_ns is not None and self.now_ns - last_ns > RULES.silence_ns:
            assert self.state.phase is Phase.LATCHED

    @invariant()
    def what_is_held_ends_with_the_signal(self) -> None:
        if self.said is None or not any(allowed.held for allowed in self.said.motions):
            return
        assert self.held_ns is not None and self.now_ns - self.held_ns <= RULES.hold_ns
        assert self.said.held_until_ns == self.held_ns + RULES.hold_ns
        assert all(allowed.speed <= RULES.low_speed for allowed in self.said.motions if allowed.held)

    @invariant()
    def the_most_cautious_wins(self) -> None:
        if self.said is None:
            return
        motions = self.said.motions
        assert self.said.speed <= min(allowed.speed for allowed in motions)
        assert self.said.level.rank <= min(allowed.level.rank for allowed in motions)
        turn, slide = self.said.joints["turn"], self.said.joints["slide"]
        assert turn == motions[2]
        assert slide.speed == min(motions[0].speed, motions[1].speed)
        assert all((allowed.level is Level.STOP) == (allowed.speed == 0) for allowed in motions)

    @invariant()
    def a_fault_that_is_there_is_latched(self) -> None:
        assert set(self.state.active) <= set(self.state.latched)
        assert (self.state.phase is Phase.LATCHED) == bool(self.state.active)


GateMachine.TestCase.settings = settings(max_examples=60, stateful_step_count=40)
TestGateMachine = GateMachine.TestCase


# laws of one step


@settings(max_examples=150)
@given(st.lists(st.tuples(EVENTS, st.integers(0, 400)), max_size=8), PASSES, st.data())
def test_more_caution_in_a_pass_never_gives_more_speed(
    events: list[tuple[Event, int]], judged: Judged, data: st.DataObject
) -> None:
    state, now_ns = GateState.start(RULES), 0
    for event, later_ms in events:
        now_ns += later_ms * MS
        state, _ = step(state, event, now_ns, RULES)
    lower = tuple(
        replace(claim, level=level, speed=speed)
        for claim in judged.claims
        for level in [Level(data.draw(st.sampled_from(list(Level)[: claim.level.rank + 1])))]
        for speed in [0.0 if level is Level.STOP else data.draw(st.floats(0, claim.speed))]
    )
    more_faults = data.draw(st.lists(st.sampled_from(FAULTS), max_size=1))
    now_ns += 50 * MS
    milder, _ = step(state, judged, now_ns, RULES)
    stricter, _ = step(state, Judged(lower, (*judged.faults, *more_faults)), now_ns, RULES)
    for claim, more, less in zip(judged.claims, milder.speeds, stricter.speeds, strict=True):
        creeps = claim.escapes or claim.overridable  # which motions may creep is the verdict's word
        assert less <= max(more, RULES.low_speed if creeps and not milder.latched else 0.0)
        assert less <= more or creeps


@given(st.lists(st.tuples(EVENTS, st.integers(0, 400)), max_size=8))
def test_the_same_events_come_to_the_same(events: list[tuple[Event, int]]) -> None:
    def once() -> list[tuple[object, ...]]:
        state, now_ns, told = GateState.start(RULES), 0, []
        for event, later_ms in events:
            now_ns += later_ms * MS
            state, said = step(state, event, now_ns, RULES)
            told.append((state.phase, state.speeds, state.latched, said.motions, said.answer))
        return told

    assert once() == once()


# the table of phases and events: the page is compared with the same rows


IN_PHASE = {
    Phase.STARTING: lambda: GateState.start(RULES),
    Phase.GUARDING: lambda: run(whole())[0],
    Phase.LATCHED: lambda: run(whole(), Judged(whole().claims, (WATCH,)))[0],
    Phase.CLEARED: lambda: run(whole(), Judged(whole().claims, (WATCH,)), whole())[0],
    Phase.ENDED: lambda: run(whole(), Ended())[0],
}
EVENT_OF = {
    "whole pass": (whole(), 100),
    "pass with a fault": (Judged(whole().claims, (WATCH,)), 100),
    "two deadlines without a pass": (Ticked(), 501),
    "reset": (ResetAsked(), 100),
    "end": (Ended(), 100),
}


def table_in(text: str) -> list[tuple[str, str, str]]:
    """Phase, event and what follows, of each cell of the table in a text."""
    lines = text[text.index("| in |") :].splitlines()
    heads = [cell.strip() for cell in lines[0].strip().strip("|").split("|")][1:]
    rows = []
    for line in lines[2:]:
        if not line.strip().startswith("|"):
            break
        phase, *cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        rows += [(phase, head, cell) for head, cell in zip(heads, cells, strict=True)]
    return rows


@pytest.mark.parametrize("text", [code.__doc__ or "", PAGE], ids=["code", "page"])
def test_the_table_of_states_is_what_the_gate_does(text: str) -> None:
    rows = table_in(text)
    assert len(rows) == len(IN_PHASE) * len(EVENT_OF)
    for phase, event_name, then in rows:
        event, later_ms = EVENT_OF[event_name]
        before = IN_PHASE[Phase[phase]]()
        assert before.phase is Phase[phase]
        after, said = run(event, every_ms=later_ms, state=before)
        assert after.phase.name == then.removesuffix(", refused"), (phase, event_name)
        assert (said.answer or "").startswith("refused") == then.endswith("refused"), (phase, event_name)


# what the laws mean, one by one


def test_starts_in_stop() -> None:
    _, said = run(Ticked())
    assert said.level is Level.STOP
    assert {allowed.reason for allowed in said.motions} == {Reason.STARTING}


def test_first_pass_moves_nothing_and_the_next_ones_raise_the_speed() -> None:
    state, said = run(whole())
    assert said.level is Level.STOP and said.speed == 0
    speeds = []
    for _ in range(25):
        state, said = run(whole(), state=state)
        speeds.append(said.speed)
    assert speeds[:3] == pytest.approx([0.05, 0.1, 0.15])
    assert speeds[-1] == 1
    assert said.level is Level.CLEAR and said.reason is Reason.NONE


def test_speed_falls_at_once() -> None:
    state, _ = run(*[whole()] * 30)
    state, said = run(whole(blocked("slide +")), state=state)
    assert said.motions[0].speed == 0 and said.motions[0].reason is Reason.SURFACE
    assert said.motions[1].level is Level.CLEAR
    assert said.speed == 0


def test_stop_before_something_seen_latches_nothing() -> None:
    state, said = run(whole(), whole(blocked("slide +")), whole(), whole())
    assert state.phase is Phase.GUARDING and said.motions[0].speed > 0


def test_cause_that_clears_clears_no_latch() -> None:
    state, said = run(whole(), Judged(whole().claims, (WATCH,)), *[whole()] * 50)
    assert state.phase is Phase.CLEARED
    assert said.reason is Reason.RESET_DUE
    assert said.latched == (WATCH,) and said.latched[0].sentence == "camera cam1 has moved"


def test_reset_stops_and_speed_rises_from_zero() -> None:
    state, _ = run(*[whole()] * 30)
    state, said = run(Judged(whole().claims, (WATCH,)), whole(), ResetAsked(), state=state)
    assert said.is_reset and state.phase is Phase.STARTING
    state, said = run(whole(), state=state)
    assert said.speed == 0
    _, said = run(whole(), state=state)
    assert said.speed == pytest.approx(0.05)


def test_failed_pass_ends_no_other_fault() -> None:
    broken = Judged((), (Fault(Reason.FAULT, "", "KeyError: 'joints'"),))
    state, _ = run(whole(), Judged(whole().claims, (WATCH,)), broken)
    assert WATCH in state.active
    state, said = run(ResetAsked(), state=state)
    assert not said.is_reset and "camera cam1 has moved" in (said.answer or "")


def test_restart_is_no_reset() -> None:
    state = GateState.start(RULES, (WATCH,))
    state, said = run(whole(), whole(), state=state)
    assert state.phase is Phase.CLEARED and said.level is Level.STOP


def test_reset_before_any_pass_is_refused() -> None:
    _, said = run(ResetAsked(), state=GateState.start(RULES, (WATCH,)))
    assert said.answer == "refused: what stopped is still there: camera cam1 has moved"


def test_clock_that_goes_back_is_a_fault() -> None:
    state, _ = run(*[whole()] * 5)
    state, said = step(state, whole(), (state.seen_ns or 0) - 1, RULES)
    assert state.phase is Phase.LATCHED and said.reason is Reason.CLOCK


def test_override_creeps_into_unseen_space_while_held() -> None:
    state, _ = run(whole(), whole())
    unseen, seen = blocked("slide +", Reason.UNSEEN), blocked("slide -", Reason.SURFACE)
    said = None
    for _ in range(5):
        state, said = run(Held(), whole(unseen, seen), state=state, every_ms=50)
    assert said is not None
    assert said.motions[0].speed == RULES.low_speed and said.motions[0].held
    assert said.motions[0].level is Level.DECELERATE
    assert said.motions[1].speed == 0
    assert said.held_until_ns == (state.held_ns or 0) + 200 * MS
    state, said = run(Ticked(), state=state, every_ms=160)
    assert said.motions[0].speed == 0


def test_override_is_no_faster_than_its_claim() -> None:
    unseen = replace(blocked("slide +", Reason.UNSEEN), creep_speed=0.03)
    _, said = run(whole(), *[Held(), whole(unseen)] * 10, every_ms=50)
    assert said.motions[0].speed == 0.03 and said.motions[0].held


@pytest.mark.parametrize("reason", [reason for reason in BARRIERS if reason is not Reason.UNSEEN])
def test_override_overrides_nothing_that_was_seen(reason: Reason) -> None:
    _, said = run(whole(), *[Held(), whole(blocked("slide +", reason))] * 10, every_ms=50)
    assert said.motions[0].speed == 0


def test_escape_is_slow_and_needs_nobody_to_hold() -> None:
    _, said = run(whole(), *[whole(blocked("slide +", escapes=True))] * 10)
    assert said.motions[0].speed == RULES.low_speed and said.motions[0].escapes and not said.motions[0].held
    leads_out = replace(clear("slide +"), escapes=True)
    _, said = run(*[whole(leads_out)] * 30)
    assert said.motions[0].speed == RULES.low_speed


def test_escape_under_a_latch_needs_a_person_who_holds_on() -> None:
    disk = Fault(Reason.LATCH_FILE, "", "No space left on device")
    stuck = Judged(whole(blocked("slide +", escapes=True)).claims, (disk,))
    _, said = run(whole(), *[stuck] * 10)
    assert said.motions[0].speed == 0
    _, said = run(whole(), *[Held(), stuck] * 10, every_ms=50)
    assert said.motions[0].speed == RULES.low_speed and said.motions[0].held
    assert said.level is Level.STOP and said.speed == 0
    assert said.motions[1].speed == 0


def test_no_escape_while_what_is_known_of_the_machine_is_in_doubt() -> None:
    for reason in (Reason.WATCH, Reason.INPUT, Reason.STALE, Reason.FAULT):
        stuck = Judged(whole(blocked("slide +", escapes=True)).claims, (Fault(reason),))
        _, said = run(whole(), *[Held(), stuck] * 10, every_ms=50)
        assert {allowed.speed for allowed in said.motions} == {0.0}


def test_what_is_refused_when_the_rules_are_made() -> None:
    with pytest.raises(InputError, match="no motion"):
        Rules(())
    for wrong in ({"deadline_ns": 0}, {"rise_per_s": -1.0}, {"low_speed": 0.6}, {"hold_ns": 200_000_001}):
        with pytest.raises(InputError, match=next(iter(wrong))):
            Rules(("a +",), **wrong)
    with pytest.raises(InputError, match="no fault"):
        Fault(Reason.SURFACE)


@pytest.mark.parametrize("speed", [float("nan"), -0.1, 1.1])
def test_claims_are_checked(speed: float) -> None:
    with pytest.raises(InputError, match="speed"):
        Claim("a +", Level.CLEAR, speed, Reason.NONE)
    with pytest.raises(InputError, match="speed"):
        Claim("a +", Level.STOP, 0.1, Reason.SURFACE)
