"""The most memory that this process has held."""

import sys


def peak_memory_mb() -> float | None:
    """The most that it has held at once [MB]; None: the system does not say (Windows)."""
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # in bytes on macOS, in kibibytes elsewhere
    return float(peak if sys.platform == "darwin" else 1024 * peak) / 1e6
