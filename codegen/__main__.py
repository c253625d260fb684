"""``python -m moro_codegen`` is ``moro-codegen``."""

from moro_codegen.cli import main

if __name__ == "__main__":
    main(prog_name="moro-codegen")
