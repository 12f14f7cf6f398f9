"""A second face, for those who live in Foxglove: what the monitor sees and decides, as topics of its protocol."""
