"""The machine's surface beside what is measured, in compiled loops."""
