# SPDX-License-Identifier: Apache-2.0
"""Mosaic navigation: where a live frame is in a finished mosaic, and how to go to a chosen place of it.

Places are pixels of `mosaic.png`, (0, 0) the centre of its top left pixel, x to the right, y down.
"""
