"""What can be measured on any machine with nothing but the package: speeds, and the papers' experiments.

| module | what |
|---|---|
| `machine` | the hardware, versions and commit that a number belongs to |
| `speed` | `BENCHMARKS`, the rows of `muybridge bench`: likelihoods, filters, rendering, backgrounds |
| `harness` | `run_experiment`: an experiment from end to end; `EXPERIMENTS`, the papers there are |
| `experiment` | what an experiment is: parts, cases, reports; how much is run |
| `runnable` | what the harness asks of a trial, whatever its kind |
| `trial` | one clip tracked once, described; its digest |
| `scenes`, `clips` | from a clip's description to a scene, and to the evidence kept of it |
| `bodies`, `spoiling` | right, fitted and wrong bodies; masks and cameras made worse on purpose |
| `running`, `through_job` | one trial in memory, or through the whole product; what it is judged by |
| `pool`, `store` | trials on several processes; results on disk |
| `statistics`, `summaries`, `tables` | intervals over seeds, paired differences; tables of them |
| `du_2005` | the thesis of the DE-MC particle filter |
| `sedai_2013` | the annealed particle filter that is guided by silhouettes |
| `zhao_2009` | the thesis of multi-part tracking in surveillance video |
"""
