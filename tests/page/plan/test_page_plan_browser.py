"""Planning in a real browser: dragged, clicked, typed; saved, and refused."""

import json
import struct
import time
from collections.abc import Callable, Iterator
from itertools import combinations, cycle

import numpy as np
import pytest

from elbowroom.page.plan import drawn
from elbowroom.page.plan.furniture import MOST_BYTES
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.opened import open_plan
from elbowroom.page.plan.room_file import write_room
from elbowroom.page.plan.saved import kept
from elbowroom.page.plan.session import Session
from elbowroom.page.words import words_of
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Solid
from elbowroom.site import Site
from page.plan.conftest import ROOM
from reference.browser import SOFTWARE_WEBGL, browsers, frames_go_by, serious, settled
from reference.colour import APART, CONES, lab

WAITS_S = 30.0


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> Iterator[Session]:
    folder = tmp_path_factory.mktemp("plan")
    (folder / "room.yaml").write_text(ROOM, encoding="utf-8")
    with browsers():  # skipped here, where there is no browser
        pass
    opened = open_plan(
        Ground.of(Site.load(folder / "room.yaml")), words_of("en"), folder / "planned.yaml", port=0
    )
    yield opened
    opened.stop()
    opened.page.stop()


@pytest.fixture(scope="module")
def panel(session):
    """The panel in a browser that draws."""
    with browsers() as browser:
        context = browser(*SOFTWARE_WEBGL).new_context(viewport={"width": 860, "height": 480})
        context.set_default_timeout(WAITS_S * 1000)
        tab = context.new_page()
        tab.goto(session.page.url)
        frame = tab.frame_locator("iframe")
        frame.get_by_role("button", name="Undo").wait_for()
        waited(lambda: session.server.get_clients())
        says((frame, tab), "Exact, at 10.0 cm")
        yield frame, tab
        context.close()


def waited(is_so: Callable[[], object]) -> None:
    until = time.monotonic() + WAITS_S
    while not is_so():
        assert time.monotonic() < until, "it did not come to be"
        time.sleep(0.05)


def click(panel, name: str) -> None:
    panel[0].get_by_role("button", name=name, exact=True).click()


def unfold(panel, section: str, button: str) -> None:
    """Opens a part of the panel, if it is closed."""
    if not panel[0].get_by_role("button", name=button, exact=True).is_visible():
        panel[0].get_by_text(section, exact=True).click()
    panel[0].get_by_role("button", name=button, exact=True).wait_for()


def says(panel, text: str) -> None:
    panel[0].get_by_text(text).first.wait_for()


def pixel(session, panel, point: np.ndarray) -> np.ndarray:
    """Where a point of the room is in the tab [px]."""
    (client,) = session.server.get_clients().values()
    camera = client.camera
    w, x, y, z = camera.wxyz
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    right, down, ahead = (point - camera.position) @ turn
    box = panel[0].locator("canvas").first.bounding_box()
    focal = box["height"] / 2 / np.tan(camera.fov / 2)
    middle = np.array([box["x"] + box["width"] / 2, box["y"] + box["height"] / 2])
    return middle + focal * np.array([right, down]) / ahead


def drag(tab, start: np.ndarray, step: np.ndarray) -> None:
    """As a hand does, not all within one frame of software drawing."""
    scene = tab.frames[1]
    tab.mouse.move(*start)
    frames_go_by(scene, 4)
    tab.mouse.down()
    for share in np.linspace(0.2, 1.0, 5):
        frames_go_by(scene)
        tab.mouse.move(*(start + share * step))
    frames_go_by(scene)
    tab.mouse.up()
    frames_go_by(scene, 4)


