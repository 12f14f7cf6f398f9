"""What two cameras see in common, in compiled loops."""
