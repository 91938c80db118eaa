# SPDX-License-Identifier: Apache-2.0
"""What every room uses: types of arrays, errors for the user, and the terminal."""
