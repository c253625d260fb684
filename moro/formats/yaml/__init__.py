"""robot.yaml: read without evaluating anything, errors with file, line and field."""
