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
handed to the monitor to when the reader reads stop, or hears nothing for 80 ms. A disk that is full is tested by itself
(`tests/monitor/gate`), not here.

The command's short form, `--quick`, throws each kind once, with a deadline of 400 ms in place of 60 so that a busy
computer can run it: its times say little, and two missed deadlines (*hangs*, *suspended*) are 800 ms of it by design.
""",
        "elbowroom evaluate faults",
        tables.fault_tables,
    ),
)


def render(results: Path = RESULTS) -> str:
    """The whole page."""
    return HEAD + "\n".join(rendered(SECTIONS, results)) + "\n"


if __name__ == "__main__":
    PAGE.write_text(with_ages(render()), encoding="utf-8")
    print(f"{PAGE.relative_to(ROOT)} written")
