import numpy as np
import pytest
import trimesh

from elbowroom.evaluate.speed import fine_machine
from elbowroom.evaluate.speed.fine_machine import DUE, fine_machine_rows


def test_rows_say_both_machines_and_what_is_due_of_the_fine_one(monkeypatch):
    monkeypatch.setattr(fine_machine, "AROUND", {2_000: (10, 12), 24_000: (30, 50)})
    rows = list(fine_machine_rows(rounds=1, cameras=1))
    assert [(row["case"], row["triangles"]) for row in rows[::2]] == [
        ("explain", 2_000),
        ("first samples", 2_000),
        ("another base", 2_000),
    ]
    for few, many in zip(rows[::2], rows[1::2], strict=True):
        assert few["times_as_long"] == 1.0 and few["drawn_triangles"] == 8 * 2 * 10 * 12
        assert many["times_as_long"] == pytest.approx(many["median_ms"] / few["median_ms"])
        assert many["drawn_triangles"] < 24_000
    assert all(
        sum(due.of({"case": due_case, "triangles": 400_000}) for due in DUE) == 1 for due_case in ("explain",)
    )


def test_a_casting_is_closed_and_as_large_as_said():
    mesh = trimesh.Trimesh(*fine_machine._casting(25, 50, 3))
    assert mesh.is_watertight and mesh.volume > 0 and len(mesh.faces) == 2 * 25 * 50
    assert np.ptp(mesh.vertices[:, 2]) == pytest.approx(0.2)
