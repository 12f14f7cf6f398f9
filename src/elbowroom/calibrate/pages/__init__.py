"""The pages and pictures that say how a calibration went."""
