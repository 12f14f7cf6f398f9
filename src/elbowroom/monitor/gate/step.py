"""The gate as one pure function: what it remembers, what happens and when, to what it remembers then and what it says.

It holds no clock and keeps nothing. The table of phases and events (docs/safety.md, "The gate"):

| in | whole pass | pass with a fault | two deadlines without a pass | reset | end |
|---|---|---|---|---|---|
| STARTING | GUARDING | LATCHED | STARTING | STARTING, refused | ENDED |
| GUARDING | GUARDING | LATCHED | LATCHED | GUARDING, refused | ENDED |
| LATCHED | CLEARED | LATCHED | LATCHED | LATCHED, refused | ENDED |
| CLEARED | CLEARED | LATCHED | LATCHED | STARTING | ENDED |
| ENDED | ENDED | ENDED | ENDED | ENDED, refused | ENDED |

A pass is whole if it has one claim for each motion and no fault. A held signal changes no phase.
"""

from dataclasses import replace

from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason
from elbowroom.monitor.gate.claim import Claim
from elbowroom.monitor.gate.state import (
    Allowed,
    Decision,
    Ended,
    Event,
    GateState,
    Held,
    Judged,
    Phase,
    ResetAsked,
    Rules,
)
from elbowroom.motion import Level


def step(state: GateState, event: Event, now_ns: int, rules: Rules) -> tuple[GateState, Decision]:
    """What an event makes of the gate. It does not raise, whatever the event says.

    Args:
        state: what is remembered.
        event: what happened.
        now_ns: when [ns of a clock that never goes back; if it does, that is a fault].
        rules: of the run.
    """
    if state.phase is Phase.ENDED:
        return state, _decision(state, rules, _refused(state) if isinstance(event, ResetAsked) else None)
    went_back = state.seen_ns is not None and now_ns < state.seen_ns
    before, now_ns = state, max(now_ns, state.seen_ns or now_ns)
    state = replace(state, seen_ns=now_ns)
    if went_back:
        state = _faulted(state, Fault(Reason.CLOCK))
    if _is_silent(state, now_ns, rules):
        state = _faulted(state, Fault(Reason.SILENCE, "", _silence_text(state, now_ns, rules)))
    answer = None
    match event:
        case Judged():
            state = _judged(state, event, went_back, rules)
        case Held():
            state = replace(state, held_ns=now_ns)
        case ResetAsked():
            answer = _refused(state)
            if answer is None:
                state = replace(
                    state, phase=Phase.STARTING, latched=(), active=(), claims=None, passed_ns=None
                )
        case Ended():
            state = replace(state, phase=Phase.ENDED, claims=None)
    is_reset = isinstance(event, ResetAsked) and answer is None
    rising_s = _since_pass_s(before, now_ns, rules) if isinstance(event, Judged) else 0.0
    state = replace(state, speeds=_speeds(state, now_ns, rising_s, rules))
    said = (
        "reset: the machine stays stopped until the next whole pass, then speed rises" if is_reset else answer
    )
    return state, _decision(state, rules, said, is_reset)


def _judged(state: GateState, event: Judged, went_back: bool, rules: Rules) -> GateState:
    """What a pass makes of the phase and of the faults. It ends the silence before it, but not the latch."""
    silent = tuple(fault for fault in state.active if fault.reason is Reason.SILENCE)
    faults = list(event.faults)
    if tuple(claim.motion for claim in event.claims) != rules.motions:
        missing = [
            motion for motion in rules.motions if motion not in {claim.motion for claim in event.claims}
        ]
        text = f"no usable verdict for {', '.join(missing) or 'the motions as they were asked'}"
        faults.append(Fault(Reason.FAULT, "", text))
    if went_back:
        faults.append(Fault(Reason.CLOCK))
    if any(fault.reason is Reason.FAULT for fault in faults):
        # a pass that failed is no evidence that anything else is over
        faults += [fault for fault in state.active if fault not in faults and fault not in silent]
    state = replace(state, passed_ns=state.seen_ns)
    if not faults:
        over = Phase.CLEARED if state.latched else Phase.GUARDING
        return replace(state, phase=over, active=(), claims=event.claims)
    state = replace(state, active=())
    for fault in faults:
        state = _faulted(state, fault)
    in_doubt = any(fault.reason.leaves_doubt for fault in faults)
    return replace(state, claims=None if in_doubt else event.claims)


