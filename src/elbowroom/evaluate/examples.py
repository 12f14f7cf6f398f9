"""Site files of the examples, which a checkout has and an installation has not."""

from pathlib import Path

from elbowroom.errors import InputError

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
"""The folder in the checkout that this code runs from; not there where it is installed."""


def example(name: str, folder: Path = EXAMPLES) -> Path:
    """The site file of an example.

    Args:
        name: such as "sevenscenes".
        folder: that holds it.

    Raises:
        InputError: it is not there.
    """
    path = folder / f"{name}.yaml"
    if not path.is_file():
        raise InputError(
            f"{path}: not there; only a checkout has examples: name a site file, or the folder that holds them"
        )
    return path
