"""A simulated room that judges a pass in a moment: site file."""

SMALL_ROOM = """
name: small room
grid: {origin_m: [-2, -2, 0], upper_m: [2, 2, 2.5], voxel_size_m: 0.2}
simulated: {cameras: 5, resolution: 48x36, seed: 3}
machine: {builtin: ceiling_c_arm}
joints:
  long: {max_speed_m_s: 0.15, braking_time_s: 0.5}
  larm: {max_speed_deg_s: 12, braking_time_s: 0.5}
"""
