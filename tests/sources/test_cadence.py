"""When it is worth to wait for images: of cameras together late in their period, of cameras that run free never."""

import random

from elbowroom.sources.cadence import SLACK, Cadence

T_NS = 60_000_000


def heard(phases_ns, until_ns, period_ns=T_NS):
    """A cadence that heard cameras until a time."""
    cadence = Cadence()
    for number, phase in enumerate(phases_ns):
        for at_ns in range(phase, until_ns + 1, period_ns):
            cadence.come(f"c{number}", at_ns)
    return cadence


def test_of_cameras_together_the_next_images_are_awaited_after_an_eighth_of_their_period():
    cadence = heard([0, 0, 0], 10 * T_NS)
    for share, is_worth in ((0.0, False), (0.12, False), (0.13, True), (0.9, True)):
        now_ns = round((10 + share) * T_NS)
        assert cadence.worth_until_ns(now_ns, now_ns) == (11 * T_NS if is_worth else now_ns)


def test_of_cameras_that_run_free_none_but_the_next_is_ever_awaited():
    count = 21
    for step in range(50):
        now_ns = 10 * T_NS + step * T_NS // count // 50
        cadence = heard([n * T_NS // count for n in range(count)], now_ns)
        assert cadence.worth_until_ns(now_ns, now_ns) - now_ns <= T_NS / count


def test_images_that_come_one_behind_the_other_are_awaited_to_the_last():
    """Cameras of one trigger whose images come within a few milliseconds: the first alone begins no pass."""
    phases = [n * 500_000 for n in range(4)]
    cadence = heard(phases, 10 * T_NS)
    assert cadence.worth_until_ns(10 * T_NS, 10 * T_NS) == 10 * T_NS + phases[-1]
    for number, phase in enumerate(phases[1:], start=1):
        cadence.come(f"c{number}", 10 * T_NS + phase)
    assert cadence.worth_until_ns(10 * T_NS + phases[-1], 10 * T_NS) == 10 * T_NS + phases[-1]


def test_a_camera_that_gives_nothing_any_more_holds_nobody_up():
    cadence = heard([0], 5 * T_NS)  # dead since
    for at_ns in range(0, 10 * T_NS + 1, T_NS):
        cadence.come("other", at_ns)
    now_ns = 10 * T_NS + 1000
    assert cadence.worth_until_ns(now_ns, now_ns) == now_ns


def test_what_is_late_is_awaited_for_a_share_of_its_period_and_no_pass_for_longer_than_one():
    cadence, asked_ns = heard([0, 0], 10 * T_NS), round(10.5 * T_NS)
    now_ns, steps = asked_ns, 0
    while (until_ns := cadence.worth_until_ns(now_ns, asked_ns)) > now_ns:
        now_ns, steps = until_ns, steps + 1
    assert 11 * T_NS < now_ns <= round((11 + SLACK + 0.05) * T_NS) and steps < 20
    assert now_ns - asked_ns <= T_NS


def test_nobody_waits_before_periods_are_known_nor_after_nothing_came():
    assert Cadence().worth_until_ns(5, 5) == 5
    cadence = heard([0], T_NS)
    assert cadence.worth_until_ns(T_NS + 50, T_NS + 50) == T_NS + 50


def test_the_moment_is_the_cheapest_of_all_moments():
    """Against the plain sum at every hundredth of a period, of cameras of any phase and period."""
    chosen = random.Random(5)
    for _ in range(60):
        period_ns = {f"c{n}": chosen.choice((30, 60, 90)) * 1_000_000 for n in range(4)}
        phase_ns = {name: chosen.randrange(period) for name, period in period_ns.items()}
        now_ns, cadence = 20 * T_NS + chosen.randrange(T_NS), Cadence()
        newest = {}
        for name, period in period_ns.items():
            for at_ns in range(phase_ns[name], now_ns + 1, period):
                cadence.come(name, at_ns)
                newest[name] = at_ns
        shortest = min(period_ns.values())

        def cost(at_ns, newest=newest, period_ns=period_ns, now_ns=now_ns):
            ages = [at_ns - (t + period_ns[n] if t + period_ns[n] <= at_ns else t) for n, t in newest.items()]
            return sum(ages) / len(ages) + (at_ns - now_ns) / 7

        found = cadence.worth_until_ns(now_ns, now_ns)
        assert now_ns <= found <= now_ns + shortest
        assert cost(found) <= min(cost(now_ns + k * shortest // 100) for k in range(100)) + 2_000_000
