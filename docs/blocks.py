"""What pages show that is neither text nor the output of a sample: formulas, tables, long runs.

A page says where, with an expression that gives the text in between:

    <!-- write: formula(M.latex()) -->
    <!-- end -->

The expression knows the names below and those of the page's samples before it.
"""

from __future__ import annotations

import re

BLOCK = re.compile(r"^(<!-- write: ([^\n]+) -->\n)(.*?)^(<!-- end -->)$", re.MULTILINE | re.DOTALL)


def formula(latex: str) -> str:
    """Return LaTeX as a displayed formula."""
    return f"\n$$\n{latex}\n$$\n"


#: what expressions may use
NAMES = {"formula": formula}
#: these take the time of the machine at hand, so that no two runs are equal
TIMED: tuple[str, ...] = ()
