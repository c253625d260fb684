"""Robot arms: exact symbolic equations of motion."""
