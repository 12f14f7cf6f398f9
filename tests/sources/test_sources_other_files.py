"""What systems and other programs leave in the folder of a recording is passed over, or named."""

import numpy as np
import pytest
from PIL import Image

from elbowroom.errors import SiteError
from elbowroom.site import Site
from elbowroom.sources import moments


@pytest.fixture
def site_in(folder, plain):
    """A site whose recording lies in the folder `rec`."""

    def site():
        return Site.load(folder.write(plain | {"recording": {"layout": "folder", "folder": "rec"}}))

    return site


def test_hidden_files_and_folders_are_nobodys_images_and_capital_endings_are(folder, site_in):
    for camera in ("north", "south"):
        folder.image(f"rec/{camera}/1000000000.PNG")
        (folder.path / f"rec/{camera}/._1000000000.PNG").write_bytes(b"\0\5\x16\7")
    for viewer in (".thumbnails", "@eaDir"):
        folder.image(f"rec/{viewer}/x.png")
    (moment,) = moments(site_in())
    assert [frame.camera for frame in moment.frames] == ["north", "south"]


def test_images_of_another_kind_are_counted_where_there_are_none(folder, site_in):
    for camera in ("north", "south"):
        (folder.path / "rec" / camera).mkdir(parents=True)
        Image.fromarray(np.ones((6, 8), np.uint16)).save(folder.path / "rec" / camera / "1000000000.tiff")
    with pytest.raises(SiteError, match=r"there are 2 files \.tiff: write depth as 16-bit PNG"):
        next(moments(site_in()))
