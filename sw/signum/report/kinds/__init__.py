# SPDX-License-Identifier: Apache-2.0
"""A module per kind of table; each has `sections(folder)`, which `folder.py` calls: the folder's part of a page."""
