# SPDX-License-Identifier: Apache-2.0
"""Stimuli for the cycle models and their modules: what surrounds a block, with the results it must give."""
