"""Models the six setups of the thesis' Appendix A and writes them as GLB, with Blender's own Python module.

    python3.11 -m venv bpyenv && bpyenv/bin/pip install bpy==5.0.1
    bpyenv/bin/python assets/rooms/build.py

Needed only to change the rooms. The C-arm is not in them: it is the package's URDF, posed by
`elbowroom.simulate.setups`. Debian's libxrender1 libxi6 libxkbcommon0 libsm6 libxxf86vm1 libxfixes3 libegl1 libgl1
must be there.
"""

import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bpy
import furniture as f
from people import GOWN_BLUE, GOWN_GREEN, GOWN_TEAL, Stance, patient, person

TARGET = Path(__file__).resolve().parents[2] / "src" / "elbowroom" / "simulate" / "setups"


def common(*, arm_out: bool = False, hang: float = 0.33) -> None:
    """What stands alike in all setups."""
    f.shell()
    f.table()
    patient(f.TOP, arm_out=arm_out)
    f.drape(hang)
    f.cabinet("cabinet", (0.70, 1.62, 0.0), (1.60, 2.03, 1.75), doors="-y")
    f.open_shelf(-2.03, -1.14, 0.0)
    f.floor_cables()


def setup1() -> None:
    """The C at the head end, upright; doctor at the right groin, a nurse at the head, one at the shelf."""
    common()
    f.cart(-1.15, -1.72, 90)
    f.monitors(0.95, -1.40, 90)
    f.lamp(1.55, 0.75, (1.12, 0.12, 2.08))
    f.lead_curtain(0.55, 1.15, -0.262, -1)
    f.iv_pole(-0.62, -0.86, line_to=(0.22, -0.23, 1.06))
    person("doctor", Stance(0.62, 0.60, -92, 1.80, 12, (35, 62), (28, 70), 0.04, GOWN_BLUE))
    person("nurse 1", Stance(-1.22, 0.93, -95, 1.68, 4, (20, 75), (25, 70), 0.03, GOWN_GREEN))
    person("nurse 2", Stance(-0.55, 1.52, 120, 1.72, 6, (40, 55), (8, 15), 0.05, GOWN_TEAL))


def setup2() -> None:
    """The C at the head end moves over the patient towards a lamp that was left over the chest."""
    common(arm_out=True)
    f.cart(-1.15, -1.72, 90)
    f.monitors(1.15, -1.30, 90)
    f.lamp(1.45, 0.85, (0.44, 0.02, 1.99))
    f.iv_pole(0.42, 1.02, line_to=(0.30, 0.62, 1.06))
    f.stool(1.35, 0.78)
    person("doctor", Stance(0.98, -0.62, 95, 1.78, 14, (30, 66), (34, 58), 0.05, GOWN_BLUE))
    person("nurse 1", Stance(1.50, -0.72, 120, 1.66, 4, (12, 40), (20, 80), 0.03, GOWN_GREEN))
    person("nurse 2", Stance(-0.72, 1.42, 60, 1.72, 0, (8, 20), (15, 85), 0.05, GOWN_TEAL))


def setup3() -> None:
    """The C reaches across the table from the side; a nurse and a drip stand beside its column."""
    common()
    f.cart(-1.15, -1.72, 90)
    f.monitors(1.50, 0.10, 180, screens=2)
    f.lamp(-0.85, 1.10, (-0.30, 0.85, 2.10))
    f.iv_pole(-0.78, -0.52, line_to=(0.22, -0.23, 1.06))
    f.stool(-1.55, 0.15)
    person("doctor", Stance(0.75, 0.66, -100, 1.80, 10, (30, 60), (36, 64), 0.04, GOWN_BLUE))
    person("nurse 1", Stance(0.68, -0.99, 180, 1.68, 3, (22, 66), (14, 40), 0.03, GOWN_GREEN))
    person("nurse 2", Stance(-1.10, 0.62, -60, 1.72, 5, (25, 50), (10, 20), 0.04, GOWN_TEAL))


