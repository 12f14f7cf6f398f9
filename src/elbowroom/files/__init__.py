"""Files written whole or not at all, rows as JSON, YAML and matrices read safely: the ground that all stand on."""
