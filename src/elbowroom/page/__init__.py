"""The page: what the cameras see, why the machine stopped, and the same over a recording, in a process of its own."""