def test_a_camera_is_dragged_and_the_figures_follow(session, panel) -> None:
    _, tab = panel
    session.choose("b")
    waited(lambda: session.gizmo._handle is not None)
    settled(tab, tab.locator("iframe"))
    before, figures = session.planner.layout.camera("b").camera, session.newest.figures
    centre, along = before.centre_in_world, before.world_from_camera[:3, 2]
    until_s, reaches = time.monotonic() + WAITS_S, cycle((0.30, 0.36, 0.24, 0.40, 0.33))
    while session.planner.layout.camera("b").camera is before:
        # a busy computer draws so slowly that a hand has to pull again
        assert time.monotonic() < until_s, "it is not dragged"
        start = pixel(session, panel, centre + next(reaches) * along)
        drag(tab, start, 0.8 * (start - pixel(session, panel, centre)))
    waited(lambda: session.newest.figures.is_exact and session.newest.layout is session.planner.layout)
    moved = session.planner.layout.camera("b").camera.centre_in_world - centre
    assert moved @ along > 0.1
    assert np.linalg.norm(moved - (moved @ along) * along) < 1e-3
    assert session.newest.figures.price != figures.price
    # all of the drag is one step
    click(panel, "Undo")
    waited(lambda: session.planner.layout.camera("b").camera is before)
    click(panel, "Redo")
    waited(lambda: session.planner.layout.camera("b").camera is not before)


def test_cameras_people_and_sensors_come_by_clicks(session, panel) -> None:
    click(panel, "Add a camera")
    waited(lambda: len(session.planner.layout.cameras) == 5)
    says(panel, "5 cameras")
    unfold(panel, "People and furniture", "Place a person")
    click(panel, "Place a person")
    waited(lambda: session.planner.layout.body_names == ("person 1",))
    click(panel, "Remove it")
    waited(lambda: not session.planner.layout.people)


def test_axe_finds_nothing_serious_in_the_frame_and_in_the_panel(session, panel) -> None:
    _, tab = panel
    unfold(panel, "People and furniture", "Place a person")
    click(panel, "Place a person")
    waited(lambda: session.planner.layout.people)
    until_s, found = time.monotonic() + 10.0, ["not asked"]
    while found and time.monotonic() < until_s:  # what just came is named within moments
        found = [*serious(tab), *serious(tab.frames[1])]
    assert found == []
    click(panel, "Remove it")
    waited(lambda: not session.planner.layout.people)


def test_what_the_plan_draws_is_told_apart_by_every_eye(session, panel) -> None:
    _, tab = panel
    shown = settled(tab, tab.locator("iframe")).reshape(-1, 3)
    due = {"invalid": drawn.INVALID, "camera": (0, 114, 178), "chosen": drawn.CHOSEN}
    found = {}
    for name, colour in due.items():
        near = shown[np.abs(shown.astype(int) - colour).max(axis=1) < 40]
        assert len(near) > 30, name
        found[name] = np.median(near, axis=0)
    dots = dict(drawn.DOTS)
    for cones, seen in CONES.items():
        for one, other in combinations(found, 2):
            assert np.linalg.norm(lab(found[one], seen) - lab(found[other], seen)) > 0.8 * APART, (
                cones,
                one,
                other,
            )
        for one, other in combinations(dots, 2):
            assert np.linalg.norm(lab(dots[one], seen) - lab(dots[other], seen)) > APART, (cones, one, other)


ASSET = {"asset": {"version": "2.0"}}
NASTY = "<img src=x onerror=window.top.hit=1>"


def chair(folder, scale: float = 1.0, name: str = "chair") -> bytes:
    """A GLB of a chair, modelled in so many metres a unit."""
    shape = join([box((0, 0, 0), (0.5 * scale, 0.5 * scale, 0.9 * scale))])
    return write_room([Solid(name, shape, np.eye(4))], folder / "chair.glb").read_bytes()


def glb_of(told: dict[str, object]) -> bytes:
    """A GLB of one piece of JSON, without geometry."""
    text = json.dumps(told).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sII", b"glTF", 2, 20 + len(text)) + struct.pack("<I4s", len(text), b"JSON") + text


def upload(panel, name: str, content: bytes) -> None:
    frame, tab = panel
    with tab.expect_file_chooser() as chooser:
        frame.get_by_role("button", name="Place a mesh").click()
    chooser.value.set_files({"name": name, "mimeType": "model/gltf-binary", "buffer": content})


