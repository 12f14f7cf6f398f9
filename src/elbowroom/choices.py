"""What a site file, the command line and the library let one choose between: each word written once.

Nothing is imported here, so that the command line starts at once.
"""

from typing import Literal, get_args

Rule = Literal["three", "majority", "veto", "any"]
"""How cameras that disagree are decided between (`reconstruct.resolve`)."""
RULES: tuple[Rule, ...] = get_args(Rule)
LAWFUL: tuple[Rule, ...] = ("three", "majority")
"""Rules by which less evidence never adds free space."""

Detail = Literal["footprint", "pixel", "point"]
"""How closely images are looked at (`reconstruct.carve`)."""
DETAILS: tuple[Detail, ...] = get_args(Detail)

ExplainWith = Literal["auto", "visual", "collision"]
"""Which geometry of a machine says what cameras see of it (`machine.seen`)."""
