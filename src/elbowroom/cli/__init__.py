"""The command line: `elbowroom COMMAND`. Errors are one line that says what to do."""

import signal
import sys
import warnings
from collections.abc import Sequence

import typer

from elbowroom.errors import ElbowroomError, NoResultError

NO_RESULT = 1
FAILED = 2
INTERRUPTED = 130


def main(argv: Sequence[str] | None = None) -> None:
    """Runs the command line and exits with its code: 0 done, 1 what was found or checked is not as it should be, 2 an
    error, both in one line on stderr, 130 on Ctrl-C or where the system asks the process to end.

    Args:
        argv: the words after the program's name; None: those of this process.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    sys.exit(run(argv))


def run(argv: Sequence[str] | None = None) -> int:
    """As `main`, but gives the code back."""
    from elbowroom.cli.app import app

    with warnings.catch_warnings():
        warnings.showwarning = _show_warning
        try:
            code = app(
                args=None if argv is None else list(argv), prog_name="elbowroom", standalone_mode=False
            )
        except NoResultError as error:
            return _fail(str(error), NO_RESULT)
        except ElbowroomError as error:
            return _fail(str(error))
        except (KeyboardInterrupt, typer.Abort):
            return INTERRUPTED
        except OSError as error:
            return _fail(f"{error.filename or 'the system'}: {error.strerror or error}")
        except MemoryError:
            return _fail("not enough memory; choose larger voxels (--voxel-size) or a smaller grid")
        except Exception as error:
            # usage errors: typer's own class, or click's, by version; both say themselves what is wrong
            message = getattr(error, "format_message", None)
            if message is None:
                raise
            # without a word where a group of commands was named alone: its help is already printed
            return (
                _fail(f"{message()} (elbowroom COMMAND --help shows what is allowed)")
                if message()
                else FAILED
            )
    return code if isinstance(code, int) else 0


def _fail(message: str, code: int = FAILED) -> int:
    print(f"elbowroom: {' '.join(message.split())}", file=sys.stderr)
    return code


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    print(f"note: {' '.join(str(message).split())}", file=sys.stderr)
