# SPDX-License-Identifier: Apache-2.0
"""The golden model's arithmetic in C++, for hosts: the same bits as `golden.log` and `golden.correlate`, sooner."""
