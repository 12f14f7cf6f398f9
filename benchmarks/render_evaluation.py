"""Writes docs/evaluation.md from the results: python benchmarks/render_evaluation.py

They are what `elbowroom evaluate all --out report --json benchmarks/results/evaluate_all.json` writes. Where a part
was measured again by itself, `evaluate_motions.json` and so on go before it; remove them after measuring all again.
With the folder of the report as an argument, the pictures that the page shows are taken from there, too.
"""

import base64
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ages import with_ages

from elbowroom.evaluate.thesis.due import due_table
from elbowroom.evaluate.thesis.parts import PARTS
from elbowroom.evaluate.thesis.scale_budget import budget_table
from elbowroom.view.report.blocks import Block, Picture, Table, Words

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "benchmarks" / "results"
PAGE = ROOT / "docs" / "evaluation.md"
IMAGES = ROOT / "docs" / "images"
SHOWN = {
    "reconstruction": {
        "reconstruction.setup3-640x480": ("cases-640x480-setup3-cubes", "cases-640x480-setup3-section"),
    },
    "scale": {"scale.pose0": ("scale-model",)},
    "more": {"more.fig3": ("fig3",)},
}
"""Pictures of the report that the page shows: by part, the share of the work that drew them, and their names."""
CAPTIONS = {
    "cases-640x480-setup3-cubes": "Setup 3, 640x480, 5 cm: white free, blue free but not found, green objects",
    "cases-640x480-setup3-section": "The thesis' point test and the pixel test; red: objects declared free",
    "scale-model": "Surfaces found by four Kinects: C-arm blue, table green, doctor red",
    "fig3": "The thesis' Fig. 3, made by the program",
}
INTRODUCTION = """# The thesis' experiments

Written by `python benchmarks/render_evaluation.py` from `benchmarks/results`. Do not edit it by hand.

The idea of this project is from a 2011 master's thesis (I. Hamersma, *Collision avoidance using multiple correlated 3D
depth measurements*, Eindhoven). Its tables are measured again here, and its figures stand beside ours.

One command does all of it and writes one page with the pictures:

    elbowroom evaluate all --out report --json report.json

`reconstruction`, `motions`, `calibration`, `scale` and `more` in place of `all` do one part. The work is cut into
shares that do not depend on each other: `--jobs N` spreads them over processes, `--cluster tcp://HOST:PORT` over the
computers of a Dask cluster, and the numbers are the same however they are spread. Ctrl-C keeps the shares that are
done in `report/parts`; the same command goes on from there. All of it took 8 min 56 s on two cores (`time` before the
command; due are 12 minutes). It needs `.venv/bin/pip install '.[evaluate]'`, and
`[cluster]` for Dask.

## The six setups

| | | |
|---|---|---|
| ![setup 1](images/setup1_colour.jpg) | ![setup 2](images/setup2_colour.jpg) | ![setup 3](images/setup3_colour.jpg) |
| ![depth 1](images/setup1_depth.jpg) | ![depth 2](images/setup2_depth.jpg) | ![depth 3](images/setup3_depth.jpg) |
| ![setup 4](images/setup4_colour.jpg) | ![setup 5](images/setup5_colour.jpg) | ![setup 6](images/setup6_colour.jpg) |
| ![depth 4](images/setup4_depth.jpg) | ![depth 5](images/setup5_depth.jpg) | ![depth 6](images/setup6_depth.jpg) |

Rooms after the thesis' Appendix A, with closed meshes: the C-arm, a table with a patient under a drape, a doctor, two
nurses, a closed cabinet, an open shelf, a cart, a monitor suspension, an operating lamp, drip stands, lines and cables.
The thesis' own models are not printed; these are ours, and so are the poses: chosen by exact geometry and by the truth
volume, so that the bands S, M, L and 0 all occur and contacts are met face on, not grazed. `assets/rooms/build.py`
makes the rooms with Blender's Python module. Look at one with simulated cameras, or at a room of your own:

    elbowroom simulate --room setup1 --out room1
    elbowroom simulate --room my.glb --out my_room

A GLB is in metres; each of its objects must be closed. The command says which object is not.

21 cameras hang along the walls, at 2.4 m and 0.4 m in turn, with a field of view of 90 degrees: 640x480 with planar
depth, or the thesis' 64x48 with radial depth. Noise, where there is any, is sigma(z) = 1.5 mm + 0.25 mm z^2 with flying
pixels and missing returns; margins are three sigmas and half a pixel unless a table says otherwise.

What to read them with:

- **Scale model.** No motion goes farther than the truth, by any sensor. What is due is asked of ways in view: four
  cameras see the way of few motions wholly, and where one voxel of it is hidden from all, free travel ends there,
  unless several see it between them. Where a camera looks at an object from the front, three sigmas (4 to 5 mm here)
  are kept clear of what it measured, the farthest stray of some hundred pixels comes on top, and by rule `three`
  fewer than three other cameras cannot overrule that; a camera that looks past the object loses nothing. So what is
  reached depends on where the cameras stand, and they are placed for the very motions that are judged (`elbowroom
  evaluate scale-cameras`, with other noise); placed by exact rays alone, with voxels of 2.5 mm, ways in view
  were short by 8.0 mm median and 13.4 worst. In poses that they were not placed for, fewer ways are in view, and
  those miss what is due; that, and what is lost to each cause, stands under the part's table. Mixed pixels and lost
  returns, which the noise model of a Kinect does not have, cost the most: where one camera alone looks, or two,
  nobody can overrule them. The half pixel of the rule *in view* was settled with verdicts in sight, when the ways
  were still made of points: without it, two more ways that stop early counted as in view, and with a whole pixel none
  of 13 did. A first search had asked nothing of ways beyond the limit of *in view*; it put one that ends 16 mm short
  0.14 mm beyond it, so now the worst that is due is asked up to twice the limit. Voxels of 2 mm, too, were taken
  because it was known that larger ones miss what is due. With half a voxel of growth of the body, as everywhere else,
  four cameras saw hardly a way wholly with such voxels, since what lies beside a link that turns along itself is then
  not body any more; hence its growth of 3.3 mm, by which the body takes the space that it takes with 4 mm.
"""


