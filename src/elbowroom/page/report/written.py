"""The report as a file."""

import html
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from elbowroom.errors import InputError
from elbowroom.files.atomic import whole_file
from elbowroom.page.hello import hello_of
from elbowroom.page.replay.again import Judge
from elbowroom.page.report.gathered import Gathering, still_of
from elbowroom.page.report.span import Span
from elbowroom.page.served import file_of_page, filled, style
from elbowroom.page.telling import Telling, clock
from elbowroom.page.words import Words

MOST_BYTES = 10_000_000
"""A report is smaller."""
DRAWN_EVERY_S = (0.25, 0.5, 1.0, 2.0, 5.0)
"""The room is drawn as often as the size allows, of these [s]."""
PROGRAM = ("plot.js", "panel.js", "slider.js", "viewer.js", "report.js")


@dataclass(frozen=True, slots=True)
class Written:
    """What was written.

    Args:
        size: of the file [bytes].
        cycles: how many moments it holds.
        drawn: at how many of them the room is drawn.
    """

    size: int
    cycles: int
    drawn: int


def write_report(
    path: Path,
    judge: Judge,
    span: Span,
    words: Words,
    wrong: str | None = None,
    tell: Callable[[int], None] = lambda done: None,
) -> Written:
    """Writes the report of a span of a recording.

    Args:
        path: of the file.
        judge: of the recording.
        span: which passes, and which one it is about.
        words: of the language.
        wrong: what is not as it was written in the recording; None: nothing.
        tell: told how many moments are gathered.

    Raises:
        BagError: the recording is malformed.
        InputError: the file cannot be written, or is too large however seldom the room is drawn.
    """
    for every_s in DRAWN_EVERY_S:
        gathering = Gathering(judge, Telling(judge.configuration, words, "report"), span, every_s)
        moments = list(gathering.moments(tell))
        values = {**_values(judge, words, span, wrong), **still_of(judge.configuration, gathering.pack)}
        told = {"drawn": gathering.drawn, "cycles": len(moments)}
        span_text = words(
            "report.span",
            **told,
            begin=clock(int(1e9 * moments[0]["wall_s"])),
            end=clock(int(1e9 * moments[-1]["wall_s"])),
        )
        values["facts"].insert(0, span_text)
        content = _page(gathering.pack.text({**values, "moments": moments}), judge, words, span).encode()
        if len(content) < MOST_BYTES:
            with whole_file(path) as file:
                file.write_bytes(content)
            return Written(len(content), len(moments), gathering.drawn)
    raise InputError(f"report: {len(content):,} bytes, must be below {MOST_BYTES:,}; take fewer seconds")


def _values(judge: Judge, words: Words, span: Span, wrong: str | None) -> dict[str, Any]:
    """What is said once."""
    recording, configuration = judge.recording, judge.configuration
    told = configuration.told
    versions = told.get("versions") or {}
    version = versions.get("elbowroom"), told.get("commit"), told.get("processor")
    facts = [
        words("report.version", **dict(zip(("version", "commit", "processor"), version, strict=True))),
        words("report.site", sum=told.get("site_sha256")),
        words("report.sum", sum=recording.sum),
    ]
    if wrong is not None:
        facts.append(words("report.damaged", text=wrong))
    note = None if recording.note is None else words("cut", note=f"{recording.note}.")
    about = span.about - span.first
    stop = {"index": about, "time": clock(recording.said_at(span.about)["wall_ns"]), "text": ""}
    return {
        "hello": {
            **hello_of(configuration, words, "report"),
            "count": span.last - span.first + 1,
            "stops": [stop],
            "note": note,
        },
        "about": about,
        "facts": facts,
        "site_file": configuration.site_text.decode("utf-8", "replace"),
    }


def _page(data: str, judge: Judge, words: Words, span: Span) -> str:
    """The whole file."""
    site = str(judge.configuration.told.get("site"))
    title = words("report.title", site=site, time=clock(judge.recording.said_at(span.about)["wall_ns"]))
    frame = filled(file_of_page("page.html").replace("{{controls}}", ""), words, title=title)
    program = "\n".join(file_of_page(name) for name in PROGRAM)
    extra = filled(file_of_page("report.html"), words)
    parts = {
        '<link rel="stylesheet" href="/page.css">': f"<style>{style()}</style>",
        "</div>\n</main>": f"{extra}</div>\n</main>",
        '<script src="/page.js"></script>': (
            f'<script type="text/plain" id="data">{html.escape(data)}</script>\n<script>{program}</script>'
        ),
    }
    for here, there in parts.items():
        frame = frame.replace(here, there)
    return frame