@pytest.mark.parametrize(
    ("name", "content", "text"),
    [
        # in several messages, each within what the door lets through
        ("broken.glb", lambda _: b"glTF nothing" * 200_000, "broken.glb"),
        ("large.glb", lambda _: bytes(MOST_BYTES + 1), "at most 30 MB"),
        ("millimetres.glb", lambda folder: chair(folder, 1000.0), "export it in metres"),
        ("tiny.glb", lambda folder: chair(folder, 1e-3), "export it in metres"),
        ("nothing.glb", lambda _: glb_of(ASSET), "nothing.glb"),
        (
            "bare.glb",
            lambda _: glb_of(
                {"asset": {"version": "2.0"}, "nodes": [{"mesh": 7}], "scenes": [{"nodes": [0]}]}
            ),
            "bare.glb",
        ),
        (f"{NASTY}.glb", lambda _: b"glTF" + bytes(60), NASTY),
    ],
    ids=lambda value: value if isinstance(value, str) and value.endswith(".glb") else "",
)
def test_a_file_that_cannot_be_placed_is_said_and_the_work_is_kept(
    session, panel, tmp_path, name, content, text
) -> None:
    layout = session.planner.layout
    session.panel.say("nothing yet")
    unfold(panel, "People and furniture", "Place a person")
    upload(panel, name, content(tmp_path))
    says(panel, text)
    assert session.planner.layout is layout
    assert panel[1].evaluate("window.hit") is None and panel[0].locator("img[src=x]").count() == 0


def test_names_with_html_in_them_are_shown_as_text(session, panel, tmp_path) -> None:
    unfold(panel, "People and furniture", "Place a person")
    upload(panel, f"{NASTY} 1.glb", chair(tmp_path, name=NASTY))
    waited(lambda: session.planner.layout.things)
    (thing,) = session.planner.layout.things
    settled(panel[1], panel[1].locator("iframe"))
    assert panel[1].evaluate("window.hit") is None and panel[0].locator("img[src=x]").count() == 0
    session.planner.remove(thing.name)


def test_a_plan_that_is_no_site_is_said_and_the_work_is_kept(session, panel) -> None:
    frame, _ = panel
    layout = session.planner.layout
    centre = next(placed.camera for placed in layout.cameras if placed.name == "a").world_from_camera.copy()
    centre[:3, 3] = (0.8, 0.8, 0.8)  # within the shelf
    session.planner.place_camera("a", centre)
    says(panel, "inside shelf")
    waited(lambda: session.newest.trouble is not None)
    click(panel, "Undo")
    waited(lambda: session.newest.figures is not None and session.newest.layout is session.planner.layout)
    while session.planner.layout.cameras:
        session.planner.remove_camera(session.planner.layout.camera_names[0])
    click(panel, "Save as site file")
    waited(lambda: "nothing yet" not in session.panel.at["message"].content)
    assert not (session.out.parent / "planned.yaml").exists() or frame.get_by_text("Saved as").count()
    while not session.planner.layout.cameras or len(session.planner.layout.cameras) < len(layout.cameras):
        session.planner.undo()


def test_what_is_saved_is_a_site_and_what_cannot_be_is_said(session, panel) -> None:
    frame, _ = panel
    field = frame.locator("input[value='planned.yaml']")
    field.evaluate("field => field.setAttribute('data-testid', 'file')")
    field = frame.get_by_test_id("file")
    field.fill("../elsewhere.yaml")
    field.press("Enter")
    click(panel, "Save as site file")
    says(panel, "without a folder")
    field.fill("room.yaml")
    field.press("Enter")
    click(panel, "Save as site file")
    says(panel, "itself")
    field.fill("mine.yaml")
    field.press("Enter")
    click(panel, "Save as site file")
    says(panel, "Saved as")
    cameras = Site.load(session.out.with_name("mine.yaml")).cameras()
    for camera, placed in zip(cameras, session.planner.layout.cameras, strict=True):
        np.testing.assert_allclose(camera.world_from_camera, placed.camera.world_from_camera, atol=2e-9)


def test_what_was_done_is_kept_without_being_saved(session, panel) -> None:
    session.kept_at.unlink(missing_ok=True)
    click(panel, "Look at the middle")
    waited(session.kept_at.is_file)
    again = kept(session.kept_at, session.ground)
    for camera, placed in zip(again.cameras, session.planner.layout.cameras, strict=True):
        pose = placed.camera.world_from_camera
        np.testing.assert_allclose(camera.camera.world_from_camera, pose, atol=2e-9)
