# SPDX-License-Identifier: Apache-2.0
"""CSV tables: the writer, and the columns of every table."""
