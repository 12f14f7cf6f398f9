"""Paths beside exact geometry."""
