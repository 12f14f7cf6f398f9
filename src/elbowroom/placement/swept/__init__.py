"""The space that a machine's motions sweep, link by link, and what of it no camera sees."""
