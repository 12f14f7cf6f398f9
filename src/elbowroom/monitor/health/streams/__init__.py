"""What comes from cameras and joints, as a stream: each thing that can be wrong with it by its name, until it is over."""
