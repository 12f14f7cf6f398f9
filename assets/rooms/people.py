"""Staff in gowns and the patient: limbs, hands with fingers, caps; clothes with folds."""

from dataclasses import dataclass

import numpy as np
from mathutils import Matrix, Vector
from modelling import Colour, Parts, placed

SKIN = (0.72, 0.47, 0.36)
HAIR = (0.03, 0.02, 0.015)
GOWN_BLUE = (0.10, 0.32, 0.48)
GOWN_GREEN = (0.13, 0.42, 0.30)
GOWN_TEAL = (0.10, 0.42, 0.45)


@dataclass
class Stance:
    """How somebody stands: where, facing where, and what the arms do (angles at shoulder and elbow)."""

    x: float
    y: float
    heading_deg: float
    height: float = 1.75
    lean_deg: float = 0.0
    left: tuple[float, float] = (10.0, 20.0)
    right: tuple[float, float] = (10.0, 20.0)
    step: float = 0.0
    gown: Colour = GOWN_BLUE
    gloves: bool = False


def person(name: str, how: Stance) -> None:
    """A member of staff as three closed objects: gown with legs, head with hands, cap."""
    scale = how.height / 1.75
    place = placed(how.x, how.y, how.heading_deg) @ Matrix.Scale(scale, 4)
    lean = Matrix.Translation((0, 0, 0.95)) @ Matrix.Rotation(np.radians(how.lean_deg), 4, "Y")
    lean = place @ lean @ Matrix.Translation((0, 0, -0.95))
    gown, skin, cap = Parts(), Parts(), Parts()
    # above the hips: leans
    gown.limb((0, 0, 0.98), (0, 0, 1.30), 0.15, 0.14)
    gown.ball((0, 0.09, 1.30), (0.115, 0.12, 0.13)).ball((0, -0.09, 1.30), (0.115, 0.12, 0.13))
    gown.limb((0, 0.17, 1.42), (0, -0.17, 1.42), 0.062)
    gown.ball((0, 0, 1.10), (0.13, 0.17, 0.20))
    skin.limb((0, 0, 1.44), (0.01, 0, 1.54), 0.052)
    skin.ball((0.02, 0, 1.635), (0.095, 0.073, 0.115)).ball((0.045, 0, 1.585), (0.06, 0.05, 0.055))
    skin.ball((0.112, 0, 1.62), (0.018, 0.014, 0.022)).ball((0.01, 0.075, 1.62), (0.02, 0.01, 0.03))
    skin.ball((0.01, -0.075, 1.62), (0.02, 0.01, 0.03))
    cap.ball((0.0, 0, 1.685), (0.105, 0.086, 0.085)).ball((-0.03, 0, 1.65), (0.08, 0.08, 0.08))
    for side, (shoulder, elbow) in ((1, how.left), (-1, how.right)):
        arm(gown, skin, side, shoulder, elbow)
    for parts in (gown, skin, cap):
        parts.turned(lean)
    legs = Parts()
    legs.bar((0, 0, 1.0), (0, 0, 0.42), 0.165, 0.235, n=20)
    for side in (1, -1):
        foot = Vector((how.step * side, 0.10 * side, 0.06))
        legs.limb((0, 0.09 * side, 0.92), foot + Vector((0, 0, 0.40)), 0.085, 0.06)
        legs.limb(foot + Vector((0, 0, 0.40)), foot, 0.06, 0.047)
        legs.ball(foot + Vector((0.06, 0, -0.015)), (0.135, 0.05, 0.045))
    legs.turned(place)
    legs.solid(
        f"{name} legs",
        tuple(0.8 * c for c in how.gown),
        grow_m=0.014,
        smooth=4,
        folds_m=0.014,
        triangles=1500,
    )
    gown.solid(f"{name} gown", how.gown, grow_m=0.011, smooth=4, folds_m=0.012, triangles=2200)
    skin.solid(f"{name} skin", SKIN, grow_m=0.006, smooth=3, triangles=2600)
    cap.solid(
        f"{name} cap", HAIR if name.endswith("2") else (0.15, 0.4, 0.5), grow_m=0.012, smooth=3, triangles=300
    )


