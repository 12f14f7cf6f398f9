"""What a site says of what its machine touches, carries and looks like."""

import numpy as np
import pytest
import trimesh

from elbowroom.errors import MachineError, SiteError
from elbowroom.site import Site
from elbowroom.site.notes import notes_of


def site_of(folder, plain, **machine):
    return Site.load(folder.write({**plain, "machine": machine}))


CARRIED = {
    "links": ["first"],
    "lower_m": [-1, -1, -0.1],
    "upper_m": [1, 1, 0.0],
}


TABLE = {"name": "table", "links": ["hand"], "lower_m": [-1, -1, -0.1], "upper_m": [9, 9, 9]}


@pytest.fixture
def urdf(arm_urdf):
    return str(arm_urdf)


def test_contacts_stands_and_parts_are_read(folder, plain, urdf):
    first, last = "base", "hand"
    trimesh.creation.box((100, 20, 10)).export(folder.path / "rod.stl")
    site = site_of(
        folder,
        plain,
        urdf=urdf,
        allowed_contacts=[[first, last]],
        stands_on=[{**CARRIED, "links": [first]}],
        carries=[
            {"name": "plate", "link": last, "box_m": [0.3, 0.3, 0.01]},
            {"name": "rod", "link": "plate", "mesh": "rod.stl", "mesh_scale": 0.001},
            {"name": "can", "link": last, "cylinder_m": [0.03, 0.1]},
        ],
    )
    machine = site.machine()
    assert machine.parts == ("plate", "rod", "can")
    assert machine.stands[0].links == (first,)
    assert (first, last) in machine.allowed_contacts
    notes = "\n".join(notes_of(site))
    assert (
        f"Not stopped by anything there, by the site's word: {first} in (-1, -1, -0.1) to (1, 1, 0) m"
        in notes
    )
    assert f"May touch each other, by the site's word: {first} and {last}" in notes


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"stands_on": [{**CARRIED, "links": []}]}, "links"),
        ({"stands_on": [{**CARRIED, "upper_m": [1, 1, -1]}]}, "has no inside"),
        ({"stands_on": [{**CARRIED, "links": ["nobody"]}]}, "link 'nobody' does not exist"),
        ({"allowed_contacts": [["nobody", "nothing"]]}, "link 'nobody' does not exist"),
        ({"allowed_contacts": [["one"]]}, "allowed_contacts"),
        ({"carries": [{"name": "a", "link": "nobody", "box_m": [1, 1, 1]}]}, "link 'nobody' does not exist"),
        ({"carries": [{"name": "a", "link": "b"}]}, "exactly one of box_m, cylinder_m"),
        (
            {"carries": [{"name": "a", "link": "b", "box_m": [1, 1, 1], "mesh": "a.stl"}]},
            "exactly one of box_m",
        ),
        (
            {"carries": [{"name": "a", "link": "b", "box_m": [1, 1, 1], "mesh_scale": 1}]},
            "mesh_scale only with mesh",
        ),
        ({"explain_with": "both"}, "explain_with"),
        (
            {"stands_on": [{"links": ["hand"], "lower_m": [-9, -9, -9], "upper_m": [9, 9, 9]}]},
            "whole way of hand",
        ),
        ({"contacts": [{**TABLE, "lower_m": [-9, -9, -9]}]}, "whole way of hand"),
        ({"contacts": [{**TABLE, "links": []}]}, "links"),
        ({"contacts": [{**TABLE, "links": ["nobody"]}]}, "link 'nobody' does not exist"),
        ({"contacts": [{**TABLE, "name": "hand"}]}, "that of a link"),
        ({"contacts": [{**TABLE, "near_m": 100}]}, "near_m"),
        ({"contacts": [{**TABLE, "mesh": "a.stl"}]}, "either lower_m and upper_m, or mesh"),
        ({"contacts": [{"name": "t", "links": ["hand"], "mesh": "none.stl"}]}, "no such file"),
        ({"own_links": "none.yaml"}, "no such file"),
        ({"srdf": "none.srdf"}, "no such file"),
        ({"srdf": "none.srdf", "own_links": "none.yaml"}, "either own_links or srdf"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_a_line(folder, plain, urdf, more, words):
    with pytest.raises((SiteError, MachineError), match=words) as error:
        site_of(folder, plain, urdf=urdf, **more).machine()
    assert "\n" not in str(error.value)


def split(**keys):
    """Two boxes that meet at z = 0.1 and are as large as the room."""
    for lower, upper in (([-9, -9, -9], [9, 9, 0.1]), ([-9, -9, 0.1], [9, 9, 9])):
        yield {"lower_m": lower, "upper_m": upper, "links": ["hand"]} | keys


def test_boxes_that_cover_a_links_whole_way_together_are_refused(folder, plain, urdf):
    """As one of them would be, whatever it is."""
    first, second = split()
    with pytest.raises(SiteError, match=r"stands_on: hand in .* and hand in .*: cover the whole way of hand"):
        site_of(folder, plain, urdf=urdf, stands_on=[first, second]).machine()
    near = [{**box, "name": name} for box, name in zip(split(), "ab", strict=True)]
    with pytest.raises(SiteError, match="contacts: a and b: cover the whole way of hand"):
        site_of(folder, plain, urdf=urdf, contacts=near).machine()
    zones = [{**box, "kind": "not_watched", "reason": "why"} for box in near]
    with pytest.raises(SiteError, match="zones: a and b: hand never leave them"):
        site_of(folder, {**plain, "zones": zones}, urdf=urdf).machine()
    # not where each has a link of its own, nor where one half stays uncovered
    site_of(folder, plain, urdf=urdf, stands_on=[first, {**second, "links": ["base"]}]).machine()
    site_of(folder, {**plain, "zones": zones[:1]}, urdf=urdf).machine()


HIGH = {
    "name": "high",
    "kind": "not_watched",
    "lower_m": [-9, -9, 9],
    "upper_m": [9, 9, 9.5],
    "links": ["hand"],
}


def test_zones_are_read_and_said(folder, plain, urdf):
    trimesh.creation.box((0.1, 0.2, 0.1)).export(folder.path / "bore.stl")
    zones = [
        {"name": "door", "kind": "kept_out", "lower_m": [-0.5, -0.5, 0], "upper_m": [0.5, 0.5, 0.5]},
        {"name": "bore", "kind": "kept_out", "mesh": "bore.stl"},
        {**HIGH, "reason": "no camera looks there"},
    ]
    site = Site.load(folder.write({**plain, "machine": {"urdf": urdf}, "zones": zones}))
    assert [zone.name for zone in site.machine().zones] == ["door", "bore", "high"]
    notes = "\n".join(notes_of(site))
    assert "Kept out of, by the site's word: door, (-0.5, -0.5, 0) to (0.5, 0.5, 0.5) m" in notes
    assert "Not watched for hand, by the site's word: high" in notes
    assert "zone high lies outside the watched box: it changes nothing" in notes


@pytest.mark.parametrize(
    ("zone", "words"),
    [
        ({**HIGH}, "links and a reason"),
        ({**HIGH, "reason": "why", "links": []}, "links and a reason"),
        ({**HIGH, "kind": "kept_out", "reason": "why"}, "no links where all are kept out"),
        ({**HIGH, "reason": "why", "upper_m": None}, "either lower_m and upper_m, or mesh"),
        ({**HIGH, "reason": "why", "links": ["nobody"]}, "link 'nobody' does not exist"),
        ({**HIGH, "reason": "why", "lower_m": [-9, -9, -9]}, "hand never leave it"),
        ({"name": "a", "kind": "kept_out", "mesh": "none.stl"}, "no such file"),
        ({"name": "a", "kind": "forbidden", "lower_m": [0, 0, 0], "upper_m": [1, 1, 1]}, "kind"),
    ],
)
def test_a_zone_that_cannot_be_meant_is_refused_in_a_line(folder, plain, urdf, zone, words):
    content = {key: value for key, value in zone.items() if value is not None}
    with pytest.raises((SiteError, MachineError), match=words) as error:
        Site.load(folder.write({**plain, "machine": {"urdf": urdf}, "zones": [content]})).machine()
    assert "\n" not in str(error.value)


def test_contacts_are_read_and_said(folder, plain, urdf):
    trimesh.creation.box((1, 1, 0.1)).export(folder.path / "table.stl")
    up = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]
    site = site_of(
        folder,
        plain,
        urdf=urdf,
        contacts=[
            {
                **TABLE,
                "upper_m": [1, 1, 0],
                "near_m": 0.05,
                "zone": {"lower_m": [0, 0, 0], "upper_m": [1, 1, 1]},
            },
            {
                "name": "shelf",
                "links": ["base"],
                "mesh": "table.stl",
                "world_from_mesh": up,
                "may_touch": True,
            },
        ],
    )
    table, shelf = site.machine().contacts
    assert (table.near_m, table.may_touch, shelf.may_touch) == (0.05, False, True)
    assert 1.94 < shelf.surface.vertices[:, 2].min() < 1.96
    notes = "\n".join(notes_of(site))
    assert (
        "May be near table, (-1, -1, -0.1) to (1, 1, 0) m, by the site's word: hand, within 50 mm, in a part"
        in notes
    )
    assert "May touch shelf" in notes


