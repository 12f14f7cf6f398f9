"""`elbowroom evaluate skew`: things that move past cameras that are not exposed together, and what ages cost."""

from collections.abc import Iterator
from typing import Annotated, Any

import typer

from elbowroom.cli.evaluate.options import Seed
from elbowroom.cli.options import JsonFile

Places = Annotated[
    int, typer.Option(min=1, metavar="COUNT", help="How many places and ways of each thing at each speed.")
]
Quick = Annotated[bool, typer.Option("--quick", help="One place, voxels of 5 cm, no setups: minutes less.")]


def skew(places: Places = 2, quick: Quick = False, seed: Seed = 1, json: JsonFile = None) -> None:
    """Move a ball and people past cameras whose images are of unlike age: is any voxel free that they touch?

    A ball at 1.6 and 2.0 m/s and people who walk at 1.2 and 1.6 m/s, ages spread over 0 to 133 ms, without the law and
    with claims aged for 1.6, 2.0 and 5.5 m/s; the same at one time by margin to the side; and the share of free voxels
    that is not found any more, in the simulated room and the six setups.
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, yes_or_no
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.skew import moving, price

    both: dict[str, Any] = {"law": "{law_m_s:g} m/s", "spread": "{spread_ms:g} ms", "detail": "{detail}"}
    seen: dict[str, Any] = {"what": "{what}", "speed": "{speed_m_s:g} m/s", "noise": yes_or_no("noise")}
    false: dict[str, Any] = {"rule": "{rule}", "touched": "{touched}", "free": "{false_free_voxels}"}
    show_moving = as_table({**seen, **both, **false}, sentence(moving.DUE[:1]))
    of_rays = {key: seen[key] for key in ("what", "speed")}
    aside = {"to the side": "{lateral_px:g} px", "touched": "{touched}", "free": "{false_free_voxels}"}
    show_still = as_table({**of_rays, **aside}, sentence(moving.DUE[1:]))
    lost: dict[str, Any] = {"found": "{found_pct:.2f} %", "lost": "{price_points:.2f} points"}
    show_price = as_table({"room": "{room}", **both, **lost}, sentence(price.DUE))

    def rows() -> Iterator[dict[str, Any]]:
        yield from moving.moving_rows(1 if quick else places, seed=seed)
        if quick:
            yield from price.price_rows(0.05, draws=1, seed=seed)
        else:
            yield from price.price_rows(setups=range(1, 7), draws=2, seed=seed)

    def show(summary: Any) -> None:
        show_moving([row for row in summary if row["kind"] == "moving"])
        show_still([row for row in summary if row["kind"] == "still"])
        show_price([row for row in summary if row["kind"] == "price"])

    measured("cases", rows(), None, json, show, _summary)


def _summary(found: Any) -> list[Any]:
    from elbowroom.evaluate.skew.moving import moving_summary
    from elbowroom.evaluate.skew.price import prices

    return [*moving_summary([row for row in found if "price_points" not in row]), *prices(found)]
