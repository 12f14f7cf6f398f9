"""URDFs of a link or two, written by tests."""

import trimesh

BOX = '<link name="a"><collision><geometry><box size="1 1 1"/></geometry></collision></link>'


def urdf(folder, body, name="made.urdf"):
    path = folder / name
    path.write_text(f'<robot name="made">{body}</robot>')
    return path


def mesh_link(filename, kind="collision", name="a"):
    return f'<link name="{name}"><{kind}><geometry><mesh filename="{filename}"/></geometry></{kind}></link>'


def joint(kind="revolute", limit='<limit lower="-1" upper="1"/>', axis="0 0 1", child="b", more=""):
    return (
        f'<joint name="j" type="{kind}"><parent link="a"/><child link="{child}"/><axis xyz="{axis}"/>{limit}'
        f"{more}</joint>"
    )


def stl_link(folder, size, scale="", name="a", kind="stl"):
    trimesh.creation.box(size).export(folder / f"{name}.{kind}")
    return mesh_link(f"{name}.{kind}", name=name).replace("/></geo", f"{scale}/></geo")
