"""Triangles in space."""

from elbowroom.geometry.kernels.bits import uncounted


@uncounted()
def normal_of(triangle):
    """Normal of a triangle's plane by the right hand, as long as twice its area; the triangle: (3, 3)."""
    ux, uy, uz = (
        triangle[1, 0] - triangle[0, 0],
        triangle[1, 1] - triangle[0, 1],
        triangle[1, 2] - triangle[0, 2],
    )
    vx, vy, vz = (
        triangle[2, 0] - triangle[0, 0],
        triangle[2, 1] - triangle[0, 1],
        triangle[2, 2] - triangle[0, 2],
    )
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
