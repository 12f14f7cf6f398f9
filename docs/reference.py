"""Writes the reference: a page for each module, made from the docstrings.

    .venv/bin/python docs/reference.py out/reference

Open `index.html` of that folder in a browser; it needs no network. Compiled loops (`kernels/`) and what begins with an
underscore are left out.
"""

import pkgutil
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

import elbowroom


def modules() -> list[str]:
    """Names of all modules that the reference shows, the package first."""
    found = [module.name for module in pkgutil.walk_packages(elbowroom.__path__, "elbowroom.")]
    return ["elbowroom", *sorted(name for name in found if _is_shown(name))]


def _is_shown(name: str) -> bool:
    words = name.split(".")
    return "kernels" not in words and not words[-1].startswith("_")


def write(out: Path, names: Sequence[str]) -> None:
    """Writes the pages of some modules, and an index.

    Args:
        out: folder.
        names: of the modules.

    Raises:
        ModuleNotFoundError: pdoc is not installed; it comes with the extras `docs` and `test`.
    """
    import pdoc

    pdoc.render.configure(docformat="google", show_source=False, footer_text=f"elbowroom {version()}")
    with warnings.catch_warnings():
        # a package without `__all__` brings its modules along
        warnings.filterwarnings("ignore", message="The module specification .* has already been added")
        pdoc.pdoc(*names, output_directory=out)


def version() -> str:
    """The installed version."""
    from elbowroom.files.json_rows import package_version

    return package_version()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python docs/reference.py FOLDER")
    write(Path(sys.argv[1]), modules())
    print(f"written: {Path(sys.argv[1]) / 'index.html'}")
