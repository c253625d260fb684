"""robot.yaml in, Robot out."""
