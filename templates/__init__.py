"""Everything that is emitted, as Jinja templates."""
