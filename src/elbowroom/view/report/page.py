"""The report: one HTML file that needs nothing else, no script and no network."""

import base64
import re
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from elbowroom.view.report.blocks import Block, Picture, Table, Words

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #18202c; max-width: 76rem; margin: 2rem auto; padding: 0 1rem; }
h1 { margin-bottom: 0; } h2 { margin-top: 3rem; border-bottom: 2px solid #18202c; }
table { border-collapse: collapse; margin: 1rem 0 1.6rem; font-size: 14px; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
th, td { padding: .18rem .7rem; border-bottom: 1px solid #d8dde4; text-align: right; }
th { border-bottom: 2px solid #8a93a0; } .l { text-align: left; }
figure { display: inline-block; margin: .4rem .8rem .8rem 0; vertical-align: top; }
figcaption { font-size: 13px; color: #5a6470; } img { max-width: 100%; height: auto; border: 1px solid #d8dde4; }
code { background: #eef1f4; padding: .1rem .3rem; } .note { color: #5a6470; }
"""


def page(
    title: str, about: str, sections: Sequence[tuple[str, Sequence[Block]]], meta: Mapping[str, Any]
) -> str:
    """The whole page.

    Args:
        title: of the page.
        about: a paragraph below it.
        sections: title and blocks of each.
        meta: as `--json` writes it: command, commit, processor, versions.
    """
    versions = ", ".join(f"{name} {version}" for name, version in meta["versions"].items())
    body = [
        f"<h1>{escape(title)}</h1>",
        _block(Words(about)),
        f'<p class="note">Made by <code>{escape(str(meta["command"]))}</code>; commit '
        f"<code>{escape(str(meta['commit']))}</code>; {escape(str(meta['processor']))}; {escape(versions)}. "
        "Not a certified safety function.</p>",
        "<p>"
        + " · ".join(f'<a href="#s{n}">{escape(name)}</a>' for n, (name, _) in enumerate(sections))
        + "</p>",
    ]
    for number, (name, blocks) in enumerate(sections):
        body.append(f'<h2 id="s{number}">{escape(name)}</h2>')
        body += [_block(block) for block in blocks]
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>elbowroom: {escape(title)}'
        f"</title><style>{STYLE}</style></head>\n<body>\n" + "\n".join(body) + "\n</body></html>\n"
    )


def _block(block: Block) -> str:
    if isinstance(block, Words):
        return "<p>" + re.sub(r"\*(\w[^*]*)\*", r"<i>\1</i>", escape(block.text)).replace("`", "") + "</p>"
    if isinstance(block, Table):
        return _table(block)
    return _picture(block)


def _table(table: Table) -> str:
    def cells(tag: str, line: Sequence[str]) -> str:
        marks = [' class="l"' if n in table.left else "" for n in range(len(line))]
        return "".join(f"<{tag}{m}>{escape(cell)}</{tag}>" for m, cell in zip(marks, line, strict=True))

    lines = "\n".join(f"<tr>{cells('td', line)}</tr>" for line in table.lines)
    return f"<table><caption>{escape(table.title)}</caption>\n<tr>{cells('th', table.columns)}</tr>\n{lines}</table>"


def _picture(picture: Picture) -> str:
    kind = "svg+xml" if picture.png.lstrip().startswith(b"<") else "png"
    data = base64.b64encode(picture.png).decode()
    return (
        f'<figure><img alt="{escape(picture.caption)}" width="{picture.width_px}" '
        f'src="data:image/{kind};base64,{data}"><figcaption style="max-width:{picture.width_px}px">'
        f"{escape(picture.caption)}</figcaption></figure>"
    )