def test_zones_need_a_machine(folder, plain):
    with pytest.raises(SiteError, match="zones only with a machine"):
        Site.load(folder.write({**plain, "zones": [{**HIGH, "reason": "why"}]}))


def shifted(x):
    return [[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def test_several_machines_are_one_to_all_that_asks(folder, plain, urdf):
    machines = [
        {"name": "left", "urdf": urdf, "joint_prefix": "left_", "stands_on": [CARRIED | {"links": ["base"]}]},
        {"name": "right", "urdf": urdf, "world_from_base": shifted(1.0)},
    ]
    content = {key: value for key, value in plain.items() if key not in ("machine", "joints")}
    machine = Site.load(folder.write({**content, "machines": machines})).machine()
    assert {name.split("/")[0] for name in machine.link_names} == {"room", "left", "right"}
    assert len(set(machine.joint_names)) == len(machine.joint_names)
    assert machine.stands[0].links == ("left/base",)
    placed = machine.world_from_links(machine.nearest_to_zero())
    assert placed["right/base"][0, 3] - placed["left/base"][0, 3] == 1.0


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"machines": [{"name": "a", "urdf": "U"}, {"name": "b", "urdf": "U"}]}, "a and b both have a joint"),
        ({"machines": [{"name": "a", "urdf": "U"}, {"name": "a", "urdf": "U"}]}, "a is there more than once"),
        ({"machines": [{"urdf": "U"}]}, "name"),
        ({"machines": [{"name": "a/b", "urdf": "U"}]}, "name"),
        ({"machines": [{"name": "a", "urdf": "U"}], "machine": {"urdf": "U"}}, "either machine or machines"),
    ],
)
def test_machines_that_cannot_be_told_apart_are_refused(folder, plain, urdf, more, words):
    content = {key: value for key, value in plain.items() if key not in ("machine", "joints")} | more
    for entry in (*content["machines"], *([content["machine"]] if "machine" in content else [])):
        entry["urdf"] = urdf
    with pytest.raises((SiteError, MachineError), match=words) as error:
        Site.load(folder.write(content)).machine()
    assert "\n" not in str(error.value)


