"""Small matrices as text: numbers separated by blanks, a row a line."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError

MAX_MATRIX_BYTES = 100_000


def read_matrix(path: Path, shape: tuple[int, int], what: str) -> NDArray[np.float64]:
    """The matrix that a text file holds.

    Args:
        path: the file.
        shape: rows and columns that it must have.
        what: what the matrix stands for, for messages.

    Raises:
        SiteError: missing, too long, not numbers, of another shape, NaN or infinite.
    """
    rows, columns = shape
    if not path.is_file():
        raise SiteError(f"{path}: no such file; expected the {what} as {rows} rows of {columns} numbers")
    if path.stat().st_size > MAX_MATRIX_BYTES:
        raise SiteError(
            f"{path}: {path.stat().st_size:,} bytes, a {what} has {rows} rows of {columns} numbers"
        )
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        table = [[float(word) for word in line.replace(",", " ").split()] for line in lines if line.strip()]
    except ValueError as error:
        raise SiteError(f"{path}: {what}: not numbers ({error})") from None
    if len(table) != rows or any(len(row) != columns for row in table):
        found = "x".join([str(len(table)), "/".join(sorted({str(len(row)) for row in table}) or "0")])
        raise SiteError(f"{path}: {what}: {found} numbers, must be {rows}x{columns}")
    matrix = np.array(table)
    if not np.isfinite(matrix).all():
        raise SiteError(f"{path}: {what}: contains NaN or infinity; every number must be finite")
    return matrix
