"""The report of a stop: one HTML file that opens without network, with scene, slider, sentences and configuration."""
