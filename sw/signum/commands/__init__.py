"""The commands of `signum`, one a file; each adds itself to `app.app`."""
