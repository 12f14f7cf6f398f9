"""All cameras' views of one moment, and what they come to if some cameras saw otherwise than is said."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.contradiction.eye import Eye
from elbowroom.reconstruct.contradiction.pairs import Pairs, Points, points_of, seen_by, together
from elbowroom.reconstruct.contradiction.sample import SAMPLES, Sample, sample_of, seen_part
from elbowroom.sensing import DepthFrame


@dataclass(frozen=True, eq=False)
class Views:
    """How the cameras are said to see, and a sample of what each measured.

    Args:
        eyes: those of which there is an image.
        samples: of their images, in the same order.
    """

    eyes: tuple[Eye, ...]
    samples: tuple[Sample, ...]

    @classmethod
    def of(
        cls,
        cameras: Sequence[DepthCamera],
        frames: Sequence[DepthFrame],
        margin: Margin,
        samples: int = SAMPLES,
    ) -> Self:
        """The views of one moment; cameras without a frame are left out.

        Args:
            cameras: of the room.
            frames: at most one of each, of its camera's size.
            margin: of cameras without one of their own.
            samples: how many pixels of each image are looked at.
        """
        masks = {camera.name: camera.mask for camera in cameras}
        given = {frame.camera: frame for frame in frames}
        eyes = tuple(Eye.of(camera, margin) for camera in cameras if camera.name in given)
        seen = (given[eye.name] for eye in eyes)
        return cls(
            eyes,
            tuple(
                sample_of(eye, seen_part(masks[eye.name], frame.depth_m), frame.stamp_ns, samples)
                for eye, frame in zip(eyes, seen, strict=True)
            ),
        )

    @cached_property
    def typical_m(self) -> tuple[float, ...]:
        """What each camera measures in the middle of all that it measures [m]; 1 where that is nothing."""
        return tuple(
            float(np.median(sample.depth_m)) * eye.scale if len(sample.depth_m) else 1.0
            for eye, sample in zip(self.eyes, self.samples, strict=True)
        )

    @cached_property
    def points(self) -> tuple[Points, ...]:
        """What each camera measured, in the world."""
        return tuple(
            points_of(eye, sample, number)
            for number, (eye, sample) in enumerate(zip(self.eyes, self.samples, strict=True))
        )

    @cached_property
    def pairs(self) -> Pairs:
        """What all say of each other."""
        return self.pairs_if({}, range(len(self.eyes)))

    def with_eyes(self, others: Mapping[int, Eye]) -> Self:
        """The same images, if some cameras see otherwise.

        Args:
            others: how, by number.
        """
        return type(self)(
            tuple(others.get(number, eye) for number, eye in enumerate(self.eyes)), self.samples
        )

    def pairs_if(self, others: Mapping[int, Eye], among: Collection[int]) -> Pairs:
        """What is counted between some cameras that see otherwise and others, in both directions.

        Args:
            others: how they see, by number; none: all pairs as is said.
            among: the numbers of those that are compared, these among them.
        """
        count = len(self.eyes)
        points = {
            number: points_of(others[number], self.samples[number], number)
            if number in others
            else self.points[number]
            for number in among
        }
        pairs = Pairs.none(count)
        for looker in among:
            is_changed = looker in others or not others
            measured = [points[n] for n in among if n != looker and (is_changed or n in others)]
            if not measured:
                continue
            eye = others.get(looker, self.eyes[looker])
            pairs.put(looker, seen_by(eye, self.samples[looker], together(measured), count))
        return pairs
