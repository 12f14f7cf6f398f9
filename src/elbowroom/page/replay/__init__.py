"""The page over a recording: time, stops, play and step."""