def _faulted(state: GateState, fault: Fault) -> GateState:
    """The same with a fault that is there now."""
    latched = state.latched if fault in state.latched else (*state.latched, fault)
    active = tuple(fault if each == fault else each for each in state.active)
    active = active if fault in active else (*active, fault)
    claims = None if fault.reason.leaves_doubt else state.claims
    return replace(state, phase=Phase.LATCHED, latched=latched, active=active, claims=claims)


def _is_silent(state: GateState, now_ns: int, rules: Rules) -> bool:
    """Whether two deadlines went by without a pass; before the first one nothing is late."""
    return state.passed_ns is not None and now_ns - state.passed_ns > rules.silence_ns


def _silence_text(state: GateState, now_ns: int, rules: Rules) -> str:
    took_ms = (now_ns - (state.passed_ns or now_ns)) / 1e6
    return f"no pass was finished for {took_ms:.0f} ms, at most {rules.silence_ns / 1e6:g} ms are allowed"


def _since_pass_s(before: GateState, now_ns: int, rules: Rules) -> float:
    """For how long speeds may have risen since the last pass [s], if it counts; no longer than a deadline."""
    if before.claims is None or before.passed_ns is None:
        return 0.0
    return min(now_ns - before.passed_ns, rules.deadline_ns) / 1e9


def _refused(state: GateState) -> str | None:
    """Why a reset is not done; None: it is."""
    if state.phase is Phase.CLEARED:
        return None
    if state.phase is Phase.LATCHED:
        causes = "; ".join(fault.sentence for fault in state.active) or "no pass has been finished since"
        return f"refused: what stopped is still there: {causes}"
    return f"refused: nothing is latched ({state.phase.value})"


def _speeds(state: GateState, now_ns: int, rising_s: float, rules: Rules) -> tuple[float, ...]:
    """What each motion is allowed: less at once, more by the rate."""
    if state.claims is None or state.phase in (Phase.STARTING, Phase.ENDED):
        return (0.0,) * len(rules.motions)
    most = [_target(state, claim, _is_held(state, now_ns, rules), rules) for claim in state.claims]
    rise = rules.rise_per_s * rising_s
    return tuple(min(target, before + rise) for target, before in zip(most, state.speeds, strict=True))


def _target(state: GateState, claim: Claim, held: bool, rules: Rules) -> float:
    """Where the speed of a motion tends to, as its claim stands alone."""
    if state.phase is not Phase.GUARDING:
        return rules.low_speed if held and claim.escapes else 0.0
    if claim.level is Level.STOP and claim.escapes:
        return rules.low_speed
    if claim.level is Level.STOP:
        return min(rules.low_speed, claim.creep_speed) if claim.overridable and held else 0.0
    return min(claim.speed, rules.low_speed) if claim.escapes else claim.speed


def _is_held(state: GateState, now_ns: int, rules: Rules) -> bool:
    return state.held_ns is not None and now_ns - state.held_ns <= rules.hold_ns


def _decision(state: GateState, rules: Rules, answer: str | None = None, is_reset: bool = False) -> Decision:
    """What the state says."""
    motions = tuple(_allowed(state, number, motion, rules) for number, motion in enumerate(rules.motions))
    held_until_ns = None
    if state.held_ns is not None and any(allowed.held for allowed in motions):
        held_until_ns = state.held_ns + rules.hold_ns
    return Decision(state.phase, motions, state.latched, state.active, held_until_ns, answer, is_reset)


def _allowed(state: GateState, number: int, motion: str, rules: Rules) -> Allowed:
    """What one motion may do, in words."""
    speed = state.speeds[number]
    claim = state.claims[number] if state.claims is not None else None
    if state.phase is Phase.GUARDING and claim is not None:
        by_hold = claim.level is Level.STOP and not claim.escapes
        reason = claim.reason if claim.reason is not Reason.NONE or speed >= 1 else Reason.RISING
    else:
        by_hold, reason = True, _phase_reason(state)
    level = Level.STOP if speed <= 0 else Level.DECELERATE if speed < 1 or claim is None else claim.level
    return Allowed(motion, level, speed, reason, by_hold and speed > 0, claim is not None and claim.escapes)


def _phase_reason(state: GateState) -> Reason:
    """Why nothing moves where verdicts do not decide."""
    if state.active:
        return state.active[0].reason
    return {Phase.STARTING: Reason.STARTING, Phase.ENDED: Reason.ENDED}.get(state.phase, Reason.RESET_DUE)
