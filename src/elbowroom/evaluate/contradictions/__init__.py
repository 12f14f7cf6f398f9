"""Whether cameras that contradict each other are found and named, and right ones are left alone."""