def render(results: Path = RESULTS) -> str:
    """The page's text; what has no file is said not to be measured."""
    text = [INTRODUCTION]
    measured = {name: found for name in PARTS if (found := _measured(results, name)) is not None}
    due = due_table(list(PARTS.values()), [row for rows, _ in measured.values() for row in rows])
    if due is not None:
        text += [f"## {due.title}", "", *_lines([due])]
    for name, part in PARTS.items():
        text += [f"## {part.title}", ""]
        if name not in measured:
            text += ["Not measured yet.", ""]
            continue
        rows, meta = measured[name]
        text += _lines(part.show(rows, {}), name)
        names = [picture for of_share in SHOWN.get(name, {}).values() for picture in of_share]
        text += [f"![{CAPTIONS[n]}](images/evaluation_{n}.png)\n" for n in names if _image(n).is_file()]
        text += [f"Measured by `{meta['command']}`; commit {meta['commit']}; {meta['processor']}.", ""]
        if name == "scale" and (results / "scale_budget.json").is_file():
            text += _budget(json.loads((results / "scale_budget.json").read_text(encoding="utf-8")))
    return "\n".join(text).rstrip() + "\n"


def _budget(content: dict[str, Any]) -> list[str]:
    """Where the scale model's free travel is lost, as `elbowroom evaluate scale-budget` measured it."""
    meta = content["meta"]
    return [
        "What it is lost to: *voxels* that the true objects touch, in an else open space; *view*, up to the first "
        "voxel that no camera sees all of; *pixels* of exact images; the *margin* of three sigmas, with exact images; "
        "*noise*. The cameras are placed for the smallest of these voxels and for the poses that are judged; *other "
        "poses* are drawn in the same way.",
        "",
        *_lines([budget_table(content["rows"])]),
        f"Measured by `{meta['command']}`; commit {meta['commit']}; {meta['processor']}.",
        "",
    ]


def _measured(results: Path, name: str) -> tuple[list[dict[str, Any]], dict[str, Any]] | None:
    """Rows and meta of a part: of its own file, or of the file of all parts."""
    for path in (results / f"evaluate_{name}.json", results / "evaluate_all.json"):
        if path.is_file():
            content = json.loads(path.read_text(encoding="utf-8"))
            rows = [row for row in content["rows"] if row["part"] == name]
            if rows:
                return rows, content["meta"]
    return None


def _image(name: str) -> Path:
    return IMAGES / f"evaluation_{name}.png"


def draw(results: Path, report: Path | None) -> None:
    """Writes the charts, which come from the results, and takes pictures out of a report's folder."""
    for name, part in PARTS.items():
        measured = _measured(results, name)
        if measured is None:
            continue
        charts = [block for block in part.show(measured[0], {}) if isinstance(block, Picture)]
        for number, chart in enumerate(charts):
            (IMAGES / f"evaluation_{name}_{number}.svg").write_bytes(chart.png)
        for share, names in SHOWN.get(name, {}).items() if report else ():
            kept = json.loads((report / "parts" / f"{share}.json").read_text(encoding="utf-8"))
            for picture in names:
                _image(picture).write_bytes(base64.b64decode(kept["pictures"][picture]))


def _lines(blocks: Sequence[Block], part: str = "") -> list[str]:
    """Words, tables and charts as Markdown."""
    lines: list[str] = []
    charts = 0
    for block in blocks:
        if isinstance(block, Words):
            lines += [block.text, ""]
        elif isinstance(block, Table):
            lines += [f"**{block.title}**", "", *_table(block), ""]
        elif isinstance(block, Picture):
            lines += [f"![{block.caption}](images/evaluation_{part}_{charts}.svg)", ""]
            charts += 1
    return lines


def _table(table: Table) -> list[str]:
    marks = ["---" if n in table.left else "---:" for n in range(len(table.columns))]
    return ["| " + " | ".join(line) + " |" for line in (table.columns, marks, *table.lines)]


if __name__ == "__main__":
    draw(RESULTS, Path(sys.argv[1]) if len(sys.argv) > 1 else None)
    PAGE.write_text(with_ages(render()), encoding="utf-8")
