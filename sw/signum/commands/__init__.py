# SPDX-License-Identifier: Apache-2.0
"""The commands of `signum`, one a file; each adds itself to `app.app`."""
