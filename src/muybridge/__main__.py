"""`python -m muybridge`: the same as `muybridge`."""

from muybridge.cli import main

main()
