"""What comes from cameras and joints, as a stream: what is wrong with it, by its name, until it is over."""
