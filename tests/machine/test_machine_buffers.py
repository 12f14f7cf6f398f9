import gc

import numpy as np

from elbowroom.machine.buffers import zero_image


def place(image):
    return image.__array_interface__["data"][0]


def test_memory_is_used_again_when_the_image_is_gone_and_is_zero_then():
    image = zero_image(7, 5)
    image[:] = 3
    before = place(image)
    del image
    gc.collect()
    again = zero_image(7, 5)
    assert place(again) == before
    assert again.shape == (7, 5)
    assert not again.any()


def test_memory_is_not_used_again_while_any_view_of_the_image_lives():
    image = zero_image(9, 4)
    image[:] = np.arange(36).reshape(9, 4)
    views = [image[2:5, 1], image.T[1:], image.reshape(-1)[::2], image.view(np.uint32)]
    kept = [view.copy() for view in views]
    del image
    while views:
        gc.collect()
        other = zero_image(9, 4)
        other[:] = -1
        assert all(np.array_equal(view, was) for view, was in zip(views, kept, strict=True))
        views.pop()
        kept.pop()


def test_images_at_the_same_time_are_apart():
    one, two = zero_image(3, 3), zero_image(3, 3)
    one[:] = 1
    assert not two.any()
