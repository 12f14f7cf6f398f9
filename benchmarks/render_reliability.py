"""Writes docs/reliability.md from the files in benchmarks/results: python benchmarks/render_reliability.py"""

from pathlib import Path

import result_tables as tables
from ages import with_ages
from render_docs import RESULTS, ROOT, Section, rendered

PAGE = ROOT / "docs" / "reliability.md"
HEAD = """# Reliability

Written by `python benchmarks/render_reliability.py` from `benchmarks/results`. Do not edit it by hand.

What happens when something is wrong, measured on the running monitor. Which causes there are, and what ends them, says
[safety](safety.md#sick-sources). *due* is what the project set out to reach; what misses it stands in bold.
"""
SECTIONS = (
    Section(
        "faults.json",
        "Faults",
        """
Every kind of fault thrown at a running monitor with its gate, its watchdog and a Modbus reader, at random moments: a
small room of eight cameras at 15 Hz and a box that slides. After each the cause has to clear by its own evidence, and a
reset has to let the machine move again. *shown*: how often the fault came to anything at all; *silent*: how often it
did, and the machine went on; *misnamed*: no cause that latched names it. Times are from when the first wrong thing was
handed to the monitor to when the reader reads stop, or hears nothing for 80 ms. A disk that is full while a stop
is saved is a small file system of its own, or a limit of a file's length where nobody may mount one: the machine stops,
the black box says so, and what it kept opens up to the cut (a latch that cannot be written: `tests/monitor/gate`).

Kinds after which the monitor has to be started again are thrown half as often as the others, and last. The command's
short form, `--quick`, throws each kind once, with a deadline of 400 ms in place of 60 so that a busy
computer can run it: its times say little, and two missed deadlines (*hangs*, *suspended*) are 800 ms of it by design.
""",
        "elbowroom evaluate faults",
        tables.fault_tables,
    ),
    Section(
        "service.json",
        "The control service, attacked",
        """
A monitor of a small room (eight cameras at 15 Hz, a pass at 30 Hz) with its gate and its
[control service](service.md), by turns left alone and attacked from another process, 1,000 requests a second on this
computer. Passes are timed from the snapshot to the end of the pass. The attacker takes processor time of its own, which
is in these figures.
""",
        "elbowroom evaluate service",
        tables.service_tables,
    ),
    Section(
        "lag.json",
        "The closed loop",
        """
A verdict is right or wrong at one moment; what counts is whether a machine that obeys is stopped in time. So the loop
is closed, in simulated time: three people walk their rounds at up to 1.6 m/s and swing their arms, a C-arm moves one
joint after the other at full speed, cameras see both, a pass begins every 100 ms and is decided 67 ms later, and the
machine does what its decision says until the next one: it brakes at *stop*, goes at half speed at *decelerate*, and
turns back after a second of standing. People do not walk into it: nearer than 3 cm they wait, and turn back in the
end. Once all cameras are exposed together, once spread over 67 ms before the pass.

Thirty times a second exact geometry (coal) says which of the eight motions would touch a person within the braking
distance if it were to stop now from full speed, and for the machine's own motion also which thing. While it says so,
that motion *should have stopped*.

- *Should have stopped and did not*: at some time of such a window, later than a reaction time after its beginning, no
  stop was in force. The reaction time is skew + period + pass: what happens right after an exposure is in the next
  pass, which is decided that much later. What is over before that cannot be reacted to, and is counted apart.
- *Stopped for nothing*: a time of stop in which, and a reaction time before, nothing was in the way. It is high here
  by choice: 12 cameras of 160 x 120 pixels with noise, voxels of 10 cm, so that half an hour is simulated in some
  twenty minutes on two cores; and claims are aged at 2 m/s, which with a skew of 67 ms takes 13 cm about all that is
  not seen.
- *People touched*: the machine, moving, met somebody.

The decision holds for longer than the moment that it is about. `--ahead` judges for as long as it holds
(`pass_time_ms`), and then less is late; feet are faster than 2 m/s (`--people-speed 5.5`).

**What pixels do not resolve is missed, and touched.** With images of 64 x 48 a pixel covers 6 cm at 2 m, and arms and
legs are thinner than the three of them that [promise 1](safety.md#what-it-promises) asks for: of 59 windows 6 were
missed in five minutes, and in another run a machine that was *clear* drove into a leg. With 160 x 120 none is missed in
ten minutes of either skew. Half an hour of both is not measured yet.

**Who comes nearer while the machine brakes is met.** In the ten minutes without skew this happened once, for the 9
ticks in the table: the doctor walked towards a machine that turned to him at full speed. *Stop* was in force 33 ms
after he came within its braking distance (`lags_ms` of part 3 in the result file), and the machine, which needs half a
second to stand, met him while it braked. A level says what is in the way now. Where people may walk up to a machine
that moves at full speed, obey the [distances](safety.md#distances) as well, which count what a person walks until the
machine stands; the loop here does not.
""",
        "elbowroom evaluate lag",
        tables.lag_tables,
    ),
    Section(
        "soak.json",
        "Half an hour at full rate",
        """
The whole monitor with the simulated room from memory, 21 cameras of 640x480 at 15 Hz: watch, gate, distances, a
recording of all passes (in files of 30 s that are taken away) and the black box (of 1 GB, which is soon full, so that
what it holds does not go with the rate of passes). What the process holds is looked at once a second; its slope is that
of Theil and Sen over the medians of 20 s, the first quarter left out, with the interval of 95 %. *the worst*: when it
was, and its longest parts in ms.
""",
        "elbowroom evaluate soak",
        tables.soak_tables,
    ),
    Section(
        "malformed.json",
        "Malformed input",
        """
Every reader of input from outside, led by coverage (atheris, libFuzzer), from inputs as this package writes them:
MCAP and sqlite3 as bags with all that is read of them, what rosbag2 writes beside its files, recordings of a run, depth
images, masks, site files, joints as CSV and as messages, and the port of the Modbus server, which has to answer a right
request as before after each. *crashes*: anything but an error of this package, and an experiment that ended before its
time, whatever ended it (it has no processor time then); *hangs*: more than 2 s of processor time for one input, twice;
*allocations*: for each input the reader gets twice the memory that its code names as its limit, 64 MB at least, beside
what there was before, and asks for more.
""",
        "elbowroom evaluate malformed",
        tables.malformed_tables,
    ),
)


def render(results: Path = RESULTS) -> str:
    """The whole page."""
    return HEAD + "\n".join(rendered(SECTIONS, results)) + "\n"


if __name__ == "__main__":
    PAGE.write_text(with_ages(render()), encoding="utf-8")
    print(f"{PAGE.relative_to(ROOT)} written")
