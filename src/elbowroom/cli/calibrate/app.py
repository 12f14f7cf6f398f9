"""`elbowroom calibrate`: where cameras are and how they see."""

import typer

from elbowroom.cli.calibrate.commission import commission
from elbowroom.cli.calibrate.extrinsics import extrinsics
from elbowroom.cli.calibrate.intrinsics import intrinsics
from elbowroom.cli.calibrate.machine import machine
from elbowroom.cli.calibrate.refine import refine
from elbowroom.cli.calibrate.simulate import simulate

calibrate_app = typer.Typer(
    help="Where cameras are and how they see: from a board, from the machine, from the room; and how sure that is.",
    epilog="Begin with: elbowroom calibrate extrinsics my_room.yaml --out calibrated.yaml",
    no_args_is_help=True,
)
calibrate_app.command(
    epilog="Example: elbowroom calibrate simulate board --out capture --cameras 21 --noise kinect_v1"
)(simulate)
calibrate_app.command(
    epilog="Example: elbowroom calibrate extrinsics capture --out calibrated.yaml --report report"
)(extrinsics)
calibrate_app.command(
    epilog="Example: elbowroom calibrate machine capture --out calibrated.yaml --report report"
)(machine)
calibrate_app.command(
    epilog="Example: elbowroom calibrate refine calibrated.yaml --out refined.yaml --report report"
)(refine)
calibrate_app.command(
    epilog="Example: elbowroom calibrate commission my_room.yaml --out my_room_watched.yaml"
)(commission)
calibrate_app.command(
    epilog="Example: elbowroom calibrate intrinsics capture --out intrinsics.yaml --report report"
)(intrinsics)
