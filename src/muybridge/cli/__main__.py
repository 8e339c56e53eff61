"""`python -m muybridge.cli`: the same as `muybridge`."""

from muybridge.cli import main

main()