def arm(gown: Parts, skin: Parts, side: int, shoulder_deg: float, elbow_deg: float) -> None:
    """A sleeve to the wrist and a hand with fingers."""
    root = np.array([0.0, 0.205 * side, 1.40])
    elbow = root + 0.29 * down(shoulder_deg) + (0, 0.045 * side, 0)
    wrist = elbow + 0.25 * down(shoulder_deg + elbow_deg) - (0, 0.03 * side, 0)
    gown.limb(root, elbow, 0.062, 0.05).limb(elbow, wrist, 0.05, 0.037)
    ahead = down(shoulder_deg + elbow_deg)
    palm = wrist + 0.055 * ahead
    skin.limb(wrist - 0.05 * ahead, wrist, 0.03, 0.027)
    skin.ball(palm, (0.045, 0.038, 0.04))
    for finger in range(4):
        base = palm + 0.03 * ahead + (0, (finger - 1.5) * 0.019, 0)
        skin.limb(
            base, base + 0.065 * ahead + 0.02 * down(shoulder_deg + elbow_deg - 60), 0.0095, 0.0085, n=8
        )
    skin.limb(palm, palm + 0.05 * ahead - (0, 0.045 * side, 0), 0.012, 0.01, n=8)


def patient(table_top: float, *, arm_out: bool = False) -> None:
    """On the back, head towards -x, as skin and a gown; a drape goes over it apart."""
    z = table_top + 0.05
    gown, skin = Parts(), Parts()
    gown.limb((-0.02, 0, z + 0.11), (0.34, 0, z + 0.11), 0.125).ball((0.05, 0, z + 0.11), (0.24, 0.19, 0.12))
    gown.ball((0.42, 0, z + 0.105), (0.18, 0.18, 0.11))
    skin.limb((-0.10, 0, z + 0.11), (-0.24, 0, z + 0.10), 0.055)
    skin.ball((-0.33, 0, z + 0.115), (0.115, 0.076, 0.10)).ball((-0.30, 0, z + 0.20), (0.02, 0.014, 0.022))
    for side in (1, -1):
        skin.limb((0.48, 0.09 * side, z + 0.10), (0.90, 0.10 * side, z + 0.13), 0.08, 0.055)
        skin.limb((0.90, 0.10 * side, z + 0.13), (1.28, 0.10 * side, z + 0.07), 0.055, 0.04)
        skin.ball((1.33, 0.10 * side, z + 0.12), (0.05, 0.045, 0.11))
        out = arm_out and side == 1
        elbow = (0.20, 0.36, z + 0.05) if out else (0.22, 0.22 * side, z + 0.06)
        wrist = (0.26, 0.58, z + 0.04) if out else (0.46, 0.21 * side, z + 0.05)
        skin.limb((-0.04, 0.17 * side, z + 0.09), elbow, 0.05, 0.042).limb(elbow, wrist, 0.042, 0.03)
        reach = np.array((0.02, 0.09, 0)) if out else np.array((0.09, 0, 0))
        skin.ball(np.array(wrist) + 0.5 * reach, (0.05, 0.04, 0.022))
        skin.limb(wrist, np.array(wrist) + 1.5 * reach, 0.02, 0.011, n=8)
    gown.solid("patient gown", (0.55, 0.62, 0.70), grow_m=0.012, smooth=4, folds_m=0.008, triangles=1500)
    skin.solid("patient skin", SKIN, grow_m=0.009, smooth=4, triangles=2600)


def down(angle_deg: float) -> np.ndarray:
    """Straight down, swung forward (towards +x) by an angle."""
    a = np.radians(angle_deg)
    return np.array([np.sin(a), 0.0, -np.cos(a)])
