"""The least machine that a kernel can be run on: a small box that slides."""

import tempfile
from pathlib import Path

from elbowroom.machine.machine import Machine

_URDF = """<robot name="probe">
  <link name="base"/>
  <link name="box"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="slide" type="prismatic">
    <parent link="base"/><child link="box"/><axis xyz="1 0 0"/>
    <limit lower="-0.1" upper="0.1" effort="1" velocity="1"/>
  </joint>
</robot>
"""


def probe() -> Machine:
    """A box of 0.1 m at the world's origin on one prismatic joint, `slide`: quick to sample, draw and check."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "probe.urdf"
        path.write_text(_URDF)
        return Machine.from_urdf(path)
