"""The most memory that this process has held."""

import sys
from pathlib import Path

STATUS = Path("/proc/self/status")


def peak_memory_mb() -> float | None:
    """The most that it has held at once, to within a megabyte [MB]; None: the system does not say (Windows).

    On Linux it is that of this program alone. What `getrusage` says there begins with what the process that started it
    held just then: a small one that a large one starts seems as large.
    """
    if STATUS.exists():
        for line in STATUS.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return 1024 * float(line.split()[1]) / 1e6
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # in bytes on macOS, in kibibytes elsewhere
    return float(peak if sys.platform == "darwin" else 1024 * peak) / 1e6
