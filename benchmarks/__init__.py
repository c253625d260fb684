"""The speed of moro and of its peers, measured side by side: ``make bench``."""
