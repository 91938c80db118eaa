"""Every RTL module against its cycle model on every clock, in the rooms of `rtl/`."""
