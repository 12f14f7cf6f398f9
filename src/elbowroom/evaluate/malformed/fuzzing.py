"""The process that tries one reader, led by coverage: `python -m elbowroom.evaluate.malformed.fuzzing NAME FOLDER S`.

It is one of its own: libFuzzer does not come back, and a reader that crashes takes the process with it.
"""

import json
import os
import sys
import time
from contextlib import suppress
from pathlib import Path

from elbowroom.extras import package

PACKAGES = ("elbowroom", "yaml", "PIL", "pymodbus")
"""Whose branches are followed."""
FOLLOWED = ("files", "guard", "monitor/blackbox", "sensing", "site", "sources", "wire")
"""Folders of this package that read what comes from outside; of all others it is no matter where they go."""
HANGS_S = 30
"""An input that takes longer is a hang [s]."""
DONE = "done.json"
PACKAGE = Path(__file__).parents[2]


def left_alone() -> list[str]:
    """Modules that are not followed; kernels are compiled from their bytecode, which has to stay as it is."""
    found = []
    for file in PACKAGE.rglob("*.py"):
        parts = file.relative_to(PACKAGE).with_suffix("").parts
        is_followed = "/".join(parts).startswith(FOLLOWED) and "kernels" not in parts
        if not is_followed:
            found.append(".".join([PACKAGE.name, *(part for part in parts if part != "__init__")]))
    return found


def main() -> None:
    """Tries until the processor time is over."""
    name, folder, seconds = sys.argv[1], Path(sys.argv[2]), float(sys.argv[3])
    atheris = package("atheris")
    with atheris.instrument_imports(include=list(PACKAGES), exclude=left_alone()):
        from elbowroom.evaluate.malformed.targets import dictionary, quietly, target_of
        from elbowroom.evaluate.malformed.trial import Trial

        target = target_of(name)
        corpus, scratch = folder / "corpus", folder / "scratch"
        for each in (corpus, scratch):
            each.mkdir()
        trial = Trial(target, folder, scratch, holds=True)
        for number, seed in enumerate(target.seeds()):
            (corpus / f"seed-{number}").write_bytes(seed)
            with suppress(Exception):  # libFuzzer tries it again, and what is found of it is kept then
                quietly(target, seed, scratch)  # imports what it needs, while that is followed
    (folder / "words").write_bytes(dictionary(target))
    begun_s = time.process_time()

    def one(data: bytes) -> None:
        trial.one(data)
        spent_s = time.process_time() - begun_s
        if spent_s >= seconds:
            done = {"runs": trial.runs, "cpu_s": spent_s, "times": dict(trial.found)}
            (folder / DONE).write_text(json.dumps(done))
            os._exit(0)

    options = [f"-max_len={target.longest}", f"-timeout={HANGS_S}", "-rss_limit_mb=0"]
    options += [f"-dict={folder / 'words'}"] if target.words else []
    options += [f"-artifact_prefix={folder}/", "-seed=1", "-report_slow_units=1000"]
    atheris.Setup([sys.argv[0], *options, str(corpus)], one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
