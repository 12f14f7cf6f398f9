"""Own links: whether published robots are stopped before they meet themselves, and only then, against mesh distance."""
