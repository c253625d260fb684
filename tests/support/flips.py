"""Single flipped bits of a file."""


def flipped(content, bit):
    """The bytes with one bit the other way round."""
    changed = bytearray(content)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)
