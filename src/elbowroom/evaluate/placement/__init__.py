"""Layouts of cameras: time, numbers, and whether what is predicted of them holds."""
