"""`elbowroom evaluate`: how right the answers are; each command from a file of its own."""

import typer

from elbowroom.cli.evaluate.bits import bits
from elbowroom.cli.evaluate.cell import cell
from elbowroom.cli.evaluate.contradictions import contradictions
from elbowroom.cli.evaluate.escape import escape
from elbowroom.cli.evaluate.faults import faults
from elbowroom.cli.evaluate.hand import hand
from elbowroom.cli.evaluate.lag import lag
from elbowroom.cli.evaluate.latch import latch
from elbowroom.cli.evaluate.looks import looks
from elbowroom.cli.evaluate.malformed import malformed
from elbowroom.cli.evaluate.own_links import own_links
from elbowroom.cli.evaluate.page import page
from elbowroom.cli.evaluate.paths import paths
from elbowroom.cli.evaluate.placement import placement
from elbowroom.cli.evaluate.plan import plan
from elbowroom.cli.evaluate.recording import cut, replay
from elbowroom.cli.evaluate.robots import robots
from elbowroom.cli.evaluate.rooms import alone, lost_pixels, poses, room, sevenscenes, thin_solids, travel
from elbowroom.cli.evaluate.scale import scale_budget, scale_cameras
from elbowroom.cli.evaluate.service import service
from elbowroom.cli.evaluate.skew import skew
from elbowroom.cli.evaluate.soak import soak
from elbowroom.cli.evaluate.thesis import all_parts, calibration, more, motions, reconstruction, scale

evaluate_app = typer.Typer(
    help="Measure how right the answers are.",
    epilog="Begin with: elbowroom evaluate room",
    no_args_is_help=True,
)


def _example(words: str) -> str:
    return f"Example: elbowroom evaluate {words}"


evaluate_app.command(epilog=_example("room --json room.json"))(room)
evaluate_app.command(epilog=_example("sevenscenes --json sevenscenes.json"))(sevenscenes)
evaluate_app.command(epilog=_example("alone --json alone.json"))(alone)
evaluate_app.command(epilog=_example("poses --poses 20 --json poses.json"))(poses)
evaluate_app.command(epilog=_example("travel --json travel.json"))(travel)
evaluate_app.command(epilog=_example("thin-solids --scenes 20 --json thin_solids.json"))(thin_solids)
evaluate_app.command(epilog=_example("lost-pixels --json lost_pixels.json"))(lost_pixels)
evaluate_app.command(epilog=_example("placement --part verify --json placement.json"))(placement)
evaluate_app.command(epilog=_example("reconstruction --setup 1 --voxel-size 0.1 --json out.json"))(
    reconstruction
)
evaluate_app.command(epilog=_example("motions --motions 100 --json motions.json"))(motions)
evaluate_app.command(epilog=_example("calibration --draws 10 --json calibration.json"))(calibration)
evaluate_app.command(epilog=_example("scale --json scale.json"))(scale)
evaluate_app.command(epilog=_example("scale-cameras --poses 2 --step 20 --json cameras.json"))(scale_cameras)
evaluate_app.command(epilog=_example("scale-budget --poses 4 --json budget.json"))(scale_budget)
evaluate_app.command(epilog=_example("more --out report --json more.json"))(more)
evaluate_app.command(epilog=_example("bits --json now.json --against benchmarks/results/bits.json"))(bits)
evaluate_app.command(epilog=_example("contradictions --sites 5 --right 20 --json contradictions.json"))(
    contradictions
)
evaluate_app.command(epilog=_example("lag --quick --json lag.json"))(lag)
evaluate_app.command(epilog=_example("latch --quick --json latch.json"))(latch)
evaluate_app.command(epilog=_example("faults --quick --json faults.json"))(faults)
evaluate_app.command(epilog=_example("page --quick --json page.json"))(page)
evaluate_app.command(epilog=_example("service --rounds 2 --json service.json"))(service)
evaluate_app.command(epilog=_example("plan --quick --json plan.json"))(plan)
evaluate_app.command(epilog=_example("looks --sites 50 --wrong 5 --json looks.json"))(looks)
evaluate_app.command(epilog=_example("robots packages --json robots.json"))(robots)
evaluate_app.command(epilog=_example("own-links packages --quick --json own_links.json"))(own_links)
evaluate_app.command(epilog=_example("escape --quick --json escape.json"))(escape)
evaluate_app.command(epilog=_example("hand --scenes 5 --json hand.json"))(hand)
evaluate_app.command(epilog=_example("paths --quick --json paths.json"))(paths)
evaluate_app.command(epilog=_example("skew --quick --json skew.json"))(skew)
evaluate_app.command(epilog=_example("cell --quick --json cell.json"))(cell)
evaluate_app.command(epilog=_example("cut --quick --json cut.json"))(cut)
evaluate_app.command(epilog=_example("replay --quick --json replay.json"))(replay)
evaluate_app.command(epilog=_example("malformed --quick --json malformed.json"))(malformed)
evaluate_app.command(epilog=_example("soak --quick --json soak.json"))(soak)
evaluate_app.command(name="all", epilog=_example("all --out report --json report.json"))(all_parts)
