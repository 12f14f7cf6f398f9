"""What all entries of a site file share: unknown keys are refused, numbers are numbers and finite."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, Strict

# no room has numbers beyond this; within it, no product of a few of them overflows
Number = Annotated[float, Strict(), Field(allow_inf_nan=False, ge=-1e9, le=1e9)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Whole = Annotated[int, Strict()]
Count = Annotated[Whole, Field(ge=1)]
Text = Annotated[str, Strict(), Field(min_length=1, max_length=1000)]
Flag = Annotated[bool, Strict()]
Point = tuple[Number, Number, Number]
Row = tuple[Number, Number, Number, Number]
Matrix = tuple[Row, Row, Row, Row]
"""A 4x4 transform, row by row."""

Six = tuple[Number, Number, Number, Number, Number, Number]
Covariance = tuple[Six, Six, Six, Six, Six, Six]
"""Of a pose, row by row: rotation vector [rad], then translation [m]."""


class Entry(BaseModel):
    """A mapping of a site file."""

    model_config = ConfigDict(extra="forbid", frozen=True)
