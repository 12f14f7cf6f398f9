"""`python -m elbowroom COMMAND`, as `elbowroom COMMAND`."""

from elbowroom.cli import main

if __name__ == "__main__":
    main()
