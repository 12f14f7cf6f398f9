"""All commands, each from a file of its own."""

from typing import Annotated

import typer

from elbowroom.cli.budget import budget
from elbowroom.cli.calibrate.app import calibrate_app
from elbowroom.cli.check import check
from elbowroom.cli.evaluate.app import evaluate_app
from elbowroom.cli.evaluate.bench import bench
from elbowroom.cli.export import export
from elbowroom.cli.gate import gate_app
from elbowroom.cli.monitor import monitor
from elbowroom.cli.placement.app import placement_app
from elbowroom.cli.plan import plan
from elbowroom.cli.reconstruct import reconstruct
from elbowroom.cli.replay import replay
from elbowroom.cli.simulate import simulate
from elbowroom.cli.site import site_app
from elbowroom.cli.view import view

app = typer.Typer(
    name="elbowroom",
    help="How much elbow room does the machine have? Free space and motion verdicts from depth cameras.",
    epilog="Begin with: elbowroom monitor",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["--help", "-h"]},
)


def _example(*lines: str) -> str:
    return "\n\n".join(["Examples:", *lines])


app.command(
    epilog=_example(
        "elbowroom monitor",
        "elbowroom monitor --voxel-size 0.02 --seconds 20 --json run.json --out pictures",
        "elbowroom monitor --noise tof --resolution 640x480",
        "elbowroom monitor --knock cam03:1deg@5",
        "elbowroom monitor my_room.yaml",
        "elbowroom monitor my_room.yaml --gate my_gate",
        "elbowroom monitor my_room.yaml --record run.mcap --black-box stops",
    )
)(monitor)
app.command(
    epilog=_example(
        "elbowroom reconstruct my_room.yaml --out result",
        "elbowroom reconstruct my_room.yaml --out result --voxel-size 0.02 --joints long=0.1,larm=12deg",
    )
)(reconstruct)
app.command(epilog=_example("elbowroom check my_room.yaml --joint larm --direction + --out seen"))(check)
app.command(
    epilog=_example(
        "elbowroom replay run.mcap",
        "elbowroom replay run.mcap --why 1200",
    )
)(replay)
app.command(
    epilog=_example(
        "elbowroom plan",
        "elbowroom plan my_room.yaml --out planned.yaml",
        "elbowroom plan setup1",
    )
)(plan)
app.command(
    epilog=_example(
        "elbowroom view my_room.yaml --picture room.png",
        "elbowroom view my_room.yaml --picture above.png --view top --hide sweeps",
        "elbowroom view my_room.yaml --picture near.png --from 2,-2,1.8 --to 0,0,1 --size 1600x1200 --sweep larm+",
    )
)(view)
app.command(epilog=_example("elbowroom export run.mcap images"))(export)
app.command(
    epilog=_example(
        "elbowroom simulate my_cell.yaml --moving person",
        "elbowroom simulate my_cell.yaml --room my.glb --moments 50 --rate 10 --out recorded",
        "elbowroom simulate --room setup1 --out room1",
        "elbowroom simulate --room my.glb --out my_room --noise tof --joints long=0.1",
    )
)(simulate)
app.command(
    epilog=_example(
        "elbowroom bench --json bench.json",
        "elbowroom bench start --json start.json",
        "elbowroom bench calibration --json calibration.json",
    )
)(bench)
app.command(
    epilog=_example(
        "elbowroom budget",
        "elbowroom budget my_room.yaml --seconds 60 --json budget.json",
    )
)(budget)
app.add_typer(calibrate_app, name="calibrate")
app.add_typer(evaluate_app, name="evaluate")
app.add_typer(gate_app, name="gate")
app.add_typer(placement_app, name="placement")
app.add_typer(site_app, name="site")


def _print_version(asked: bool) -> None:
    if asked:
        from elbowroom.files.json_rows import commit, package_version

        version, source = package_version(), commit()
        print(f"elbowroom {version}" + (f" ({source})" if source != version else ""))
        raise typer.Exit


@app.callback(invoke_without_command=True)
def _main(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        print(context.get_help())
