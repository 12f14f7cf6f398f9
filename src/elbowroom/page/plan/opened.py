"""Opens the page of a plan: a guarded server, a frame with the room in it, a session."""

import html
from pathlib import Path

from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.session import Session
from elbowroom.page.served import file_of_page
from elbowroom.page.server import Answer, Guarded, guarded
from elbowroom.page.words import Words

STYLE = (
    "html,body{margin:0;height:100%;overflow:hidden;font:16px system-ui,sans-serif;background:#fff}"
    "body{display:flex;flex-direction:column}"
    "header{display:flex;gap:1.5em;align-items:baseline;padding:.5em 1em;background:#182c4a;color:#fff}"
    "h1{font-size:1.05em;margin:0}p{margin:0;font-size:.9em}iframe{flex:1;border:0;width:100%}"
)
FRAME = (
    '<!doctype html><html lang="{language}"><head><meta charset="utf-8"><title>{title}</title>'
    '<link rel="icon" href="data:,"><style>{style}</style></head><body>'
    "<header><h1>{title}</h1><p>{hint}</p></header>"
    '<iframe src="/scene/plan" title="{scene}" data-close="{close}" data-settings="{settings}"></iframe>'
    '<script src="/plan.js"></script></body></html>'
)
PORT = 8139
"""At which the page is, if nobody says otherwise."""


def open_plan(
    ground: Ground, words: Words, out: Path, *, port: int = PORT, is_fresh: bool = False
) -> Session:
    """Begins to serve a plan; `Session.stop` and its server's `stop` end it.

    Args:
        ground: the room.
        words: of the language.
        out: where the site file goes, if nobody says otherwise.
        port: at which; 0: any that is free.
        is_fresh: begin anew, whatever plan was kept.

    Raises:
        InputError: the port is taken, or what was kept is no plan of this site.
        PackageError: viser is missing.
    """
    made = guarded(Guarded(_answers(words, ground.site.name)), port)
    try:
        made.viser.gui.configure_theme(control_width="large", show_logo=False, show_share_button=False)
        made.viser.gui.main_panel.dock_right()
        session = Session(made.viser, ground, words, out, is_fresh)
    except BaseException:
        made.stop()
        raise
    session.page = made
    _look_in(session)
    session.start()
    return session


def _answers(words: Words, site: str) -> dict[str, Answer]:
    """By path, what is served."""
    return {
        "/": Answer("text/html; charset=utf-8", frame_of(words, site)),
        "/plan.css": Answer("text/css; charset=utf-8", file_of_page("plan.css").encode()),
        "/plan.js": Answer("text/javascript; charset=utf-8", file_of_page("plan.js").encode()),
    }


def frame_of(words: Words, site: str) -> bytes:
    """The page round the room.

    Args:
        words: of the language.
        site: its name.
    """
    values = {
        "language": words.language,
        "title": words("plan.title", site=site),
        "hint": words("plan.hint"),
        "scene": words("plan.scene"),
        "close": words("plan.close"),
        "settings": words("plan.settings"),
    }
    escaped = {key: html.escape(value) for key, value in values.items()}
    return FRAME.format(style=STYLE, **escaped).encode()


def _look_in(session: Session) -> None:
    """Where browsers look from at first: over a corner, at the middle."""
    lower, upper = session.ground.box_m
    middle, size = (lower + upper) / 2, upper - lower
    camera = session.server.initial_camera
    camera.position = tuple(middle + size * (-0.6, -0.95, 0.8))
    camera.look_at = tuple(middle - (0, 0, 0.15 * size[2]))
