"""Whether a run of the whole monitor goes on as it begins: its memory, its times, its recording."""
