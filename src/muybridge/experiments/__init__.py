"""What can be measured on any machine with nothing but the package.

| module | what |
|---|---|
| `machine` | the hardware, versions and commit that a number belongs to |
| `speed` | `BENCHMARKS`: likelihoods, filters, rendering; each a row of the table that `muybridge bench` prints |
"""