FAR = [[1, 0, 0, 300], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


@pytest.mark.parametrize(
    ("machine", "more", "words"),
    [
        (
            {"carries": [{"name": "rod", "link": "hand", "mesh": "mm.stl"}]},
            {},
            r"part rod: is 300 m long, at most 20 m may be; is it in millimetres\? mesh_scale .* 0.001 makes it 0.3 m",
        ),
        (
            {"carries": [{"name": "rod", "link": "hand", "box_m": [300, 20, 10]}]},
            {},
            "part rod: is 300 m long",
        ),
        (
            {"carries": [{"name": "rod", "link": "hand", "box_m": [0.1, 0.1, 0.1], "link_from_part": FAR}]},
            {},
            r"part rod: lies 299.* m from its link's frame; is link_from_part in millimetres",
        ),
        (
            {"contacts": [{"name": "t", "links": ["hand"], "mesh": "mm.stl"}]},
            {},
            "contacts: t: .*mm.stl: is 300 m long",
        ),
        (
            {},
            {"zones": [{"name": "z", "kind": "kept_out", "mesh": "mm.stl"}]},
            "zones: z: .*mm.stl: is 300 m long",
        ),
        ({"limit_tolerance_deg": 400}, {}, "limit_tolerance_deg"),
        ({"limit_tolerance_mm": 5000}, {}, "limit_tolerance_mm"),
    ],
)
def test_what_must_be_in_millimetres_is_refused(folder, plain, urdf, machine, more, words):
    trimesh.creation.box((300, 20, 10)).export(folder.path / "mm.stl")
    with pytest.raises((SiteError, MachineError), match=words):
        site_of(folder, {**plain, **more}, urdf=urdf, **machine).machine()


def test_what_may_be_in_another_unit_is_a_note(folder, plain, urdf):
    contact = {"name": "post", "links": ["hand"], "lower_m": [300, 0, 0], "upper_m": [301, 1, 1]}
    carries = [{"name": "rod", "link": "hand", "box_m": [15, 0.01, 0.01], "link_from_part": beside(8.0)}]
    carries += [{"name": "dot", "link": "hand", "box_m": [1e-4, 1e-4, 1e-4], "link_from_part": beside(0.5)}]
    site = site_of(folder, plain, urdf=urdf, contacts=[contact], carries=carries)
    notes = "\n".join(notes_of(site))
    for words in (
        "part rod is 15 m long",
        "part dot is 0.1 mm long",
        "contact post lies outside the watched box",
    ):
        assert words in notes
    assert not site.machine().without_part("rod").without_part("dot").findings


def beside(x):
    pose = np.eye(4)
    pose[0, 3] = x
    return pose.tolist()
