"""Images brought to a pinhole, in compiled loops."""
