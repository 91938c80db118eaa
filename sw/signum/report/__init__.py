# SPDX-License-Identifier: Apache-2.0
"""Reports: HTML pages with pictures, plots and tables inside, made from what a command wrote."""
