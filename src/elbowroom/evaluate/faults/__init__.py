"""Faults thrown at a running monitor, its gate, its watchdog and its Modbus reader."""
