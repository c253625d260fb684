"""Slips of the pen in files: words left out, or others in their place."""

import re

from hypothesis import strategies as st

_OTHERS = ["", "<", ">", '"', "nan", "-1", "a", "0", "&x;", "\n", "é", "<!--"]


def slipped(text):
    """Texts with one to three words, or signs between them, that are others."""
    words = re.split(r"(\W)", text)
    slip = st.tuples(st.integers(0, len(words) - 1), st.sampled_from(_OTHERS))

    def written(slips):
        found = [*words]
        for at, word in slips:
            found[at] = word
        return "".join(found)

    return st.lists(slip, min_size=1, max_size=3).map(written)