def setup4() -> None:
    """The C tilted beside the doctor, monitors drawn in close on the other side."""
    common()
    f.cart(-1.15, -1.72, 90)
    f.monitors(0.25, -1.18, 90)
    f.lamp(1.55, 0.75, (1.00, 0.22, 2.05))
    f.shield(0.62, -0.56, 10)
    f.iv_pole(-0.40, 1.12)
    person("doctor", Stance(0.16, 0.84, -90, 1.82, 8, (32, 58), (26, 66), 0.04, GOWN_BLUE))
    person("nurse 1", Stance(-1.04, -0.90, 100, 1.66, 4, (8, 25), (6, 20), 0.03, GOWN_GREEN))
    person("nurse 2", Stance(1.30, 0.72, -110, 1.72, 6, (20, 70), (24, 60), 0.04, GOWN_TEAL))


def setup5() -> None:
    """The C among thin things: drip stands, lines, a hose from the ceiling, a lead-glass screen."""
    common(arm_out=True)
    f.cart(-1.15, -1.72, 90)
    f.monitors(1.10, -1.25, 95)
    f.lamp(1.55, 0.85, (1.05, 0.30, 2.06))
    f.iv_pole(0.37, 0.44, height=2.05, line_to=(0.30, 0.62, 1.06))
    f.iv_pole(-0.55, -0.90)
    f.hose(
        [
            (0.50, -0.12, 2.9),
            (0.47, -0.10, 2.4),
            (0.43, -0.06, 1.9),
            (0.46, -0.05, 1.55),
            (0.60, -0.02, 1.34),
        ],
        0.012,
        "gas hose",
    )
    person("doctor", Stance(0.95, 0.64, -95, 1.78, 12, (34, 58), (26, 70), 0.04, GOWN_BLUE))
    person("nurse 1", Stance(1.00, -0.72, 100, 1.67, 8, (24, 66), (30, 55), 0.03, GOWN_GREEN))
    person("nurse 2", Stance(-1.05, 0.86, -70, 1.72, 3, (16, 60), (10, 30), 0.04, GOWN_TEAL))


def setup6() -> None:
    """The C turned along its ring over the patient, doctor and nurse close by."""
    common()
    f.cart(-1.15, -1.72, 90)
    f.monitors(0.85, -1.35, 90)
    f.lamp(1.30, 1.00, (0.95, 0.02, 1.78))
    f.stool(0.20, 1.05)
    f.iv_pole(-0.62, 0.92)
    person("doctor", Stance(0.86, 0.66, -95, 1.80, 14, (36, 56), (30, 66), 0.04, GOWN_BLUE))
    person("nurse 1", Stance(0.90, -0.68, 92, 1.68, 8, (20, 70), (28, 62), 0.03, GOWN_GREEN))
    person("nurse 2", Stance(-1.05, -0.95, 30, 1.74, 2, (10, 25), (20, 75), 0.04, GOWN_TEAL))


SETUPS: tuple[Callable[[], None], ...] = (setup1, setup2, setup3, setup4, setup5, setup6)


def write(path: Path) -> None:
    """The scene as GLB: positions, faces and one colour per object, nothing else."""
    bpy.ops.export_scene.gltf(
        filepath=str(path),
        export_format="GLB",
        export_normals=False,
        export_texcoords=False,
        export_animations=False,
        export_skins=False,
        export_morph=False,
        export_cameras=False,
        export_lights=False,
        export_yup=True,
    )


def main(names: list[str]) -> None:
    """Builds those that are named, all if none is."""
    TARGET.mkdir(parents=True, exist_ok=True)
    for build in SETUPS:
        if names and build.__name__ not in names:
            continue
        bpy.ops.wm.read_factory_settings(use_empty=True)
        build()
        write(TARGET / f"{build.__name__}.glb")
        triangles = sum(len(thing.data.polygons) for thing in bpy.data.objects)
        print(f"{build.__name__}: {len(bpy.data.objects)} objects, {triangles} triangles")


if __name__ == "__main__":
    main(sys.argv[1:])
