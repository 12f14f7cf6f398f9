"""Results as Markdown tables, the figure that is due beside the measured one."""

from result_tables.asked import asked_tables
from result_tables.calibration import calibration_tables
from result_tables.cells import Row, any_tables
from result_tables.drift import drift_tables
from result_tables.faults import fault_tables
from result_tables.lag import decision_tables, lag_tables, law_tables
from result_tables.latch import latch_tables
from result_tables.long import malformed_tables, soak_tables
from result_tables.looks import contradiction_tables, looks_tables
from result_tables.page import page_tables
from result_tables.placement import placement_tables, sweep_tables
from result_tables.plan import plan_table
from result_tables.recording import cut_tables, record_tables, replay_tables
from result_tables.robots import robot_tables
from result_tables.service import service_tables
from result_tables.skew import skew_tables
from result_tables.space import room_tables, sevenscenes_tables
from result_tables.speed import bench_tables, machine_tables, parts_tables, start_tables
from result_tables.verdicts import (
    alone_tables,
    cell_tables,
    escape_tables,
    hand_tables,
    own_links_tables,
    path_tables,
    poses_tables,
    travel_tables,
)

__all__ = [
    "Row",
    "alone_tables",
    "any_tables",
    "asked_tables",
    "bench_tables",
    "calibration_tables",
    "cell_tables",
    "contradiction_tables",
    "cut_tables",
    "decision_tables",
    "drift_tables",
    "escape_tables",
    "fault_tables",
    "hand_tables",
    "lag_tables",
    "latch_tables",
    "law_tables",
    "looks_tables",
    "machine_tables",
    "malformed_tables",
    "own_links_tables",
    "page_tables",
    "parts_tables",
    "path_tables",
    "placement_tables",
    "plan_table",
    "poses_tables",
    "record_tables",
    "replay_tables",
    "robot_tables",
    "room_tables",
    "service_tables",
    "sevenscenes_tables",
    "skew_tables",
    "soak_tables",
    "start_tables",
    "sweep_tables",
    "travel_tables",
]
