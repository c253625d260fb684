"""``python -m moro_codegen.cli``."""

from moro_codegen.cli.command import main

main()
